/// @file
/// Room `simulation`: recorded or live joint states in, in whatever order the topics deliver them; simulator advanced
/// from moment to moment. Used alike by the node and by offline replay, so both give the same bits.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/simulation/topic_clock.h"

namespace tissue_contact {

/// One joint-state message. `positions` in rad or m, one per name; `velocities` per second of that: another number than names, or one that is
/// not finite, is not known.
struct JointStateSample {
  std::int64_t stamp_ns = 0;
  std::vector<std::string> names;
  std::vector<double> positions;
  std::vector<double> velocities = {};
};

enum class Verdict {
  kAccepted,        ///< its joints were taken
  kDuplicateStamp,  ///< same stamp as the topic's last one with these joints: ignored
  kBadStamp,        ///< zero or negative stamp, or one that ROS time does not reach: ignored
  kNotFinite,       ///< a position of a known joint is NaN, infinite or beyond 1e9: ignored
  kBadLength,       ///< as many positions as names are needed: ignored
  kNoKnownJoint,    ///< none of the names means a joint of an instrument on this topic: ignored
  kLate,            ///< its stamp lies before its topic's last with these joints, or in time already simulated: ignored
  kTwoClocks,       ///< far off the stamps that the topic follows, and these go on: ignored
};
constexpr int kVerdictCount = 8;

/// A few words for people ("duplicate stamp"), never null.
const char* verdictText(Verdict verdict);

/// A moment that was played, or one sample that was refused.
struct PlayedSample {
  Verdict verdict = Verdict::kAccepted;
  int topic = -1;                ///< of the refused sample; of a moment: the first topic that triggered it
  std::int64_t stamp_ns = 0;     ///< of the refused sample; of a moment: where the simulator is now
  std::string detail;            ///< names the joint and value for a refused sample; empty if accepted
  bool was_reset = false;        ///< time went backwards (bag loop): the scene was reset before this moment
  bool was_resumed = false;      ///< time went on where it was before a stamp far off, without a reset
  bool was_gap = false;          ///< the interval was longer than max_gap_s and was simulated as that long
  bool interrupted = false;      ///< AdvanceLimits ended it before the samples' stamp: it owes no wrench
  int accepted = 0;              ///< samples of this moment, those of topics that only update included
  int merged = 0;                ///< samples passed over on the way to this moment
  std::string placed;            ///< joints heard for the first time long after the run began, and where from
  std::vector<int> instruments;  ///< each owes one wrench at this stamp; ascending
};

/// Plays joint states into a simulator.
///
/// Moments. The samples of all topics that have one stamp (in one loop) are one moment. All of them are taken, then the
/// tissues advance to it, once, and every instrument with a triggering sample among them owes one wrench. A topic of
/// which no instrument is triggered makes no moment: its joints are taken at the next one.
///
/// Joints. At a moment every joint is where its topic says: in its sample of that stamp; else on the way to
/// its next sample, if that is here and follows in less than max_gap_s; else where its newest sample before put it. A joint that was so
/// held at moments of others, and for whose way less than half of the time between its samples is left, takes all of that time
/// (at most .2 s and max_gap_s), and so is late by as much: made in what is left it would be as fast as it never was. In between joints
/// move as a cubic through the velocities of samples at both ends of their way, linearly without such or where they do not fit it (JointWay). A joint heard for the first time since the start or a reset is placed. Joints not
/// heard stay at the scene's initial position. The first moment of a run places instruments without any step.
///
/// Publishers. Several may share a topic, each with joints of its own (drivers of an arm and of its gripper). A sample that is no later
/// than its topic's last one, by at most max_gap_s, but later than all that named one of its joints, makes no moment: its joints are taken
/// with the topic's next sample, and it counts as merged. So the order of arrival on that topic counts, and nothing waits for a publisher.
///
/// Continuous joints go the shorter way from one sample to the next: drivers give their angle between -pi and pi. Revolute ones
/// go on over the whole turns that drivers leave out (IndependentJoint::turnsLeftOut).
///
/// Waiting. A moment waits until every other topic has delivered its stamp or a later one, so that what arrives first
/// does not matter. A topic is waited for only while its newest stamp is less than max_gap_s behind the newest of all
/// (if it was never heard: that behind the first of all): beyond that it is missing or stuck, unless keepWaitingFor()
/// says that it may only have been delayed. Under kNewestState the
/// bound is a quarter of max_lag_s (kWaitShare) or stopWaiting(), and topics that only update are not waited for.
///
/// Time. A stamp before its topic's last by at most max_gap_s that says nothing new is late: refused, nothing else changes. Farther back is a
/// loop, once the topic's next two go on from there (TopicClock has the rules); till then it waits. The first moment of
/// a loop resets the scene. So does any stamp that goes back after restart(). A topic first heard joins the newest
/// loop; so does one that fits it within max_gap_s after another topic has begun it. Stamps of a second clock on a
/// topic are refused while the first goes on. One far in the future is believed; if the topic goes on where it was, so
/// does the simulation, without a reset. A looped recording shorter than max_gap_s needs restart(); without it passes
/// are refused as late until their stamps have gone through max_gap_s, and the next pass is a loop.
///
/// An interval shorter than 100 us (kShortest_s), or than a tenth of max_step_s (kShortestShare), is jitter of stamps
/// or another topic's clock, and no time in which to move a tool: the tissues stay, the moment's wrenches are those of
/// the step before, and its time and motion are part of the next interval.
///
/// Counts. pushed, and notePassedOver(), = accepted + merged + refused (count() of the other verdicts) + waiting(), at any time. Accepted are
/// the samples of moments that were played, and those of update-only topics up to them. Merged are those that were
/// passed over: noted by notePassedOver(); under kNewestState older moments, which only shape the motion by their last positions; what is taken with a topic's
/// next sample; and those of an interrupted advance.
///
/// Memory. Played or refused samples are forgotten; waiting ones span at most max_gap_s of message time per loop (more only
/// with keepWaitingFor()) and are at most kMaxWaiting (of update-only topics: each), provided that playNext() is called until it returns nothing
/// after every push().
///
/// Under kEveryState the result depends on the stamps and positions alone; with several topics, on condition that what
/// arrives keeps the newest stamps of all topics within max_gap_s of each other and no loop is shorter than that. Not
/// thread-safe.
class JointStatePlayer {
 public:
  static constexpr double kShortestShare = 0.1;  ///< of max_step_s
  static constexpr double kShortest_s = 1e-4;
  static constexpr double kWaitShare = 0.25;  ///< of max_lag_s, under kNewestState; the rest is for the steps
  /// Samples that may wait for another topic: 20 s of one 500 Hz topic. Beyond it nothing waits.
  static constexpr std::size_t kMaxWaiting = 10000;

