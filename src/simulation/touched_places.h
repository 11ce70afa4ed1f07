/// @file
/// Room `simulation`, private: where instruments and tissues touch refined tissues or are about to, and how fine cells are to be
/// there. Contacts of the last step and near surfaces in; places at rest out.
#pragma once

#include <vector>

#include "simulation/fine_cells.h"
#include "simulation/instrument_motion.h"
#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/solved_contact.h"

namespace tissue_contact {

/// A place of a tissue's surface that is to be fine.
struct TouchedPlace {
  Vector3 rest_W;                        ///< at rest, m, world frame
  double cell_m = 0.0;                   ///< edge of the cells there
  Vector3 velocity_W = Vector3::Zero();  ///< with which the touch moves over the tissue, m/s
  bool touches = true;                   ///< or does so within the next few steps
};

/// Of shapes, each counted with the smallest of its three, m; zeros: there are none.
struct HalfExtents {
  double smallest_m = 0.0;
  double largest_m = 0.0;
};

class TouchedPlaces {
 public:
  TouchedPlaces(const Scene& scene, const std::vector<Instrument>& instruments);

  /// Edge of the finest cells under a shape, m; 0: they are not refined for it.
  double cellUnder(int tissue, int instrument, int contact_link, int shape) const;
  /// Of all shapes on a tissue, m, ascending; none: it is refined for none.
  std::vector<double> cellsOn(int tissue) const;

  /// Smallest half extent of a shape, m; 0: it is flat.
  double halfExtent(int instrument, int contact_link, int shape) const {
    return half_extents_[instrument][contact_link][shape];
  }
  HalfExtents halfExtents() const;

  /// Begins with the places of one tissue where contacts carry force.
  /// @param rest its nodes at rest, m. @param last_dt length of the step that the contacts are of, s.
  void begin(int tissue, const std::vector<SolvedContact>& contacts, const NodalVectors& rest, double last_dt);

  /// How shapes come near in the step to come.
  struct Approaching {
    const InstrumentMotion& motion;
    double dt;
    double ahead_m;    ///< they are looked for that far beyond the reach of their cells
    double touches_m;  ///< as near they touch within a few steps
  };
  /// Adds those that shapes without such a contact are near to.
  /// @param x of the tissue, m.
  void addNear(const std::vector<NearPlace>& near, const FineCells& cells, const Approaching& approaching,
               const NodalVectors& x, const NodalVectors& rest);
  const std::vector<TouchedPlace>& places() const { return places_; }

 private:
  void add(const std::array<int, 3>& nodes, const Vector3& weights, double cell_m, const NodalVectors& rest);
  void addSpeed(std::size_t first, const Vector3& slips_W, double last_dt);

  std::vector<RefinementDescription> refinements_;              ///< per tissue
  std::vector<std::vector<std::vector<double>>> half_extents_;  ///< [instrument][contact link][shape], m
  int tissue_ = -1;
  std::vector<ContactKey> touching_;  ///< shapes that carry force there
  std::vector<TouchedPlace> places_;
};

}  // namespace tissue_contact
