/// @file
/// Room `simulation`: where JointStatePlayer has the joints at a moment.
#include <algorithm>
#include <cstdint>
#include <sstream>
#include <utility>

#include "simulation/joint_way.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {
namespace {

/// Of drivers slower than 5 Hz, and of those that speak only when something moves, nobody knows how they came there.
constexpr std::int64_t kLongestWay_ns = 200'000'000;

/// After the first moment: drivers of one robot that start later than that are told of.
constexpr std::int64_t kLongestStart_ns = 200'000'000;

double secondsBetween(std::int64_t from_ns, std::int64_t to_ns) { return 1e-9 * static_cast<double>(to_ns - from_ns); }

}  // namespace

/// Takes everything of a topic up to the moment.
void JointStatePlayer::take(const Moment& moment, int topic, PlayedSample& played) {
  Topic& state = topic_states_[static_cast<std::size_t>(topic)];
  while (!state.queue.empty() && !(moment < state.queue.front().moment)) {
    const Queued& next = state.queue.front();
    const bool is_passed_over = state.triggers && next.moment < moment;
    if (next.moment.epoch == moment.epoch) {
      takeJoints(next, state);
      state.taken = next.moment;
      state.taken_at_ns = moment.stamp_ns;
    }
    if (state.triggers && !is_passed_over && played.topic < 0) played.topic = topic;
    ++(is_passed_over ? played.merged : played.accepted);
    state.queue.pop_front();
    --waiting_;
  }
}

/// Where a joint is that a sample of that stamp says to be at `position`: beyond whole turns that its driver leaves out. After a pause nobody knows
/// how it turned, and the shorter way does less.
double JointStatePlayer::goneOnTo(double position, std::int64_t stamp_ns, std::size_t instrument, int joint) const {
  const auto index = static_cast<std::size_t>(joint);
  if (heard_[instrument][index] == Heard::kNever) return position;
  const IndependentJoint& described = simulator_.instruments()[instrument].model().joints()[index];
  const Said& before = said_[instrument][index];
  if (described.turns_on) return described.nearest(position, before.position + before.turns);
  const bool goes_on = stamp_ns >= before.stamp_ns && stamp_ns - before.stamp_ns < max_gap_ns_;
  const double interval_s = goes_on ? secondsBetween(before.stamp_ns, stamp_ns) : 0.0;
  return position + before.turns + described.turnsLeftOut(before.position, position, interval_s);
}

/// Notes where the joints in a sample are to go.
void JointStatePlayer::takeJoints(const Queued& queued, const Topic& topic) {
  const JointStateSample& sample = queued.sample;
  for (const Listener& listener : topic.listeners) {
    const auto index = static_cast<std::size_t>(listener.instrument);
    bool any_known = false;
    for (std::size_t k = 0; k < sample.names.size(); ++k) {
      const int joint = simulator_.instruments()[index].jointOfRecordedName(sample.names[k]);
      if (joint < 0) continue;
      any_known = true;
      Said& said = said_[index][static_cast<std::size_t>(joint)];
      said.turns = goneOnTo(sample.positions[k], queued.moment.stamp_ns, index, joint) - sample.positions[k];
      said.position = sample.positions[k];
      said.stamp_ns = queued.moment.stamp_ns;
      said.is_news = true;
      said.velocity = sample.velocities[k];
      Heard& heard = heard_[index][static_cast<std::size_t>(joint)];
      if (heard == Heard::kNever) heard = Heard::kNow;
    }
    if (any_known && listener.triggers) owes_[index] = true;
  }
}

