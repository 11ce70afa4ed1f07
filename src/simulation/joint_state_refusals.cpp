/// @file
/// Room `simulation`: which joint states JointStatePlayer refuses, what it keeps of the others, and to which loop of
/// time it counts them.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>
#include <utility>
#include <vector>

#include "instrument/joint_bounds.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {
namespace {

/// The last moment that a ROS stamp can name, 2106-02-07: 32 bits of seconds and less than a second of nanoseconds.
constexpr std::int64_t kLastStamp_ns = 4294967295999999999;

std::string twoClocksText(std::int64_t stamp_ns, std::int64_t followed_ns) {
  std::ostringstream text;
  text << "far off the stamps that this topic follows, now at " << stampText(followed_ns)
       << " s, and not confirmed by those after it (off by " << 1e-9 * static_cast<double>(stamp_ns - followed_ns)
       << " s); let the publishers of a topic have one clock, and set those of all computers by one (NTP)";
  return text.str();
}

}  // namespace

const char* verdictText(Verdict verdict) {
  switch (verdict) {
    case Verdict::kAccepted:
      return "accepted";
    case Verdict::kDuplicateStamp:
      return "duplicate stamp";
    case Verdict::kBadStamp:
      return "bad stamp";
    case Verdict::kNotFinite:
      return "position not finite";
    case Verdict::kBadLength:
      return "names and positions differ in number";
    case Verdict::kNoKnownJoint:
      return "no known joint";
    case Verdict::kLate:
      return "too late";
    case Verdict::kTwoClocks:
      return "two clocks";
  }
  return "unknown";
}

void JointStatePlayer::refuse(Verdict verdict, int topic, std::int64_t stamp_ns, const std::string& detail) {
  PlayedSample refused;
  refused.verdict = verdict;
  refused.topic = topic;
  refused.stamp_ns = stamp_ns;
  refused.detail = topics_[static_cast<std::size_t>(topic)] + " at " + stampText(stamp_ns) + " s: " + detail;
  refused_.push_back(std::move(refused));
}

/// All but the order of stamps.
Verdict JointStatePlayer::judgeContent(const JointStateSample& sample, const Topic& topic, std::string& detail) const {
  if (sample.stamp_ns <= 0) {
    detail = "the stamp must be > 0; fill header.stamp";
    return Verdict::kBadStamp;
  }
  if (sample.stamp_ns > kLastStamp_ns) {
    detail = "stamp out of range; ROS time ends at " + stampText(kLastStamp_ns) + " s, with nsecs < 1e9";
    return Verdict::kBadStamp;
  }
  if (sample.names.size() != sample.positions.size()) {
    detail = std::to_string(sample.names.size()) + " names but " + std::to_string(sample.positions.size()) +
             " positions; each name needs a position";
    return Verdict::kBadLength;
  }
  return judgeJoints(sample, topic, detail);
}

Verdict JointStatePlayer::judgeJoints(const JointStateSample& sample, const Topic& topic, std::string& detail) const {
  bool any_known = false;
  for (const Listener& listener : topic.listeners) {
    const Instrument& instrument = simulator_.instruments()[static_cast<std::size_t>(listener.instrument)];
    for (std::size_t k = 0; k < sample.names.size(); ++k) {
      if (instrument.jointOfRecordedName(sample.names[k]) < 0) continue;
      any_known = true;
      if (!isJointPosition(sample.positions[k])) {
        std::ostringstream text;
        text << "position of joint '" << printable(sample.names[k]) << "' is " << sample.positions[k] << "; it must be "
             << kJointPositionRange;
        detail = text.str();
        return Verdict::kNotFinite;
      }
    }
  }
  if (any_known) return Verdict::kAccepted;
  detail = "none of its joints (" + listOf(sample.names) + ") is a joint of an instrument on this topic; ";
  std::string why;
  for (const Listener& listener : topic.listeners) {
    if (!why.empty()) break;
    const Instrument& instrument = simulator_.instruments()[static_cast<std::size_t>(listener.instrument)];
    why = instrument.model().mimicsText(sample.names);
    if (why.empty()) why = instrument.mappedText(sample.names);
  }
  detail += why.empty() ? "map them by joint_names" : "of these are " + why;
  for (const Listener& listener : topic.listeners) {
    const Instrument& instrument = simulator_.instruments()[static_cast<std::size_t>(listener.instrument)];
    std::vector<std::string> own;
    for (const IndependentJoint& joint : instrument.model().joints()) own.push_back(joint.name);
    detail += "; those of '" + instrument.name() + "': " + listOf(own);
  }
  return Verdict::kNoKnownJoint;
}

