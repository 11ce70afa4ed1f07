/// @file
/// Room `simulation`, private: how far sheets give way through their thickness where something presses them. Contacts of a
/// step in; a compliance for each out.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Without it jaws that close to less than the thickness of a sheet between them would ask for what no force can do.
/// What half the thickness resists with over a node's share of the area, Tissue::thicknessStiffness(), is divided among the
/// contacts of one shape, or other tissue, that press there, by their weights: so plates over all of a sheet meet
/// (lambda + 2 mu) A (1 - d / t) at the distance d. Linear: with a law that stiffens to the end jaws with real meshes press single
/// nodes with all they have. No allocation once vectors have grown; nothing is done where all tissues are volumes.
class SheetThickness {
 public:
  explicit SheetThickness(const std::vector<Tissue>& tissues);

  /// @param contacts of the step, with the forces of the step before.
  void prepare(const std::vector<SolvedContact>& contacts);

  /// Of the contact of that index, m/N: what the sheets on both its sides give way; 0: volumes touch.
  double complianceOf(std::size_t contact) const { return any_sheet_ ? compliances_[contact] : 0.0; }

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
