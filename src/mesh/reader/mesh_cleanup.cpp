#include "mesh/reader/mesh_cleanup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

#include "mesh/edge_table.h"
#include "mesh/nodes.h"

namespace tissue_contact {
namespace {

constexpr double kMergeDistance = 1e-7;  // of the bounding box's diagonal: the resolution of single precision
constexpr double kFlatArea = 1e-10;      // of the longest edge squared

/// Points filed by grid cell, to find one near a given point in constant time.
class PointGrid {
 public:
  PointGrid(const Vector3& origin, double tolerance) : origin_(origin), tolerance_(tolerance) {}

  /// Index of a filed point within the tolerance of `p`, or of `p` itself after filing it.
  int findOrAdd(const Vector3& p) {
    // Cells are 4 tolerances wide, so most points look into one cell only.
    const Cell low = cellOf(p - Vector3::Constant(tolerance_));
    const Cell high = cellOf(p + Vector3::Constant(tolerance_));
    for (std::int64_t x = low[0]; x <= high[0]; ++x) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t z = low[2]; z <= high[2]; ++z) {
          const int found = findIn({x, y, z}, p);
          if (found >= 0) return found;
        }
      }
    }
    points_.push_back(p);
    cells_[cellOf(p)].push_back(static_cast<int>(points_.size()) - 1);
    return static_cast<int>(points_.size()) - 1;
  }

  const std::vector<Vector3>& points() const { return points_; }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t i : cell) hash = (hash ^ static_cast<std::uint64_t>(i)) * 0x9E3779B97F4A7C15u;
      return static_cast<std::size_t>(hash ^ (hash >> 32));
    }
  };

  Cell cellOf(const Vector3& p) const {
    const Vector3 scaled = (p - origin_) / (4.0 * tolerance_);
    return {std::llround(scaled.x()), std::llround(scaled.y()), std::llround(scaled.z())};
  }

  int findIn(const Cell& cell, const Vector3& p) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end()) return -1;
    for (const int i : found->second) {
      if ((points_[static_cast<std::size_t>(i)] - p).norm() <= tolerance_) return i;
    }
    return -1;
  }

  Vector3 origin_;
  double tolerance_;
  std::vector<Vector3> points_;
  std::unordered_map<Cell, std::vector<int>, CellHash> cells_;
};

/// Orients one connected part after another. Edges of exactly two triangles connect them.
class Orienter {
 public:
  explicit Orienter(TriangleMesh& mesh)
      : mesh_(mesh),
        table_(mesh.triangles),
        done_(mesh.triangles.size(), false),
        turned_(mesh.triangles.size(), false) {}

  void run() {
    for (std::size_t t = 0; t < done_.size(); ++t) {
      if (done_[t]) continue;
      const std::vector<int> part = spreadFrom(static_cast<int>(t));
      const bool is_closed = isClosed(part);
      const bool inside_out = is_closed && volume(part) < 0.0;
      for (const int i : part) {
        if (is_closed && turned_[i] != inside_out) std::swap(mesh_.triangles[i][1], mesh_.triangles[i][2]);
      }
    }
  }

 private:
  /// Triangles connected with `start`, each turned to agree with the one it was reached from.
  std::vector<int> spreadFrom(int start) {
    std::vector<int> part = {start};
    done_[start] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (const int edge : table_.edgesOf(part[i])) {
        const EdgeTable::Uses uses = table_.usesOf(table_[edge]);
        if (uses.size() != 2) continue;
        const int other = uses[uses[0].triangle == part[i] ? 1 : 0].triangle;
        if (done_[other]) continue;
        done_[other] = true;
        part.push_back(other);
        // Neighbours that agree run along their common edge in opposite directions.
        turned_[other] = (uses[0].forward == uses[1].forward) != turned_[part[i]];
      }
    }
    return part;
  }

  /// Every edge is run along as often forwards as backwards: no border, and one orientation all over.
  bool isClosed(const std::vector<int>& part) const {
    std::map<int, int> balance;
    for (const int t : part) {
      for (int k = 0; k < 3; ++k) {
        const bool forward = mesh_.triangles[t][k] < mesh_.triangles[t][(k + 1) % 3];
        balance[table_.edgesOf(t)[k]] += forward != turned_[t] ? 1 : -1;
      }
    }
    return std::all_of(balance.begin(), balance.end(), [](const auto& entry) { return entry.second == 0; });
  }

  /// Enclosed volume, from tetrahedra to a vertex of the part (not to the origin, which may be far away).
  double volume(const std::vector<int>& part) const {
    const Vector3 apex = mesh_.vertices.col(mesh_.triangles[part.front()][0]);
    double sum = 0.0;
    for (const int i : part) {
      const Triangle& t = mesh_.triangles[i];
      const Vector3 a = mesh_.vertices.col(t[0]) - apex;
      const Vector3 b = mesh_.vertices.col(t[turned_[i] ? 2 : 1]) - apex;
      const Vector3 c = mesh_.vertices.col(t[turned_[i] ? 1 : 2]) - apex;
      sum += a.cross(b).dot(c) / 6.0;
    }
    return sum;
  }

  TriangleMesh& mesh_;
  EdgeTable table_;
  std::vector<bool> done_;
  std::vector<bool> turned_;
};

}  // namespace

TriangleMesh mergeVertices(const std::vector<Vector3>& vertices, const std::vector<Triangle>& triangles) {
  TriangleMesh mesh;
  if (triangles.empty()) return mesh;
  Vector3 low = vertices[static_cast<std::size_t>(triangles.front()[0])];
  Vector3 high = low;
  for (const Triangle& triangle : triangles) {  // vertices that nothing uses must not widen the box
    for (const int v : triangle) {
      low = low.cwiseMin(vertices[static_cast<std::size_t>(v)]);
      high = high.cwiseMax(vertices[static_cast<std::size_t>(v)]);
    }
  }
  const double diagonal = (high - low).stableNorm();
  if (!(diagonal > 0.0)) return mesh;  // one point: every triangle is degenerate
  PointGrid grid(low, kMergeDistance * diagonal);
  std::vector<int> merged(vertices.size(), -1);
  for (const Triangle& triangle : triangles) {
    Triangle t{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<std::size_t>(triangle[k]);
      if (merged[v] < 0) merged[v] = grid.findOrAdd(vertices[v]);
      t[k] = merged[v];
    }
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
  }
  mesh.vertices = columnsOf(grid.points());
  return mesh;
}

void orientOutward(TriangleMesh& mesh) { Orienter(mesh).run(); }

void dropFlatTriangles(TriangleMesh& mesh) {
  const auto is_flat = [&mesh](const Triangle& t) {
    const Vector3 a = mesh.vertices.col(t[1]) - mesh.vertices.col(t[0]);
    const Vector3 b = mesh.vertices.col(t[2]) - mesh.vertices.col(t[0]);
    const double longest = std::max({a.norm(), b.norm(), (a - b).norm()});
    return !(a.cross(b).norm() > 2.0 * kFlatArea * longest * longest);
  };
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_flat), mesh.triangles.end());
}

}  // namespace tissue_contact
