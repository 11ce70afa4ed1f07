#include "tissue_contact/friction/friction_law.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

#include "friction/check_friction_law.h"
#include "friction/sliding_search.h"

namespace tissue_contact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Use of the elliptic limit with these semiaxes by a force in its axes. A limit of 0 along one axis counts as this
/// share of the other: round-off of turning axes must not release a contact that pulls along the other one.
double ellipseUse(const Vector2& f, const Vector2& semiaxes) {
  constexpr double kNone = 1e-13;
  const double least = kNone * semiaxes.maxCoeff();
  if (!(least > 0.0)) return f.isZero(0.0) ? 0.0 : kInfinity;
  const Vector2 shares = f.cwiseQuotient(semiaxes.cwiseMax(least));
  return semiaxes.minCoeff() > least ? shares.norm() : shares.lpNorm<Eigen::Infinity>();
}

/// Orthotropic and asymmetric laws. The limit is two half ellipses that meet on axis 2; friction is the point of the
/// limit that dissipates most.
class EllipticFriction final : public AnisotropicFriction {
 public:
  struct Coefficients {
    double forward, backward, across;
  };
  EllipticFriction(const Coefficients& fixed, const Coefficients& kinetic) : static_(fixed), kinetic_(kinetic) {}

  Vector2 slidingForce(const Vector2& d) const override {
    const Vector2 mu = semiaxes(kinetic_, d.x());
    const Vector2 scaled = mu.cwiseProduct(d);
    const double size = scaled.norm();
    if (!(size > 0.0)) return Vector2::Zero();
    return mu.cwiseProduct(scaled) / -size;
  }

  double use(const Vector2& f, bool kinetic) const override {
    return ellipseUse(f, semiaxes(kinetic ? kinetic_ : static_, -f.x()));
  }

  Vector3 slidingImpulse(const Matrix3& W, const Vector3& q, double factor) const override {
    const Coefficients mu{factor * kinetic_.forward, factor * kinetic_.backward, factor * kinetic_.across};
    return SlidingSearch<Ellipses>(W, q, {mu}).impulse();
  }

 private:
  /// f = -S e belongs to sliding d with S d = s e, s >= 0: on an ellipse that is the associated rule. Where e lies on
  /// axis 2, which belongs to both halves, the sliding tells which one counts.
  struct Ellipses {
    Coefficients mu;
    FrictionPoint at(const Vector2& e) const {
      const Vector2 S = semiaxes(mu, e.x());
      return {-S.cwiseProduct(e), -S.cwiseProduct(quarterTurn(e))};
    }
    Vector2 weight(const Vector2& e, const Vector2& U) const { return semiaxes(mu, e.x() != 0.0 ? e.x() : U.x()); }
  };

  static Vector2 semiaxes(const Coefficients& mu, double along) {
    return {along > 0.0 ? mu.forward : mu.backward, mu.across};
  }

  Coefficients static_, kinetic_;
};

/// A coefficient for each sliding direction; friction straight against sliding.
class TableFriction final : public AnisotropicFriction {
 public:
  explicit TableFriction(const FrictionLawDescription& law)
      : angles_(law.angles_rad), static_(law.static_coefficients), kinetic_(law.kinetic_coefficients) {}

  Vector2 slidingForce(const Vector2& d) const override { return -coefficient(kinetic_, d).mu * d; }

  double use(const Vector2& f, bool kinetic) const override {
    const double size = f.norm();
    return size > 0.0 ? size / coefficient(kinetic ? kinetic_ : static_, -f).mu : 0.0;
  }

  Vector3 slidingImpulse(const Matrix3& W, const Vector3& q, double factor) const override {
    return SlidingSearch<Curve>(W, q, {*this, factor}).impulse();
  }

 private:
  struct Coefficient {
    double mu, slope;  ///< slope: by the angle, 1/rad
  };

  struct Curve {
    const TableFriction& table;
    double factor;
    FrictionPoint at(const Vector2& d) const {
      const Coefficient now = table.coefficient(table.kinetic_, d);
      return {-factor * now.mu * d, -factor * (now.mu * quarterTurn(d) + now.slope * d)};
    }
    static Vector2 weight(const Vector2&, const Vector2&) { return Vector2::Ones(); }
  };

  Coefficient coefficient(const std::vector<double>& mu, const Vector2& d) const {
    constexpr double kTurn = 2.0 * M_PI;
    double angle = std::atan2(d.y(), d.x());
    if (angle < 0.0) angle += kTurn;
    const std::size_t after = std::upper_bound(angles_.begin(), angles_.end(), angle) - angles_.begin();
    const std::size_t before = after - 1;  // angles start at 0
    const bool last = after == angles_.size();
    const double width = (last ? kTurn : angles_[after]) - angles_[before];
    const double next = mu[last ? 0 : after];
    const double share = (angle - angles_[before]) / width;
    return {(1.0 - share) * mu[before] + share * next, (next - mu[before]) / width};
  }

  std::vector<double> angles_, static_, kinetic_;
};

/// The set {M d : |d| <= 1}: an ellipse, or a segment or point where M is singular.
class TensorLimit {
 public:
  explicit TensorLimit(const Matrix2& M) {
    const Eigen::JacobiSVD<Matrix2> svd(M, Eigen::ComputeFullU);
    to_axes_ = svd.matrixU().transpose();
    semiaxes_ = svd.singularValues();
  }
  double use(const Vector2& f) const { return ellipseUse(to_axes_ * f, semiaxes_); }

