/// @file
/// Room `ros`, private: how often a topic is published, measured in message time, so that a bag gives the same messages at any
/// playback rate.
#pragma once

#include <cmath>
#include <cstdint>

namespace tissue_contact {

class MessageTimeRate {
 public:
  /// @param rate_hz messages per second of message time; 0: never.
  explicit MessageTimeRate(double rate_hz)
      : period_ns_(rate_hz > 0.0 ? std::llround(std::fmin(1e9 / rate_hz, 1e18)) : 0), off_(!(rate_hz > 0.0)) {}

  /// Whether a message is due at this stamp (ns). Due times lie on a grid that starts at the first stamp asked for, so
  /// the mean rate holds although stamps fall between; stamps must not go back without reset().
  bool due(std::int64_t stamp_ns) {
    if (off_ || (started_ && stamp_ns < next_ns_)) return false;
    if (!started_) next_ns_ = stamp_ns;
    started_ = true;
    if (period_ns_ > 0) next_ns_ += ((stamp_ns - next_ns_) / period_ns_ + 1) * period_ns_;
    return true;
  }

  /// The next stamp is due whatever it is (time went backwards).
  void reset() { started_ = false; }

 private:
  std::int64_t period_ns_;
  bool off_;
  bool started_ = false;
  std::int64_t next_ns_ = 0;  ///< valid when started
};

}  // namespace tissue_contact
