/// @file
/// Room `mesh`, private: which points lie in one place.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Points nearer than this are one, relative to the diagonal of the box around all: the resolution of single precision.
constexpr double kMergeDistance = 1e-7;

/// Points filed by grid cell, to find one near a given point in constant time.
class PointGrid {
 public:
  /// @param tolerance > 0.
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

}  // namespace tissue_contact
