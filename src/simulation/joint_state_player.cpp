/// @file
/// Room `simulation`: see joint_state_player.h.
#include "tissue_contact/simulation/joint_state_player.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "instrument/joint_bounds.h"

namespace tissue_contact {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

/// Nanoseconds of a positive number of seconds; more than 100 years counts as 100 years so that sums stay in 64 bits.
std::int64_t toNanoseconds(double seconds) {
  constexpr double kCentury = 3.2e9;
  return std::llround(std::min(seconds, kCentury) * kNanosecondsPerSecond);
}

}  // namespace

JointStatePlayer::JointStatePlayer(Simulator& simulator)
    : simulator_(simulator),
      max_gap_ns_(toNanoseconds(simulator.scene().step.max_gap_s)),
      shortest_ns_(toNanoseconds(std::min(kShortest_s, kShortestShare * simulator.scene().step.max_step_s))),
      owes_(simulator.instruments().size(), false) {
  setMaxLag(simulator.scene().step.max_lag_s);
  const std::vector<InstrumentDescription>& instruments = simulator.scene().instruments;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    for (const JointStateTopic& described : instruments[i].joint_state_topics) {
      const auto known = std::find(topics_.begin(), topics_.end(), described.name);
      const auto index = static_cast<std::size_t>(known - topics_.begin());
      if (known == topics_.end()) {
        topics_.push_back(described.name);
        topic_states_.emplace_back(max_gap_ns_);
      }
      Topic& topic = topic_states_[index];
      topic.listeners.push_back({static_cast<int>(i), described.triggers});
      topic.triggers |= described.triggers;
    }
  }
  if (topics_.empty()) {
    throw std::invalid_argument(
        placeOf(simulator.scene(), "instruments") +
        ": no instrument has a joint-state topic, so nothing would ever move; give at least one "
        "instrument a joint_state_topics entry");
  }
  forgetJoints();
}

void JointStatePlayer::setPolicy(StatePolicy policy) {
  if (policy == StatePolicy::kAuto) {
    throw std::invalid_argument("the policy 'auto' has to be made every_state or newest_state by whoever plays");
  }
  policy_ = policy;
}

void JointStatePlayer::setMaxLag(double max_lag_s) {
  live_wait_ns_ = std::min(max_gap_ns_, toNanoseconds(kWaitShare * max_lag_s));
}

void JointStatePlayer::push(int topic, JointStateSample sample) {
  assert(topic >= 0 && topic < static_cast<int>(topic_states_.size()));
  std::string detail;
  const Verdict verdict = judgeContent(sample, topic_states_[static_cast<std::size_t>(topic)], detail);
  if (verdict != Verdict::kAccepted) {
    refuse(verdict, topic, sample.stamp_ns, detail);
    return;
  }
  if (sample.velocities.size() != sample.names.size()) sample.velocities.assign(sample.names.size(), kUnknown);
  for (double& velocity : sample.velocities) velocity = isJointPosition(velocity) ? velocity : kUnknown;
  keepKnown(topic_states_[static_cast<std::size_t>(topic)], sample);
  place(topic, std::move(sample));
}

/// Queues the sample in the loop it belongs to, holds or refuses it.
void JointStatePlayer::place(int topic, JointStateSample sample) {
  Topic& state = topic_states_[static_cast<std::size_t>(topic)];
  const int newest = newest_ ? newest_->epoch : 0;
  if (joinsNewest(sample.stamp_ns, state)) {
    state.clock.join(sample.stamp_ns);
    acceptHeld(topic, newest);
    accept(topic, newest, std::move(sample));
    return;
  }
  if (!state.clock.isRestarted() && hasNews(state, sample)) return keepForNext(state, sample);
  const bool was_late = state.clock.isLateInARow();
  const ClockRuling ruling = state.clock.judge(sample.stamp_ns);
  const int epoch = state.last ? state.last->epoch : newest;
  if (ruling == ClockRuling::kLoops) acceptHeld(topic, epoch + 1);
  if (!state.held.empty() && !state.clock.isHolding()) refuseHeld(topic);
  switch (ruling) {
    case ClockRuling::kGoesOn:
      return accept(topic, epoch, std::move(sample));
    case ClockRuling::kLoops:
      return accept(topic, epoch + 1, std::move(sample));
    case ClockRuling::kResumes:
      resumptions_[newest + 1] = state.clock.resumedFrom();
      return accept(topic, newest + 1, std::move(sample));
    case ClockRuling::kHeld:
      ++waiting_;
      state.held.push_back(std::move(sample));
      return;
    default:
      if (!fitsHeld(state, sample)) return refuseByClock(ruling, topic, sample.stamp_ns, was_late);
      ++waiting_;
      state.held.push_back(std::move(sample));
  }
}

