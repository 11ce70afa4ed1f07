/// @file
/// Room `simulation`, private: whether the contact forces of a step are such as the tissue could bear. Contacts with
/// their forces and node positions in; a finding with its place out.
#pragma once

#include <vector>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Finds
///  - tetrahedra at nodes that carry contact forces whose volume is below kInsideOut times that at rest: the tool has
///    been pushed through the elements, or these through each other, and the material law no longer means anything;
///  - a mean contact pressure, sum |f| over the rest area of the nodes touched, above kMostPressure times Young's
///    modulus. Soft tissue fails at strains of about .3 to 1 (capsule of the liver .35: Brunon et al. 2010), so at
///    stresses below its modulus. Opposed forces that a tool catches tissue with count here, although they cancel in
///    its wrench.
class LoadWatch {
 public:
  static constexpr double kMostPressure = 2.0;  ///< times Young's modulus
  /// Not 0: where a coarse surface folds around a tool, a corner of an element may pass through its base for a step.
  static constexpr double kInsideOut = -0.1;

  LoadWatch(const Scene& scene, const std::vector<Tissue>& tissues);

  /// @param contacts sorted by key. No allocation once it has grown.
  void check(const std::vector<SolvedContact>& contacts, const std::vector<NodalVectors>& positions,
             ImplausibleLoad& load);

 private:
  struct Body {
    const Tissue* tissue;
    double modulus_pa;
    std::vector<double> node_area;   ///< m^2 at rest, a third of each surface triangle around
    std::vector<int> first_of_node;  ///< into elements_of_node, one more than nodes
    std::vector<int> elements_of_node;
    std::vector<long> node_seen, element_seen;  ///< the check in which it last was
  };
  void checkElements(Body& body, int node, const NodalVectors& x, int instrument, int tissue, ImplausibleLoad& load);

  std::vector<Body> bodies_;
  long checks_ = 0;
  double worst_volume_ = 0.0;  ///< of this check, over that at rest
};

}  // namespace tissue_contact
