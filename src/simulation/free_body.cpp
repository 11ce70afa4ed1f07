#include "simulation/free_body.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/slice_product.h"

namespace tissue_contact {
namespace {

/// Turns in a step by more than this, rad, are no motion that a step follows; where nodes lie on a line they are
/// round-off.
constexpr double kMostTurn = 1.0;

/// Turns in a step by less, rad, brake nothing: what lies at rest is spared the product.
constexpr double kLeastTurn = 1e-9;

/// sum += scale * matrix * v.
TISSUE_CONTACT_CLONES
void addTimes(const BlockMatrix& matrix, double scale, const NodalVectors& v, NodalVectors& sum) {
  for (Eigen::Index i = 0; i < v.cols(); ++i) {
    sum.col(i) += scale * (matrix.diagonal[static_cast<std::size_t>(i)] * v.col(i));
  }
  addOffDiagonalProduct(matrix, scale, v, sum);
}

}  // namespace

Vector3 FreeMotion::turnWith(const Vector3& angular_momentum) const {
  const Vector3 turn = inertia.ldlt().solve(angular_momentum);
  return turn.allFinite() ? turn : Vector3(0.0, 0.0, 0.0);
}

FreeMotion freeMotionOf(const VectorX& mass, const NodalVectors& x, const NodalVectors& v) {
  FreeMotion motion;
  motion.mass = mass.sum();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    motion.centre += mass[i] * x.col(i);
    motion.linear += mass[i] * v.col(i);
  }
  motion.centre /= motion.mass;
  const Vector3 drift = motion.linear / motion.mass;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3 r = x.col(i) - motion.centre;
    const Vector3 speed = v.col(i) - drift;
    motion.inertia += mass[i] * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
    motion.angular += mass[i] * r.cross(speed);
  }
  return motion;
}

void keepMomentum(const FreeMotion& had, const VectorX& mass, const NodalVectors& x, NodalVectors& v) {
  const FreeMotion now = freeMotionOf(mass, x, v);
  const Vector3 drift = (had.linear - now.linear) / now.mass;
  const Vector3 omega = now.turnWith(had.angular - now.angular);
  for (Eigen::Index i = 0; i < x.cols(); ++i) v.col(i) += drift + omega.cross(Vector3(x.col(i) - now.centre));
}

void letTurn(const VectorX& mass, const NodalVectors& x, const NodalVectors& v, double dt_s, NodalVectors& w,
             BodySystem& system) {
  const FreeMotion motion = freeMotionOf(mass, x, v);
  const Vector3 omega = motion.omega();
  const double angle = dt_s * omega.norm();
  if (!(angle > kLeastTurn && angle < kMostTurn)) return;
  const Matrix3 rotation = Eigen::AngleAxisd(angle, omega.normalized()).toRotationMatrix();
  const Matrix3 chord = (rotation - Matrix3::Identity()) / dt_s;
  w.resize(3, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) w.col(i) = chord * (x.col(i) - motion.centre);
  addTimes(*system.K, system.stiffness_scale, w, system.b);
  if (system.D != nullptr) addTimes(*system.D, system.damping_scale, w, system.b);
}

}  // namespace tissue_contact
