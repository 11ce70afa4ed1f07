/// @file
/// Room `simulation`: recorded or live joint states in, in whatever order the topics deliver them; simulator advanced
/// from stamp to stamp. Used alike by the node and by offline replay, so both give the same bits.
#pragma once

#include <array>
#include <cstddef>
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

/// A few words for people ("duplicate stamp"), never null.
const char* verdictText(Verdict verdict);

/// What happened to one sample.
struct PlayedSample {
  Verdict verdict = Verdict::kAccepted;
  int topic = -1;
  std::int64_t stamp_ns = 0;
  std::string detail;            ///< names the joint and value for a refused sample; empty if accepted
  bool was_reset = false;        ///< time went backwards (bag loop): the scene was reset before this sample
  bool was_gap = false;          ///< the interval was longer than max_gap_s and was simulated as that long
  std::vector<int> instruments;  ///< instruments that took joints from it: each owes one wrench at this stamp
};

/// Plays joint states into a simulator.
///
/// Order. Samples are played in the order of (loop, stamp, topic index). Time going backwards on a topic starts that
/// topic's next loop; the first sample played from a new loop resets the scene. A topic first heard joins the newest
/// loop; so does one that did not go back itself but whose stamps are within max_gap_s of the newest loop's newest
/// stamp (a source whose clock was set back a little, beside others).
///
/// Joints. A joint heard for the first time since the start or a reset is placed; later its instrument moves linearly
/// from stamp to stamp. Joints not heard stay at the scene's initial position. The first sample of a run places
/// instruments without any step. A sample at the stamp the simulator is already at (another topic's) changes only where
/// the instruments head in the next interval.
///
/// Memory. Played or refused samples are forgotten; waiting ones span at most max_gap_s of message time per loop and
/// are at most kMaxWaiting, provided that playNext() is called until it returns nothing after every push().
///
/// With one topic the result depends on the stamps and positions alone; with several, also on nothing else as long as
/// no topic is more than max_gap_s late and no loop is shorter than that. Not thread-safe.
class JointStatePlayer {
 public:
  /// Samples that may wait for another topic: 20 s of one 500 Hz topic. Beyond it nothing waits.
  static constexpr std::size_t kMaxWaiting = 10000;

  /// @param simulator must outlive the player. @throws std::invalid_argument when no instrument has a topic.
  explicit JointStatePlayer(Simulator& simulator);

  /// Distinct joint-state topics of the scene, in order of first mention. Indices are the `topic` of push().
  const std::vector<std::string>& topics() const { return topics_; }

  /// Queues a sample. With several topics samples are played in the order of their stamps: a sample waits until every
  /// other topic has delivered one of its stamp or later, or until it is max_gap_s older than the newest one.
  /// A sample whose content is refused has no say in time: neither its stamp nor its arrival is remembered.
  void push(int topic, JointStateSample sample);

  /// Plays the next sample whose turn it is; nothing if there is none. Call until it returns nothing. Refused samples
  /// come first.
  std::optional<PlayedSample> playNext();

  /// No more samples will come (end of a bag): nothing waits any longer.
  void finish() { finished_ = true; }

  /// Samples so far by verdict, resets and gaps.
  std::int64_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }
  std::int64_t resets() const { return resets_; }
  std::int64_t gaps() const { return gaps_; }

 private:
  /// When a sample is: loop first, then stamp.
  struct Moment {
    int epoch = 0;  ///< how often time has gone backwards
    std::int64_t stamp_ns = 0;

    friend bool operator<(const Moment& a, const Moment& b) {
      return a.epoch != b.epoch ? a.epoch < b.epoch : a.stamp_ns < b.stamp_ns;
    }
  };
  struct Queued {
    Moment moment;
    JointStateSample sample;
  };
  struct Topic {
    std::deque<Queued> queue;
    std::optional<Moment> last;  ///< of the last sample queued, to see time go backwards
    std::vector<int> instruments;
  };
  /// The newest loop any topic has reached.
  struct NewestLoop {
    int epoch = 0;
    std::int64_t first_ns = 0;  ///< stamp of its first sample to arrive
    std::int64_t last_ns = 0;   ///< newest stamp in it
  };

  Verdict judge(const JointStateSample& sample, const Topic& topic, std::string& detail) const;
  Verdict judgeJoints(const JointStateSample& sample, const Topic& topic, std::string& detail) const;
  Moment momentOf(std::int64_t stamp_ns, const Topic& topic) const;
  void noteMoment(const Moment& moment);
  int nextTopic() const;
  bool mustWait(const Moment& moment) const;
  bool isLate(const Moment& moment) const;
  void play(const Queued& next, PlayedSample& played);
  void startLoop(int epoch);
  void forgetJoints();
  void takeJoints(const JointStateSample& sample, const Topic& topic, PlayedSample& played);
  void advanceTo(std::int64_t stamp_ns, PlayedSample& played);

  Simulator& simulator_;
  std::int64_t max_gap_ns_;
  std::vector<std::string> topics_;
  std::vector<Topic> topic_states_;
  std::deque<PlayedSample> refused_;  ///< judged by push(), not yet reported
  std::optional<NewestLoop> newest_;
  std::size_t waiting_ = 0;               ///< samples in all queues
  std::vector<VectorX> targets_;          ///< joint positions last heard, per instrument
  std::vector<std::vector<bool>> heard_;  ///< per instrument and joint: ever heard since the last reset
  std::optional<std::int64_t> time_ns_;   ///< stamp the simulator is at
  int epoch_ = 0;                         ///< loop being played
  bool finished_ = false;
  std::array<std::int64_t, kVerdictCount> counts_{};
  std::int64_t resets_ = 0;
  std::int64_t gaps_ = 0;
};

}  // namespace tissue_contact