void JointStatePlayer::accept(int topic, int epoch, JointStateSample sample) {
  Topic& state = topic_states_[static_cast<std::size_t>(topic)];
  const Moment moment = {epoch, sample.stamp_ns};
  const bool begins = newest_ && newest_->epoch < epoch;
  noteMoment(moment);
  if (state.last && state.last->epoch != epoch) state.kept = {};
  state.last = moment;
  for (const std::string& name : sample.names) state.named[name] = moment;
  addUnnamed(std::exchange(state.kept, {}), sample);
  state.queue.push_back({moment, std::move(sample)});
  ++waiting_;
  if (!state.triggers && state.queue.size() > kMaxWaiting) {
    state.queue.pop_front();  // nothing triggers: the newer ones tell where the joints are
    --waiting_;
    ++merged_;
  }
  if (!begins) return;
  for (std::size_t t = 0; t < topic_states_.size(); ++t) {
    Topic& other = topic_states_[t];
    if (other.held.empty() || !joinsNewest(other.held.front().stamp_ns, other)) continue;
    other.clock.join(other.held.back().stamp_ns);
    acceptHeld(static_cast<int>(t), epoch);
  }
}

void JointStatePlayer::acceptHeld(int topic, int epoch) {
  for (JointStateSample& sample : std::exchange(topic_states_[static_cast<std::size_t>(topic)].held, {})) {
    --waiting_;
    Topic& state = topic_states_[static_cast<std::size_t>(topic)];
    if (hasNews(state, sample)) {
      keepForNext(state, sample);
    } else {
      accept(topic, epoch, std::move(sample));
    }
  }
}

void JointStatePlayer::restart() {
  std::vector<int> confirmed;
  for (std::size_t t = 0; t < topic_states_.size(); ++t) {
    if (topic_states_[t].clock.restart()) confirmed.push_back(static_cast<int>(t));
  }
  for (const int t : confirmed) acceptHeld(t, topic_states_[static_cast<std::size_t>(t)].last->epoch + 1);
}

void JointStatePlayer::finish() {
  finished_ = true;
  for (std::size_t t = 0; t < topic_states_.size(); ++t) refuseHeld(static_cast<int>(t));
}

void JointStatePlayer::noteMoment(const Moment& moment) {
  if (!newest_ || newest_->epoch < moment.epoch) {
    newest_ = NewestLoop{moment.epoch, moment.stamp_ns, moment.stamp_ns};
  } else if (newest_->epoch == moment.epoch) {
    newest_->last_ns = std::max(newest_->last_ns, moment.stamp_ns);
  }
}

/// The earliest moment that waits to be played, if it has not to wait for a topic.
std::optional<JointStatePlayer::Moment> JointStatePlayer::nextMoment() const {
  std::optional<Moment> earliest;
  for (const Topic& topic : topic_states_) {
    if (!topic.triggers || topic.queue.empty()) continue;
    const Moment& moment = topic.queue.front().moment;
    if (!earliest || moment < *earliest) earliest = moment;
  }
  if (earliest && mustWait(*earliest)) earliest.reset();
  return earliest;
}