/// Sets the joints to where samples have them, at once or at a pace of their own: where others' moments came in between, at which a joint
/// was held since nothing was known of it, its way from one sample to the next is not to be made in what is left of that time.
void JointStatePlayer::goToSamples(const Moment& moment) {
  for (std::size_t i = 0; i < said_.size(); ++i) {
    for (std::size_t k = 0; k < said_[i].size(); ++k) {
      Said& said = said_[i][k];
      const bool is_news = std::exchange(said.is_news, false);
      if (!is_news && said.arrives_ns == 0) continue;
      double& target = targets_[i][static_cast<Eigen::Index>(k)];
      const double goal = said.position + said.turns;
      const std::int64_t arrives_ns = heard_[i][k] == Heard::kNow ? 0 : arrivalOf(said, is_news, moment);
      said.seen_ns = said.stamp_ns;
      if (arrives_ns <= moment.stamp_ns) {
        target = goal;
        said.right_ns = said.stamp_ns;
        said.arrives_ns = 0;
        said.target_velocity = said.velocity;
        continue;
      }
      target += static_cast<double>(moment.stamp_ns - *time_ns_) / static_cast<double>(arrives_ns - *time_ns_) *
                (goal - target);
      said.arrives_ns = arrives_ns;
    }
  }
}

/// When a joint is to be where the newest sample has it; not after the moment: then.
std::int64_t JointStatePlayer::arrivalOf(const Said& said, bool is_news, const Moment& moment) const {
  if (!time_ns_ || moment.stamp_ns <= *time_ns_) return 0;  // the first one, or time has gone back
  const std::int64_t now_ns = *time_ns_;
  if (said.arrives_ns > now_ns) {  // on its way
    const std::int64_t arrives_ns = std::min(said.arrives_ns, now_ns + kLongestWay_ns);
    return is_news ? std::max(arrives_ns, now_ns + ownWay(said.seen_ns, said.stamp_ns)) : arrives_ns;
  }
  const std::int64_t own_ns = ownWay(said.right_ns, said.stamp_ns);
  return isSqueezed(own_ns, moment.stamp_ns - now_ns + behind_ns_) ? now_ns + own_ns : 0;
}

/// The time that a joint takes from one place to another.
std::int64_t JointStatePlayer::ownWay(std::int64_t from_ns, std::int64_t to_ns) const {
  return std::min({to_ns - from_ns, max_gap_ns_, kLongestWay_ns});
}

/// Whether a way that took so long is made in so much less time that speed, and what hangs on it, is another. Stamps jitter.
bool JointStatePlayer::isSqueezed(std::int64_t own_ns, std::int64_t left_ns) {
  constexpr std::int64_t kMostHaste = 2;
  return left_ns > 0 && own_ns > kMostHaste * left_ns;
}

/// Moves the joints' targets from where they were last known towards the topic's next sample, as far as the moment
/// lies between the two.
void JointStatePlayer::headForNext(const Moment& moment, const Topic& topic) {
  if (!topic.taken || topic.taken->stamp_ns >= moment.stamp_ns || topic.queue.empty()) return;
  const Queued& next = topic.queue.front();
  if (next.moment.epoch != moment.epoch || next.moment.stamp_ns - topic.taken->stamp_ns >= max_gap_ns_) return;
  const std::int64_t from_ns = std::max(topic.taken->stamp_ns, time_ns_.value_or(topic.taken->stamp_ns));
  if (from_ns >= moment.stamp_ns) return;  // a restored state is later
  const double fraction =
      static_cast<double>(moment.stamp_ns - from_ns) / static_cast<double>(next.moment.stamp_ns - from_ns);
  const double duration_s = secondsBetween(from_ns, next.moment.stamp_ns);
  for (const Listener& listener : topic.listeners) {
    const auto index = static_cast<std::size_t>(listener.instrument);
    for (std::size_t k = next.sample.names.size();
         k-- > 0;) {  // of a joint that is named twice the last position counts
      const int joint = simulator_.instruments()[index].jointOfRecordedName(next.sample.names[k]);
      if (joint < 0 || heard_[index][static_cast<std::size_t>(joint)] == Heard::kNever) continue;
      Said& said = said_[index][static_cast<std::size_t>(joint)];
      if (said.right_ns == moment.stamp_ns || said.arrives_ns != 0 ||
          isSqueezed(ownWay(said.right_ns, next.moment.stamp_ns), next.moment.stamp_ns - from_ns))
        continue;
      said.right_ns = moment.stamp_ns;
      double& target = targets_[index][joint];
      const double distance = goneOnTo(next.sample.positions[k], next.moment.stamp_ns, index, joint) - target;
      const JointWay way(distance, duration_s, said.target_velocity, next.sample.velocities[k]);
      target += way.at(fraction);
      said.target_velocity = way.isStraight() ? kUnknown : way.slope(fraction) / duration_s;
    }
  }
}

