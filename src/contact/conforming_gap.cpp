#include "contact/conforming_gap.h"

#include <algorithm>
#include <cmath>

namespace tissue_contact {

ConformingGap conformingGap(const std::array<Vector3, 3>& corners, const std::array<double, 3>& distances,
                            const Vector3& weights, double gap) {
  constexpr double kSmooth = 0.25;  // l / R
  constexpr double kSharp = 0.5;
  Vector3 p = Vector3::Zero();
  double sagitta = -gap;
  for (int i = 0; i < 3; ++i) {
    p += weights[i] * corners[i];
    sagitta += weights[i] * distances[i];
  }
  double squared = 0.0;
  for (int i = 0; i < 3; ++i) squared += weights[i] * (corners[i] - p).squaredNorm();
  if (!(squared > 0.0)) return {gap, true};  // at a vertex
  const double bend = 2.0 * sagitta / std::sqrt(squared);
  const double share = std::clamp((kSharp - bend) / (kSharp - kSmooth), 0.0, 1.0);
  return {gap + share * sagitta, share == 1.0};
}

}  // namespace tissue_contact
