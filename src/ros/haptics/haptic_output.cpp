#include "ros/haptics/haptic_output.h"

namespace tissue_contact {
namespace {

/// Cut to a length, also where the square of it would overflow.
Vector3 atMost(double length, const Vector3& vector) {
  const double found = vector.stableNorm();
  return found > length ? Vector3(vector * (length / found)) : vector;
}

}  // namespace

void HapticOutput::take(const Wrench& wrench, std::int64_t now_ns) {
  received_ = true;
  received_ns_ = now_ns;
  const Vector3 force = options_.force_scale * (options_.R_DW * wrench.force);
  const Vector3 torque = options_.torque_scale * (options_.R_DW * wrench.torque);
  if (!force.allFinite() || !torque.allFinite()) {
    ++not_finite_;
    scaled_ = Wrench();
    return;
  }
  scaled_ = {atMost(options_.max_force_n, force), atMost(options_.max_torque_nm, torque)};
}

bool HapticOutput::isStale(std::int64_t now_ns) const {
  return !received_ || static_cast<double>(now_ns - received_ns_) > options_.stale_after_s * 1e9;
}

Wrench HapticOutput::command(std::int64_t now_ns) const { return isStale(now_ns) ? Wrench() : scaled_; }

}  // namespace tissue_contact
