#include "ros/replay/replay_progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace tissue_contact {
namespace {

constexpr double kTerminalPeriod_s = 1.0;
constexpr double kLogPeriod_s = 10.0;

/// "7 s", "3:05 min", "2:10:00 h".
std::string durationText(double duration_s) {
  const long seconds = std::lround(duration_s);
  char text[48];
  if (seconds < 60) {
    std::snprintf(text, sizeof text, "%ld s", seconds);
  } else if (seconds < 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld min", seconds / 60, seconds % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld h", seconds / 3600, seconds / 60 % 60, seconds % 60);
  }
  return text;
}

}  // namespace

ReplayProgress::ReplayProgress(std::ostream& out, bool is_terminal, std::string prefix, double length_s)
    : out_(out),
      is_terminal_(is_terminal),
      prefix_(std::move(prefix)),
      length_s_(length_s),
      next_s_(is_terminal ? kTerminalPeriod_s : kLogPeriod_s) {}

ReplayProgress::~ReplayProgress() {
  if (line_shown_) out_ << "\r\033[K" << std::flush;
}

void ReplayProgress::at(double played_s, double wall_s) {
  if (wall_s < next_s_ || !(length_s_ > 0.0)) return;
  next_s_ = wall_s + (is_terminal_ ? kTerminalPeriod_s : kLogPeriod_s);
  const double share = std::clamp(played_s / length_s_, 0.0, 1.0);
  char text[96];
  std::snprintf(text, sizeof text, "%.1f %% of %.4g s, %.2g times real time", 100.0 * share, length_s_,
                share * length_s_ / wall_s);
  // At the mean speed so far; from the very first samples that is a guess not worth printing.
  constexpr double kLeastShare = 1e-3;
  const std::string left = share > kLeastShare ? ", " + durationText(wall_s * (1.0 - share) / share) + " left" : "";
  out_ << (is_terminal_ ? "\r" : "") << prefix_ << text << left << (is_terminal_ ? "\033[K" : "\n") << std::flush;
  line_shown_ = is_terminal_;
}

}  // namespace tissue_contact