  /// @param simulator must outlive the player.
  /// @throws std::invalid_argument when no instrument has a topic.
  explicit JointStatePlayer(Simulator& simulator);

  /// Distinct joint-state topics of the scene, in order of first mention. Indices are the `topic` of push().
  const std::vector<std::string>& topics() const { return topics_; }
  /// Whether the topic's stamps are moments of some instrument; if not, it only updates joints.
  bool triggers(int topic) const { return topic_states_.at(static_cast<std::size_t>(topic)).triggers; }

  /// kEveryState (at first) or kNewestState; at any time.
  /// @throws std::invalid_argument for kAuto.
  void setPolicy(StatePolicy policy);
  StatePolicy policy() const { return policy_; }

  /// For every advance from now on.
  void setLimits(AdvanceLimits limits) { limits_ = std::move(limits); }

  /// In place of step.max_lag_s of the scene, > 0.
  void setMaxLag(double max_lag_s);

  /// Queues a sample. One whose content is refused has no say in time: neither its stamp nor its arrival is remembered.
  void push(int topic, JointStateSample sample);

  /// The source of time has restarted (a bag that is played again): the next stamp of each topic that is not later than
  /// its last begins a new loop, however little it goes back. Forgotten per topic once its stamps have gone on by
  /// max_gap_s.
  void restart();

  /// Plays the next moment whose turn it is (kEveryState) or the newest (kNewestState), or reports a refused sample,
  /// those first; nothing if there is neither. Call until it returns nothing.
  std::optional<PlayedSample> playNext();

