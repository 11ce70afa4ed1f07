/// @file
/// Room `ros`: see real_time_factor.h.
#include "tissue_contact/ros/real_time_factor.h"

namespace tissue_contact {
namespace {

constexpr double kWindow = 1.0;               ///< s
constexpr double kDistance = kWindow / 20.0;  ///< s, between points, so that their number is bounded

}  // namespace

void RealTimeFactor::note(double now_s, double simulated_s) {
  simulated_s_ += simulated_s;
  if (!points_.empty() && now_s - points_.back().now_s < kDistance) return;
  points_.push_back({now_s, simulated_s_});
  while (points_.size() > 1 && now_s - points_[1].now_s >= kWindow) points_.pop_front();
}

double RealTimeFactor::value(double now_s) const {
  if (points_.empty() || !(now_s > points_.front().now_s)) return 0.0;
  return (simulated_s_ - points_.front().simulated_s) / (now_s - points_.front().now_s);
}

}  // namespace tissue_contact
