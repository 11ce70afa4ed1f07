/// @file
/// Room `simulation`: see joint_state_player.h.
#include "tissue_contact/simulation/joint_state_player.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace tissue_contact {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

/// Nanoseconds of a positive number of seconds; more than 100 years counts as 100 years so that sums stay in 64 bits.
std::int64_t toNanoseconds(double seconds) {
  constexpr double kCentury = 3.2e9;
  return std::llround(std::min(seconds, kCentury) * kNanosecondsPerSecond);
}

std::string listOf(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxNamed = 12;  // a message may hold any number of names, a warning should not
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMaxNamed); ++i) text += (i == 0 ? "" : ", ") + names[i];
  return names.size() > kMaxNamed ? text + ", ..." : text;
}

std::string stampText(std::int64_t stamp_ns) {
  std::ostringstream text;
  const std::int64_t ns_per_s = 1000000000;
  text << stamp_ns / ns_per_s << '.';
  text.width(9);
  text.fill('0');
  text << std::abs(stamp_ns % ns_per_s) << " s";
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
  }
  return "unknown";
}

JointStatePlayer::JointStatePlayer(Simulator& simulator)
    : simulator_(simulator), max_gap_ns_(toNanoseconds(simulator.scene().step.max_gap_s)) {
  const std::vector<InstrumentDescription>& instruments = simulator.scene().instruments;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    for (const std::string& name : instruments[i].joint_state_topics) {
      const auto known = std::find(topics_.begin(), topics_.end(), name);
      const auto topic = static_cast<std::size_t>(known - topics_.begin());
      if (known == topics_.end()) {
        topics_.push_back(name);
        topic_states_.emplace_back();
      }
      std::vector<int>& listeners = topic_states_[topic].instruments;
      if (listeners.empty() || listeners.back() != static_cast<int>(i)) listeners.push_back(static_cast<int>(i));
    }
  }
  if (topics_.empty()) {
    throw std::invalid_argument(
        simulator.scene().file +
        ": no instrument has a joint-state topic, so nothing would ever move; give at least one "
        "instrument a joint_state_topics entry");
  }
  forgetJoints();
}

void JointStatePlayer::push(int topic, JointStateSample sample) {
  assert(topic >= 0 && topic < static_cast<int>(topic_states_.size()));
  Topic& state = topic_states_[static_cast<std::size_t>(topic)];
  std::string detail;
  const Verdict verdict = judge(sample, state, detail);
  if (verdict != Verdict::kAccepted) {
    PlayedSample refused;
    refused.verdict = verdict;
    refused.topic = topic;
    refused.stamp_ns = sample.stamp_ns;
    refused.detail = topics_[static_cast<std::size_t>(topic)] + " at " + stampText(sample.stamp_ns) + ": " + detail;
    refused_.push_back(std::move(refused));
    return;
  }
  const Moment moment = momentOf(sample.stamp_ns, state);
  noteMoment(moment);
  state.last = moment;
  state.queue.push_back({moment, std::move(sample)});
  ++waiting_;
}

/// Everything that can be said about a sample without knowing what was played.
Verdict JointStatePlayer::judge(const JointStateSample& sample, const Topic& topic, std::string& detail) const {
  if (sample.stamp_ns <= 0) {
    detail = "the stamp must be > 0; fill header.stamp";
    return Verdict::kBadStamp;
  }
  if (sample.names.size() != sample.positions.size()) {
    detail = std::to_string(sample.names.size()) + " names but " + std::to_string(sample.positions.size()) +
             " positions; each name needs a position";
    return Verdict::kBadLength;
  }
  const Verdict verdict = judgeJoints(sample, topic, detail);
  if (verdict != Verdict::kAccepted) return verdict;
  if (topic.last && topic.last->stamp_ns == sample.stamp_ns) {
    detail = "same stamp as the topic's last joint state";
    return Verdict::kDuplicateStamp;
  }
  return Verdict::kAccepted;
}

Verdict JointStatePlayer::judgeJoints(const JointStateSample& sample, const Topic& topic, std::string& detail) const {
  bool any_known = false;
  for (const int i : topic.instruments) {
    const Instrument& instrument = simulator_.instruments()[static_cast<std::size_t>(i)];
    for (std::size_t k = 0; k < sample.names.size(); ++k) {
      if (instrument.jointOfRecordedName(sample.names[k]) < 0) continue;
      any_known = true;
      if (!std::isfinite(sample.positions[k])) {
        std::ostringstream text;
        text << "position of joint '" << sample.names[k] << "' is " << sample.positions[k] << "; it must be finite";
        detail = text.str();
        return Verdict::kNotFinite;
      }
    }
  }
  if (any_known) return Verdict::kAccepted;
  detail = "none of its joints (" + listOf(sample.names) +
           ") is a joint of an instrument on this topic, neither by its " + "URDF name nor through joint_names";
  return Verdict::kNoKnownJoint;
}

JointStatePlayer::Moment JointStatePlayer::momentOf(std::int64_t stamp_ns, const Topic& topic) const {
  const int newest = newest_ ? newest_->epoch : 0;
  if (!topic.last) return {newest, stamp_ns};
  if (stamp_ns < topic.last->stamp_ns) return {topic.last->epoch + 1, stamp_ns};
  const bool near_newest = newest_ && std::abs(stamp_ns - newest_->last_ns) <= max_gap_ns_;
  return {near_newest ? newest : topic.last->epoch, stamp_ns};
}