/// The newest moment that has not to wait for a topic and lies ahead.
std::optional<JointStatePlayer::Moment> JointStatePlayer::newestMoment() const {
  std::optional<Moment> newest;
  for (const Topic& topic : topic_states_) {
    if (!topic.triggers) continue;
    const auto is_ready = [&](const Queued& queued) { return !mustWait(queued.moment); };
    const auto found = std::find_if(topic.queue.rbegin(), topic.queue.rend(), is_ready);
    if (found == topic.queue.rend() || isPast(found->moment)) continue;
    if (!newest || *newest < found->moment) newest = found->moment;
  }
  return newest;
}

/// Whether a topic could still deliver something for `moment` or earlier, and is worth waiting for.
bool JointStatePlayer::mustWait(const Moment& moment) const {
  const bool is_live = policy_ == StatePolicy::kNewestState;
  const std::int64_t bound_ns = is_live ? live_wait_ns_ : max_gap_ns_;
  if (finished_ || waiting_ > kMaxWaiting || (released_ && !(*released_ < moment))) return false;
  return std::any_of(topic_states_.begin(), topic_states_.end(), [&](const Topic& topic) {
    if (topic.last && !(*topic.last < moment)) return false;
    if (is_live && !topic.triggers) return false;
    return ageOf(topic.last) < bound_ns || (!is_live && topic.awaited);
  });
}

bool JointStatePlayer::isOvertaken(int topic) const {
  return newest_ && ageOf(topic_states_.at(static_cast<std::size_t>(topic)).last) >= max_gap_ns_;
}

/// How far behind the newest stamp of all, in ns. Stamps of different loops do not compare: what is not in the newest
/// loop is as far behind as that is long.
std::int64_t JointStatePlayer::ageOf(const std::optional<Moment>& moment) const {
  const bool is_in_newest = moment && moment->epoch == newest_->epoch;
  return newest_->last_ns - (is_in_newest ? moment->stamp_ns : newest_->first_ns);
}

bool JointStatePlayer::isPast(const Moment& moment) const {
  if (restored_) return false;  // time goes on wherever the first moment is
  return moment.epoch < epoch_ || (moment.epoch == epoch_ && time_ns_ && moment.stamp_ns <= *time_ns_);
}

std::optional<std::int64_t> JointStatePlayer::nextStamp() const {
  const std::optional<Moment> moment = policy_ == StatePolicy::kNewestState ? newestMoment() : nextMoment();
  return moment ? std::optional(moment->stamp_ns) : std::nullopt;
}

std::optional<std::int64_t> JointStatePlayer::earliestStamp() const {
  std::optional<Moment> earliest;
  for (const Topic& topic : topic_states_) {
    if (!topic.triggers) continue;
    const auto found = std::find_if(topic.queue.begin(), topic.queue.end(),
                                    [this](const Queued& queued) { return !isPast(queued.moment); });
    if (found != topic.queue.end() && (!earliest || found->moment < *earliest)) earliest = found->moment;
  }
  return earliest ? std::optional(earliest->stamp_ns) : std::nullopt;
}

void JointStatePlayer::stopWaiting() {
  for (const Topic& topic : topic_states_) {
    if (!topic.triggers || topic.queue.empty()) continue;
    const Moment& newest = topic.queue.back().moment;
    if (!released_ || *released_ < newest) released_ = newest;
  }
}

std::optional<PlayedSample> JointStatePlayer::playNext() {
  refuseLate();
  PlayedSample played;
  if (!refused_.empty()) {
    played = std::move(refused_.front());
    refused_.pop_front();
    ++counts_[static_cast<std::size_t>(played.verdict)];
    return played;
  }
  const std::optional<Moment> moment = policy_ == StatePolicy::kNewestState ? newestMoment() : nextMoment();
  if (!moment) return std::nullopt;
  play(*moment, played);
  return played;
}

void JointStatePlayer::play(const Moment& moment, PlayedSample& played) {
  if (moment.epoch > epoch_) {
    played.was_resumed = resumes(moment);
    played.was_reset = !played.was_resumed;
    played.was_reset ? startLoop() : resume(moment);
    epoch_ = moment.epoch;
    resumptions_.erase(resumptions_.begin(), resumptions_.upper_bound(epoch_));
  }
  for (std::size_t t = 0; t < topic_states_.size(); ++t) take(moment, static_cast<int>(t), played);
  goToSamples(moment);
  for (const Topic& topic : topic_states_) headForNext(moment, topic);
  noteVelocities(moment);
  placeNewJoints(moment.stamp_ns, played);
  advanceTo(moment.stamp_ns, played);
  settle(played);
}

