#include "contact/distance_grid.h"

#include <algorithm>
#include <cmath>

namespace tissue_contact {
namespace {

/// Weights of three neighbouring coefficients and their slopes, at `t` in [-1/2, 1/2] from the middle one.
struct Weights {
  std::array<double, 3> value;
  std::array<double, 3> slope;
  explicit Weights(double t)
      : value{0.5 * (0.5 - t) * (0.5 - t), 0.75 - t * t, 0.5 * (0.5 + t) * (0.5 + t)},
        slope{t - 0.5, -2.0 * t, t + 0.5} {}
};

}  // namespace

Eigen::AlignedBox3d DistanceGrid::box() const {
  return {origin + Vector3::Constant(spacing), origin + spacing * Vector3(size[0] - 2, size[1] - 2, size[2] - 2)};
}

GridSample DistanceGrid::inside(const Vector3& p_S) const {
  const Vector3 u = (p_S - origin) / spacing;
  std::array<int, 3> middle;
  std::array<double, 3> t;
  for (int axis = 0; axis < 3; ++axis) {
    middle[axis] = std::clamp(static_cast<int>(u[axis] + 0.5), 1, size[axis] - 2);
    t[axis] = u[axis] - middle[axis];
  }
  const Weights x(t[0]);
  const Weights y(t[1]);
  const Weights z(t[2]);
  double value = 0.0;
  Vector3 slope = Vector3::Zero();
  const float* corner = &samples[index(middle[0] - 1, middle[1] - 1, middle[2] - 1)];
  for (int k = 0; k < 3; ++k) {
    for (int j = 0; j < 3; ++j) {
      const float* row = corner + (static_cast<std::size_t>(k) * size[1] + j) * size[0];
      const double along = x.value[0] * row[0] + x.value[1] * row[1] + x.value[2] * row[2];
      const double rise = x.slope[0] * row[0] + x.slope[1] * row[1] + x.slope[2] * row[2];
      const double yz = y.value[j] * z.value[k];
      value += yz * along;
      slope += Vector3(yz * rise, y.slope[j] * z.value[k] * along, y.value[j] * z.slope[k] * along);
    }
  }
  return {value, slope / spacing};
}

GridSample DistanceGrid::at(const Vector3& p_S) const {
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

}  // namespace tissue_contact
