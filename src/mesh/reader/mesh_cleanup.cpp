#include "mesh/reader/mesh_cleanup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "mesh/edge_table.h"
#include "mesh/nodes.h"
#include "mesh/point_grid.h"

namespace tissue_contact {
namespace {

constexpr double kFlatArea = 1e-10;  // of the longest edge squared

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
