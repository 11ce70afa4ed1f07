/// @file
/// Room `ros`: a controller against tissue in one process, for its tests: joint positions in, wrenches out, one after the other. No ROS
/// master, no thread; the same bits as the node gives for the same joint states.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tissue_contact/core/content_hash.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Steps a scene from joint state to joint state, and keeps what a test wants to know at the end. Not thread-safe.
class LockStep {
 public:
  using JointValues = std::map<std::string, double>;  ///< by joint name as the topic has it: rad or m, or per s of it
  static constexpr std::size_t kMostComplaints = 5;   ///< kept; a run that goes wrong goes wrong at every step

  /// @param scene_file a path, or package://PACKAGE/PATH.
  /// @param rate_hz of the joint states, 0.1 to 10 000 Hz.
  /// @throws std::invalid_argument as loadScene() and Simulator, and for a rate out of range.
  LockStep(const std::string& scene_file, double rate_hz);

  /// The same for a scene that takes URDFs or frames from elsewhere.
  LockStep(const Scene& scene, const SceneEnvironment& environment, double rate_hz);

  LockStep(const LockStep&) = delete;
  LockStep& operator=(const LockStep&) = delete;

  /// Takes a joint state of each topic named, all with the next stamp, and steps to it: the first is at 1 s, the next 1 / rate_hz later.
  /// @param joint_velocities rad/s or m/s by topic and joint, of joints that have a position; others' are not known.
  /// @throws std::invalid_argument for a topic that the scene has not, or a velocity without position. What the node would refuse is a complaint.
  void step(const std::map<std::string, JointValues>& joint_states,
            const std::map<std::string, JointValues>& joint_velocities = {});

  /// What the tissues exert on the instrument at the last stamp: N and N m, at the origin of the tip link and in its axes.
  /// @throws std::invalid_argument for a name that no instrument has.
  Wrench wrench(const std::string& instrument) const { return simulator_.wrench(indexOf(instrument)); }

  /// Largest norm of the force so far, N.
  double peakForce(const std::string& instrument) const {
    return peaks_[static_cast<std::size_t>(indexOf(instrument))];
  }

  /// What a test should not let pass, a sentence each: joint states refused, tools that jumped, steps without a finite answer, loads that
  /// no tissue bears, gaps. Empty: all is well.
  const std::vector<std::string>& complaints() const { return complaints_; }

  /// Of all wrenches so far with their stamps (ContentHash); the one of tissue_contact_testing.py.
  std::uint64_t digest() const { return digest_.value(); }

  const Simulator& simulator() const { return simulator_; }

 private:
  int indexOf(const std::string& instrument) const;
  int topicOf(const std::string& name) const;
  void note(const PlayedSample& played);
  void complain(std::int64_t stamp_ns, const std::string& what);

  Simulator simulator_;
  JointStatePlayer player_;
  double rate_hz_;
  std::int64_t steps_ = 0;
  std::vector<double> peaks_;  ///< per instrument, N
  std::vector<std::string> complaints_;
  ContentHash digest_;
};

}  // namespace tissue_contact
