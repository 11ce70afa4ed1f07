/// @file
/// Room `ros`, private: what a haptic device is told to exert, from the newest wrench. Numbers and times in, a wrench out; knows neither
/// ROS nor a clock.
#pragma once

#include <cstdint>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// How wrenches become commands.
struct HapticOptions {
  double force_scale =
      1.0;  ///< newtons of the device per newton; negative for wrenches of the instrument on the tissue (CRTK)
  double torque_scale = 0.0;
  double max_force_n = 2.0;  ///< longer forces are cut to it, their direction kept
  double max_torque_nm = 0.05;
  double stale_after_s = 0.05;         ///< a wrench received longer ago commands nothing
  Matrix3 R_DW = Matrix3::Identity();  ///< from the axes of the wrenches to those of the device
};

/// The newest wrench, and what it commands. Not thread-safe.
class HapticOutput {
 public:
  explicit HapticOutput(const HapticOptions& options) : options_(options) {}

  /// A wrench that has come at this time (ns, of a clock that never goes back). One that is not finite commands nothing until the next.
  void take(const Wrench& wrench, std::int64_t now_ns);

  /// What to exert now: zero before the first wrench, and when the newest is stale or not finite.
  Wrench command(std::int64_t now_ns) const;

  bool isStale(std::int64_t now_ns) const;
  std::int64_t notFinite() const { return not_finite_; }  ///< wrenches so far

 private:
  HapticOptions options_;
  Wrench scaled_;  ///< in the device's axes, within the bounds
  std::int64_t received_ns_ = 0;
  bool received_ = false;
  std::int64_t not_finite_ = 0;
};

}  // namespace tissue_contact
