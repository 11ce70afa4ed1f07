/// @file
/// Room `simulation`, private: where the cells of a refined mesh are fine. Places that are touched in; foci around which cells are fine,
/// and how long edges may be anywhere, out.
///
/// Cells are fine within the reach of a focus, and longer by a growth per metre beyond it.
#pragma once

#include <vector>

#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/refinement_description.h"

namespace tissue_contact {

/// A place that is to be fine, in the tissue's frame T.
struct FinePlace {
  Vector3 p_T;    ///< at rest, m
  double cell_m;  ///< edge of the cells there
};

class FineCells {
 public:
  /// Of the reach: as far from a focus a contact may come before the mesh moves on, and idle foci stay.
  static constexpr double kCovered = 0.75;

  explicit FineCells(const RefinementDescription& refinement)
      : reach_m_(refinement.reach_m),
        cells_of_reach_(refinement.choice().cells_of_reach),
        growth_(refinement.growth > 0.0 ? refinement.growth : refinement.choice().growth) {}

  double reach(double cell_m) const;
  double growth() const { return growth_; }
  bool isCovered(const FinePlace& place, double share_of_reach) const;
  double longestEdge(const Vector3& p_T) const;  ///< m

  bool empty() const { return foci_.empty(); }
  void clear();
  /// Without the foci near to which no place is.
  void dropIdle(const std::vector<FinePlace>& places);
  /// With foci of places that none covers well, of cells longer by coarsening().
  void add(const std::vector<FinePlace>& places);
  bool anyFinerThan(double coarsening) const;

  double coarsening() const { return coarsening_; }  ///< of the newest foci
  void setCoarsening(double coarsening) { coarsening_ = coarsening; }

  void carry(StateArchive& archive);

 private:
  struct Focus {
    Vector3 p_T;
    double asked_m;     ///< cells that a place asked for
    double coarsening;  ///< what they are longer by
  };
  bool covers(const Focus& focus, const FinePlace& place, double share) const;

  double reach_m_;  ///< how far fine cells reach beyond a place; 0: so many cells
  double cells_of_reach_;
  double growth_;  ///< length that they gain per length of distance beyond that
  std::vector<Focus> foci_;
  double coarsening_ = 1.0;
};

/// Refuses places that no scene has.
void carryPlaces(StateArchive& archive, std::vector<FinePlace>& places);

}  // namespace tissue_contact
