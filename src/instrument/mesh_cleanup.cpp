#include "mesh_cleanup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

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

using Edge = std::pair<int, int>;  // smaller vertex index first

/// Side k of a triangle as an edge, and whether the triangle runs along it from the smaller to the larger index.
std::pair<Edge, bool> side(const Triangle& t, int k) {
  const int a = t[static_cast<std::size_t>(k)];
  const int b = t[static_cast<std::size_t>((k + 1) % 3)];
  return a < b ? std::make_pair(Edge(a, b), true) : std::make_pair(Edge(b, a), false);
}

/// Orients one connected part after another. Sides shared by exactly two triangles connect them.
class Orienter {
 public:
  explicit Orienter(TriangleMesh& mesh) : mesh_(mesh), done_(mesh.triangles.size(), false) {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      for (int k = 0; k < 3; ++k) users_[side(mesh_.triangles[t], k).first].push_back(t);
    }
  }

  void run() {
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (done_[t]) continue;
      std::vector<std::size_t> flipped;
      const std::vector<std::size_t> part = spreadFrom(t, flipped);
      if (!isClosed(part)) {
        for (const std::size_t i : flipped) flip(i);  // back to what the file says
      } else if (volume(part) < 0.0) {
        for (const std::size_t i : part) flip(i);
      }
    }
  }

 private:
  void flip(std::size_t t) { std::swap(mesh_.triangles[t][1], mesh_.triangles[t][2]); }

  /// Triangles connected with `start`, each turned to agree with the one it was reached from; those turned are listed.
  std::vector<std::size_t> spreadFrom(std::size_t start, std::vector<std::size_t>& flipped) {
    std::vector<std::size_t> part = {start};
    done_[start] = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const auto [edge, forward] = side(mesh_.triangles[part[i]], k);
        const std::vector<std::size_t>& users = users_.at(edge);
        if (users.size() != 2) continue;
        const std::size_t other = users[0] == part[i] ? users[1] : users[0];
        if (done_[other]) continue;
        done_[other] = true;
        part.push_back(other);
        // Neighbours that agree run along their common side in opposite directions.
        if (runsForward(other, edge) == forward) {
          flip(other);
          flipped.push_back(other);
        }
      }
    }
    return part;
  }

  bool runsForward(std::size_t t, const Edge& edge) const {
    for (int k = 0; k < 3; ++k) {
      const auto [own, forward] = side(mesh_.triangles[t], k);
      if (own == edge) return forward;
    }
    return false;
  }

  /// Every side is run along as often forwards as backwards: no border, and one orientation all over.
  bool isClosed(const std::vector<std::size_t>& part) const {
    std::map<Edge, int> balance;
    for (const std::size_t t : part) {
      for (int k = 0; k < 3; ++k) {
        const auto [edge, forward] = side(mesh_.triangles[t], k);
        balance[edge] += forward ? 1 : -1;
      }
    }
    return std::all_of(balance.begin(), balance.end(), [](const auto& entry) { return entry.second == 0; });
  }

  /// Enclosed volume, from tetrahedra to a vertex of the part (not to the origin, which may be far away).
  double volume(const std::vector<std::size_t>& part) const {
    const Vector3 apex = mesh_.vertices.col(mesh_.triangles[part.front()][0]);
    double sum = 0.0;
    for (const std::size_t i : part) {
      const Triangle& t = mesh_.triangles[i];
      const Vector3 a = mesh_.vertices.col(t[0]) - apex;
      const Vector3 b = mesh_.vertices.col(t[1]) - apex;
      const Vector3 c = mesh_.vertices.col(t[2]) - apex;
      sum += a.cross(b).dot(c) / 6.0;
    }
    return sum;
  }

  TriangleMesh& mesh_;
  std::vector<bool> done_;
  std::map<Edge, std::vector<std::size_t>> users_;
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
  mesh.vertices.resize(3, static_cast<Eigen::Index>(grid.points().size()));
  for (std::size_t i = 0; i < grid.points().size(); ++i) {
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = grid.points()[i];
  }
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

void dropUnusedVertices(TriangleMesh& mesh) {
  std::vector<int> moved_to(static_cast<std::size_t>(mesh.vertices.cols()), -1);
  for (const Triangle& triangle : mesh.triangles) {
    for (const int v : triangle) moved_to[static_cast<std::size_t>(v)] = 0;
  }
  int used = 0;
  for (std::size_t v = 0; v < moved_to.size(); ++v) {
    if (moved_to[v] < 0) continue;
    moved_to[v] = used;
    const Vector3 p = mesh.vertices.col(static_cast<Eigen::Index>(v));
    mesh.vertices.col(used++) = p;
  }
  mesh.vertices.conservativeResize(Eigen::NoChange, used);
  for (Triangle& triangle : mesh.triangles) {
    for (int& v : triangle) v = moved_to[static_cast<std::size_t>(v)];
  }
}

}  // namespace tissue_contact
