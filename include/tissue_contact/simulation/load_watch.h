/// @file
/// Room `simulation`: whether the contact forces of a step are such as the tissue could bear. Contacts with their forces
/// and node positions in; a finding with its place out.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/scene/scene.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

class Simulator;
struct SolvedContact;

/// What no tissue bears, at the end of an interval. The forces are then not to be trusted.
struct ImplausibleLoad {
  bool found = false;
  int tissue = -1;
  int instrument = -1;            ///< -1: another tissue
  Vector3 p_W = Vector3::Zero();  ///< where it is worst, m
  int inverted_elements = 0;      ///< at nodes that carry contact forces
  double pressure_pa = 0.0;       ///< largest mean contact pressure of an instrument on a tissue
  double modulus_pa = 0.0;        ///< Young's modulus it is compared with: the largest of that tissue
};

/// Finds
///  - tetrahedra at nodes that carry contact forces whose volume is below kInsideOut times that at rest: the tool has been
///    pushed through the elements, or these through each other, and the material law no longer means anything;
///  - a mean contact pressure, sum |f| over the rest area of the nodes touched, above kMostPressure times Young's modulus.
///    Soft tissue fails at strains of about .3 to 1 (capsule of the liver .35: Brunon et al. 2010), so at stresses below its modulus.
///    Opposed forces that a tool catches tissue with count here, although they cancel in its wrench.
class LoadWatch {
 public:
  static constexpr double kMostPressure = 2.0;  ///< times Young's modulus
  /// Not 0: where a coarse surface folds around a tool, a corner of an element may pass through its base for a step.
  static constexpr double kInsideOut = -0.1;

  LoadWatch(const Scene& scene, const std::vector<Tissue>& tissues);

  /// @param contacts sorted by key. No allocation once it has grown.
  void look(const std::vector<SolvedContact>& contacts, const std::vector<NodalVectors>& positions,
            ImplausibleLoad& load);

 private:
  struct Body {
    const Tissue* tissue;
    double modulus_pa;
    std::vector<double> node_area;   ///< m^2 at rest, a third of each surface triangle around
    std::vector<int> first_of_node;  ///< into elements_of_node, one more than nodes
    std::vector<int> elements_of_node;
    std::vector<long> node_seen, element_seen;  ///< the look in which it last was
  };
  void lookAtElements(Body& body, int node, const NodalVectors& x, int instrument, int tissue, ImplausibleLoad& load);

  std::vector<Body> bodies_;
  long looks_ = 0;
  double worst_volume_ = 0.0;  ///< of this look, over that at rest
};

/// A sentence for a log about what the last advance has found: what, where and what to do.
std::string implausibleLoadText(const Simulator& simulator);

}  // namespace tissue_contact
