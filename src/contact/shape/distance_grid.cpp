#include "contact/shape/distance_grid.h"

#include <algorithm>
#include <cmath>

#include "core/lanes.h"

namespace tissue_contact {
namespace {

using Weights = std::array<double, 3>;

/// Of three neighbouring coefficients, at `t` in [-1/2, 1/2] from the middle one.
Weights valueWeights(double t) { return {0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)}; }
Weights slopeWeights(double t) { return {t - 0.5, -2.0 * t, t + 0.5}; }

double sum(const Weights& weights, const float* values) {
  return weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2];
}

}  // namespace

Eigen::AlignedBox3d DistanceGrid::box() const {
  return {origin + Vector3::Constant(spacing), origin + spacing * Vector3(size[0] - 2, size[1] - 2, size[2] - 2)};
}

/// The 27 coefficients around a point and where among them it lies.
struct DistanceGrid::Neighbours {
  const float* first;
  std::size_t row_length;
  std::size_t layer_length;
  std::array<double, 3> t;

  const float* row(int j, int k) const { return first + k * layer_length + j * row_length; }
};

TISSUE_CONTACT_INLINE DistanceGrid::Neighbours DistanceGrid::around(const Vector3& p_S) const {
  const Vector3 u = (p_S - origin) / spacing;
  std::array<int, 3> middle{};
  std::array<double, 3> t{};
  for (int axis = 0; axis < 3; ++axis) {
    // NOLINTNEXTLINE(bugprone-incorrect-roundings): not negative within box(), and lround() is a call
    middle[axis] = std::clamp(static_cast<int>(u[axis] + 0.5), 1, size[axis] - 2);
    t[axis] = u[axis] - middle[axis];
  }
  const std::size_t row = size[0];
  return {&samples[index(middle[0] - 1, middle[1] - 1, middle[2] - 1)], row, row * size[1], t};
}

TISSUE_CONTACT_INLINE double DistanceGrid::valueInside(const Vector3& p_S) const {
  const Neighbours here = around(p_S);
  const Weights x = valueWeights(here.t[0]);
  const Weights y = valueWeights(here.t[1]);
  const Weights z = valueWeights(here.t[2]);
  double value = 0.0;
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) value += y[j] * z[k] * sum(x, here.row(j, k));
  }
  return value;
}

TISSUE_CONTACT_INLINE GridSample DistanceGrid::inside(const Vector3& p_S) const {
  const Neighbours here = around(p_S);
  const Weights x = valueWeights(here.t[0]);
  const Weights y = valueWeights(here.t[1]);
  const Weights z = valueWeights(here.t[2]);
  const Weights x_slope = slopeWeights(here.t[0]);
  const Weights y_slope = slopeWeights(here.t[1]);
  const Weights z_slope = slopeWeights(here.t[2]);
  double value = 0.0;
  double along_x = 0.0;
  double along_y = 0.0;
  double along_z = 0.0;
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      const float* row = here.row(j, k);
      const double here_value = sum(x, row);
      value += y[j] * z[k] * here_value;
      along_x += y[j] * z[k] * sum(x_slope, row);
      along_y += y_slope[j] * z[k] * here_value;
      along_z += y[j] * z_slope[k] * here_value;
    }
  }
  return {value, Vector3(along_x, along_y, along_z) / spacing};
}

TISSUE_CONTACT_CLONES GridSample DistanceGrid::at(const Vector3& p_S) const {
  const Eigen::AlignedBox3d valid = box();
  const Vector3 q = p_S.cwiseMax(valid.min()).cwiseMin(valid.max());
  GridSample sample = inside(q);
  const Vector3 way = p_S - q;
  const double squared = way.squaredNorm();
  if (squared > 0.0) {
    const double there = std::max(sample.distance, 0.0);
    for (int axis = 0; axis < 3; ++axis) {
      if (way[axis] != 0.0) sample.gradient[axis] = 0.0;
    }
    const double distance = std::sqrt(squared + there * there);
    sample = {distance, (way + there * sample.gradient) / distance};
  }
  return sample;
}

TISSUE_CONTACT_CLONES double DistanceGrid::valueAt(const Vector3& p_S) const {
  const Eigen::AlignedBox3d valid = box();
  const Vector3 q = p_S.cwiseMax(valid.min()).cwiseMin(valid.max());
  const double there = valueInside(q);
  const double squared = (p_S - q).squaredNorm();
  if (!(squared > 0.0)) return there;
  return std::sqrt(squared + std::max(there, 0.0) * std::max(there, 0.0));
}

FieldJump widestJump(const DistanceGrid& grid) {
  constexpr double kClosed = 2.0;  // spacings
  FieldJump widest;
  double most = kClosed * grid.spacing;
  for (int axis = 0; axis < 3; ++axis) {
    const std::array<int, 3> next = {axis == 0 ? 1 : 0, axis == 1 ? 1 : 0, axis == 2 ? 1 : 0};
    const std::size_t step = grid.index(next[0], next[1], next[2]);
    for (int k = 0; k + next[2] < grid.size[2]; ++k) {
      for (int j = 0; j + next[1] < grid.size[1]; ++j) {
        const float* row = &grid.samples[grid.index(0, j, k)];
        for (int i = 0; i + next[0] < grid.size[0]; ++i) {
          const float here = row[i];
          const float there = row[i + step];
          if ((here < 0.0F) == (there < 0.0F) || !(std::abs(here - there) > most)) continue;
          most = std::abs(here - there);
          widest = {most, 0.5 * (grid.point(i, j, k) + grid.point(i + next[0], j + next[1], k + next[2]))};
        }
      }
    }
  }
  return widest;
}

}  // namespace tissue_contact
