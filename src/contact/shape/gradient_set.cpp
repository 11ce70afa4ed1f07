#include "contact/shape/gradient_set.h"

#include <limits>

#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace {

/// Keeps the combination with the shortest tangential part; later ones must be clearly shorter, so that simple
/// combinations are preferred where several do.
class ShortestPart {
 public:
  void offer(const Vector3& gradient, const Vector3& part) {
    const double squared = part.squaredNorm();
    if (!(squared < kClearlyShorter * squared_)) return;
    squared_ = squared;
    gradient_ = gradient;
  }
  bool isZero() const { return squared_ < 1e-24; }
  const Vector3& gradient() const { return gradient_; }

 private:
  static constexpr double kClearlyShorter = 0.999999;
  double squared_ = std::numeric_limits<double>::infinity();
  Vector3 gradient_ = Vector3::Zero();
};

}  // namespace

void GradientSet::dropOne() {
  int dropped = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count_; ++i) {
    for (int j = i + 1; j < count_; ++j) {
      const double apart = (gradients_[j] - gradients_[i]).squaredNorm();
      if (!(apart < nearest)) continue;
      nearest = apart;
      dropped = j;
    }
  }
  gradients_[dropped] = gradients_[--count_];
}

Vector3 stationaryGradient(const GradientSet& gradients, const Matrix3& tangent) {
  const int n = gradients.count();
  std::array<Vector3, GradientSet::kMost> parts;
  ShortestPart best;
  for (int i = 0; i < n; ++i) {
    parts[i] = tangent * gradients[i];
    best.offer(gradients[i], parts[i]);
  }
  for (int i = 0; i < n && !best.isZero(); ++i) {
    for (int j = i + 1; j < n; ++j) {
      const double u = projectOnSegment(parts[i], parts[j], Vector3::Zero());
      best.offer((1.0 - u) * gradients[i] + u * gradients[j], (1.0 - u) * parts[i] + u * parts[j]);
    }
  }
  for (int i = 0; i < n && !best.isZero(); ++i) {
    for (int j = i + 1; j < n; ++j) {
      for (int k = j + 1; k < n; ++k) {
        const Vector3 w = projectOnTriangle({parts[i], parts[j], parts[k]}, Vector3::Zero());
        best.offer(w[0] * gradients[i] + w[1] * gradients[j] + w[2] * gradients[k],
                   w[0] * parts[i] + w[1] * parts[j] + w[2] * parts[k]);
      }
    }
  }
  return best.gradient();
}

}  // namespace tissue_contact
