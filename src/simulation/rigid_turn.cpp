#include "simulation/rigid_turn.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/slice_product.h"

namespace tissue_contact {
namespace {

/// Turns in a step by more than this, rad, are no motion that a step follows; where nodes lie on a line they are round-off.
constexpr double kMostTurn = 1.0;

struct Turn {
  Vector3 centre = Vector3::Zero();  ///< m
  Vector3 omega = Vector3::Zero();   ///< rad/s
};

Turn turnOf(const VectorX& mass, const NodalVectors& x, const NodalVectors& v) {
  const double whole = mass.sum();
  Turn turn;
  Vector3 drift = Vector3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    turn.centre += mass[i] * x.col(i);
    drift += mass[i] * v.col(i);
  }
  turn.centre /= whole;
  drift /= whole;
  Matrix3 inertia = Matrix3::Zero();
  Vector3 angular_momentum = Vector3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3 r = x.col(i) - turn.centre;
    const Vector3 speed = v.col(i) - drift;
    inertia += mass[i] * (r.squaredNorm() * Matrix3::Identity() - r * r.transpose());
    angular_momentum += mass[i] * r.cross(speed);
  }
  turn.omega = inertia.ldlt().solve(angular_momentum);
  return turn;
}

/// sum += scale * matrix * v.
TISSUE_CONTACT_CLONES
void addTimes(const BlockMatrix& matrix, double scale, const NodalVectors& v, NodalVectors& sum) {
  for (Eigen::Index i = 0; i < v.cols(); ++i) {
    sum.col(i) += scale * (matrix.diagonal[static_cast<std::size_t>(i)] * v.col(i));
  }
  addOffDiagonalProduct(matrix, scale, v, sum);
}

}  // namespace

void letTurn(const VectorX& mass, const NodalVectors& x, const NodalVectors& v, double dt_s, NodalVectors& w,
             BodySystem& system) {
  const Turn turn = turnOf(mass, x, v);
  const double angle = dt_s * turn.omega.norm();
  if (!(angle > 0.0 && angle < kMostTurn)) return;
  const Matrix3 rotation = Eigen::AngleAxisd(angle, turn.omega.normalized()).toRotationMatrix();
  const Matrix3 chord = (rotation - Matrix3::Identity()) / dt_s;
  w.resize(3, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) w.col(i) = chord * (x.col(i) - turn.centre);
  addTimes(*system.K, system.stiffness_scale, w, system.b);
  if (system.D != nullptr) addTimes(*system.D, system.damping_scale, w, system.b);
}

}  // namespace tissue_contact
