/// @file
/// Room `solver`, private: keeps a step that ends before its tolerance from bringing energy into the tissue.
#pragma once

#include <vector>

#include "tissue_contact/solver/contact_solver.h"

namespace tissue_contact {

/// Where v'A v <= (b + J'lambda)'v the tissue's energy grows by no more than contacts and loads did work (doc/method.md, "When a step
/// ends"). The step's answer meets that; a v on the way there may not, and steps that pass such ones on grow without bound.
class EnergyGuard {
 public:
  /// Shortens the velocities of each body to where v'A v / 2 - (b + J'lambda)'v is least along them, if that is shorter. Nodes that
  /// contacts may move stay as these have them. Allocates only for more nodes than ever before.
  void shorten(const ContactProblem& problem, ContactSolution& solution);

 private:
  std::vector<NodalVectors> impulses_;  ///< of contacts per body, N s
  NodalVectors free_;                   ///< velocities of one body without the nodes that contacts may move, m/s
  NodalVectors defect_;                 ///< N s
};

}  // namespace tissue_contact
