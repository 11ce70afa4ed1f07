#include "tissue_contact/ros/lock_step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "tissue_contact/core/range.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/ros/environment.h"
#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact {
namespace {

constexpr Range kJointStateRate{0.1, 10000.0, "Hz"};
constexpr std::int64_t kStart_ns = 1000000000;  // 0 is no stamp

/// What nobody would look at is a mistake.
void requirePositions(const std::map<std::string, LockStep::JointValues>& joint_states, const std::string& topic,
                      const LockStep::JointValues& velocities) {
  const auto positions = joint_states.find(topic);
  for (const auto& [joint, velocity] : velocities) {
    if (positions != joint_states.end() && positions->second.count(joint) > 0) continue;
    throw std::invalid_argument("joint " + inQuotes(joint) + " of topic " + inQuotes(topic) +
                                " has a velocity, but no position");
  }
}

/// NaN: not known.
double velocityOf(const std::map<std::string, LockStep::JointValues>& joint_velocities, const std::string& topic,
                  const std::string& joint) {
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  const auto velocities = joint_velocities.find(topic);
  if (velocities == joint_velocities.end()) return kUnknown;
  const auto velocity = velocities->second.find(joint);
  return velocity == velocities->second.end() ? kUnknown : velocity->second;
}

SceneEnvironment plainEnvironment() {
  SceneEnvironment environment;
  environment.package_path = packagePath;
  environment.clock = steadySeconds;
  return environment;
}

}  // namespace

LockStep::LockStep(const std::string& scene_file, double rate_hz)
    : LockStep(loadScene(scene_file, packagePath), plainEnvironment(), rate_hz) {}

LockStep::LockStep(const Scene& scene, const SceneEnvironment& environment, double rate_hz)
    : simulator_(scene, environment),
      player_(simulator_),
      rate_hz_(kJointStateRate.require("the rate of the joint states", rate_hz)),
      peaks_(scene.instruments.size(), 0.0) {}

void LockStep::step(const std::map<std::string, JointValues>& joint_states,
                    const std::map<std::string, JointValues>& joint_velocities) {
  for (const auto& [topic, velocities] : joint_velocities) requirePositions(joint_states, topic, velocities);
  const std::int64_t stamp_ns = kStart_ns + std::llround(static_cast<double>(steps_) * 1e9 / rate_hz_);
  std::vector<std::pair<int, JointStateSample>> samples;
  for (const auto& [topic, positions] : joint_states) {
    JointStateSample& sample = samples.emplace_back(topicOf(topic), JointStateSample{stamp_ns, {}, {}, {}}).second;
    for (const auto& [joint, position] : positions) {
      sample.names.push_back(joint);
      sample.positions.push_back(position);
      sample.velocities.push_back(velocityOf(joint_velocities, topic, joint));
    }
  }
  ++steps_;
  for (auto& [topic, sample] : samples) player_.push(topic, std::move(sample));
  player_.stopWaiting();  // all that is to come of this stamp is here
  while (const auto played = player_.playNext()) note(*played);
}

void LockStep::note(const PlayedSample& played) {
  if (played.verdict != Verdict::kAccepted) {
    complain(played.stamp_ns,
             std::string("joint state refused: ") + verdictText(played.verdict) + ", " + played.detail);
    return;
  }
  for (const int instrument : played.instruments) {
    const Wrench felt = simulator_.wrench(instrument);
    digest_.add(&played.stamp_ns, sizeof played.stamp_ns);
    for (const Vector3& vector : {felt.force, felt.torque}) digest_.add(vector.data(), 3 * sizeof(double));
    double& peak = peaks_[static_cast<std::size_t>(instrument)];
    peak = std::max(peak, felt.force.norm());
  }
  const StepReport& report = simulator_.report();
  if (played.was_gap) complain(played.stamp_ns, "the interval was longer than step.max_gap_s, and was cut");
  if (report.jumped) complain(played.stamp_ns, "an instrument moved too far at once, and was placed without a path");
  if (report.discarded) complain(played.stamp_ns, "a step had no finite answer");
  if (report.implausible_load.found) complain(played.stamp_ns, implausibleLoadText(simulator_));
}

void LockStep::complain(std::int64_t stamp_ns, const std::string& what) {
  if (complaints_.size() >= kMostComplaints) return;
  std::ostringstream text;
  text << "at " << static_cast<double>(stamp_ns) * 1e-9 << " s: " << what;
  complaints_.push_back(text.str());
}

int LockStep::indexOf(const std::string& instrument) const {
  const std::vector<Instrument>& all = simulator_.instruments();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Instrument& one) { return one.name() == instrument; });
  if (found != all.end()) return static_cast<int>(found - all.begin());
  std::vector<std::string> names;
  names.reserve(all.size());
  for (const Instrument& one : all) names.push_back(one.name());
  throw std::invalid_argument("the scene has no instrument " + inQuotes(instrument) + "; it has " + joined(names));
}

int LockStep::topicOf(const std::string& name) const {
  const std::vector<std::string>& all = player_.topics();
  const auto found = std::find(all.begin(), all.end(), name);
  if (found != all.end()) return static_cast<int>(found - all.begin());
  throw std::invalid_argument("the scene has no joint-state topic " + inQuotes(name) + "; it has " + joined(all));
}

}  // namespace tissue_contact
