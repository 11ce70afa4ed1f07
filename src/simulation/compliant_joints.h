/// @file
/// Room `simulation`, private: joints that give way. Contact forces of a step in; how far each compliant joint is from where its joint state
/// has it in the next step out.
///
/// A joint rests where the effort of the contacts on it, tau = J_q' f, is what its spring takes, k delta, or its limit. Forces of a step are
/// known when it is solved, so joints follow by a step. What contacts resist, R = n' A n / dt^2, n the way of the touched nodes with the
/// joint while all others are held, is about what they resist with the others free, or more: that is the least energy of all that go that way. So
/// a joint that touches goes from where it stood, not from where its joint state moves it, to where R (q' - q) = tau - k delta' or the limit.
/// Of tau the mean of the last two steps is taken, or what damping takes off it while a joint moves, R at most, could drive it back and
/// forth; where a joint does so nevertheless R is taken for more, and where it goes on and on before that for less. A joint that nothing touches goes with
/// its joint state, and comes back to it within some hundredths of a second. Beside what its joint state moves it, a step's way is bounded by a share of
/// what shapes may move in one.
#pragma once

#include <vector>

#include "simulation/instrument_motion.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/solver/contact_problem.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

class CompliantJoints {
 public:
  /// A node that a contact of a link moves with a joint.
  struct Moved {
    int link;
    int body;
    int node;
    int contact;
    Vector3 way;  ///< for each rad or m of the joint
    double weight;
  };

  /// @param instruments, tissues must outlive this object.
  CompliantJoints(const std::vector<Instrument>& instruments, const std::vector<Tissue>& tissues,
                  const InstrumentMotion& motion);

  /// Before a step, with `motion` moved to its end.
  void give(double dt, InstrumentMotion& motion) const;

  /// After a step that was finished. @param contacts of `problem`, as solved.
  void load(const ContactProblem& problem, const ContactSolution& solution, const std::vector<SolvedContact>& contacts,
            InstrumentMotion& motion);

 private:
  struct Joint {
    int instrument;
    CompliantJoint compliance;
    double longest_way;        ///< in a step, rad or m
    std::vector<Moved> moved;  ///< by the contacts
  };
  /// A side of a sheet's node that something presses.
  struct PressedSide {
    int body;
    int node;
    Vector3 normal_W;  ///< into the sheet
  };
  static bool beforeNode(const PressedSide& one, const PressedSide& other);
  void findEffort(Joint& joint, const ContactProblem& problem, const ContactSolution& solution,
                  const std::vector<SolvedContact>& contacts, const std::vector<Pose>& X_WL,
                  InstrumentMotion::JointLoad& load);
  double resistance(Joint& joint, const ContactProblem& problem, const ContactSolution& solution);
  void findPressed(const ContactProblem& problem, const ContactSolution& solution);
  bool isPressedBehind(const ContactProblem& problem, const Moved& one) const;
  double squeezing(const Joint& joint, const ContactProblem& problem, const ContactSolution& solution) const;
  using MovedNodes = std::vector<Moved>::const_iterator;
  double energyOf(const ContactProblem& problem, MovedNodes begin, MovedNodes end);

  const std::vector<Instrument>& instruments_;
  const std::vector<Tissue>& tissues_;
  std::vector<Joint> joints_;
  std::vector<PressedSide> pressed_;  ///< scratch of load()
  std::vector<NodalVectors> ways_;    ///< scratch: per body, 0 between calls
};

}  // namespace tissue_contact
