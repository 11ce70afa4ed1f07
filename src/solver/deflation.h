/// @file
/// Room `solver`, private: deflation of the sweeps over one body's nodes, a coarse correction on one vector that is kept from step to step.
/// What sweeps are slow to find they were slow to find in the step before: that change of the velocities, u, is kept, and between a sweep
/// forth and the sweep back v goes along it to where the energy v'A v / 2 - (b + J'lambda)'v is least.
///
/// Nicolaides, "Deflation of Conjugate Gradients with Applications to Boundary Value Problems", SIAM J. Numer. Anal. 24 (1987) 355-365;
/// vectors kept from one system to the next: Parks et al., "Recycling Krylov Subspaces for Sequences of Linear Systems", SIAM J. Sci.
/// Comput. 28 (2006) 1651-1674. Figures, and what was tried: doc/notes/method.md.
#pragma once

#include <algorithm>
#include <vector>

#include "core/padded_vectors.h"
#include "solver/residual_measures.h"

namespace tissue_contact {

/// With L, A below the diagonal: a sweep forth from v0 to v leaves the defect -L'(v - v0), since each row was in balance when its turn
/// came; so u'(b + J'lambda - A v) = -(L u)'(v - v0), and L u, half a product with A in each step, is all it takes.
///
/// Nodes that contacts may move have no part in it. They stay where contacts have them, so no contact changes its state by it.
class Deflation {
 public:
  /// What is known of u in a step.
  struct Products {
    double energy = 0.0;   ///< u'A u, J
    double inertia = 0.0;  ///< u'M u, J
    double mass = 0.0;     ///< of all nodes, kg
  };

  /// Begins a step. Allocates only for another number of nodes than before.
  void beginStep(std::size_t nodes);

  /// A sweep forth begins. @param v m/s.
  void beginForth(const PaddedVectors& v);

  /// Where the last sweep forth began, m/s, until correct().
  const PaddedVectors& begun() const { return begun_; }

  /// Between the first sweep forth of a step and what follows it, where there is a u (m/s).
  void beginAlong(const NodalVectors& u, const std::vector<bool>& fixed);
  void exclude(int node) { u_[static_cast<std::size_t>(node)] = {}; }
  /// @param measure given u, makes L u (N s), and returns its products.
  template <class Measure>
  void measure(const Measure& measure) {
    const Products found = measure(u_, lower_);
    // What is round-off has no way to go, and what K, which may be indefinite, takes the energy from leads nowhere.
    along_ = found.inertia > kStillSpeed * kStillSpeed * found.mass && found.energy >= kLeastEnergy * found.inertia;
    energy_ = found.energy;
  }

  /// A node has moved since the sweep forth, which changes L v of node j by `added`, N s; beyond contacts, which have no part in u, of A v
  /// but for what is above the diagonal.
  void follow(int j, const Vector3& added) {
    if (along_) followed_ += added.dot(vectorOf(u_[static_cast<std::size_t>(j)]));
  }

  /// With what contacts moved followed. Moves v (m/s) and `lower`, L v (N s), along u.
  void correct(PaddedVectors& v, PaddedVectors& lower);

  bool isFirst() const { return forths_ == 1; }  ///< sweep forth of this step
  bool hasAlong() const { return along_; }

  /// What else has moved v before the sweep back is found as well, m/s.
  void correctedElsewhere(const PaddedVectors& v) { std::copy(v.begin(), v.end(), begun_.begin()); }

  /// Ends a step of several sweeps forth. @param u becomes what was found since the first of them, m/s.
  /// @param v as the last sweep forth and what followed it left it, before any sweep back.
  void finish(const PaddedVectors& v, NodalVectors& u) const;
  /// The same where a sweep back came last.
  void finish(NodalVectors& u) const { finish(begun_, u); }

  /// Of what mass alone has of it; all of it where K has no negative eigenvalues.
  static constexpr double kLeastEnergy = 0.5;

 private:
  bool along_ = false;     ///< there is a u
  PaddedVectors u_;        ///< m/s; 0 at nodes that are excluded or do not move
  PaddedVectors lower_;    ///< L u, N s
  double energy_ = 0.0;    ///< u'A u, J
  int forths_ = 0;         ///< sweeps forth in this step
  PaddedVectors first_;    ///< what the first of them led to
  PaddedVectors begun_;    ///< where the last one began; from correct() on, where it led
  double followed_ = 0.0;  ///< u'L of what followed it, J
};

}  // namespace tissue_contact