  /// The stamp that playNext() would play to; nothing if no moment's turn has come.
  std::optional<std::int64_t> nextStamp() const;
  /// The stamp of the earliest sample that triggers and lies ahead, whether or not it has to wait for a topic.
  std::optional<std::int64_t> earliestStamp() const;
  /// Whether the topic's newest stamp is max_gap_s or more behind the newest of all, so that no moment of kEveryState waits for it.
  bool isOvertaken(int topic) const;
  /// Whether moments of kEveryState wait for such a topic all the same, from now on: wall time has not shown yet that nothing comes.
  void keepWaitingFor(int topic, bool wait) { topic_states_.at(static_cast<std::size_t>(topic)).awaited = wait; }
  /// Of a topic that only updates: how far its newest stamp is ahead of the newest of those that trigger, s. 0: it is not, or none is in the loop.
  double lead_s(int topic) const;
  /// Simulated time since something was taken from the topic, s; nothing: not yet in this loop.
  std::optional<double> idle_s(int topic) const;
  /// Moments that are here now wait for no topic any longer, since wall time presses or nothing more can come.
  void stopWaiting();

  /// Everything to where it was before the first sample: the simulator is reset, what waits counts as merged.
  void reset();

  /// The simulator's state (Simulator::saveState()), the moment it is at and where joints were heard to be, as bytes for restoreState().
  /// Samples that wait are not in it, nor what is to be taken with a topic's next sample.
  std::string saveState();

  /// Goes on from a saved state of the same scene, with what is pushed from now on; what waits counts as merged. If the first stamp
  /// is that of the state or follows it within max_gap_s, the same bits follow as without saving and restoring. Else time goes
  /// on at the first stamp, and the way of the joints from where the state has them takes max_gap_s, as after any gap.
  /// @throws std::invalid_argument telling what does not fit; nothing has changed then.
  void restoreState(const std::string& state);

  /// A sample that was to be pushed before a reset or restoreState(): counted as merged.
  void notePassedOver() { ++merged_; }

  /// What every saved state begins with: kind and version.
  static const char* stateTitle();

  /// Of the moment played last; none yet. A restored one: that of the state.
  const std::optional<std::int64_t>& time() const { return time_ns_; }

  /// No more samples will come (end of a bag): no moment waits any longer. What would have to be confirmed is refused.
  void finish();

  /// Samples so far by verdict, merged, waiting; resets and gaps.
  std::int64_t count(Verdict verdict) const { return counts_[static_cast<std::size_t>(verdict)]; }
  std::int64_t merged() const { return merged_; }
  std::int64_t waiting() const { return static_cast<std::int64_t>(waiting_ + refused_.size()); }
  std::int64_t resets() const { return resets_; }
  std::int64_t gaps() const { return gaps_; }

 private:
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

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
  struct Listener {
    int instrument = 0;
    bool triggers = true;
  };
  struct Topic {
    explicit Topic(std::int64_t max_gap_ns) : clock(max_gap_ns) {}

    TopicClock clock;
    std::deque<Queued> queue;
    JointStateSample kept;                    ///< joints of samples that came too late to be a moment, for the next
    std::map<std::string, Moment> named;      ///< of the newest sample that names the joint
    std::vector<JointStateSample> held;       ///< by the clock: a loop perhaps
    std::optional<Moment> last;               ///< of the last sample queued, to see time go backwards
    std::optional<Moment> taken;              ///< of the last sample whose joints were taken
    std::optional<std::int64_t> taken_at_ns;  ///< the moment at which that was
    std::vector<Listener> listeners;
    bool triggers = false;  ///< any listener
    bool awaited = false;   ///< see keepWaitingFor()
  };
  /// The newest loop any topic has reached.
  struct NewestLoop {
    int epoch = 0;
    std::int64_t first_ns = 0;  ///< stamp of its first sample to arrive
    std::int64_t last_ns = 0;   ///< newest stamp in it
  };

