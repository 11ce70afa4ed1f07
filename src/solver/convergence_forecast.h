/// @file
/// Room `solver`, private: how many more iterations a step likely takes.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace tissue_contact {

/// By the mean rate of the last four iterations: two sweeps forth and two back, which leave different defects.
class ConvergenceForecast {
 public:
  void begin() { count_ = 0; }

  /// Ends an iteration. @param excess what is left over what may be left.
  void add(double excess) { last_[count_++ % last_.size()] = excess; }

  /// Until no more is left than may be; infinity where it does not fall; 0 where it is reached or nothing is known yet.
  double iterationsLeft() const {
    constexpr std::size_t kSpan = kKept - 1;
    if (count_ < kLeast) return 0.0;
    const double now = last_[(count_ - 1) % kKept];
    const double before = last_[(count_ - 1 - kSpan) % kKept];
    if (!(now > 1.0 && before > 0.0)) return 0.0;
    const double fall = std::log(before / now);
    return fall > 0.0 ? std::log(now) * kSpan / fall : std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr std::size_t kKept = 5;
  static constexpr std::size_t kLeast = 8;  ///< the first ones fall fast and tell little
  std::array<double, kKept> last_{};
  std::size_t count_ = 0;
};

}  // namespace tissue_contact
