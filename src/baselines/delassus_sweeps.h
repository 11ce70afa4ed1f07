/// @file
/// Room `baselines`, private: the predictor-corrector's pass over the contacts on a Delassus matrix, and the rivals'
/// passes. A problem and a warm start in; impulses, velocities and states out.
#pragma once

#include "solver/anderson.h"
#include "solver/contact_corrector.h"
#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

struct SweepsReport {
  int iterations = 0;
  bool converged = false;  ///< the natural map met the tolerance
};

/// The velocity a contact has without its own impulse predicts how it slides; ContactCorrector corrects; W carries the
/// change to all others at once. Each contact is solved exactly, so what repeats itself solves the problem.
class ContactSweeps {
 public:
  /// The four-sided cone is aligned once, along the tangential velocity of the warm start's u, or else of q.
  /// @param problem must outlive this object.
  /// @param warm_start taken over where its sizes match; else r = 0.
  ContactSweeps(const DelassusProblem& problem, const SolverDescription& description,
                const DelassusSolution& warm_start);

  /// Repeats two passes under Anderson's acceleration until the scaled natural map is <= tolerance, nothing changes any
  /// more by more than `settled` (relative), or `iterations` are used up. Called again, it goes on.
  SweepsReport iterate(double tolerance, double settled, int iterations);

  /// Where the passes are, with u = W r + q computed anew.
  DelassusSolution solution() const;

 private:
  void restart(const VectorX& r);  ///< sets the impulses, and u = W r + q with them
  void correct(Eigen::Index contact);

  const DelassusProblem& problem_;
  ContactCorrector corrector_;
  DelassusSolution now_;  ///< u carries the round-off of the passes
  AndersonMixing mixing_;
};

}  // namespace tissue_contact