/// Keeps the joints that the topic's instruments know, each once: what waits is no larger than they are.
void JointStatePlayer::keepKnown(const Topic& topic, JointStateSample& sample) const {
  constexpr std::size_t kUsual = 100;  // names; so many may be there twice
  const auto is_known = [&](const std::string& name) {
    return std::any_of(topic.listeners.begin(), topic.listeners.end(), [&](const Listener& listener) {
      return simulator_.instruments()[static_cast<std::size_t>(listener.instrument)].jointOfRecordedName(name) >= 0;
    });
  };
  if (sample.names.size() <= kUsual && std::all_of(sample.names.begin(), sample.names.end(), is_known)) return;
  JointStateSample known{sample.stamp_ns, {}, {}, {}};
  std::set<std::string> seen;
  for (std::size_t k = sample.names.size(); k-- > 0;) {  // of one name the last position counts
    if (!is_known(sample.names[k]) || !seen.insert(sample.names[k]).second) continue;
    known.names.push_back(std::move(sample.names[k]));
    known.positions.push_back(sample.positions[k]);
    known.velocities.push_back(sample.velocities[k]);
  }
  std::reverse(known.names.begin(), known.names.end());
  std::reverse(known.positions.begin(), known.positions.end());
  std::reverse(known.velocities.begin(), known.velocities.end());
  sample = std::move(known);
}

/// Whether a sample that is not later than its topic's last, by no more than a gap, says something new all the same: each of its joints
/// was last named by a sample before it. So it is of another publisher than those since.
bool JointStatePlayer::hasNews(const Topic& topic, const JointStateSample& sample) const {
  if (!topic.last || sample.stamp_ns > topic.last->stamp_ns) return false;
  if (topic.last->stamp_ns - sample.stamp_ns > max_gap_ns_) return false;
  const Moment moment = {topic.last->epoch, sample.stamp_ns};
  return std::all_of(sample.names.begin(), sample.names.end(), [&](const std::string& name) {
    const auto named = topic.named.find(name);
    return named == topic.named.end() || named->second < moment;
  });
}

/// Adds the joints that `sample` does not name, as they are in `kept`.
void JointStatePlayer::addUnnamed(const JointStateSample& kept, JointStateSample& sample) {
  const std::size_t own = sample.names.size();
  for (std::size_t k = 0; k < kept.names.size(); ++k) {
    const auto end = sample.names.begin() + static_cast<std::ptrdiff_t>(own);
    if (std::find(sample.names.begin(), end, kept.names[k]) != end) continue;
    sample.names.push_back(kept.names[k]);
    sample.positions.push_back(kept.positions[k]);
    sample.velocities.push_back(kUnknown);  // it is of another stamp
  }
}

/// For the topic's next sample to take along.
void JointStatePlayer::keepForNext(Topic& topic, JointStateSample sample) {
  for (const std::string& name : sample.names) topic.named[name] = {topic.last->epoch, sample.stamp_ns};
  addUnnamed(topic.kept, sample);
  topic.kept = std::move(sample);
  ++merged_;
}

/// Whether a sample is that of another publisher beside those that are held as a loop perhaps: behind the newest of them, without a joint of
/// theirs.
bool JointStatePlayer::fitsHeld(const Topic& topic, const JointStateSample& sample) const {
  constexpr std::size_t kMost = 100;  // of some publishers, until one of them has confirmed the loop
  if (!topic.clock.isHolding() || topic.held.empty() || topic.held.size() >= kMost) return false;
  const auto is_apart = [&](const JointStateSample& held) {
    return held.stamp_ns < sample.stamp_ns ||
           std::none_of(held.names.begin(), held.names.end(), [&](const std::string& name) {
             return std::find(sample.names.begin(), sample.names.end(), name) != sample.names.end();
           });
  };
  return sample.stamp_ns >= topic.held.front().stamp_ns - max_gap_ns_ &&
         sample.stamp_ns <= topic.held.back().stamp_ns + max_gap_ns_ &&
         std::all_of(topic.held.begin(), topic.held.end(), is_apart);
}

