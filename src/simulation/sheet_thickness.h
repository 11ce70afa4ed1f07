/// @file
/// Room `simulation`, private: how far sheets give way through their thickness where something presses them. Contacts of a
/// step in; a gap and a compliance for each out.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Without it jaws that close to less than the thickness of a sheet between them would ask for what no force can do.
/// A part of thickness h that is squeezed by s bears k h ln(h / (h - s)), by the logarithmic strain (Hencky, Z. Tech. Phys. 9, 1928), and
/// more and more as it is squeezed out; k is what it resists with at first, Tissue::thicknessStiffness() of a node. Steps have
/// its tangent. A node's k is divided among the contacts of one shape, or other tissue, that press there, by their weights:
/// so plates over all of a sheet meet (lambda + 2 mu) A ln(t / d) at the distance d. No allocation once vectors have grown;
/// nothing is done where all tissues are volumes.
class SheetThickness {
 public:
  explicit SheetThickness(const std::vector<Tissue>& tissues);

  /// @param contacts of the step, with the forces of the step before.
  void prepare(const std::vector<SolvedContact>& contacts);

  struct Tangent {
    double gap_m;       ///< that of the contact; < 0: minus the compliance times the force at this squeeze
    double compliance;  ///< m/N: of the sheets on both sides; 0: volumes touch
  };
  /// @param contact of that index.
  Tangent at(std::size_t index, const Contact& contact) const;

 private:
  /// A sheet's node as one contact presses it.
  struct Pressed {
    int tissue;
    int node;
    std::array<int, 4> by;  ///< instrument, link, shape; the other tissue
    std::size_t contact;
    int side;  ///< 0: the contact's own tissue, 1: the other
    double weight;
    bool presses;
  };
  void add(const SolvedContact& solved, std::size_t contact, int side);
  void divide(std::vector<Pressed>::const_iterator begin, std::vector<Pressed>::const_iterator end);

  const std::vector<Tissue>& tissues_;
  bool any_sheet_ = false;
  std::vector<Pressed> pressed_;                    ///< scratch
  std::vector<std::array<double, 2>> stiffnesses_;  ///< scratch: per contact and side, N/m; 0: no sheet
  std::vector<double> compliances_;
};

}  // namespace tissue_contact
