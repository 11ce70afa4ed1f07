/// @file
/// Room `simulation`: see topic_clock.h.
#include "tissue_contact/simulation/topic_clock.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace tissue_contact {

ClockRuling TopicClock::judge(std::int64_t stamp_ns) {
  if (!last_) {
    last_ = stamp_ns;
    return ClockRuling::kGoesOn;
  }
  const std::int64_t ahead_ns = stamp_ns - *last_;
  if (restart_before_ns_ && ahead_ns <= 0) {
    join(stamp_ns);
    return ClockRuling::kLoops;
  }
  if (candidate_ && isOfCandidate(stamp_ns)) return judgeCandidate(stamp_ns);
  return std::abs(ahead_ns) <= max_gap_ns_ ? judgeNear(stamp_ns) : judgeFar(stamp_ns);
}

void TopicClock::join(std::int64_t stamp_ns) {
  last_ = stamp_ns;
  restart_before_ns_.reset();
  late_ns_.reset();
  late_progress_ns_ = 0;
  jump_.reset();
  candidate_.reset();
  is_trusted_ = true;
}

bool TopicClock::restart() {
  if (candidate_ && is_trusted_) {
    join(candidate_->last_ns);
    return true;
  }
  if (last_) restart_before_ns_ = *last_ + max_gap_ns_;
  return false;
}

/// Within a gap of the last stamp, either way.
ClockRuling TopicClock::judgeNear(std::int64_t stamp_ns) {
  if (candidate_) distrust();  // the clock that is followed goes on
  const std::int64_t ahead_ns = stamp_ns - *last_;
  if (ahead_ns > 0) {
    goOn(stamp_ns);
    return ClockRuling::kGoesOn;
  }
  if (ahead_ns == 0) return ClockRuling::kDuplicate;
  // Late ones in a row that have gone on for more than a gap and go back again are a short recording played in a loop.
  if (late_progress_ns_ > max_gap_ns_ && stamp_ns < *late_ns_) {
    join(stamp_ns);
    return ClockRuling::kLoops;
  }
  if (late_ns_) late_progress_ns_ += std::max<std::int64_t>(0, stamp_ns - *late_ns_);
  late_ns_ = stamp_ns;
  return ClockRuling::kLate;
}

/// More than a gap from the last stamp, and of no candidate.
ClockRuling TopicClock::judgeFar(std::int64_t stamp_ns) {
  if (jump_ && stamp_ns > jump_->from_ns && stamp_ns - jump_->from_ns < std::abs(stamp_ns - *last_)) {
    resumed_from_ns_ = jump_->from_ns;
    distrust();
    jump_.reset();
    last_ = stamp_ns;
    return ClockRuling::kResumes;
  }
  if (stamp_ns < *last_) return propose(stamp_ns);
  // A pause of the clock that is followed, unless that is known to have a rival, and the rival's is not farther off.
  const bool is_nearer = candidate_ && stamp_ns - *last_ < std::abs(stamp_ns - candidate_->last_ns);
  if (!is_trusted_ && !is_nearer) return propose(stamp_ns);
  if (candidate_) distrust();
  jumpTo(stamp_ns);
  return ClockRuling::kGoesOn;
}

/// Whether the stamp goes on where the candidate was rather than where the clock that is followed was.
bool TopicClock::isOfCandidate(std::int64_t stamp_ns) const {
  const bool is_nearer = std::abs(stamp_ns - candidate_->last_ns) < std::abs(stamp_ns - *last_);
  if (stamp_ns > candidate_->last_ns) return is_nearer || stamp_ns < *last_ - max_gap_ns_;
  return is_nearer && candidate_->last_ns - stamp_ns <= max_gap_ns_;
}

ClockRuling TopicClock::judgeCandidate(std::int64_t stamp_ns) {
  if (stamp_ns == candidate_->last_ns) return ClockRuling::kDuplicate;
  if (stamp_ns < candidate_->last_ns) return ClockRuling::kLate;
  candidate_->last_ns = stamp_ns;
  ++candidate_->count;
  if (is_trusted_ ? candidate_->count < kConfirming : stamp_ns - candidate_->first_ns <= max_gap_ns_) {
    return is_trusted_ ? ClockRuling::kHeld : ClockRuling::kStray;
  }
  const bool is_loop = stamp_ns < *last_;
  jumpTo(stamp_ns);
  return is_loop ? ClockRuling::kLoops : ClockRuling::kGoesOn;
}

/// The first stamp of a clock that may have to be followed.
ClockRuling TopicClock::propose(std::int64_t stamp_ns) {
  if (candidate_) distrust();  // neither the clock that is followed nor the candidate
  candidate_ = Candidate{stamp_ns, stamp_ns};
  if (is_trusted_) return ClockRuling::kHeld;
  healed_ns_ = 0;
  return ClockRuling::kStray;
}

void TopicClock::goOn(std::int64_t stamp_ns) {
  healed_ns_ += stamp_ns - *last_;
  is_trusted_ |= healed_ns_ > kHealing * max_gap_ns_;
  last_ = stamp_ns;
  if (restart_before_ns_ && stamp_ns > *restart_before_ns_) restart_before_ns_.reset();
  if (jump_ && stamp_ns - jump_->to_ns > max_gap_ns_) jump_.reset();
  late_ns_.reset();
  late_progress_ns_ = 0;
}

void TopicClock::jumpTo(std::int64_t stamp_ns) {
  const Jump jump = {*last_, stamp_ns};
  const bool was_trusted = is_trusted_;
  join(stamp_ns);
  is_trusted_ = was_trusted;
  jump_ = jump;
}

void TopicClock::distrust() {
  candidate_.reset();
  is_trusted_ = false;
  healed_ns_ = 0;
}

}  // namespace tissue_contact
