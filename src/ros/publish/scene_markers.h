/// @file
/// Room `ros`, private: the scene as RViz markers: surfaces coloured by displacement, instrument shapes, contact forces.
#pragma once

#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/MarkerArray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ros/publish/scene_snapshot.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// How markers are drawn, in positive numbers (the node's parameters, which `Outputs` checks). Fixed scales, so that pictures
/// taken at different times compare.
struct MarkerStyle {
  double displacement_full_scale_m = 0.005;  ///< displacement drawn in the last colour, m: a deep press of soft tissue
  double force_arrow_m_per_n = 0.5;          ///< arrow length per newton: 0.02 N at one contact is seen as 1 cm
};

/// Colour of a displacement: light skin (0) over red to near black (1), falling in lightness so that it also reads in
/// grey.
/// @param fraction of full scale; values outside 0..1 are drawn as the nearer end.
std_msgs::ColorRGBA displacementColor(double fraction);

/// Keeps one MarkerArray and updates it in place. Everything is drawn in the world frame, so RViz needs no tf.
/// Namespaces: `<tissue>` (triangles and their edges), `<instrument>` (its touching shapes, and its other links as the
/// URDF draws them), `contact_forces` (an arrow per touching contact: the force on the instrument, from the contact point;
/// held contacts blue, sliding ones red).
class SceneMarkers {
 public:
  /// @param simulator must outlive this; only what never changes is read of it.
  /// @param is_shown if not, the surfaces of sampled meshes are not looked for, which takes a while.
  SceneMarkers(const Simulator& simulator, const MarkerStyle& style, bool is_shown = true);

  /// The scene as it was in the snapshot, taken with `markers`. The answer belongs to this object and is overwritten by the
  /// next call.
  const visualization_msgs::MarkerArray& update(const SceneSnapshot& snapshot);

 private:
  struct ShapeMarker {
    std::size_t marker;  ///< index into message_.markers
    int instrument;
    int link;   ///< index into RobotModel::links()
    Pose X_LS;  ///< of the shape in its link
  };

  void addTissues();
  void addInstrument(int instrument, bool is_shown);
  void addShape(int instrument, int link, const ShapeDescription& shape, const TriangleMesh* mesh, bool touches);
  void layOut(std::size_t tissue, const MeshRevision& mesh);
  void updateTissue(std::size_t tissue, const MeshRevision& mesh, const NodalVectors& x);
  void updateForces(const std::vector<SolvedContact>& contacts);
  void setArrow(std::size_t index, const SolvedContact& contact);

  const Simulator& simulator_;
  MarkerStyle style_;
  visualization_msgs::MarkerArray message_;  ///< tissue surfaces, tissue edges, instrument shapes, arrows
  std::vector<int> laid_out_;  ///< per tissue: revision of the mesh that its markers have room for; -1: none
  std::vector<std::vector<std::array<int, 2>>> edges_;  ///< per tissue: nodes of each surface edge
  std::vector<NodalVectors> normals_;                   ///< per tissue: scratch for shading
  std::vector<ShapeMarker> shapes_;
  std::size_t first_arrow_ = 0;
};

}  // namespace tissue_contact
