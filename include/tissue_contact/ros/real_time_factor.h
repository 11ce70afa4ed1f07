/// @file
/// Room `ros`: simulated time over wall time of late. No ROS and no clock inside.
#pragma once

#include <deque>

namespace tissue_contact {

/// 1: keeps up with a source that plays in real time; less: falls behind, or the source pauses. Not thread-safe.
class RealTimeFactor {
 public:
  /// `simulated_s` more were simulated by the time `now_s`, which never goes back.
  void note(double now_s, double simulated_s);

  /// Over the last second or a little more; 0 before the first note.
  double value(double now_s) const;

 private:
  struct Point {
    double now_s;
    double simulated_s;
  };
  std::deque<Point> points_;  ///< the last second at some distance, and one older
  double simulated_s_ = 0.0;
};

}  // namespace tissue_contact
