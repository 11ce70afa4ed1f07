#include "benchmark/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace tissue_contact {

void Progress::begin(const std::string& what, double work) {
  what_ = what;
  part_ = work;
  at(0.0);
}

void Progress::at(double share) {
  using std::chrono::steady_clock;
  if (bar_ == nullptr) return;
  const steady_clock::time_point now = steady_clock::now();
  if (now - shown_ < std::chrono::milliseconds(200)) return;
  shown_ = now;
  const double done = std::clamp((done_ + share * part_) / work_, 0.0, 1.0);
  const double passed_s = std::chrono::duration<double>(now - start_).count();
  constexpr int kWidth = 30;
  const auto filled = static_cast<std::size_t>(done * kWidth);
  char left[32] = "";
  if (done > 0.01) {  // before that the rate is a guess
    const long seconds = std::lround(passed_s * (1.0 - done) / done);
    std::snprintf(left, sizeof left, ", %ld:%02ld left", seconds / 60, seconds % 60);
  }
  *bar_ << "\r[" << std::string(filled, '=') << std::string(kWidth - filled, ' ') << "] "
        << static_cast<int>(100.0 * done) << " %" << left << ": " << what_ << "\033[K" << std::flush;
}

void Progress::end() {
  done_ += part_;
  part_ = 0.0;
}

void Progress::clear() {
  if (bar_ != nullptr) *bar_ << "\r\033[K" << std::flush;
}

}  // namespace tissue_contact
