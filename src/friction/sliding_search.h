/// @file
/// Room `friction`, private: the impulse of one sliding contact for any friction that depends on the direction of
/// sliding. W, q and the friction in; the impulse out.
///
/// With u_n = 0 and friction f per unit normal impulse, the normal impulse is -q_n / bracket with
///   bracket = W_nn + W_nt . f,
/// and the sliding velocity times the bracket (> 0) is affine in the friction:
///   U = U_0 + C f,   U_0 = W_nn q_t - q_n W_tn,   C = q_t W_nt' - q_n W_tt.
/// Friction is a closed curve f(e), e a unit vector; it belongs to sliding U if w(e) U = s e, s >= 0, w a diagonal
/// weight. In the plain case e is the direction of sliding and w = 1; an ellipse {S e} with the associated rule has
/// -S e for f and S for w, which stays smooth however slender it is. Where w is made of pieces, U must belong to the
/// piece of e: s = |w(U) U|. One unknown, then: the angle of e.
///
/// For W symmetric positive definite and friction that dissipates but cannot hold the contact there is an answer:
/// friction grown from 0 to its full size never lets it leave a bounded set (r'W r + r'q = r_t . u_t <= 0), so that
/// frictionless sliding leads to it.
#pragma once

#include <cmath>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A point of the curve f(e) and its derivative by the angle of e.
struct FrictionPoint {
  Vector2 f, turned;
};

inline Vector2 quarterTurn(const Vector2& a) { return {-a.y(), a.x()}; }

/// `Curve` has FrictionPoint at(e), on the tissue, and Vector2 weight(e, U), the diagonal of w at e, or where e lies
/// between two pieces that of U; both in the axes of W.
template <class Curve>
class SlidingSearch {
 public:
  SlidingSearch(const Matrix3& W, const Vector3& q, const Curve& curve)
      : curve_(curve), W_nn_(W(0, 0)), q_n_(q[0]), W_nt_(W(0, 1), W(0, 2)) {
    const Vector2 q_t = q.tail<2>();
    U_0_ = W_nn_ * q_t - q_n_ * Vector2(W(1, 0), W(2, 0));
    C_ = q_t * W_nt_.transpose() - q_n_ * W.bottomRightCorner<2, 2>();
    U_0_size_ = U_0_.lpNorm<1>();
  }

  /// (r_n, r_t1, r_t2). Where nothing is consistent to round-off, to a billionth: right at sticking. Should there be
  /// nothing at all (not seen in 10^7 random contacts, most with far more friction than is physical), the impulse
  /// without friction.
  Vector3 impulse() const {
    constexpr double kExact = 1e-13;
    constexpr double kRightAtSticking = 1e-9;
    Trial trial;
    if (!find(kExact, trial) && !find(kRightAtSticking, trial)) trial.point.f.setZero();
    const Vector2& f = trial.point.f;
    const double normal = -q_n_ / (W_nn_ + W_nt_.dot(f));
    return {normal, normal * f.x(), normal * f.y()};
  }

 private:
  static constexpr double kRoundOff = 1e-15;  ///< of a sum of a handful of terms, as a share of their sizes

  /// One e tried.
  struct Trial {
    Vector2 e;
    FrictionPoint point;
    Vector2 U, weight, V;  ///< V = w U
    double miss;           ///< e x V; > 0: V is turned from e towards the quarter turn of e
    double size;           ///< of the terms of V

    bool found() const { return std::abs(miss) <= kRoundOff * size; }
  };

  static double cross(const Vector2& a, const Vector2& b) { return a.x() * b.y() - a.y() * b.x(); }

  Trial tryPoint(const Vector2& e, const FrictionPoint& point) const {
    const Vector2 change = C_ * point.f;
    const Vector2 U = U_0_ + change;
    const Vector2 weight = curve_.weight(e, U);
    const Vector2 V = weight.cwiseProduct(U);
    return {e, point, U, weight, V, cross(e, V), weight.maxCoeff() * (U_0_size_ + change.lpNorm<1>())};
  }
  Trial tryAt(const Vector2& e) const { return tryPoint(e, curve_.at(e)); }

