/// @file
/// Room `solver`, private: the predictor-corrector's pass over the contacts on a Delassus matrix, and the rivals'
/// passes. A problem and a warm start in; impulses, velocities and states out.
#pragma once

#include <vector>

#include "solver/anderson.h"
#include "solver/natural_map.h"

namespace tissue_contact {

struct SweepsReport {
  int iterations = 0;
  bool converged = false;  ///< the natural map met the tolerance
};

/// The velocity a contact has without its own impulse predicts how it slides; the one-contact solver corrects; W
/// carries the change to all others at once. Each contact's answer is exact, so what repeats itself solves the problem.
class ContactSweeps {
 public:
  /// Starts from `solution` where its sizes match, else from r = 0. `problem` must outlive this object.
  /// @param description method (predictor-corrector, cone4, polyhedral) and cone_sides.
  /// The four-sided cone is aligned once, along the tangential velocity of the warm start's u, or else of q.
  ContactSweeps(const DelassusProblem& problem, const SolverDescription& description, const DelassusSolution& solution);

  /// Repeats two passes under Anderson's acceleration until the scaled natural map is <= tolerance, nothing changes any
  /// more by more than `settled` (relative), or `iterations` are used up. Called again, it goes on.
  SweepsReport iterate(double tolerance, double settled, int iterations);

  const VectorX& impulses() const { return r_; }
  const VectorX& velocities() const { return u_; }
  const std::vector<ContactState>& states() const { return states_; }

  /// The scaled natural map, from velocities that carry the round-off of the sweeps.
  double naturalMapNorm() const;

 private:
  void restart(const VectorX& r);  ///< sets the impulses, and u = W r + q with them
  void pass();                     ///< visits every contact
  void correct(Eigen::Index contact);

  const DelassusProblem& problem_;
  SolverMethod method_;
  int cone_sides_;
  NaturalUnits units_;
  VectorX r_;
  VectorX u_;
  std::vector<ContactState> states_;
  std::vector<int> flips_;                 ///< changes between static and kinetic, per contact
  std::vector<Vector2> previous_sliding_;  ///< m/s, per contact
  AndersonMixing mixing_;
};

}  // namespace tissue_contact
