/// @file
/// Room `solver`, private: the momentum that contacts bring to the nodes they act on, J' lambda. Impulses of contacts in, its norm out.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Where faces, edges and vertices around a place all have contacts, their rows of J are nearly dependent: which of them bears
/// how much changes for long after what they bear together, and so v and the wrench, is known. So changes are measured where
/// they act. A node that is pressed from opposed sides, as a sheet is between jaws, counts once for each: what two jaws squeeze
/// it with is a force on both, though none on the node.
class ContactMomentum {
 public:
  /// Begins a step.
  void prepare(const ContactProblem& problem);

  /// |J' impulses|, N s.
  /// @param impulses per contact, contact frame, N s.
  double norm(const ContactProblem& problem, const std::vector<Vector3>& impulses) {
    return norm(problem, impulses, nullptr);
  }

  /// |J' (impulses - before)|, N s.
  double change(const ContactProblem& problem, const std::vector<Vector3>& impulses,
                const std::vector<Vector3>& before) {
    return norm(problem, impulses, &before);
  }

 private:
  double norm(const ContactProblem& problem, const std::vector<Vector3>& impulses, const std::vector<Vector3>* minus);

  /// A node as one contact sees it.
  struct Seen {
    int body;
    int node;
    int contact;
    int place;         ///< in the contact's row
    Vector3 normal_W;  ///< into the body
  };
  std::vector<Seen> seen_;                 ///< scratch
  std::vector<std::array<int, 4>> sides_;  ///< per contact and node of its row: a side of a node, index into sums_
  std::vector<Vector3> sums_;              ///< per side of a node, world axes, N s
};

}  // namespace tissue_contact