/// Of joints that are at the moment where their topic says, and not held since nothing is known of them.
void JointStatePlayer::noteVelocities(const Moment& moment) {
  for (std::size_t i = 0; i < said_.size(); ++i) {
    for (std::size_t k = 0; k < said_[i].size(); ++k) {
      Said& said = said_[i][k];
      if (said.right_ns != moment.stamp_ns) said.target_velocity = kUnknown;
      velocities_.end[i][static_cast<Eigen::Index>(k)] = said.target_velocity;
    }
  }
}

/// The simulator is not, or not so long before the moment, where velocities were said: the way to it is straight.
void JointStatePlayer::forgetStartVelocities() {
  for (VectorX& velocities : velocities_.start) velocities.setConstant(kUnknown);
}

/// And so is the one to the next sample.
void JointStatePlayer::forgetVelocities() {
  forgetStartVelocities();
  for (std::vector<Said>& of_instrument : said_) {
    for (Said& said : of_instrument) said.target_velocity = kUnknown;
  }
}

double JointStatePlayer::lead_s(int topic) const {
  const Topic& own = topic_states_.at(static_cast<std::size_t>(topic));
  if (own.triggers || !own.last) return 0.0;
  std::optional<std::int64_t> newest_ns;
  for (const Topic& other : topic_states_) {
    if (!other.triggers || !other.last || other.last->epoch != own.last->epoch) continue;
    newest_ns = std::max(newest_ns.value_or(other.last->stamp_ns), other.last->stamp_ns);
  }
  return newest_ns ? std::max(0.0, secondsBetween(*newest_ns, own.last->stamp_ns)) : 0.0;
}

std::optional<double> JointStatePlayer::idle_s(int topic) const {
  const Topic& own = topic_states_.at(static_cast<std::size_t>(topic));
  if (!own.taken_at_ns || !time_ns_) return std::nullopt;
  return secondsBetween(*own.taken_at_ns, *time_ns_);
}

void JointStatePlayer::placeNewJoints(std::int64_t stamp_ns, PlayedSample& played) {
  if (!begun_ns_) begun_ns_ = stamp_ns;
  const bool is_late = stamp_ns - *begun_ns_ > kLongestStart_ns;
  for (std::size_t i = 0; i < heard_.size(); ++i) {
    if (std::find(heard_[i].begin(), heard_[i].end(), Heard::kNow) == heard_[i].end()) continue;
    VectorX placed = simulator_.jointPositions(static_cast<int>(i));
    for (std::size_t k = 0; k < heard_[i].size(); ++k) {
      if (heard_[i][k] != Heard::kNow) continue;
      const double target = targets_[i][static_cast<Eigen::Index>(k)];
      const double stood = std::exchange(placed[static_cast<Eigen::Index>(k)], target);
      if (is_late && stood != target) {
        const Instrument& instrument = simulator_.instruments()[i];
        std::ostringstream text;
        text << "joint '" << instrument.model().joints()[k].name << "' of '" << instrument.name()
             << "' is heard for the first time and goes from " << stood << " to " << target
             << " at once, through what is between; initial_joint_positions of the scene say where it begins";
        played.placed += (played.placed.empty() ? "" : "; ") + text.str();
      }
      heard_[i][k] = Heard::kBefore;
    }
    simulator_.placeInstrument(static_cast<int>(i), placed);
  }
}

}  // namespace tissue_contact
