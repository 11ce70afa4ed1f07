/// @file
/// Room `simulation`, private: how the rate of a tissue's momentum changes from step to step. Momenta in; a force out.
#pragma once

#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Implicit Euler takes for the rate of momentum p at a step's end the difference quotient r = (p - p_before) / dt over the step; the
/// formula of second order (BDF2, for equal steps) adds (r - r_before) / 2. So half the change of r is what the step leaves out of the
/// forces on the tissue, to first order in dt.
class MomentumRate {
 public:
  /// Nothing is known of the step before, as where the mesh has changed.
  void clear() { *this = MomentumRate(); }

  /// Ends a step of `dt`, s. @param momentum of all nodes, N s.
  void step(const Vector3& momentum, double dt) {
    const Vector3 rate = (momentum - momentum_) / dt;
    half_change_n_ = known_ >= 2 ? 0.5 * (rate - rate_).norm() : 0.0;
    momentum_ = momentum;
    rate_ = rate;
    if (known_ < 2) ++known_;
  }

  double halfChange() const { return half_change_n_; }  ///< N; 0: not known

  void carry(StateArchive& archive) {
    archive.carry(momentum_);
    archive.carry(rate_);
    archive.carry(half_change_n_);
    archive.carry(known_);
    archive.check(momentum_.allFinite() && rate_.allFinite() && half_change_n_ >= 0.0 && known_ >= 0 && known_ <= 2,
                  "a rate of momentum that no tissue has");
  }

 private:
  Vector3 momentum_ = Vector3::Zero();
  Vector3 rate_ = Vector3::Zero();
  double half_change_n_ = 0.0;
  int known_ = 0;  ///< 1: momentum_, 2: rate_ as well
};

}  // namespace tissue_contact
