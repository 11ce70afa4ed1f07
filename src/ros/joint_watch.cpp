#include "ros/joint_watch.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMostForeign = 12;  // told; a message may name a million
constexpr double kHearing_s = 5.0;        // a jaw's topic may begin some seconds after its arm's

bool isFarOutside(const IndependentJoint& joint, double position) {
  const double range = joint.upper - joint.lower;
  return range > 0.0 && std::isfinite(position) && (position > joint.upper + range || position < joint.lower - range);
}

/// Empty where the topic is not ahead by more than max_gap_s.
std::string leadText(const std::string& topic, double lead_s, double max_gap_s) {
  if (!(lead_s > max_gap_s)) return {};
  std::ostringstream text;
  text << std::setprecision(4) << "the stamps on " << topic
       << ", which only updates, are ahead of those that give wrenches by up to " << lead_s << " s (step.max_gap_s is "
       << max_gap_s
       << "): its joints stay where they are until time is there. Set the clocks of all computers by one (NTP), or "
          "correct "
          "header.stamp in the recording";
  return text.str();
}

}  // namespace

JointWatch::JointWatch(const Simulator& simulator, const JointStatePlayer& player, double longest_silence_s)
    : simulator_(simulator),
      player_(player),
      topics_(player.topics().size()),
      seen_(simulator.instruments().size()),
      silence_(longest_silence_s) {
  std::size_t joints = 0;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    first_numbers_.push_back(joints);
    joints += simulator.instruments()[i].model().joints().size();
    for (const JointStateTopic& described : simulator.scene().instruments[i].joint_state_topics) {
      const auto at = std::find(player.topics().begin(), player.topics().end(), described.name);
      topics_[static_cast<std::size_t>(at - player.topics().begin())].listeners.push_back(static_cast<int>(i));
    }
  }
}

std::size_t JointWatch::numberOf(int instrument, int joint) const {
  return first_numbers_[static_cast<std::size_t>(instrument)] + static_cast<std::size_t>(joint);
}

void JointWatch::note(int topic, const JointStateSample& sample, double now_s) {
  if (sample.names.size() != sample.positions.size()) return;  // the player refuses it
  Topic& heard = topics_[static_cast<std::size_t>(topic)];
  if (sample.names != heard.last_names) noteNames(heard, sample.names);
  silence_.note(static_cast<std::size_t>(topic), now_s, heard.joints);
  for (const Known& known : heard.known) {
    const auto i = static_cast<std::size_t>(known.instrument);
    const double position = sample.positions[known.place];
    const RobotModel& model = simulator_.instruments()[i].model();
    if (isFarOutside(model.joints()[static_cast<std::size_t>(known.joint)], position)) {
      seen_[i].outside.emplace(known.joint, position);
    }
  }
}

void JointWatch::noteNames(Topic& heard, const std::vector<std::string>& names) {
  heard.last_names = names;
  heard.known.clear();
  heard.joints.clear();
  for (const int i : heard.listeners) {
    Seen& seen = seen_[static_cast<std::size_t>(i)];
    std::set<int> known_here;
    for (std::size_t k = 0; k < names.size(); ++k) {
      const int joint = simulator_.instruments()[static_cast<std::size_t>(i)].jointOfRecordedName(names[k]);
      if (joint >= 0) {
        seen.joints.insert(joint);
        if (known_here.insert(joint).second) {
          heard.known.push_back({k, i, joint});  // a message may name one a million times
          heard.joints.push_back(numberOf(i, joint));
        } else {
          seen.twice.insert(joint);
        }
      } else if (seen.foreign.size() < kMostForeign &&
                 std::find(seen.foreign.begin(), seen.foreign.end(), names[k]) == seen.foreign.end()) {
        seen.foreign.push_back(names[k]);
      }
    }
  }
}

void JointWatch::notePlayed() {
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    const int topic = static_cast<int>(t);
    if (player_.triggers(topic)) continue;
    topics_[t].lead_s = std::max(topics_[t].lead_s, player_.lead_s(topic));
    topics_[t].idle_s = std::max(topics_[t].idle_s, player_.idle_s(topic).value_or(0.0));
  }
}

std::vector<std::string> JointWatch::findings() const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    for (std::string& line : std::vector<std::string>{namesText(i), twiceText(i), limitsText(i)}) {
      if (!line.empty()) lines.push_back(std::move(line));
    }
  }
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    std::string line = leadText(player_.topics()[t], topics_[t].lead_s, simulator_.scene().step.max_gap_s);
    if (line.empty()) line = silenceText(t);
    if (!line.empty()) lines.push_back(std::move(line));
  }
  for (const std::string& line : silentTexts(silence_.longest(), true))
    lines.push_back(line + "; they stood still, with what they pressed");
  return lines;
}

std::vector<std::string> JointWatch::takeNews(double now_s) {
  std::vector<std::string> lines;
  if (!began_s_) began_s_ = now_s;
  const bool has_heard = now_s - *began_s_ >= kHearing_s;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    if (has_heard && !std::exchange(seen_[i].told_names, true)) lines.push_back(namesText(i));
    if (!seen_[i].outside.empty() && !std::exchange(seen_[i].told_limits, true)) lines.push_back(limitsText(i));
    if (!seen_[i].twice.empty() && !std::exchange(seen_[i].told_twice, true)) lines.push_back(twiceText(i));
  }
  for (std::size_t t = 0; t < topics_.size(); ++t) {
    if (topics_[t].told_lead) continue;
    lines.push_back(leadText(player_.topics()[t], topics_[t].lead_s, simulator_.scene().step.max_gap_s));
    topics_[t].told_lead = !lines.back().empty();
  }
  takeSilences(now_s, lines);
  lines.erase(std::remove(lines.begin(), lines.end(), std::string()), lines.end());
  return lines;
}

