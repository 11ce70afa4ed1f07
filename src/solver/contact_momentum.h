/// @file
/// Room `solver`, private: how much the momentum that contacts bring to the nodes they act on, J' lambda, changes. Impulses of contacts
/// before and after in; a norm out.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Where faces, edges and vertices around a place all have contacts, their rows of J are nearly dependent: which of them bears
/// how much changes for long after what they bear together, and so v and the wrench, is known. So changes are measured where
/// they act. A node that several instruments press, or one from opposed sides, as a sheet is between jaws, counts once for each: what
/// they take from each other, or squeeze it with, is a force on them, though none on the node. Nodes that cannot move do not count.
class ContactMomentum {
 public:
  /// Begins a step.
  void prepare(const ContactProblem& problem);

  /// |J' (after - before)|, N s.
  /// @param before, after impulses per contact, contact frame, N s.
  double change(const ContactProblem& problem, const std::vector<Vector3>& before, const std::vector<Vector3>& after);

 private:
  /// A node as one contact sees it.
  struct Seen {
    int body;
    int node;
    int pair;
    int contact;
    int place;         ///< in the contact's row
    Vector3 normal_W;  ///< into the body
  };
  std::vector<Seen> seen_;  ///< scratch
  std::vector<std::array<int, 4>>
      sides_;                  ///< per contact and node of its row: a side of a node, index into sums_; -1: cannot move
  std::vector<Vector3> sums_;  ///< per side of a node, world axes, N s
};

}  // namespace tissue_contact
