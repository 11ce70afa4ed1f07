/// @file
/// Room `solver`, private: solves one contact, given its local operator and its velocity, and remembers what matters for
/// that within a step: how often the contact has changed between sticking and sliding, and whether it is still held. Serves every iteration that goes
/// from contact to contact: the method's, on J P^-1 J', and the baselines', on the Delassus matrix.
#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// A way to solve one contact other than solveCoulombContact(), which see for W, q and law.
/// kinetic_limit: the contact sticks only if kinetic friction can hold it.
/// previous_sliding: tangential velocity of the contact in the warm start, m/s.
using ContactRival = std::function<ContactAnswer(const Matrix3& W, const Vector3& q, const CoulombLaw& law,
                                                 bool kinetic_limit, const Vector2& previous_sliding)>;

class ContactCorrector {
 public:
  /// @param rival takes the place of solveCoulombContact(); empty: nothing does.
  explicit ContactCorrector(ContactRival rival = nullptr) : rival_(std::move(rival)) {}

  bool hasRival() const { return static_cast<bool>(rival_); }

  /// Begins a step.
  /// @param sliding tangential velocity of a contact in the warm start, m/s; asked for rivals only.
  void prepare(std::size_t contacts, const std::function<Vector2(std::size_t)>& sliding);

  /// Contacts that have been static so far are held at the static limit (holdContact()) while others still move, each until it is released.
  /// Where many hold one body the first that is visited would otherwise be offered the whole body's change, let go, and the others after it.
  void hold(const ContactProblem& problem);

  /// Releases those that are at the static limit; to be called once all else is solved.
  /// @return there were such.
  bool releaseOverloaded();

  /// Releases all.
  /// @return some were at the static limit.
  bool releaseAll();

  /// Solves u = W r + q for one contact; q contains what closes the gap.
  /// @param before the contact's state so far.
  ContactAnswer solve(std::size_t contact, const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding,
                      ContactState before) {
    Past& past = past_[contact];
    if (past.held != Held::kNo) {
      const ContactAnswer answer = holdContact(W, q, law);
      past.held = answer.state == ContactState::kKinetic ? Held::kAtLimit : Held::kYes;
      return answer;
    }
    unsigned char& flips = past.flips;
    const bool kinetic_limit = was_sliding || flips > kMaxFlips;
    ContactAnswer answer = rival_ ? rival_(W, q, law, kinetic_limit, previous_sliding_[contact])
                                  : solveCoulombContact(W, q, law, kinetic_limit);
    const bool both_touch = answer.state != ContactState::kOpen && before != ContactState::kOpen;
    if (both_touch && answer.state != before && flips <= kMaxFlips) ++flips;
    return answer;
  }

  /// The same for a contact of a step, whose impulse and state are set.
  /// @param W local operator J P^-1 J' with the compliances of the row, 1/kg.
  /// @param u relative velocity with the present impulse, m/s.
  /// @return the change of the impulse, contact frame, N s.
  Vector3 correct(const ContactProblem& problem, std::size_t contact, const Matrix3& W, const Vector3& u,
                  ContactSolution& solution);

 private:
  /// Changes between sticking and sliding a contact may make in one step before it is held to the kinetic limit: with
  /// mu_static > mu_kinetic both can be consistent, and the iteration would cycle between them. Not a few: while the
  /// tissue is far from solved contacts change for other reasons, and a grip that is held to the kinetic limit for them slips.
  static constexpr int kMaxFlips = 24;

  enum class Held : unsigned char { kNo, kYes, kAtLimit };

  struct Past {
    unsigned char flips = 0;
    Held held = Held::kNo;
  };

  ContactRival rival_;
  std::vector<Past> past_;                 ///< per contact, this step
  std::vector<Vector2> previous_sliding_;  ///< per contact, m/s; for rivals only
};

/// A contact that has a normal part only: both coefficients 0.
inline bool isFrictionless(const CoulombLaw& law) { return law.anisotropic == nullptr && law.mu_static == 0.0; }

}  // namespace tissue_contact
