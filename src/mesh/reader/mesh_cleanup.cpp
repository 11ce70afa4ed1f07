#include "mesh/reader/mesh_cleanup.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

#include "mesh/edge_table.h"
#include "mesh/nodes.h"
#include "mesh/point_grid.h"

namespace tissue_contact {
namespace {

constexpr double kNoBorder = std::numeric_limits<double>::infinity();

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
      const double border = borderOf(part);
      const double enclosed = border < kNoBorder ? volume(part) : 0.0;
      const bool is_told = border == 0.0 || isClear(part, border, enclosed);
      for (const int i : part) {
        if (is_told && turned_[i] != (enclosed < 0.0)) std::swap(mesh_.triangles[i][1], mesh_.triangles[i][2]);
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

  /// Length of its border: 0 where every edge is run along as often forwards as backwards, kNoBorder where one that is none is not,
  /// as there is no one orientation all over.
  double borderOf(const std::vector<int>& part) const {
    std::map<int, int> balance;
    for (const int t : part) {
      for (int k = 0; k < 3; ++k) {
        const bool forward = mesh_.triangles[t][k] < mesh_.triangles[t][(k + 1) % 3];
        balance[table_.edgesOf(t)[k]] += forward != turned_[t] ? 1 : -1;
      }
    }
    double length = 0.0;
    for (const auto& [edge, sum] : balance) {
      if (sum == 0) continue;
      const EdgeTable::Edge& border = table_[edge];
      if (border.count > 1) return kNoBorder;
      length += (mesh_.vertices.col(border.nodes[0]) - mesh_.vertices.col(border.nodes[1])).norm();
    }
    return length;
  }

  /// Whether a part with a border is a solid with small holes, and its volume tells where it is solid. Surfaces that close
  /// holes of a length L have an area of at most L^2 / (4 pi) (Carleman 1921, of minimal ones), so the volume behind them, seen
  /// from a vertex of the part, is at most L^2 D / (12 pi) in a part of size D.
  bool isClear(const std::vector<int>& part, double border, double enclosed) const {
    constexpr double kSmall =
        0.1;  // of the area, for L^2: holes of 1 % of it. A dome or an open tube has a side, but no inside
    if (border == kNoBorder) return false;
    double area = 0.0;
    Eigen::AlignedBox3d box;
    for (const int i : part) {
      area += triangleArea(mesh_.vertices, mesh_.triangles[i]);
      for (const int v : mesh_.triangles[i]) box.extend(Vector3(mesh_.vertices.col(v)));
    }
    const double hidden = border * border * box.diagonal().norm() / (12.0 * M_PI);
    return border * border < kSmall * area && std::abs(enclosed) > hidden;
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

/// Triangle by triangle, one other that is the same the other way round; -1 for those without. Not where there are more.
std::vector<int> backsOf(const std::vector<Triangle>& triangles) {
  std::map<Triangle, std::vector<int>> same;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Triangle nodes = triangles[t];
    std::sort(nodes.begin(), nodes.end());
    same[nodes].push_back(static_cast<int>(t));
  }
  const auto runsUp = [&triangles](int t) {  // along its nodes in ascending order
    const Triangle& nodes = triangles[t];
    return (nodes[0] < nodes[1]) == (nodes[1] < nodes[2]) ? nodes[0] < nodes[1] : nodes[2] < nodes[0];
  };
  std::vector<int> backs(triangles.size(), -1);
  for (const auto& [nodes, found] : same) {
    if (found.size() != 2 || runsUp(found[0]) == runsUp(found[1])) continue;
    backs[found[0]] = found[1];
    backs[found[1]] = found[0];
  }
  return backs;
}

/// Some programs write every face of a closed surface twice, to be seen from both sides; together they enclose nothing. Leaves the
/// first of each two where a connected part is nothing but such pairs, four triangles at each edge; a face that two solids
/// share stays twice, since each needs its own.
void dropBacks(TriangleMesh& mesh) {
  const std::vector<int> backs = backsOf(mesh.triangles);
  if (std::all_of(backs.begin(), backs.end(), [](int back) { return back < 0; })) return;
  const EdgeTable table(mesh.triangles);
  std::vector<bool> done(backs.size(), false);
  std::vector<bool> dropped(backs.size(), false);
  for (std::size_t start = 0; start < backs.size(); ++start) {
    if (done[start]) continue;
    std::vector<int> part = {static_cast<int>(start)};
    done[start] = true;
    bool is_double = true;
    for (std::size_t i = 0; i < part.size(); ++i) {
      is_double = is_double && backs[part[i]] >= 0;
      for (const int edge : table.edgesOf(part[i])) {
        is_double = is_double && table[edge].count == 4;
        for (const EdgeUse& use : table.usesOf(table[edge])) {
          if (!done[use.triangle]) part.push_back(use.triangle);
          done[use.triangle] = true;
        }
      }
    }
    for (const int t : part) dropped[t] = is_double && backs[t] < t;
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < backs.size(); ++t) {
    if (!dropped[t]) mesh.triangles[kept++] = mesh.triangles[t];
  }
  mesh.triangles.resize(kept);
}

/// Between corners of a triangle that do not lie in one place; infinity where there are none.
double shortestEdge(const std::vector<Vector3>& vertices, const std::vector<Triangle>& triangles) {
  double squared = std::numeric_limits<double>::infinity();
  for (const Triangle& t : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double edge =
          (vertices[static_cast<std::size_t>(t[k])] - vertices[static_cast<std::size_t>(t[(k + 1) % 3])]).squaredNorm();
      if (edge > 0.0) squared = std::min(squared, edge);
    }
  }
  return std::sqrt(squared);
}

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
  if (!(diagonal > 0.0)) return mesh;           // one point: every triangle is degenerate
  constexpr double kSinglePrecision = 0x1p-21;  // as firstInPlace() has it
  const double resolved = kSinglePrecision * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  PointGrid grid(low,
                 std::max(kMergeDistance * diagonal, std::min(resolved, 1e-3 * shortestEdge(vertices, triangles))));
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

void orientOutward(TriangleMesh& mesh) {
  dropBacks(mesh);
  Orienter(mesh).run();
}

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
