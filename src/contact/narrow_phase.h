/// @file
/// Room `contact`: contacts of one shape with one tissue surface. Candidate triangles in; merged, sorted contacts out.
///
/// Per triangle: the point where the shape is nearest or deepest, named by the face, edge or vertex it lies on, so that
/// triangles sharing that feature report it once. Where the shape lies flush on the triangle, or is smooth compared with it
/// (conforming_gap.h), that point is one of many; there the tissue's vertices, and corners of the shape, carry the
/// contact instead, which stay the same from step to step.
///
/// Which contacts are real (shapes are solid):
///  - On the boundary of a volume a contact counts when at least one surface triangle at its feature faces the
///    instrument (contact normal times triangle normal < -kFacing). A point of the tissue nearest to something outside
///    it always has such a triangle. The lower face of a thin layer pressed from above has none, nor has a surface that
///    the middle of the shape has already passed: tissue more than half-way through an instrument is let go, never
///    pulled through its far side; an instrument that starts inside touches nothing until it reaches the surface.
///  - A sheet is touched from both sides, half its thickness before its triangles; which side, the shape's signed
///    distance tells: it is pushed out on the side it is nearest to.
///  - At a face (edge) the normal is perpendicular to that face (edge), see stationaryGradient(); where no gradient of
///    the distance comes near that, or the shape pierces the triangle in its middle (|g| < 0.3), there is no contact
///    direction.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "contact/shape_distance.h"
#include "contact/surface_topology.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct ShapeContact {
  SurfaceFeature feature = {-1, -1, -1};
  int corner = -1;                       ///< of the shape, -1 for the feature's closest point
  std::array<int, 3> nodes = {0, 0, 0};  ///< of the first surface triangle that contains the feature
  Vector3 weights = Vector3::Zero();     ///< barycentric in it
  Vector3 normal_W = Vector3::Zero();    ///< unit, from the shape into the tissue
  double gap = 0.0;                      ///< m, less half the thickness of a sheet
};

class NarrowPhase {
 public:
  /// @param fixed per node. @param thickness_m > 0: a sheet, 0: the boundary of a volume. @throws std::invalid_argument
  ///   for bad triangles, a size that differs from the node count or a thickness that is not finite or < 0.
  NarrowPhase(std::vector<Triangle> triangles, std::vector<bool> fixed, int node_count, double thickness_m = 0.0);

  /// @param positions m, world frame. @param candidates surface triangles to look at, ascending. @param margin m.
  /// @param contacts overwritten, sorted by feature and corner. No allocation once the vectors have grown.
  void findContacts(const ShapeDistance& shape, const Pose& X_WS, const NodalVectors& positions,
                    const std::vector<int>& candidates, double margin, std::vector<ShapeContact>& contacts);

  double halfThickness() const { return half_thickness_; }
  const std::vector<Triangle>& triangles() const { return topology_.triangles(); }

  /// Whether a surface triangle at the feature faces a shape whose contact normal is `normal_W` (unit).
  bool faces(const SurfaceFeature& feature, const Vector3& normal_W, const NodalVectors& positions) const;

 private:
  struct NodeCache {
    std::int64_t placed = 0;    ///< the call in which p_S was computed
    std::int64_t measured = 0;  ///< the call in which the rest was
    Vector3 p_S = Vector3::Zero();
    double distance = 0.0;                                         ///< signed distance of the shape
    double contact_gap = std::numeric_limits<double>::infinity();  ///< of the vertex contact; infinite if there is none
  };
  struct NormalCache {
    std::int64_t computed = 0;
    Vector3 normal_S = Vector3::Zero();
  };
  struct Call {
    const ShapeDistance* shape = nullptr;
    const NodalVectors* positions = nullptr;
    Matrix3 R_SW;
    Vector3 p_WS;
    double margin = 0.0;  ///< from the triangles themselves
    std::vector<ShapeContact>* contacts = nullptr;
  };

  const Vector3& nodePosition(int node);
  const Vector3& triangleNormalOf(int triangle);
  TrianglePoints trianglePoints(int triangle);
  std::array<double, 3> vertexDistances(int triangle) const;
  const NodeCache& measureVertex(int triangle, int corner);
  bool certainlyFar(int triangle, const TrianglePoints& points);
  double addCorners(int triangle, const TrianglePoints& points);
  double addCornerInFold(int triangle, const ShapeCorner& corner);
  void addClosest(int triangle, const TrianglePoints& points, double flush_gap);
  double lowestVertexGap(const SurfaceFeature& feature) const;
  bool add(int triangle, const Vector3& weights, int corner, const Vector3& normal_S, double gap);
  void mergeAndSort();

  SurfaceTopology topology_;
  std::vector<bool> fixed_;
  double half_thickness_;
  std::vector<NodeCache> nodes_;
  std::vector<NormalCache> normals_;
  std::vector<ShapeCorner> corners_;
  std::int64_t call_index_ = 0;
  Call call_;
};

}  // namespace tissue_contact