  bool isConsistent(const Trial& trial, double slack) const {
    const double s = curve_.weight(trial.U, trial.U).cwiseProduct(trial.U).norm();
    return W_nn_ + W_nt_.dot(trial.point.f) > 0.0 && trial.e.dot(trial.V) >= s - slack * trial.size;
  }

  bool find(double slack, Trial& trial) const {
    const Vector2 V_0 = curve_.weight(U_0_, U_0_).cwiseProduct(U_0_);  // frictionless sliding
    const double size = V_0.norm();
    const Vector2 start = size > 0.0 ? Vector2(V_0 / size) : Vector2::UnitX();
    trial = tryAt(start);
    if (findNearby(slack, trial)) return true;
    // Roots crowd around `start`, where friction nearly jams the contact, and around an axis, where pieces meet.
    const bool along_1 = std::abs(start.x()) > std::abs(start.y());
    const Vector2 axis = along_1 ? Vector2(std::copysign(1.0, start.x()), 0.0)  //
                                 : Vector2(0.0, std::copysign(1.0, start.y()));
    for (const int points : {32, 256, 2048}) {
      if (findAround(start, points, slack, trial) || findAround(axis, points, slack, trial)) return true;
    }
    return false;
  }

  /// Newton's iteration on `miss`. Only slopes < 0 are followed: that is the slope of the roots that frictionless
  /// sliding leads to.
  bool findNearby(double slack, Trial& trial) const {
    constexpr int kMaxSteps = 12;         // typical: 2 to 4
    constexpr double kLargestTurn = 1.0;  // tangent of the angle
    for (int step = 0; step < kMaxSteps; ++step) {
      if (trial.found() && isConsistent(trial, slack)) return true;
      const Vector2 V_turned = trial.weight.cwiseProduct(C_ * trial.point.turned);
      const double slope = -trial.e.dot(trial.V) + cross(trial.e, V_turned);
      double turn = slope < 0.0 ? -trial.miss / slope : std::copysign(kLargestTurn, trial.miss);
      if (!(std::abs(turn) < kLargestTurn)) turn = std::copysign(kLargestTurn, turn);
      trial = tryAt((trial.e + turn * quarterTurn(trial.e)).normalized());
    }
    return false;
  }

  /// The root between two neighbours, miss > 0 on the `right` and <= 0 on the `left`. Where f turns so fast that no
  /// representable e meets it, a mixture of both sides does.
  Trial bisect(Trial right, Trial left) const {
    constexpr int kMaxSteps = 60;  // from a fraction of a turn to round-off
    for (int step = 0; step < kMaxSteps; ++step) {
      Trial middle = tryAt((right.e + left.e).normalized());
      if (middle.found()) return middle;
      (middle.miss > 0.0 ? right : left) = middle;
    }
    const double share = right.miss / (right.miss - left.miss);
    const Vector2 f = (1.0 - share) * right.point.f + share * left.point.f;
    return tryPoint((right.e + left.e).normalized(), {f, Vector2::Zero()});
  }

  /// Tries points all around, outwards from `start` to both sides.
  /// @return a consistent root was found.
  bool findAround(const Vector2& start, int points, double slack, Trial& answer) const {
    const Eigen::Rotation2Dd turn(2.0 * M_PI / points);
    Trial left = tryAt(start);  // the outermost on the side of growing angle
    Trial right = left;
    for (int i = 0; i < points / 2; ++i) {
      const Trial further_left = tryAt((turn * left.e).normalized());
      const Trial further_right = tryAt((turn.inverse() * right.e).normalized());
      if (left.miss > 0.0 && !(further_left.miss > 0.0)) {
        answer = bisect(left, further_left);
        if (isConsistent(answer, slack)) return true;
      }
      if (further_right.miss > 0.0 && !(right.miss > 0.0)) {
        answer = bisect(further_right, right);
        if (isConsistent(answer, slack)) return true;
      }
      left = further_left;
      right = further_right;
    }
    return false;
  }

  Curve curve_;
  double W_nn_, q_n_;
  Vector2 W_nt_, U_0_;
  Matrix2 C_;
  double U_0_size_;
};

}  // namespace tissue_contact