 private:
  Matrix2 to_axes_;
  Vector2 semiaxes_;
};

class TensorFriction final : public AnisotropicFriction {
 public:
  TensorFriction(const Matrix2& fixed, const Matrix2& kinetic)
      : kinetic_(kinetic), static_limit_(fixed), kinetic_limit_(kinetic) {}

  Vector2 slidingForce(const Vector2& d) const override { return -(kinetic_ * d); }
  double use(const Vector2& f, bool kinetic) const override {
    return (kinetic ? kinetic_limit_ : static_limit_).use(f);
  }
  Vector3 slidingImpulse(const Matrix3& W, const Vector3& q, double factor) const override {
    return SlidingSearch<Curve>(W, q, {factor * kinetic_}).impulse();
  }

 private:
  struct Curve {
    Matrix2 M;
    FrictionPoint at(const Vector2& d) const { return {-(M * d), -(M * quarterTurn(d))}; }
    static Vector2 weight(const Vector2&, const Vector2&) { return Vector2::Ones(); }
  };

  Matrix2 kinetic_;
  TensorLimit static_limit_, kinetic_limit_;
};

/// Columns: minus the law's axis 1 and minus its axis 2 = n x axis 1, in (t1, t2). Contacts are solved in the tissue's
/// motion relative to the instrument and the impulse on the tissue; laws speak of the instrument's motion over the
/// tissue and the force on the instrument. Both are opposites, so one half turn of the axes takes the ones to the
/// others.
Matrix2 lawAxes(const CoulombLaw& law) {
  Matrix2 R_CL;
  R_CL << -law.axis.x(), law.axis.y(),  //
      -law.axis.y(), -law.axis.x();
  return R_CL;
}

/// Of a table over a speed or pressure, linear in between, held beyond its ends; 1 without one.
double factorAt(const std::vector<double>& table, const std::vector<double>& factors, double value) {
  if (table.empty()) return 1.0;
  const std::size_t after = std::upper_bound(table.begin(), table.end(), value) - table.begin();
  if (after == 0) return factors.front();
  if (after == table.size()) return factors.back();
  const double share = (value - table[after - 1]) / (table[after] - table[after - 1]);
  return (1.0 - share) * factors[after - 1] + share * factors[after];
}

EllipticFriction::Coefficients elliptic(const std::vector<double>& mu) {
  return mu.size() == 2 ? EllipticFriction::Coefficients{mu[0], mu[0], mu[1]}
                        : EllipticFriction::Coefficients{mu[0], mu[1], mu[2]};
}

}  // namespace

std::unique_ptr<const AnisotropicFriction> makeAnisotropicFriction(const FrictionLawDescription& law) {
  checkFrictionLaw(law);
  switch (law.kind) {
    case FrictionLawDescription::Kind::kIsotropic:
      break;
    case FrictionLawDescription::Kind::kOrthotropic:
    case FrictionLawDescription::Kind::kAsymmetric:
      return std::make_unique<EllipticFriction>(elliptic(law.static_coefficients), elliptic(law.kinetic_coefficients));
    case FrictionLawDescription::Kind::kTable:
      return std::make_unique<TableFriction>(law);
    case FrictionLawDescription::Kind::kTensor:
      return std::make_unique<TensorFriction>(frictionTensor(law.static_coefficients),
                                              frictionTensor(law.kinetic_coefficients));
  }
  return nullptr;
}

double kineticFactor(const FrictionLawDescription& law, double speed_m_per_s) {
  return factorAt(law.speeds_m_per_s, law.speed_factors, speed_m_per_s);
}

double pressureFactor(const FrictionLawDescription& law, double pressure_pa) {
  return factorAt(law.pressures_pa, law.pressure_factors, pressure_pa);
}

Vector2 kineticFriction(const CoulombLaw& law, const Vector2& direction) {
  if (law.anisotropic == nullptr) return -law.mu_kinetic * direction;
  const Matrix2 R_CL = lawAxes(law);
  return law.kinetic_factor * (R_CL * law.anisotropic->slidingForce(R_CL.transpose() * direction));
}

double frictionUse(const CoulombLaw& law, const Vector2& f, bool kinetic) {
  double use = 0.0;
  double limit = 1.0;
  if (law.anisotropic == nullptr) {
    use = f.norm();
    limit = kinetic ? law.mu_kinetic : law.mu_static;
  } else {
    use = law.anisotropic->use(lawAxes(law).transpose() * f, kinetic);
    limit = kinetic ? law.kinetic_factor : law.static_factor;
  }
  if (limit > 0.0) return use / limit;
  return use > 0.0 ? kInfinity : 0.0;
}

ContactAnswer solveAnisotropicContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding) {
  ContactAnswer answer;
  if (!(q[0] < 0.0)) return answer;  // separating without any impulse
  const Vector3 sticking = -(W.inverse() * q);
  if (sticking[0] > 0.0 && frictionUse(law, sticking.tail<2>(), was_sliding) <= sticking[0]) {
    answer.state = ContactState::kStatic;
    answer.impulse = sticking;
    return answer;
  }
  Matrix3 R = Matrix3::Identity();
  R.bottomRightCorner<2, 2>() = lawAxes(law);
  answer.state = ContactState::kKinetic;
  answer.impulse = R * law.anisotropic->slidingImpulse(R.transpose() * W * R, R.transpose() * q, law.kinetic_factor);
  return answer;
}

}  // namespace tissue_contact
