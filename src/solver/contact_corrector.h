/// @file
/// Room `solver`, private: the answer of one contact given its local operator and the velocity it would have without its
/// own impulse: friction history, the guard against cycling, and the choice of corrector.
#pragma once

#include <vector>

#include "solver/rival_contact.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

class ContactCorrector {
 public:
  /// Changes between static and kinetic a contact may make in one step before it is held to the kinetic limit.
  static constexpr int kMaxFlips = 4;

  ContactCorrector(SolverMethod method, int cone_sides) : method_(method), cone_sides_(cone_sides) {}

  /// Begins a step. `solution` holds the warm start.
  void prepare(const ContactProblem& problem, const ContactSolution& solution);

  /// @param W local operator J P^-1 J', 1/kg. @param u relative velocity with the present impulse, m/s.
  /// Sets the contact's impulse and state in `solution`. @return the change of the impulse, contact frame, N s.
  Vector3 correct(const ContactProblem& problem, std::size_t contact, const Matrix3& W, const Vector3& u,
                  ContactSolution& solution);

  std::size_t bytes() const { return flips_.capacity() + previous_sliding_.capacity() * sizeof(Vector2); }

 private:
  SolverMethod method_;
  int cone_sides_;
  std::vector<unsigned char> flips_;       ///< per contact, this step
  std::vector<Vector2> previous_sliding_;  ///< per contact, m/s; for the rivals alone
};

/// A contact that has a normal part only: both coefficients 0.
inline bool isFrictionless(const CoulombLaw& law) { return law.anisotropic == nullptr && law.mu_static == 0.0; }

}  // namespace tissue_contact