void JointStatePlayer::startLoop() {
  simulator_.reset();
  forgetJoints();
  time_ns_.reset();
  behind_ns_ = 0;
  ++resets_;
}

/// Whether no loop that is a new beginning lies between the one played last and the moment's.
bool JointStatePlayer::resumes(const Moment& moment) const {
  const auto known = std::distance(resumptions_.upper_bound(epoch_), resumptions_.upper_bound(moment.epoch));
  return time_ns_ && known == moment.epoch - epoch_;
}

/// Where time was before the stamps far off; the tissues and joints stay as these have left them. The first moment may
/// be another topic's that was not so far.
void JointStatePlayer::resume(const Moment& moment) {
  time_ns_ = std::min(resumptions_.at(moment.epoch), moment.stamp_ns);
  behind_ns_ = 0;
  forgetVelocities();
  for (Topic& topic : topic_states_) {
    topic.taken.reset();
    topic.taken_at_ns.reset();
  }
}

void JointStatePlayer::forgetJoints() {
  begun_ns_.reset();
  targets_.clear();
  heard_.clear();
  said_.clear();
  for (const Instrument& instrument : simulator_.instruments()) {
    targets_.push_back(instrument.initialPositions());
    heard_.emplace_back(instrument.model().joints().size(), Heard::kNever);
    said_.emplace_back(instrument.model().joints().size());
  }
  velocities_ = {targets_, targets_};
  forgetVelocities();
  for (Topic& topic : topic_states_) {
    topic.taken.reset();
    topic.taken_at_ns.reset();
  }
  owes_.assign(owes_.size(), false);
}

void JointStatePlayer::advanceTo(std::int64_t stamp_ns, PlayedSample& played) {
  if (std::exchange(restored_, false) && (stamp_ns < *time_ns_ || stamp_ns - *time_ns_ > max_gap_ns_)) {
    time_ns_ = stamp_ns - max_gap_ns_ - 1;  // so that it counts as a gap
    behind_ns_ = 0;
  }
  const bool begins = !time_ns_;
  std::int64_t interval_ns = time_ns_ ? stamp_ns - *time_ns_ + behind_ns_ : 0;
  time_ns_ = stamp_ns;
  behind_ns_ = interval_ns < shortest_ns_ ? interval_ns : 0;
  if (behind_ns_ > 0) return;
  if (begins) velocities_.start = velocities_.end;
  if (interval_ns == 0) return;
  if (interval_ns > max_gap_ns_) {
    interval_ns = max_gap_ns_;
    forgetStartVelocities();
    played.was_gap = true;
    for (Topic& topic : topic_states_) {  // nothing was said by anybody
      if (topic.taken_at_ns) topic.taken_at_ns = stamp_ns;
    }
    ++gaps_;
  }
  simulator_.advance(static_cast<double>(interval_ns) / kNanosecondsPerSecond, targets_, limits_, &velocities_);
  velocities_.start = velocities_.end;
  played.interrupted = simulator_.report().interrupted;
  if (!played.interrupted) return;
  time_ns_ = stamp_ns - interval_ns + toNanoseconds(simulator_.report().advanced_s);
  forgetVelocities();
}

/// What the moment owes and how its samples count.
void JointStatePlayer::settle(PlayedSample& played) {
  played.stamp_ns = *time_ns_;
  if (played.interrupted) {
    played.merged += std::exchange(played.accepted, 0);
  } else {
    for (std::size_t i = 0; i < owes_.size(); ++i) {
      if (owes_[i]) played.instruments.push_back(static_cast<int>(i));
    }
    owes_.assign(owes_.size(), false);
  }
  counts_[static_cast<std::size_t>(Verdict::kAccepted)] += played.accepted;
  merged_ += played.merged;
}

}  // namespace tissue_contact
