#include "contact/shape/thin_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "contact/shape/surface_points.h"

namespace tissue_contact {
namespace {

constexpr int kFar = 4;          // spacings
constexpr double kSolid = 0.25;  // spacings inside; behind a flat face half a spacing deep the distance is .5

/// The least way from a point along a line, either way, to a triangle that it is not on; infinite: there is none.
double thicknessAt(const TriangleMesh& mesh, const Vector3& p, const Vector3& direction, double at_least) {
  double least = std::numeric_limits<double>::infinity();
  for (const Triangle& t : mesh.triangles) {  // Moeller and Trumbore 1997
    const Vector3 u = mesh.vertices.col(t[1]) - mesh.vertices.col(t[0]);
    const Vector3 v = mesh.vertices.col(t[2]) - mesh.vertices.col(t[0]);
    const Vector3 across = direction.cross(v);
    const double determinant = u.dot(across);
    if (determinant == 0.0) continue;
    const Vector3 s = (p - mesh.vertices.col(t[0])) / determinant;
    const Vector3 q = s.cross(u);
    const double a = s.dot(across);
    const double b = direction.dot(q);
    const double way = std::abs(v.dot(q));
    if (a >= 0.0 && b >= 0.0 && a + b <= 1.0 && way > at_least) least = std::min(least, way);
  }
  return least;
}

}  // namespace

ThinParts::ThinParts(const TriangleMesh& mesh, const DistanceGrid& grid, double points) : grid_(grid) {
  std::vector<std::uint8_t> thick(grid.samples.size(), 0);
  eachPoint(mesh, points, [&](const Vector3& p, double share, const Triangle& t) {
    const Vector3 normal = triangleNormal(mesh.vertices.col(t[0]), mesh.vertices.col(t[1]), mesh.vertices.col(t[2]));
    double lowest = 0.0;
    for (const double depth : {-1.0, -0.5, 0.5, 1.0}) {  // triangles may look either way
      lowest = std::min(lowest, grid.valueAt(p + depth * grid.spacing * normal));
    }
    if (lowest > -kSolid * grid.spacing) {
      share_ += share;
      far_.push_back({p, normal, share, lowest >= 0.0});
    } else {
      thick[cellOf(p)] = 1;
    }
  });
  if (!far_.empty()) dropNearThick(std::move(thick));
  if (!far_.empty()) measureLost();
}

std::size_t ThinParts::cellOf(const Vector3& p) const {
  const Vector3 u = (p - grid_.origin) / grid_.spacing;
  std::array<int, 3> at{};
  for (int a = 0; a < 3; ++a) at[a] = std::clamp(static_cast<int>(std::lround(u[a])), 0, grid_.size[a] - 1);
  return grid_.index(at[0], at[1], at[2]);
}

/// Of the thin points those in the cells of the grid that are within kFar of a thick one, along each axis.
void ThinParts::dropNearThick(std::vector<std::uint8_t> thick) {
  const std::array<std::size_t, 3> step = {grid_.index(1, 0, 0), grid_.index(0, 1, 0), grid_.index(0, 0, 1)};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = thick;
    for (int k = 0; k < grid_.size[2]; ++k) {
      for (int j = 0; j < grid_.size[1]; ++j) {
        for (int i = 0; i < grid_.size[0]; ++i) {
          const std::array<int, 3> at = {i, j, k};
          const std::size_t cell = grid_.index(i, j, k);
          if (before[cell] == 0) continue;
          const int low = std::max(-kFar, -at[axis]);
          const int high = std::min(kFar, grid_.size[axis] - 1 - at[axis]);
          for (int n = low; n <= high; ++n) thick[cell + n * static_cast<std::ptrdiff_t>(step[axis])] = 1;
        }
      }
    }
  }
  far_.erase(
      std::remove_if(far_.begin(), far_.end(), [&](const Point& point) { return thick[cellOf(point.p_S)] != 0; }),
      far_.end());
}

