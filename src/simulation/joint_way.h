/// @file
/// Room `simulation`, private: how a joint goes from one position to another within an interval.
#pragma once

#include <algorithm>
#include <cmath>

namespace tissue_contact {

/// The cubic through both positions with the given velocities there (Hermite), as joint trajectory controllers of ROS take
/// it (sampled positions with velocities); the straight line where a velocity is not known, or where the mean of the
/// two misses this way by half of it and a quarter of either: drivers fill in zeros, or filter so long that the joint is elsewhere by then.
class JointWay {
 public:
  JointWay() = default;
  /// @param distance rad or m; `start_velocity` and `end_velocity` per second of it, NaN: not known.
  JointWay(double distance, double duration_s, double start_velocity, double end_velocity) : distance_(distance) {
    const double start = duration_s * start_velocity;
    const double end = duration_s * end_velocity;
    const double most = std::max({0.5 * std::abs(distance), 0.25 * std::abs(start), 0.25 * std::abs(end)});
    if (!std::isfinite(most) || !(std::abs(distance - 0.5 * (start + end)) <= most)) return;
    start_bend_ = start - distance;
    end_bend_ = end - distance;
  }

  /// How far it has gone at this fraction (0..1) of the interval.
  double at(double fraction) const {
    const double left = 1.0 - fraction;
    return fraction * distance_ + fraction * left * (left * start_bend_ - fraction * end_bend_);
  }
  /// Its velocity there, times the interval's duration.
  double slope(double fraction) const {
    const double left = 1.0 - fraction;
    return distance_ + left * (1.0 - 3.0 * fraction) * start_bend_ + fraction * (3.0 * fraction - 2.0) * end_bend_;
  }
  /// Bound on |slope| less |distance|, and on how far it goes beyond both ends: the weights of the bends above sum to 1 at most.
  double excess() const { return std::max(std::abs(start_bend_), std::abs(end_bend_)); }
  bool isStraight() const { return start_bend_ == 0.0 && end_bend_ == 0.0; }

 private:
  double distance_ = 0.0;
  double start_bend_ = 0.0;  ///< by which the velocity at the start would take it farther than `distance_`
  double end_bend_ = 0.0;
};

}  // namespace tissue_contact
