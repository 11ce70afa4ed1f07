/// @file
/// Room `simulation`, private: joints that give way. Contact forces of a step in; how far each compliant joint is from where its joint state
/// has it in the next step out.
///
/// A joint rests where the effort of the contacts on it, tau = J_q' f, is what its spring takes, k delta, or its limit. Forces of a step are known when it
/// is solved, so joints follow by a step. What contacts resist, R = n' A n / dt^2, n the way of the touched nodes with the joint while all others
/// are held, is more than what they resist with the others free. So the joint goes from where it stood, not from where its joint state moves it, to
/// where R (q' - q) = tau - k delta' or the limit: into tissue it never goes faster than that gives way. Of tau the mean of the last two steps is
/// taken, or what damping takes off it while a joint moves, R at most, could drive it back and forth. A joint that nothing touches any more comes back within some
/// hundredths of a second. A step's way is bounded by what shapes may move in one.
#pragma once

#include <vector>

#include "simulation/instrument_motion.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

class CompliantJoints {
 public:
  /// @param instruments must outlive this object.
  CompliantJoints(const std::vector<Instrument>& instruments, const InstrumentMotion& motion);

  /// Before a step, with `motion` moved to its end.
  void give(double dt, InstrumentMotion& motion) const;

  /// After a step that was finished. @param contacts of `problem`, as solved.
  void load(const ContactProblem& problem, const ContactSolution& solution, const std::vector<SolvedContact>& contacts,
            InstrumentMotion& motion);

 private:
  /// A node that contacts move with a joint: the sum of their ways for each rad or m of it, and of their weights there.
  struct Moved {
    int body;
    int node;
    Vector3 way;
    double weight;
  };
  struct Joint {
    int instrument;
    CompliantJoint compliance;
    double longest_way;        ///< in a step, rad or m
    std::vector<Moved> moved;  ///< by the contacts
  };
  double effortOn(Joint& joint, const ContactProblem& problem, const ContactSolution& solution,
                  const std::vector<SolvedContact>& contacts, const std::vector<Pose>& X_WL);
  double resistance(Joint& joint, const ContactProblem& problem);

  const std::vector<Instrument>& instruments_;
  std::vector<Joint> joints_;
  std::vector<NodalVectors> ways_;  ///< scratch: per body, 0 between calls
};

}  // namespace tissue_contact