void ThinParts::measureLost() {
  constexpr int kBlock = 4;
  std::vector<Vector3> solid;  // middles of the samples inside, of each block that has any
  for (int k = 0; k < grid_.size[2]; k += kBlock) {
    for (int j = 0; j < grid_.size[1]; j += kBlock) {
      for (int i = 0; i < grid_.size[0]; i += kBlock) {
        Vector3 sum = Vector3::Zero();
        int count = 0;
        for (int n = 0; n < kBlock * kBlock * kBlock; ++n) {
          const std::array<int, 3> at = {i + n % kBlock, j + n / kBlock % kBlock, k + n / (kBlock * kBlock)};
          if (at[0] >= grid_.size[0] || at[1] >= grid_.size[1] || at[2] >= grid_.size[2]) continue;
          if (!(grid_.samples[grid_.index(at[0], at[1], at[2])] < -kSolid * grid_.spacing)) continue;
          sum += grid_.point(at[0], at[1], at[2]);
          ++count;
        }
        if (count > 0) solid.push_back(sum / count);
      }
    }
  }
  if (solid.empty()) return;  // all of it is thin
  for (const Point& point : far_) {
    if (!point.is_lost) continue;
    const auto [lost, is_new] = lost_.emplace(cellOf(point.p_S), std::numeric_limits<double>::infinity());
    if (!is_new) continue;
    for (const Vector3& p : solid) lost->second = std::min(lost->second, (p - point.p_S).norm());
  }
}

ThinParts::Part ThinParts::largest(const TriangleMesh& mesh) const {
  // Points in cells of the grid, those that are side by side or one apart being of one part.
  std::unordered_map<std::size_t, std::vector<std::size_t>> in_cell;
  for (std::size_t i = 0; i < far_.size(); ++i) in_cell[cellOf(far_[i].p_S)].push_back(i);
  std::vector<bool> met(far_.size(), false);
  std::vector<std::size_t> best;
  Part part;
  for (std::size_t first = 0; first < far_.size(); ++first) {
    if (met[first]) continue;
    std::vector<std::size_t> found = {first};
    met[first] = true;
    double share = 0.0;
    for (std::size_t next = 0; next < found.size(); ++next) {
      const Point& point = far_[found[next]];
      share += point.share;
      for (int n = 0; n < 125; ++n) {
        const std::array<int, 3> at = {n % 5 - 2, n / 5 % 5 - 2, n / 25 - 2};
        const Vector3 aside(at[0], at[1], at[2]);
        const auto cell = in_cell.find(cellOf(point.p_S + grid_.spacing * aside));
        if (cell == in_cell.end()) continue;
        for (const std::size_t other : cell->second) {
          if (!met[other]) found.push_back(other);
          met[other] = true;
        }
        in_cell.erase(cell);
      }
    }
    if (!(share > part.share)) continue;
    part.share = share;
    best = std::move(found);
  }
  if (best.empty()) return part;
  Vector3 middle = Vector3::Zero();
  for (const std::size_t i : best) middle += far_[i].share / part.share * far_[i].p_S;
  // Of some points at its middle the one where it is thinnest: at the rim of a sheet the normal runs along it.
  const std::size_t tried = std::min<std::size_t>(best.size(), 16);
  std::partial_sort(best.begin(), best.begin() + static_cast<std::ptrdiff_t>(tried), best.end(),
                    [&](std::size_t a, std::size_t b) {
                      return (far_[a].p_S - middle).squaredNorm() < (far_[b].p_S - middle).squaredNorm();
                    });
  part.thickness_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tried; ++i) {
    const Point& point = far_[best[i]];
    const double thickness_m = thicknessAt(mesh, point.p_S, point.normal, 1e-6 * grid_.spacing);
    if (i > 0 && !(thickness_m < part.thickness_m)) continue;
    part.p_S = point.p_S;
    part.thickness_m = thickness_m;
  }
  return part;
}

double ThinParts::lostAt(const Vector3& p_S) const {
  if (lost_.empty()) return 0.0;
  const auto lost = lost_.find(cellOf(p_S));
  return lost == lost_.end() ? 0.0 : lost->second;
}

}  // namespace tissue_contact
