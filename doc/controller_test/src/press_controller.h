// The controller under test: lowers a probe onto tissue until it feels a force, and holds that. No ROS, no clock: called once per period.
#pragma once

#include <algorithm>

class PressController {
 public:
  explicit PressController(double target_n) : target_n_(target_n) {}

  // From the force felt (N) at the last position to the next position of the probe (m, upwards).
  double next(double force_n) {
    z_m_ -= std::clamp(kGain_m_per_n * (target_n_ - force_n), -kLargestStep_m, kLargestStep_m);
    return z_m_;
  }

 private:
  static constexpr double kGain_m_per_n = 0.001;    // the tissue is some 200 N/m stiff: a fifth of the error per period
  static constexpr double kLargestStep_m = 0.0002;  // 20 mm/s at 100 Hz

  double target_n_;
  double z_m_ = 0.0;
};
