/// @file
/// Room `contact`: triangle-mesh shape.
#pragma once

#include <array>
#include <vector>

#include "contact/shape_distance.h"
#include "contact/triangle_tree.h"

namespace tissue_contact {

/// Signed distance: nearest point by a bounding-volume tree, sign by the angle-weighted pseudonormal of the face, edge
/// or vertex it lies on (Baerentzen and Aanaes 2005), exact for closed surfaces. An open mesh gets the same treatment:
/// points on the side its normals point away from count as inside, whatever their distance, so it acts as a one-sided
/// sheet.
///
/// Where on a triangle the distance is least (mesh_closest.cpp): clear of the mesh, the nearest pair of triangles,
/// exactly. Where they touch or overlap, by cutting planes.
class MeshDistance : public ShapeDistance {
 public:
  explicit MeshDistance(const TriangleMesh& mesh);

  double size() const override { return size_; }
  Vector3 halfExtents(const Matrix3& R_WS) const override { return R_WS.cwiseAbs() * half_; }
  Vector3 boxCentre() const override { return centre_; }
  SignedDistance at(const Vector3& p_S) const override;
  bool closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const override;
  void foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                       std::vector<ShapeCorner>& corners) const override;
  double cornerReach() const override { return half_.minCoeff(); }

 private:
  struct Corner {
    int vertex;
    std::vector<int> neighbours;  ///< vertices joined to it by an edge
  };

  void computeNormals();
  void findCorners();
  Vector3 featureNormal(const NearestOnTriangles& nearest) const;
  bool isForemost(const Corner& corner, const Vector3& forward) const;
  bool startingPoint(const TrianglePoints& triangle, double margin, Vector3& weights, bool& exact) const;
  void addFaceNormals(const Vector3& p_S, GradientSet& gradients) const;

  NodalVectors vertices_;
  std::vector<Triangle> triangles_;
  TriangleTree tree_;
  Vector3 centre_;
  Vector3 half_;
  double size_;
  std::vector<Vector3> face_normals_;
  std::vector<std::array<Vector3, 3>> edge_normals_;  ///< per triangle, edge i from its corner i to i + 1
  std::vector<Vector3> vertex_normals_;
  std::vector<Corner> corners_;
  mutable std::vector<int> found_;  ///< scratch
};

}  // namespace tissue_contact
