/// @file
/// Room `tissue`, private: distinct shapes of elements, each kept once: a block of even cells has few. Shapes of batches in, their places in a list out.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/lanes.h"
#include "tissue_contact/core/content_hash.h"

namespace tissue_contact {

/// N numbers of each of four elements side by side, which tell their shapes, all of one unit.
template <std::size_t N>
using ShapeBatch = std::array<std::array<double, kLanes>, N>;

/// Shapes that differ by round-off alone count as the same: in each element by less than 1e-10 of its largest number. Cells of an even block are as much as
/// 1e-13 apart, since so are differences of coordinates.
template <std::size_t N>
class ShapeTable {
 public:
  /// @return its place among shapes(), or that of one like it.
  std::size_t add(const ShapeBatch<N>& shape) {
    const auto [known, is_new] = places_.emplace(hash(shape), shapes_.size());
    if (!is_new && isLike(shapes_[known->second], shape)) return known->second;
    shapes_.push_back(shape);
    return shapes_.size() - 1;
  }

  const std::vector<ShapeBatch<N>>& shapes() const { return shapes_; }

 private:
  static constexpr double kRoundOff = 1e-10;

  static double largest(const ShapeBatch<N>& shape, std::size_t lane) {
    double most = 0.0;
    for (const auto& four : shape) most = std::max(most, std::abs(four[lane]));
    return most;
  }

  /// Like shapes mostly share it; isLike() tells those apart that share it by chance.
  static std::uint64_t hash(const ShapeBatch<N>& shape) {
    constexpr int kBits = 30;
    double most = 0.0;
    for (std::size_t lane = 0; lane < kLanes; ++lane) most = std::max(most, largest(shape, lane));
    int exponent = 0;
    std::frexp(1.1 * most, &exponent);  // powers of two, which are common, lie far from where it changes
    ContentHash hash(static_cast<std::uint64_t>(exponent));
    for (const auto& four : shape) {
      for (const double number : four) {
        const std::int64_t rounded = std::llround(std::ldexp(number, kBits - exponent));
        hash.add(&rounded, sizeof rounded);
      }
    }
    return hash.value();
  }

  static bool isLike(const ShapeBatch<N>& a, const ShapeBatch<N>& b) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const double little = kRoundOff * largest(a, lane);
      for (std::size_t i = 0; i < N; ++i) {
        if (!(std::abs(a[i][lane] - b[i][lane]) <= little)) return false;
      }
    }
    return true;
  }

  std::vector<ShapeBatch<N>> shapes_;
  std::unordered_map<std::uint64_t, std::size_t> places_;  ///< by hash, the first that had it
};

}  // namespace tissue_contact