void JointWatch::takeSilences(double now_s, std::vector<std::string>& lines) {
  constexpr double kLook_s = 0.2;
  if (looked_s_ && now_s >= *looked_s_ && now_s - *looked_s_ < kLook_s) return;
  looked_s_ = now_s;
  silent_joints_.clear();
  for (const std::string& text : silentTexts(silence_.now(), false))
    silent_joints_ += (silent_joints_.empty() ? "" : "; ") + text;
  for (const std::string& text : silentTexts(silence_.takeNew(), false))
    lines.push_back(
        text +
        ": they stay where they were, and the forces of what they move go on. Has a driver ended? See `rostopic echo`");
}

/// A sentence for those of an instrument that fell silent on one topic together.
/// @param is_over the recording is.
std::vector<std::string> JointWatch::silentTexts(const std::vector<JointSilence::Silent>& silent, bool is_over) const {
  std::vector<std::string> texts;
  std::map<std::string, std::vector<std::string>> names;  // joints by what is said of them
  std::vector<std::string> order;
  for (const JointSilence::Silent& one : silent) {
    const auto next = std::upper_bound(first_numbers_.begin(), first_numbers_.end(), one.joint);
    const auto i = static_cast<std::size_t>(next - first_numbers_.begin()) - 1;
    const Instrument& instrument = simulator_.instruments()[i];
    std::ostringstream text;
    text << std::setprecision(3) << "for " << (is_over ? one.silent_s : std::floor(one.silent_s))
         << " s no joint state on " << player_.topics()[one.topic] << ", where others " << (is_over ? "came" : "come")
         << ", " << (is_over ? "named" : "has named") << " these joints of '" << instrument.name() << "': ";
    if (names.count(text.str()) == 0) order.push_back(text.str());
    names[text.str()].push_back(instrument.model().joints()[one.joint - first_numbers_[i]].name);
  }
  texts.reserve(order.size());
  for (const std::string& text : order) texts.push_back(text + listOf(names[text]));
  return texts;
}

/// Empty where names are as they should be.
std::string JointWatch::namesText(std::size_t instrument) const {
  const RobotModel& model = simulator_.instruments()[instrument].model();
  const std::vector<IndependentJoint>& joints = model.joints();
  const Seen& seen = seen_[instrument];
  std::vector<std::string> still;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (seen.joints.count(static_cast<int>(j)) == 0) still.push_back(joints[j].name);
  }
  if (still.empty() || seen.foreign.empty()) return {};
  std::string why = model.mimicsText(seen.foreign);
  if (why.empty()) why = simulator_.instruments()[instrument].mappedText(seen.foreign);
  return "no joint state names these joints of '" + simulator_.instruments()[instrument].name() +
         "', which stay where the scene puts them: " + listOf(still) +
         "; those that come name others, which are none of its independent joints: " + listOf(seen.foreign) +
         (why.empty() ? ". If they are the same, map them by joint_names" : ". Of these are " + why);
}

/// Empty where no message names a joint more than once.
std::string JointWatch::twiceText(std::size_t instrument) const {
  const Instrument& one = simulator_.instruments()[instrument];
  std::vector<std::string> names;
  for (const int joint : seen_[instrument].twice)
    names.push_back(one.model().joints()[static_cast<std::size_t>(joint)].name);
  if (names.empty()) return {};
  return "joint states name these joints of '" + one.name() + "' more than once: " + listOf(names) +
         ". The last position counts; let the driver name each once, and each arm have names or a topic of its own";
}

/// Empty where something was taken often enough from a topic that only updates.
std::string JointWatch::silenceText(std::size_t topic) const {
  const double max_gap_s = simulator_.scene().step.max_gap_s;
  if (!(topics_[topic].idle_s > max_gap_s)) return {};
  std::ostringstream text;
  text << std::setprecision(3) << "for " << topics_[topic].idle_s << " s no joint state came on "
       << player_.topics()[topic] << ", which only updates: its joints stood still, with what they pressed";
  return text.str();
}

/// Empty where no joint was far outside its limits.
std::string JointWatch::limitsText(std::size_t instrument) const {
  std::vector<std::string> outside;
  for (const auto& [joint, position] : seen_[instrument].outside) {
    const IndependentJoint& limited =
        simulator_.instruments()[instrument].model().joints()[static_cast<std::size_t>(joint)];
    std::ostringstream text;
    text << std::setprecision(4) << limited.name << " at " << position << " (" << limited.lower << " to "
         << limited.upper << ")";
    outside.push_back(text.str());
  }
  if (outside.empty()) return {};
  return "joints of '" + simulator_.instruments()[instrument].name() +
         "' are far outside the limits of their URDF: " + listOf(outside) +
         ". Positions are taken in rad and m; look whether they come in degrees or millimetres, and whether "
         "joint_names maps each to its joint";
}

std::string aheadText(const JointStatePlayer& player, double max_gap_s) {
  for (std::size_t t = 0; t < player.topics().size(); ++t) {
    std::string text = leadText(player.topics()[t], player.lead_s(static_cast<int>(t)), max_gap_s);
    if (!text.empty()) return text;
  }
  return {};
}

}  // namespace tissue_contact
