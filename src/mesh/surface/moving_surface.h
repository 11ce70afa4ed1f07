/// @file
/// Room `mesh`, private: the surface of one tissue: what its triangles share, where they were at rest, where they are now.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "mesh/edge_table.h"
#include "mesh/surface/triangle_tree.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/tissue_surface.h"

namespace tissue_contact {

/// A vertex (a, -1, -1), an edge (a, b, -1) or a face (a, b, c): sorted node indices, as in ContactKey.
using SurfaceFeature = std::array<int, 3>;

inline SurfaceFeature vertexFeature(int node) { return {node, -1, -1}; }
inline SurfaceFeature edgeFeature(const EdgeTable::Edge& edge) { return {edge.nodes[0], edge.nodes[1], -1}; }

/// Holds a tree and caches: not thread-safe.
class MovingSurface {
 public:
  /// @param tissue its index.
  /// @param rest positions at rest, m.
  /// @throws std::invalid_argument: see shareSurfaces().
  MovingSurface(int tissue, TissueSurface surface, const NodalVectors& rest);

  int tissue() const { return tissue_; }
  double halfThickness() const { return half_thickness_; }  ///< m
  bool isVolume() const { return half_thickness_ == 0.0; }
  const std::vector<Triangle>& triangles() const { return triangles_; }
  const EdgeTable& edges() const { return edges_; }
  const std::vector<int>& nodes() const { return nodes_; }  ///< those that triangles use, ascending
  int nodeCount() const { return static_cast<int>(rest_.cols()); }

  /// Whether a point of these nodes belongs to what is fixed: less than a quarter of it is of nodes that can move, which would have to go
  /// more than four times as far as the point is to, and without bound where it is nearly a fixed node.
  bool isHeld(const Triangle& nodes, const Vector3& weights) const;
  /// Of a triangle with nodes that can move and others: barycentric weights of one that can (first column) and of the ends of the line where
  /// points begin to be held.
  /// @returns whether it is such a triangle.
  bool findHeldLine(int triangle, Matrix3& corners) const;
  /// The feature that the corners of non-zero weight make up.
  SurfaceFeature featureOf(int triangle, const Vector3& weights) const;
  /// Calls `visit(triangle)` for the triangles that contain the feature, ascending, until it returns true.
  /// @returns whether it did.
  template <typename Visitor>
  bool anyTriangleOf(const SurfaceFeature& feature, const Visitor& visit) const {
    for (int i = fan_start_[feature[0]]; i < fan_start_[feature[0] + 1]; ++i) {
      if (contains(fan_[i], feature) && visit(fan_[i])) return true;
    }
    return false;
  }

  const NodalVectors& rest() const { return rest_; }
  double meanEdge() const { return mean_edge_; }                      ///< at rest, m
  double longestEdge(int node) const { return longest_edge_[node]; }  ///< at a node at rest, m
  /// Of the box around it at rest, m; infinite for a sheet.
  double smallestExtent() const { return smallest_extent_; }

  /// Moves it to these positions (m, world frame); costs next to nothing where it is there already. No allocation.
  /// What follows depends on the last positions alone.
  /// @throws std::invalid_argument for another number of nodes.
  void place(const NodalVectors& positions);
  /// The same, and brings all up to date at once that overlapping() else would in time.
  void fit(const NodalVectors& positions);
  const NodalVectors& positions() const { return x_; }
  Vector3 x(int node) const { return x_.col(node); }
  const Eigen::AlignedBox3d& box() const { return box_; }  ///< around the nodes that triangles use
  /// Triangles whose bounding boxes overlap `box`, ascending.
  void overlapping(const Eigen::AlignedBox3d& box, std::vector<int>& triangles);
  const Vector3& normal(int triangle);  ///< unit, or zero for a degenerate triangle
  /// Pseudonormal (Baerentzen and Aanaes 2005): its sign against the offset of a point tells inside from outside.
  Vector3 featureNormal(const SurfaceFeature& feature);

 private:
  struct NormalCache {
    std::int64_t computed = 0;
    Vector3 normal = Vector3::Zero();
  };
  void findFans();
  void fit();
  double farthestMove() const;
  void measureAtRest();
  bool contains(int triangle, const SurfaceFeature& feature) const;

  int tissue_;
  NodalVectors rest_;
  std::vector<Triangle> triangles_;
  std::vector<bool> fixed_;
  double half_thickness_;
  std::vector<int> fan_start_;  ///< per node, into fan_; one more entry than nodes
  std::vector<int> fan_;        ///< triangles around each node, ascending
  EdgeTable edges_;
  std::vector<int> nodes_;
  std::vector<double> longest_edge_;
  double mean_edge_ = 0.0;
  double smallest_extent_ = std::numeric_limits<double>::infinity();

  NodalVectors x_;
  std::int64_t placed_ = 0;  ///< how often it has moved
  TriangleTree tree_;
  std::vector<Vector3> fitted_;  ///< of `nodes_`: where they were when the tree was fitted, m
  std::int64_t asked_ = 0;       ///< `placed_` when the tree was last asked
  double moved_ = 0.0;           ///< the farthest a node has come since in one coordinate, then, m
  Eigen::AlignedBox3d box_;
  std::vector<NormalCache> normals_;
};

/// Places all of them.
/// @throws std::invalid_argument when the sizes differ.
void placeAll(std::vector<MovingSurface>& surfaces, const std::vector<NodalVectors>& positions);

}  // namespace tissue_contact
