/// @file
/// Room `ros`, private: the scene as RViz markers: coloured surfaces, instrument shapes, contact forces, and how to read them.
#pragma once

#include <visualization_msgs/MarkerArray.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ros/publish/marker_legend.h"
#include "ros/publish/marker_style.h"
#include "ros/publish/scene_snapshot.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Keeps one MarkerArray and updates it in place. Everything is drawn in the world frame, so RViz needs no tf.
/// Namespaces: `<tissue>` (triangles and their edges), `<instrument>` (its touching shapes, and its other links as the
/// URDF draws them), `force_texts` (the force of the tissues on each instrument, beside its tip), `<instrument>/tip` (origin of its tip link, where the wrench is taken), `legend` (MarkerLegend),
/// `contact_forces` (an arrow per touching contact: the force on the instrument, from the contact point; held contacts blue, sliding
/// ones red). Scales are FullScale's: they depend on what this object has drawn so far, and on nothing else.
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
  void addForceTexts();
  void addTips();
  void layOut(std::size_t tissue, const MeshRevision& mesh);
  void updateTissue(std::size_t tissue, const MeshRevision& mesh, const NodalVectors& x);
  void findColors(std::size_t tissue, const MeshRevision& mesh, const SceneSnapshot& snapshot);
  void updateForceTexts(const SceneSnapshot& snapshot);
  void updateForces(const std::vector<SolvedContact>& contacts);
  void setArrow(std::size_t index, const SolvedContact& contact);

  double arrowPerNewton() const;
  Vector3 textPlace(const Vector3& tip, double half_width_m) const;
  double riseAbove(const std::vector<NodalVectors>& tissues, const Vector3& text, double half_width_m) const;

  const Simulator& simulator_;
  const MarkerStyle style_;
  const PictureFrame frame_;
  FullScale color_scale_;  ///< SI unit
  FullScale force_scale_;  ///< of one contact, N, of the longest arrow; not with arrows of a given length
  visualization_msgs::MarkerArray
      message_;                ///< tissue surfaces, tissue edges, instrument shapes, texts, legend, arrows
  std::vector<int> laid_out_;  ///< per tissue: revision of the mesh that its markers have room for; -1: none
  std::vector<std::vector<std::array<int, 2>>> edges_;  ///< per tissue: nodes of each surface edge
  std::vector<NodalVectors> areas_;                     ///< per tissue: nodalAreas(), for shading and pressure
  std::vector<VectorX> values_;                         ///< per tissue and node: what is shown by colour
  std::vector<double> half_widths_;                     ///< per instrument: of the widest shape that touches, m
  std::vector<ShapeMarker> shapes_;
  std::size_t first_text_ = 0;  ///< one per instrument
  std::size_t first_tip_ = 0;   ///< likewise
  std::optional<MarkerLegend> legend_;
  std::size_t first_arrow_ = 0;
};

}  // namespace tissue_contact