  void refuse(Verdict verdict, int topic, std::int64_t stamp_ns, const std::string& detail);
  void refuseHeld(int topic);
  Verdict judgeContent(const JointStateSample& sample, const Topic& topic, std::string& detail) const;
  Verdict judgeJoints(const JointStateSample& sample, const Topic& topic, std::string& detail) const;
  bool joinsNewest(std::int64_t stamp_ns, const Topic& topic) const;
  void place(int topic, JointStateSample sample);
  void refuseByClock(ClockRuling ruling, int topic, std::int64_t stamp_ns, bool was_late);
  void keepKnown(const Topic& topic, JointStateSample& sample) const;
  bool resumes(const Moment& moment) const;
  bool hasNews(const Topic& topic, const JointStateSample& sample) const;
  static void addUnnamed(const JointStateSample& kept, JointStateSample& sample);
  void keepForNext(Topic& topic, JointStateSample sample);
  bool fitsHeld(const Topic& topic, const JointStateSample& sample) const;
  void accept(int topic, int epoch, JointStateSample sample);
  void acceptHeld(int topic, int epoch);
  void noteMoment(const Moment& moment);
  std::optional<Moment> nextMoment() const;
  std::optional<Moment> newestMoment() const;
  bool mustWait(const Moment& moment) const;
  std::int64_t ageOf(const std::optional<Moment>& moment) const;
  bool isPast(const Moment& moment) const;
  bool isLeftBehind(const Topic& topic) const;
  void refuseLate();
  void play(const Moment& moment, PlayedSample& played);
  void take(const Moment& moment, int topic, PlayedSample& played);
  void takeJoints(const Queued& queued, const Topic& topic);
  double goneOnTo(double position, std::int64_t stamp_ns, std::size_t instrument, int joint) const;
  std::int64_t ownWay(std::int64_t from_ns, std::int64_t to_ns) const;
  void goToSamples(const Moment& moment);
  static bool isSqueezed(std::int64_t own_ns, std::int64_t left_ns);
  void headForNext(const Moment& moment, const Topic& topic);
  void noteVelocities(const Moment& moment);
  void forgetStartVelocities();
  void forgetVelocities();
  void placeNewJoints(std::int64_t stamp_ns, PlayedSample& played);
  void carry(StateArchive& archive);
  void forgetSamples();
  void startLoop();
  void resume(const Moment& moment);
  void forgetJoints();
  void advanceTo(std::int64_t stamp_ns, PlayedSample& played);
  void settle(PlayedSample& played);

  Simulator& simulator_;
  std::int64_t max_gap_ns_;
  std::int64_t shortest_ns_;       ///< interval that is simulated
  std::int64_t live_wait_ns_ = 0;  ///< message time that a topic is waited for under kNewestState
  StatePolicy policy_ = StatePolicy::kEveryState;
  AdvanceLimits limits_;
  std::vector<std::string> topics_;
  std::vector<Topic> topic_states_;
  std::deque<PlayedSample> refused_;  ///< not yet reported
  std::optional<NewestLoop> newest_;
  std::optional<Moment> released_;  ///< nothing up to it waits for a topic
  /// Loops that go on where an earlier one was, and the stamp there; those not yet played.
  std::map<int, std::int64_t> resumptions_;
  std::size_t waiting_ = 0;       ///< samples in all queues
  std::vector<VectorX> targets_;  ///< joint positions at the moment played last, per instrument
  /// What the newest sample says of a joint.
  struct Said {
    double position = 0.0;  ///< rad or m
    double turns = 0.0;     ///< that drivers have left out up to then, rad
    std::int64_t stamp_ns = 0;
    std::int64_t seen_ns = 0;           ///< stamp of the newest sample at the moment played last
    std::int64_t right_ns = 0;          ///< the joint's target is where it was then
    std::int64_t arrives_ns = 0;        ///< when it is to be where the sample says; 0: it was
    bool is_news = false;               ///< since the moment played last
    double velocity = kUnknown;         ///< rad/s or m/s; of the sample
    double target_velocity = kUnknown;  ///< where the joint's target is
  };
  JointVelocities velocities_;  ///< start: where the simulator is; end: at the targets
  std::int64_t arrivalOf(const Said& said, bool is_news, const Moment& moment) const;
  std::vector<std::vector<Said>> said_;  ///< per instrument and joint, of those that are heard
  enum class Heard { kNever, kNow, kBefore };
  std::optional<std::int64_t> begun_ns_;  ///< stamp of the first moment since the last reset, or since a state was read
  std::vector<std::vector<Heard>> heard_;  ///< per instrument and joint: since the last reset; kNow: to be placed
  std::vector<bool> owes_;                 ///< per instrument: has a triggering sample without a wrench
  std::optional<std::int64_t> time_ns_;    ///< stamp of the moment played last
  std::int64_t behind_ns_ = 0;             ///< by how much the simulator is behind that, < shortest_ns_
  int epoch_ = 0;                          ///< loop being played
  bool restored_ = false;                  ///< no moment has been played since restoreState()
  bool finished_ = false;
  std::array<std::int64_t, kVerdictCount> counts_{};
  std::int64_t merged_ = 0;
  std::int64_t resets_ = 0;
  std::int64_t gaps_ = 0;
};

}  // namespace tissue_contact