/// Whether a sample of a topic that is a loop behind fits the newest.
bool JointStatePlayer::joinsNewest(std::int64_t stamp_ns, const Topic& topic) const {
  if (!topic.last || topic.last->epoch >= newest_->epoch) return false;
  // After restart() a stamp that goes on is left over from the loop before, however short the loop is.
  if (topic.clock.isRestarted() && stamp_ns > topic.last->stamp_ns) return false;
  return std::abs(stamp_ns - newest_->last_ns) <= max_gap_ns_;
}

void JointStatePlayer::refuseByClock(ClockRuling ruling, int topic, std::int64_t stamp_ns, bool was_late) {
  const std::int64_t last_ns = *topic_states_[static_cast<std::size_t>(topic)].clock.last();
  if (ruling == ClockRuling::kDuplicate) {
    refuse(Verdict::kDuplicateStamp, topic, stamp_ns, "same stamp as the topic's last joint state with these joints");
  } else if (ruling == ClockRuling::kStray) {
    refuse(Verdict::kTwoClocks, topic, stamp_ns, twoClocksText(stamp_ns, last_ns));
  } else {
    std::string detail = "the topic's last joint state is at " + stampText(last_ns) + " s";
    if (was_late) {
      detail +=
          ", as for the one before; if a recording shorter than max_gap_s is played in a loop, let it give the time "
          "(rosbag play --clock, /use_sim_time), or shorten step.max_gap_s";
    }
    refuse(Verdict::kLate, topic, stamp_ns, detail);
  }
}

void JointStatePlayer::refuseHeld(int topic) {
  Topic& state = topic_states_[static_cast<std::size_t>(topic)];
  for (const JointStateSample& sample : std::exchange(state.held, {})) {
    --waiting_;
    refuse(Verdict::kTwoClocks, topic, sample.stamp_ns, twoClocksText(sample.stamp_ns, *state.clock.last()));
  }
}

/// Whether a topic's states all wait behind the time of the simulation, and have done so for more than a gap of their own time: no moment
/// comes that would take them along.
bool JointStatePlayer::isLeftBehind(const Topic& topic) const {
  const Moment& front = topic.queue.front().moment;
  const Moment& back = topic.queue.back().moment;
  return topic.triggers && isPast(back) && front.epoch == back.epoch && back.stamp_ns - front.stamp_ns > max_gap_ns_;
}

/// Refuses what waits for a moment that has been played without it, except where its joints still say something new:
/// those of an update-only topic, and under kNewestState of every one, are taken at the next moment, if it comes within a gap.
void JointStatePlayer::refuseLate() {
  for (std::size_t t = 0; t < topic_states_.size(); ++t) {
    Topic& topic = topic_states_[t];
    const bool is_taken_later = !topic.triggers || policy_ == StatePolicy::kNewestState;
    while (!topic.queue.empty()) {
      const Moment moment = topic.queue.front().moment;
      const bool is_old_loop = moment.epoch < epoch_;
      const bool is_late = is_taken_later ? isLeftBehind(topic) : isPast(moment);
      if (!is_old_loop && !is_late) break;
      std::string detail = is_old_loop ? "time went backwards on another topic but not on this one"
                                       : "the simulation is already at " + stampText(*time_ns_) + " s";
      if (!is_old_loop && is_taken_later) {
        detail += ", where stamps of another topic have taken it; let all publishers have one clock (NTP)";
      }
      refuse(Verdict::kLate, static_cast<int>(t), moment.stamp_ns, detail);
      topic.queue.pop_front();
      --waiting_;
    }
  }
}

}  // namespace tissue_contact
