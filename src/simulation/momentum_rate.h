/// @file
/// Room `simulation`, private: how the rate of a tissue's momentum changes from step to step. Momenta in; a force out.
#pragma once

#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Implicit Euler takes for the rate of momentum p at a step's end the difference quotient r = (p - p_before) / dt over the step; the
/// formula of second order (BDF2) adds dt / (dt + dt_before) (r - r_before). That is what the step leaves out of the forces on the
/// tissue, to first order in dt.
class MomentumRate {
 public:
  /// Nothing is known of the step before, as where the mesh has changed.
  void clear() { *this = MomentumRate(); }

  /// Ends a step of `dt`, s. @param momentum of all nodes, N s.
  void step(const Vector3& momentum, double dt) {
    const Vector3 rate = (momentum - momentum_) / dt;
    defect_n_ = known_ >= 2 ? dt / (dt + last_dt_) * (rate - rate_).norm() : 0.0;
    momentum_ = momentum;
    rate_ = rate;
    last_dt_ = dt;
    if (known_ < 2) ++known_;
  }

  double defect() const { return defect_n_; }                       ///< N; 0: not known
  double size() const { return known_ >= 2 ? rate_.norm() : 0.0; }  ///< of the rate itself, N; 0: not known

  void carry(StateArchive& archive) {
    archive.carry(momentum_);
    archive.carry(rate_);
    archive.carry(last_dt_);
    archive.carry(defect_n_);
    archive.carry(known_);
    archive.check(
        momentum_.allFinite() && rate_.allFinite() && defect_n_ >= 0.0 && last_dt_ >= 0.0 && known_ >= 0 && known_ <= 2,
        "a rate of momentum that no tissue has");
  }

 private:
  Vector3 momentum_ = Vector3::Zero();
  Vector3 rate_ = Vector3::Zero();
  double last_dt_ = 0.0;  ///< s
  double defect_n_ = 0.0;
  int known_ = 0;  ///< 1: momentum_, 2: rate_ as well
};

}  // namespace tissue_contact
