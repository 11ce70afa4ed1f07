/// @file
/// Room `simulation`: which clock the stamps of one topic follow, and which stamps are of another.
#pragma once

#include <cstdint>
#include <optional>

namespace tissue_contact {

/// What a stamp is to its topic.
enum class ClockRuling {
  kGoesOn,     ///< the first of all, or later than the last; by however much, where the topic can be trusted
  kLoops,      ///< time has started again: this stamp and those held before it
  kResumes,    ///< the clock of before a jump goes on, so that jump was none
  kDuplicate,  ///< the last one once more
  kLate,       ///< before the last, by no more than a gap
  kHeld,       ///< farther back: a loop, if the stamps that follow go on from here
  kStray,      ///< of another clock than the one that is followed
};

/// Rules by the stamps of one topic, in the order they arrive, and by nothing else.
///
/// Forwards. A pause may last as long as it likes, so a stamp that lies more than max_gap_s ahead is believed. If the
/// clock of before then goes on all the same, by a stamp later than its last and nearer to it than to the one jumped
/// to, before the new clock has gone on by max_gap_s, that was an outlier or another publisher's: the clock of before
/// is followed again (kResumes), and the topic no longer trusted.
///
/// Backwards. A stamp more than max_gap_s back is held. It is a loop (kLoops) once kConfirming stamps in a row, this
/// one among them, have gone on from there and none from the clock that is followed; restart() makes it one at once. If
/// the clock that is followed goes on, the held ones were strays and the topic is no longer trusted.
///
/// Without trust every jump is a stray, until those in a row have gone on for more than max_gap_s without a stamp of
/// the clock that is followed: then that one has ended. Trust comes back after kHealing gaps of time without a stray.
class TopicClock {
 public:
  static constexpr int kConfirming = 3;  ///< two publishers take turns; one that loops does not
  static constexpr int kHealing = 10;

  /// @param max_gap_ns > 0.
  explicit TopicClock(std::int64_t max_gap_ns) : max_gap_ns_(max_gap_ns) {}

  /// The last stamp of the clock that is followed.
  const std::optional<std::int64_t>& last() const { return last_; }
  /// Whether stamps are held.
  bool isHolding() const { return candidate_ && is_trusted_; }
  /// Whether the stamp before was late as well.
  bool isLateInARow() const { return late_ns_.has_value(); }
  /// Whether restart() still counts.
  bool isRestarted() const { return restart_before_ns_.has_value(); }
  /// After kResumes: the last stamp before the jump that was none.
  std::int64_t resumedFrom() const { return resumed_from_ns_; }

  /// Rules on a stamp and remembers it. Of what was held see isHolding(): if not, and
  /// not by kLoops, those were strays.
  ClockRuling judge(std::int64_t stamp_ns);

  /// A stamp belongs to the loop that another topic has begun.
  void join(std::int64_t stamp_ns);

  /// The source of time has restarted: the next stamp not later than the last is a loop, forgotten once stamps have
  /// gone on by max_gap_s.
  /// @return whether the stamps that are held, if any, are that loop.
  bool restart();

 private:
  struct Jump {
    std::int64_t from_ns;  ///< last stamp of the clock before
    std::int64_t to_ns;
  };
  struct Candidate {
    std::int64_t first_ns;
    std::int64_t last_ns;
    int count = 1;
  };

  ClockRuling judgeNear(std::int64_t stamp_ns);
  ClockRuling judgeFar(std::int64_t stamp_ns);
  ClockRuling judgeCandidate(std::int64_t stamp_ns);
  bool isOfCandidate(std::int64_t stamp_ns) const;
  ClockRuling propose(std::int64_t stamp_ns);
  void goOn(std::int64_t stamp_ns);
  void jumpTo(std::int64_t stamp_ns);
  void distrust();

  std::int64_t max_gap_ns_;
  std::optional<std::int64_t> last_;
  std::optional<std::int64_t> restart_before_ns_;
  std::optional<std::int64_t> late_ns_;  ///< the stamp before, if that was late
  std::int64_t late_progress_ns_ = 0;    ///< by how much late stamps in a row have gone forward
  std::optional<Jump> jump_;             ///< the last one, until it cannot have been none any more
  std::optional<Candidate> candidate_;   ///< stamps in a row that may be a clock to follow
  std::int64_t resumed_from_ns_ = 0;
  bool is_trusted_ = true;
  std::int64_t healed_ns_ = 0;  ///< by how much stamps have gone on since the last stray
};

}  // namespace tissue_contact