void JointStatePlayer::noteMoment(const Moment& moment) {
  if (!newest_ || newest_->epoch < moment.epoch) {
    newest_ = NewestLoop{moment.epoch, moment.stamp_ns, moment.stamp_ns};
  } else if (newest_->epoch == moment.epoch) {
    newest_->last_ns = std::max(newest_->last_ns, moment.stamp_ns);
  }
}

/// Topic whose first waiting sample is the earliest, -1 if there is none or it has to wait.
int JointStatePlayer::nextTopic() const {
  int next = -1;
  const Moment* earliest = nullptr;
  for (std::size_t i = 0; i < topic_states_.size(); ++i) {
    if (topic_states_[i].queue.empty()) continue;
    const Moment& moment = topic_states_[i].queue.front().moment;
    if (earliest != nullptr && !(moment < *earliest)) continue;
    earliest = &moment;
    next = static_cast<int>(i);
  }
  return earliest != nullptr && mustWait(*earliest) ? -1 : next;
}

/// Whether a topic could still deliver something earlier than `moment`, the earliest waiting, and is worth waiting for.
bool JointStatePlayer::mustWait(const Moment& moment) const {
  if (finished_ || waiting_ > kMaxWaiting) return false;
  const auto has_passed = [&](const Topic& topic) { return topic.last && !(*topic.last < moment); };
  if (std::all_of(topic_states_.begin(), topic_states_.end(), has_passed)) return false;
  // Stamps of different loops do not compare: a sample of an older loop is as old as the newest loop is long.
  const std::int64_t since = newest_->epoch == moment.epoch ? moment.stamp_ns : newest_->first_ns;
  return newest_->last_ns - since < max_gap_ns_;
}

std::optional<PlayedSample> JointStatePlayer::playNext() {
  PlayedSample played;
  if (!refused_.empty()) {
    played = std::move(refused_.front());
    refused_.pop_front();
  } else {
    const int topic = nextTopic();
    if (topic < 0) return std::nullopt;
    std::deque<Queued>& queue = topic_states_[static_cast<std::size_t>(topic)].queue;
    const Queued next = std::move(queue.front());
    queue.pop_front();
    --waiting_;
    played.topic = topic;
    played.stamp_ns = next.sample.stamp_ns;
    play(next, played);
  }
  ++counts_[static_cast<std::size_t>(played.verdict)];
  return played;
}

void JointStatePlayer::play(const Queued& next, PlayedSample& played) {
  if (isLate(next.moment)) {
    played.verdict = Verdict::kLate;
    played.detail = topics_[static_cast<std::size_t>(played.topic)] + " at " + stampText(played.stamp_ns) +
                    (next.moment.epoch < epoch_ ? ": time went backwards on another topic but not on this one"
                                                : ": the simulation is already at " + stampText(*time_ns_));
    return;
  }
  if (next.moment.epoch > epoch_) {
    startLoop(next.moment.epoch);
    played.was_reset = true;
  }
  takeJoints(next.sample, topic_states_[static_cast<std::size_t>(played.topic)], played);
  advanceTo(next.sample.stamp_ns, played);
}

bool JointStatePlayer::isLate(const Moment& moment) const {
  return moment.epoch < epoch_ || (moment.epoch == epoch_ && time_ns_ && moment.stamp_ns < *time_ns_);
}

void JointStatePlayer::startLoop(int epoch) {
  simulator_.reset();
  forgetJoints();
  time_ns_.reset();
  epoch_ = epoch;
  ++resets_;
}

void JointStatePlayer::forgetJoints() {
  targets_.clear();
  heard_.clear();
  for (const Instrument& instrument : simulator_.instruments()) {
    targets_.push_back(instrument.initialPositions());
    heard_.emplace_back(instrument.model().joints().size(), false);
  }
}

/// Sets the targets of the joints in `sample`; those heard for the first time are placed there.
void JointStatePlayer::takeJoints(const JointStateSample& sample, const Topic& topic, PlayedSample& played) {
  for (const int i : topic.instruments) {
    const auto index = static_cast<std::size_t>(i);
    const Instrument& instrument = simulator_.instruments()[index];
    VectorX placed = simulator_.jointPositions(i);
    bool any_known = false;
    bool any_new = false;
    for (std::size_t k = 0; k < sample.names.size(); ++k) {
      const int joint = instrument.jointOfRecordedName(sample.names[k]);
      if (joint < 0) continue;
      any_known = true;
      targets_[index][joint] = sample.positions[k];
      if (heard_[index][static_cast<std::size_t>(joint)]) continue;
      heard_[index][static_cast<std::size_t>(joint)] = true;
      placed[joint] = sample.positions[k];
      any_new = true;
    }
    if (any_new) simulator_.placeInstrument(i, placed);
    if (any_known) played.instruments.push_back(i);
  }
}

void JointStatePlayer::advanceTo(std::int64_t stamp_ns, PlayedSample& played) {
  std::int64_t interval_ns = time_ns_ ? stamp_ns - *time_ns_ : 0;
  time_ns_ = stamp_ns;
  if (interval_ns == 0) return;
  if (interval_ns > max_gap_ns_) {
    interval_ns = max_gap_ns_;
    played.was_gap = true;
    ++gaps_;
  }
  simulator_.advance(static_cast<double>(interval_ns) / kNanosecondsPerSecond, targets_);
}

}  // namespace tissue_contact
