#include "ros/node/joint_state_policy.h"

#include <cmath>
#include <sstream>

namespace tissue_contact {

PolicyChoice choosePolicy(StatePolicy wanted, bool simulated_time, double age_s) {
  // A driver stamps what it has just read. A second allows for clocks of two computers; a recording is older than that.
  constexpr double kPresent = 1.0;
  if (wanted != StatePolicy::kAuto) return {wanted, "the scene says so"};
  if (simulated_time) return {StatePolicy::kEveryState, "time is simulated (/use_sim_time)"};
  std::ostringstream text;
  text.precision(3);
  if (std::abs(age_s) <= kPresent) {
    text << "joint states are stamped with the present (" << age_s << " s ago), as by a robot driver";
    return {StatePolicy::kNewestState, text.str()};
  }
  text << "joint states are stamped " << std::abs(age_s) << " s " << (age_s > 0.0 ? "ago" : "ahead")
       << ", as in a recording";
  return {StatePolicy::kEveryState, text.str()};
}

std::optional<PolicyChoice> PolicyChooser::note(double age_s, double received_s) {
  PolicyChoice choice = choosePolicy(wanted_, simulated_time_, age_s);
  if (chosen_ == choice.policy) {
    decides_ = false;
    contrary_ = 0;
    return std::nullopt;
  }
  if (contrary_++ == 0) contrary_since_s_ = received_s;
  const bool lasts = contrary_ >= kLeastStates && received_s - contrary_since_s_ >= kLeastTime;
  if (!decides_ && !lasts) return std::nullopt;
  decides_ = false;
  contrary_ = 0;
  chosen_ = choice.policy;
  return choice;
}

}  // namespace tissue_contact
