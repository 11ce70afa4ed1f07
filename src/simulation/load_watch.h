/// @file
/// Room `simulation`, private: whether the contact forces of a step are such as the tissue could bear, and whether its elastic law
/// still describes it there. Contacts with their forces and node positions in; a finding with its place, and the likely error
/// of the law, out.
#pragma once

#include <vector>

#include "tissue_contact/simulation/law_error.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Finds
///  - tetrahedra at nodes that carry contact forces whose volume is below kInsideOut times that at rest: the tool has
///    been pushed through the elements, or these through each other, and the material law no longer means anything;
///  - a mean contact pressure, sum |f| over the rest area of the nodes touched, above kMostPressure times Young's
///    modulus. Soft tissue fails at strains of about .3 to 1 (capsule of the liver .35: Brunon et al. 2010), so at
///    stresses below its modulus. Opposed forces that a tool catches tissue with count here, although they cancel in
///    its wrench.
/// Takes the strain and Poisson's ratio under each tool, where the law is one that leaves its range (law_error.h): of each contact
/// the mean over the elements around its nodes, by volume; of those the mean by force.
class LoadWatch {
 public:
  static constexpr double kMostPressure = 2.0;  ///< times Young's modulus
  /// Not 0: where a coarse surface folds around a tool, a corner of an element may pass through its base for a step.
  static constexpr double kInsideOut = -0.1;

  LoadWatch(const Scene& scene, const std::vector<Tissue>& tissues);

  /// Goes on with other materials of a tissue.
  void setMaterials(int index, const TissueDescription& description);
  /// What is kept of a tissue's mesh.
  struct Mesh {
    std::vector<double> node_area;   ///< m^2 at rest, a third of each surface triangle around
    std::vector<int> first_of_node;  ///< into elements_of_node, one more than nodes
    std::vector<int> elements_of_node;
    std::vector<long> node_seen, element_seen;  ///< the check in which it last was
    struct Strain {
      double times_volume, volume;
    };
    std::vector<Strain> strains;  ///< of the elements seen in this check; empty: the law has no range
  };
  static Mesh meshOf(const Tissue& tissue, ElasticModel law);
  /// Goes on with another mesh of a tissue, which has become that one; exchanges what is kept of it for what was before.
  void swapMesh(int index, Mesh& mesh);

  /// @param contacts sorted by key. No allocation once it has grown.
  void check(const std::vector<SolvedContact>& contacts, const std::vector<NodalVectors>& positions,
             ImplausibleLoad& load, LawError& law_error);

 private:
  struct Body {
    const Tissue* tissue;
    double modulus_pa;
    Mesh mesh;
    ElasticModel law;
    double poissons_ratio;                          ///< of the tissue
    std::vector<double> poissons_ratio_of_regions;  ///< less that
  };
  struct UnderTool {
    double strain = 0.0;
    double poissons_ratio = 0.0;  ///< less that of the tissue
  };
  static UnderTool underTool(const Body& body, const Contact& contact);
  static void add(const ContactKey& key, const Body& body, const UnderTool& mean, LawError& law_error);
  void checkElements(Body& body, int node, const NodalVectors& x, int instrument, int tissue, ImplausibleLoad& load);

  std::vector<Body> bodies_;
  long checks_ = 0;
  double worst_volume_ = 0.0;  ///< of this check, over that at rest
};

}  // namespace tissue_contact
