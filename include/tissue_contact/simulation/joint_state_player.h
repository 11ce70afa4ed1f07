/// @file
/// Room `simulation`: recorded or live joint states in, in whatever order the topics deliver them; simulator advanced from
/// stamp to stamp. Used alike by the node and by offline replay, so both give the same bits.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// One joint-state message. `positions` in rad or m, one per name.
struct JointStateSample {
  std::int64_t stamp_ns = 0;
  std::vector<std::string> names;
  std::vector<double> positions;
};

enum class Verdict {
  kAccepted,        ///< the simulator is now at this stamp
  kDuplicateStamp,  ///< same stamp as the topic's last one: ignored
  kBadStamp,        ///< zero or negative stamp: ignored
  kNotFinite,       ///< a position of a known joint is NaN or infinite: ignored
  kBadLength,       ///< as many positions as names are needed: ignored
  kNoKnownJoint,    ///< none of the names means a joint of an instrument on this topic: ignored
  kLate,            ///< older than the time already simulated (another topic was not waited for any longer): ignored
};
constexpr int kVerdictCount = 7;

const char* verdictText(Verdict verdict);

/// What happened to one sample.
struct PlayedSample {
  Verdict verdict = Verdict::kAccepted;
  int topic = -1;
  std::int64_t stamp_ns = 0;
  std::string detail;             ///< names the joint and value for a refused sample; empty if accepted
  bool was_reset = false;         ///< time went backwards (bag loop): the scene was reset before this sample
  bool was_gap = false;           ///< the interval was longer than max_gap_s and was simulated as that long
  std::vector<int> instruments;   ///< instruments that took joints from it: each owes one wrench at this stamp
};

class JointStatePlayer {
 public:
  /// @param simulator must outlive the player. @throws std::invalid_argument when no instrument has a topic.
  explicit JointStatePlayer(Simulator& simulator);

  /// Distinct joint-state topics of the scene, in order of first mention. Indices are the `topic` of push().
  const std::vector<std::string>& topics() const { return topics_; }

  /// Queues a sample. With several topics samples are played in the order of their stamps: a sample waits until every
  /// other topic has delivered one, or until it is max_gap_s older than the newest one.
  void push(int topic, JointStateSample sample);

  /// Plays the next sample whose turn it is; nothing if there is none. Call until it returns nothing.
  std::optional<PlayedSample> playNext();

  /// No more samples will come (end of a bag): nothing waits any longer.
  void finish() { finished_ = true; }

  /// Samples so far by verdict, resets and gaps.
  std::int64_t count(Verdict verdict) const { return counts_[static_cast<int>(verdict)]; }
  std::int64_t resets() const { return resets_; }
  std::int64_t gaps() const { return gaps_; }

 private:
  struct Queued {
    int epoch;  ///< how often this topic's time has gone backwards
    JointStateSample sample;
  };
  struct Topic {
    std::deque<Queued> queue;
    std::optional<std::int64_t> last_stamp_ns;  ///< of the last sample pushed, to see time go backwards
    int epoch = 0;
    std::vector<int> instruments;
  };

  int nextTopic() const;
  std::string validate(const JointStateSample& sample, const Topic& topic, Verdict& verdict) const;
  void takeJoints(const JointStateSample& sample, const Topic& topic, PlayedSample& played);

  Simulator& simulator_;
  std::vector<std::string> topics_;
  std::vector<Topic> topic_states_;
  std::vector<VectorX> targets_;                ///< joint positions last heard, per instrument
  std::vector<std::vector<bool>> heard_;        ///< per instrument and joint: ever heard since the last reset
  std::optional<std::int64_t> time_ns_;         ///< stamp the simulator is at
  int epoch_ = 0;
  bool finished_ = false;
  std::array<std::int64_t, kVerdictCount> counts_{};
  std::int64_t resets_ = 0;
  std::int64_t gaps_ = 0;
};

}  // namespace tissue_contact
