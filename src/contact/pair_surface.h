/// @file
/// Room `contact`: one tissue surface as TissuePairDetector needs it: edges, normals and rest lengths.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "contact/surface_topology.h"
#include "contact/triangle_tree.h"
#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct SurfaceEdge {
  std::array<int, 2> nodes;    ///< ascending
  std::vector<int> triangles;  ///< those that contain it, ascending
};

/// A material point of a surface: barycentric over three nodes, of which those of weight 0 do not matter.
struct SurfacePoint {
  std::array<int, 3> nodes = {0, 0, 0};
  Vector3 weights = Vector3::UnitX();

  Vector3 in(const NodalVectors& positions) const {
    return weights[0] * positions.col(nodes[0]) + weights[1] * positions.col(nodes[1]) +
           weights[2] * positions.col(nodes[2]);
  }
};

/// Holds trees and caches: not thread-safe.
class PairSurface {
 public:
  /// @param rest positions at rest, m. @throws std::invalid_argument for bad triangles, flags or thickness.
  PairSurface(int tissue, TissueSurface surface, const NodalVectors& rest);

  /// Starts a call. @param positions m, world frame; must outlive it.
  void place(const NodalVectors& positions);
  /// Brings the tree up to date, once per call.
  void refit();

  int tissue() const { return tissue_; }
  bool isVolume() const { return half_thickness_ == 0.0; }
  double halfThickness() const { return half_thickness_; }
  double meanEdge() const { return mean_edge_; }  ///< at rest, m
  /// Of the box around it at rest, m; infinite for a sheet.
  double smallestExtent() const { return smallest_extent_; }
  const NodalVectors& rest() const { return rest_; }
  /// The longest edge at a node at rest, m.
  double localLength(int node) const { return local_length_[node]; }
  bool fixed(int node) const { return fixed_[node]; }

  const SurfaceTopology& topology() const { return topology_; }
  const TriangleTree& tree() const { return tree_; }
  const std::vector<int>& nodes() const { return nodes_; }  ///< those that triangles use, ascending
  const std::vector<SurfaceEdge>& edges() const { return edges_; }
  const std::array<int, 3>& edgesOf(int triangle) const { return edges_of_[triangle]; }

  const Eigen::AlignedBox3d& box() const { return box_; }
  const NodalVectors& positions() const { return *positions_; }
  Vector3 x(int node) const { return positions_->col(node); }
  const Vector3& normal(int triangle);  ///< unit, or zero for a degenerate triangle

  /// Pseudonormal (Baerentzen and Aanaes 2005): its sign against the offset of a point tells inside from outside.
  Vector3 featureNormal(const SurfaceFeature& feature);

 private:
  struct NormalCache {
    std::int64_t computed = 0;
    Vector3 normal = Vector3::Zero();
  };
  void findEdges();

  int tissue_;
  NodalVectors rest_;
  SurfaceTopology topology_;
  TriangleTree tree_;
  std::vector<bool> fixed_;
  double half_thickness_;
  std::vector<int> nodes_;
  std::vector<SurfaceEdge> edges_;
  std::vector<std::array<int, 3>> edges_of_;  ///< per triangle
  std::vector<double> local_length_;
  double mean_edge_ = 0.0;
  double smallest_extent_ = std::numeric_limits<double>::infinity();

  const NodalVectors* positions_ = nullptr;
  Eigen::AlignedBox3d box_;
  std::vector<NormalCache> normals_;
  std::int64_t call_ = 0;
  std::int64_t refitted_ = 0;  ///< the call in which it was
};

}  // namespace tissue_contact
