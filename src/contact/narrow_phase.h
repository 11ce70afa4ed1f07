/// @file
/// Room `contact`: contacts of one shape with one tissue surface. Candidate triangles in; merged, sorted contacts out.
///
/// Per triangle: the point where the shape is nearest or deepest, named by the face, edge or vertex it lies on, so that
/// triangles sharing that feature report it once. Where the shape lies flush on the triangle, or is smooth compared with it
/// (conforming_gap.h), that point is one of many; there the tissue's vertices, and corners of the shape, carry the
/// contact instead, which stay the same from step to step.
///
/// Which contacts are real (shapes are solid):
///  - Where the nearest face of a shape with edges stands across the surface at a vertex, the one below it counts
///    (leaving_face.h). Elsewhere a vertex is pressed along the mean normal over the surface that it stands for
///    (nodal_normal.h); which triangles face the shape, and how far it is, its own normal tells.
///  - On the boundary of a volume a contact counts when at least one surface triangle at its feature faces the
///    instrument (contact normal times triangle normal < -kFacing). A point of the tissue nearest to something outside
///    it always has such a triangle. The lower face of a thin layer pressed from above has none, nor has a surface that
///    the middle of the shape has already passed: tissue more than half-way through an instrument is released, never
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

#include "contact/leaving_face.h"
#include "contact/shape/shape_distance.h"
#include "mesh/surface/moving_surface.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct ShapeContact {
  SurfaceFeature feature = {-1, -1, -1};
  int corner = -1;                       ///< of the shape, -1 for the feature's closest point
  std::array<int, 3> nodes = {0, 0, 0};  ///< of the first surface triangle that contains the feature
  Vector3 weights = Vector3::Zero();     ///< barycentric in it
  Vector3 normal_W = Vector3::Zero();    ///< unit, from the shape into the tissue
  Vector3 lean_W = Vector3::Zero();      ///< as Contact has it
  double gap = 0.0;                      ///< m, less half the thickness of a sheet
};

class NarrowPhase {
 public:
  /// Takes the memory that a surface needs, so that findContacts() need not.
  void makeRoom(const MovingSurface& surface);

  /// @param surface where it has been placed.
  /// @param candidates its triangles to look at, ascending.
  /// @param margin m.
  /// @param contacts overwritten, sorted by feature and corner. No allocation once the vectors have grown.
  /// @param beside what may keep vertices beside an edge from passing below it (leaving_face.h); null: nothing.
  void findContacts(const ShapeDistance& shape, const Pose& X_WS, const MovingSurface& surface,
                    const std::vector<int>& candidates, double margin, std::vector<ShapeContact>& contacts,
                    const ShapesBeside* beside = nullptr);

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
    const MovingSurface* surface = nullptr;
    Matrix3 R_SW;
    Vector3 p_WS;
    double margin = 0.0;  ///< from the triangles themselves
    const ShapesBeside* beside = nullptr;
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
  bool findClosestBesideHeld(int triangle, const TrianglePoints& points, ClosestPoint& closest);
  double lowestVertexGap(const SurfaceFeature& feature) const;
  bool add(int triangle, const Vector3& weights, int corner, const Vector3& normal_S, double gap);
  void mergeAndSort();

  std::vector<NodeCache> nodes_;
  std::vector<NormalCache> normals_;
  std::vector<ShapeCorner> corners_;
  std::int64_t call_index_ = 0;
  Call call_;
};

}  // namespace tissue_contact
