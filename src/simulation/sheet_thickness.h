/// @file
/// Room `simulation`, private: how far sheets give way through their thickness where something presses them. Contacts of a
/// step in; compliances for each out.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Of one contact, m/N: what the sheets on both its sides give way; 0: volumes touch.
struct SheetCompliance {
  double normal = 0.0;
  double tangential = 0.0;  ///< in shear
};

/// Without it jaws that close to less than the thickness of a sheet between them would ask for what no force can do.
/// What half the thickness resists with over a node's share of the area, Tissue::thicknessStiffness(), is divided among the
/// contacts of one shape, or other tissue, that press there, by their weights: so plates over all of a sheet meet
/// (lambda + 2 mu) A (1 - d / t) at the distance d. Linear: with a law that stiffens to the end jaws with real meshes press single
/// nodes with all they have. Likewise tangentially what half the thickness resists with in simple shear, G A / (t / 2): two tools that hold
/// the same nodes would have friction that only their order in the scene decides between them. No allocation once vectors have grown; nothing is done where all tissues are volumes.
class SheetThickness {
 public:
  explicit SheetThickness(const std::vector<Tissue>& tissues);

  /// To be called before prepare(), and when materials change. @param descriptions of the tissues.
  void setMaterials(const std::vector<TissueDescription>& descriptions);

  /// @param contacts of the step, with the forces of the step before.
  void prepare(const std::vector<SolvedContact>& contacts);

  SheetCompliance complianceOf(std::size_t contact) const {
    return any_sheet_ ? compliances_[contact] : SheetCompliance();
  }

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
  std::vector<Pressed> pressed_;          ///< scratch
  std::vector<VectorX> shear_stiffness_;  ///< per tissue and node, N/m: G A / (t / 2); empty: a volume
  struct Stiffness {
    double normal = 0.0;
    double tangential = 0.0;
  };
  std::vector<std::array<Stiffness, 2>> stiffnesses_;  ///< scratch: per contact and side, N/m; 0: no sheet
  std::vector<SheetCompliance> compliances_;
};

}  // namespace tissue_contact
