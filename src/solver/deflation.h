/// @file
/// Room `solver`, private: deflation of the sweeps over one body's nodes. What sweeps are slow to find they were slow to find in the step
/// before: that change of the velocities, u, is kept, and between a sweep forth and the sweep back v goes along it to where the energy
/// v'A v / 2 - (b + J'lambda)'v is least.
///
/// Nicolaides, "Deflation of Conjugate Gradients with Applications to Boundary Value Problems", SIAM J. Numer. Anal. 24 (1987) 355-365;
/// vectors kept from one system to the next: Parks et al., "Recycling Krylov Subspaces for Sequences of Linear Systems", SIAM J. Sci.
/// Comput. 28 (2006) 1651-1674. Figures, and what was tried: doc/method.md.
#pragma once

#include <memory>

#include "core/padded_vectors.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Takes no product with A: a sweep forth makes sum_{j<i} A_ij v_j of every node i (`lower` below), so of u, a difference of two of its
/// results, L u is known, L being A below the diagonal. A sweep forth from v0 to v leaves the defect -L'(v - v0), since each row was
/// in balance when its turn came; hence u'(b + J'lambda - A v) = -(L u)'(v - v0).
///
/// Nodes that contacts may move have no part in it. They stay where contacts have them, so no contact changes its state by it. L u is
/// that of the A of its step; where A has changed since, v goes a little too far or not far enough, and the next sweeps see to that.
class Deflation {
 public:
  void forget() { kept_ = false; }

  /// Begins a step. Allocates only for a body of another size than before.
  void prepare(const BodySystem& body);

  /// A node that a contact may move in this step; before the first follow().
  void exclude(int node);

  /// A sweep forth begins. @param v m/s.
  void beginForth(const PaddedVectors& v);

  /// A contact has moved a node by `change` (m/s) since the sweep forth: adds to `lower` what that makes of the nodes after it.
  void follow(int node, const Vector3& change, PaddedVectors& lower);

  /// Between a sweep forth, with what contacts moved followed, and the sweep back. Moves v and `lower` (N s) along.
  void correct(PaddedVectors& v, PaddedVectors& lower);

  /// Ends a step: what was found since its first sweep forth is kept.
  /// @param v as the last sweep forth and what followed it left it, before any sweep back. @param lower of that v.
  void finish(const PaddedVectors& v, const PaddedVectors& lower);
  /// The same where a sweep back came last.
  void finish(const PaddedVectors& lower) { finish(begun_, lower); }

 private:
  void goAlong(PaddedVectors& v, PaddedVectors& lower);
  void rescale();
  void clear(int node);
  double dampingScale() const { return body_->D != nullptr ? body_->damping_scale : 0.0; }
  Matrix3 diagonal(int node) const;
  template <class Use>
  void forFollowers(int node, const Use& use) const;

  const BodySystem* body_ = nullptr;
  std::shared_ptr<const BlockPattern> pattern_;  ///< of the body that u belongs to
  double stiffness_scale_ = 0.0;                 ///< of L u
  double damping_scale_ = 0.0;

  bool kept_ = false;     ///< there is a u
  PaddedVectors u_;       ///< m/s; 0 at nodes that are excluded or do not move
  PaddedVectors lower_;   ///< L u, N s
  double energy_ = 0.0;   ///< u'A u, J
  double inertia_ = 0.0;  ///< what mass has in it, J

  int forths_ = 0;             ///< sweeps forth in this step
  PaddedVectors first_;        ///< what the first of them led to
  PaddedVectors first_lower_;  ///< and its sums
  PaddedVectors begun_;        ///< where the last one began; from correct() on, where it led
  double most_gained_ = 0.0;   ///< by the first correction of this step, J
  double followed_ = 0.0;      ///< u'L of what followed it, J
};

}  // namespace tissue_contact
