#include "simulation/energy_debt.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tissue_contact {
namespace {

/// kg m/s.
Vector3 momentum(const VectorX& mass, const NodalVectors& v) {
  Vector3 sum = Vector3::Zero();
  for (Eigen::Index i = 0; i < v.cols(); ++i) sum += mass[i] * v.col(i);
  return sum;
}

/// That of the centre of mass of a free body.
Vector3 keptVelocity(const VectorX& mass, bool is_free, const NodalVectors& v) {
  return is_free ? Vector3(momentum(mass, v) / mass.sum()) : Vector3(0.0, 0.0, 0.0);
}

}  // namespace

void slowDown(const VectorX& mass, bool is_free, double share, NodalVectors& v) {
  const Vector3 kept = keptVelocity(mass, is_free, v);
  for (Eigen::Index i = 0; i < v.cols(); ++i) v.col(i) = kept + share * (v.col(i) - kept);
}

void EnergyDebt::clear() {
  forces_.clear();
  dt_s_ = 0.0;
  owed_j_ = 0.0;
}

void EnergyDebt::begin(const NodalVectors& forces, const VectorX& mass, const Vector3& gravity_m_per_s2, bool is_free,
                       NodalVectors& v) {
  const auto nodes = static_cast<std::size_t>(v.cols());
  const bool follows = forces_.size() == nodes && dt_s_ > 0.0 && counts_;
  forces_.resize(nodes, Vector3::Zero());
  // One way through memory, since it is gone in every step.
  double twice_kinetic_j = 0.0;
  double power_w = 0.0;  // twice that of the mean of the forces at both ends
  Vector3 momentum = Vector3::Zero();
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const Vector3 at = v.col(column);
    const Vector3 force_n = forces.col(column);
    twice_kinetic_j += mass[column] * at.squaredNorm();
    momentum += mass[column] * at;
    power_w += (forces_[i] + force_n).dot(at);
    forces_[i] = force_n;
  }
  const double before_j = kinetic_j_;
  kinetic_j_ = 0.5 * twice_kinetic_j;
  const double step_s = std::exchange(dt_s_, 0.0);  // until this one ends
  if (!follows) {
    owed_j_ = 0.0;
    return;
  }
  const double work_j = contact_work_j_ + step_s * (gravity_m_per_s2.dot(momentum) + 0.5 * power_w);
  owed_j_ = std::max(0.0, (was_cut_ ? owed_j_ : 0.0) + kinetic_j_ - before_j - work_j);
  if (!(owed_j_ > 0.0)) return;
  const double there_j = kinetic_j_ - 0.5 * mass.sum() * keptVelocity(mass, is_free, v).squaredNorm();
  const double paid_j = std::min(owed_j_, there_j);
  if (!(paid_j > 0.0)) return;
  slowDown(mass, is_free, std::sqrt(1.0 - paid_j / there_j), v);
  owed_j_ -= paid_j;
  kinetic_j_ -= paid_j;
}

void EnergyDebt::finish(double dt_s, double contact_work_j, bool was_cut, bool is_free_of_contact) {
  dt_s_ = dt_s;
  contact_work_j_ = contact_work_j;
  was_cut_ = was_cut;
  counts_ = was_cut || is_free_of_contact;
}

void EnergyDebt::carry(StateArchive& archive, Eigen::Index nodes) {
  bool follows = !forces_.empty() && dt_s_ > 0.0;
  archive.carry(follows);
  if (!follows) {
    if (archive.isReading()) clear();
    return;
  }
  if (archive.isReading()) forces_.assign(static_cast<std::size_t>(nodes), Vector3::Zero());
  archive.carry(forces_);
  archive.carry(was_cut_);
  archive.carry(counts_);
  archive.carry(kinetic_j_);
  archive.carry(dt_s_);
  archive.carry(contact_work_j_);
  archive.carry(owed_j_);
  archive.check(std::all_of(forces_.begin(), forces_.end(), [](const Vector3& force) { return force.allFinite(); }) &&
                    std::isfinite(kinetic_j_) && std::isfinite(dt_s_) && dt_s_ > 0.0 &&
                    std::isfinite(contact_work_j_) && std::isfinite(owed_j_) && owed_j_ >= 0.0,
                "an energy or force that no tissue has");
}

}  // namespace tissue_contact
