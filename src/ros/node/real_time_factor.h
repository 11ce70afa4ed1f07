/// @file
/// Room `ros`, private: simulated time over wall time of late. No ROS and no clock inside.
#pragma once

#include <deque>

namespace tissue_contact {

/// 1: keeps up with a source that plays in real time; less: falls behind, or the source pauses. Not thread-safe.
class RealTimeFactor {
 public:
  /// `simulated_s` more were simulated by the time `now_s`, which never goes back.
  void note(double now_s, double simulated_s) {
    simulated_s_ += simulated_s;
    if (!points_.empty() && now_s - points_.back().now_s < kApart) return;
    points_.push_back({now_s, simulated_s_});
    while (points_.size() > 1 && now_s - points_[1].now_s >= kWindow) points_.pop_front();
  }

  /// Over the last second or a little more; 0 before the first note.
  double value(double now_s) const {
    if (points_.empty() || !(now_s > points_.front().now_s)) return 0.0;
    return (simulated_s_ - points_.front().simulated_s) / (now_s - points_.front().now_s);
  }

 private:
  static constexpr double kWindow = 1.0;            ///< s
  static constexpr double kApart = kWindow / 20.0;  ///< s, between points, so that their number is bounded
  struct Point {
    double now_s;
    double simulated_s;
  };
  std::deque<Point> points_;  ///< the last second at some distance, and one older
  double simulated_s_ = 0.0;
};

}  // namespace tissue_contact
