#include "simulation/energy_debt.h"

#include <algorithm>
#include <cmath>

namespace tissue_contact {
namespace {

/// kg m/s.
Vector3 momentum(const VectorX& mass, const NodalVectors& v) {
  Vector3 sum = Vector3::Zero();
  for (Eigen::Index i = 0; i < v.cols(); ++i) sum += mass[i] * v.col(i);
  return sum;
}

double kineticEnergy(const VectorX& mass, const NodalVectors& v) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < v.cols(); ++i) sum += mass[i] * v.col(i).squaredNorm();
  return 0.5 * sum;
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
  was_cut_ = false;
  owed_j_ = 0.0;
}

void EnergyDebt::begin(const NodalVectors& forces, const VectorX& mass, const Vector3& gravity_m_per_s2, bool is_free,
                       NodalVectors& v) {
  double kinetic_j = kineticEnergy(mass, v);
  const auto nodes = static_cast<std::size_t>(v.cols());
  if (!was_cut_ || forces_.size() != nodes) {
    owed_j_ = 0.0;
  } else {
    double work_j = contact_work_j_ + dt_s_ * gravity_m_per_s2.dot(momentum(mass, v));
    for (Eigen::Index i = 0; i < v.cols(); ++i)
      work_j += 0.5 * dt_s_ * (forces_[static_cast<std::size_t>(i)] + forces.col(i)).dot(v.col(i));
    owed_j_ = std::max(0.0, owed_j_ + kinetic_j - kinetic_j_ - work_j);
    const double there_j = kinetic_j - 0.5 * mass.sum() * keptVelocity(mass, is_free, v).squaredNorm();
    const double paid_j = std::min(owed_j_, there_j);
    if (paid_j > 0.0) {
      slowDown(mass, is_free, std::sqrt(1.0 - paid_j / there_j), v);
      owed_j_ -= paid_j;
      kinetic_j -= paid_j;
    }
  }
  forces_.resize(nodes);
  for (std::size_t i = 0; i < nodes; ++i) forces_[i] = forces.col(static_cast<Eigen::Index>(i));
  kinetic_j_ = kinetic_j;
}

void EnergyDebt::finish(double dt_s, double contact_work_j, bool was_cut) {
  dt_s_ = dt_s;
  contact_work_j_ = contact_work_j;
  was_cut_ = was_cut;
}

void EnergyDebt::carry(StateArchive& archive, Eigen::Index nodes) {
  archive.carry(was_cut_);
  if (!was_cut_) {
    if (archive.isReading()) clear();
    return;
  }
  if (archive.isReading()) forces_.assign(static_cast<std::size_t>(nodes), Vector3::Zero());
  archive.carry(forces_);
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
