/// @file
/// Room `ros`, private: which joint states the simulation stops at when the scene leaves that open. No ROS and no clock inside.
#pragma once

#include <optional>
#include <string>

#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

struct PolicyChoice {
  StatePolicy policy = StatePolicy::kEveryState;  ///< never kAuto
  std::string reason;                             ///< for the log
};

/// @param wanted by the scene.
/// @param simulated_time whether ROS time comes from /clock.
/// @param age_s of the first joint state that was taken: wall clock minus stamp, when it was received.
PolicyChoice choosePolicy(StatePolicy wanted, bool simulated_time, double age_s);

/// Chooses by the first joint state, and anew when others have said the contrary for a while: a driver's first may be an
/// old latched one, and a driver may come after a recording. The scene and simulated time have the last word. What
/// is old in a row for less than a second of receiving says nothing: it may be a backlog. Not thread-safe.
class PolicyChooser {
 public:
  static constexpr int kLeastStates = 10;
  static constexpr double kLeastTime = 1.0;  ///< s

  PolicyChooser(StatePolicy wanted, bool simulated_time) : wanted_(wanted), simulated_time_(simulated_time) {}

  /// A joint state was taken.
  /// @param age_s see choosePolicy().
  /// @param received_s on a clock that never goes back.
  /// @return the choice when it is made or changed.
  std::optional<PolicyChoice> note(double age_s, double received_s);

  /// Time has started again, maybe by another source: the next state decides at once.
  void startAgain() { decides_ = true; }

 private:
  StatePolicy wanted_;
  bool simulated_time_;
  bool decides_ = true;  ///< the next state
  std::optional<StatePolicy> chosen_;
  int contrary_ = 0;  ///< states in a row that say otherwise
  double contrary_since_s_ = 0.0;
};

}  // namespace tissue_contact
