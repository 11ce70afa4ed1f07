#include "simulation/moving_tissue.h"

#include <algorithm>
#include <cmath>

#include "simulation/advisor.h"
#include "simulation/element_inversion.h"
#include "simulation/free_body.h"

namespace tissue_contact {

MovingTissue::MovingTissue(const Scene& scene, ElasticModel model, const Tissue& tissue, NodalVectors& x,
                           NodalVectors& v, BodySystem& system)
    : scene_(scene),
      model_(model),
      tissue_(tissue),
      x_(x),
      v_(v),
      system_(system),
      loads_(NodalVectors::Zero(3, tissue.nodeCount())) {
  reset();
  watchSleep(meanSurfaceEdge(&tissue_, 1));
}

void MovingTissue::watchSleep(double edge_m) {
  sleep_.reset();
  if (!advisedSleep(scene_) || tissue_.elasticity().hasMemory()) return;
  sleep_.emplace(tissue_.fixed(), system_, edge_m, tissue_.attachmentStiffness(), advisedSleepByParts(scene_));
  system_.fixed = &sleep_->still();
}

void MovingTissue::changeMesh(std::unique_ptr<Elasticity::State>& elastic_state, double edge_m) {
  for (int i = 0; i < tissue_.nodeCount(); ++i) {
    if (!tissue_.fixed()[i]) continue;
    x_.col(i) = tissue_.restPositions().col(i);
    v_.col(i).setZero();
  }
  loads_.setZero(3, tissue_.nodeCount());
  system_.b.setZero(3, tissue_.nodeCount());
  system_.mass = tissue_.nodeMasses();
  sleep_.reset();
  elastic_state_.swap(elastic_state);
  makeState();
  energy_debt_.clear();
  momentum_rate_.clear();
  watchSleep(edge_m);
}

void MovingTissue::changeMaterials() {
  sleep_.reset();
  elastic_state_ = tissue_.elasticity().makeStateAfter(*elastic_state_, x_);
  makeState();
  watchSleep(meanSurfaceEdge(&tissue_, 1));
  still_changed_ = false;
  energy_debt_.clear();
  momentum_rate_.clear();
}

void MovingTissue::reset() {
  x_ = tissue_.restPositions();
  elastic_state_.reset();
  stop();
}

void MovingTissue::stop() {
  v_.setZero(3, tissue_.nodeCount());
  // What a body remembers comes from positions alone: where they were still good, only the answer was not.
  if (elastic_state_ && !(tissue_.elasticity().hasMemory() && loads_.allFinite())) {
    elastic_state_.reset();  // or else a large tissue would hold two for a moment
  }
  if (!loads_.allFinite()) loads_.setZero();  // nothing saves or reads them again: the next step finds its own
  makeState();
  if (sleep_) sleep_->wakeAll();
  still_changed_ = false;
  energy_debt_.clear();
  momentum_rate_.clear();
}

void MovingTissue::carry(StateArchive& archive) {
  if (archive.isReading()) reset();
  if (system_.b.cols() == 0) {  // no step has been taken
    system_.b.setZero(3, tissue_.nodeCount());
    system_.mass = tissue_.nodeMasses();
  }
  archive.carry(x_);
  archive.carry(v_);
  archive.carry(loads_);
  archive.check(x_.allFinite() && v_.allFinite() && loads_.allFinite() && x_.cwiseAbs().maxCoeff() <= kMost &&
                    v_.cwiseAbs().maxCoeff() <= kMost,
                "a position, speed or force that no tissue has");
  elastic_state_->carry(archive);
  archive.carry(system_.b);
  archive.carry(system_.mass);
  archive.carry(system_.stiffness_scale);
  archive.carry(system_.damping_scale);
  archive.carry(still_changed_);
  energy_debt_.carry(archive, tissue_.nodeCount());
  momentum_rate_.carry(archive);
  if (sleep_) sleep_->carry(archive);
}

void MovingTissue::makeState() {
  if (!elastic_state_) elastic_state_ = tissue_.elasticity().makeState();
  elastic_state_->adapt_rotations = scene_.advisor.adapt_rotations;
  system_.K = &elastic_state_->stiffness;
  system_.D = elastic_state_->damping.rows() > 0 ? &elastic_state_->damping : nullptr;
  system_.fixed = sleep_ ? &sleep_->still() : &tissue_.fixed();
  system_.stiff_parts = &tissue_.stiffParts();
  const std::vector<bool>& fixed = tissue_.fixed();
  is_free_ = std::find(fixed.begin(), fixed.end(), true) == fixed.end() && tissue_.attachmentStiffness() == 0.0;
  if (is_free_) rigid_.resize(3, tissue_.nodeCount());
  system_.x = &x_;
  is_fast_.reserve(static_cast<std::size_t>(tissue_.nodeCount()));
}

void MovingTissue::wake(const std::vector<int>& touched) {
  const int before = sleepers();
  if (before == 0) return;
  for (const int node : touched) sleep_->touch(node);
  if (sleepers() != before) still_changed_ = true;
}

void MovingTissue::assemble(double dt) {
  system_.asleep = sleep_ && sleep_->allAsleep();
  if (system_.asleep) return energy_debt_.clear();
  if (still_changed_) tissue_.elasticity().holdStill(sleep_->still(), x_, *elastic_state_);
  still_changed_ = false;
  elastic_state_->step_s = dt;
  tissue_.elasticity().update(x_, *elastic_state_, loads_);
  tissue_.addPressure(x_, loads_);
  energy_debt_.begin(loads_, tissue_.nodeMasses(), scene_.gravity_m_per_s2, is_free_, v_);
  system_.stiffness_scale = dt * (dt + tissue_.damping().stiffness_s);
  system_.damping_scale = system_.D != nullptr ? dt : 0.0;
  system_.mass = (1.0 + dt * tissue_.damping().mass_per_s) * tissue_.nodeMasses();
  const Vector3 fall = dt * scene_.gravity_m_per_s2;
  system_.b.resize(3, tissue_.nodeCount());
  double squared = 0.0;
  Vector3 net = Vector3::Zero();
  for (int i = 0; i < tissue_.nodeCount(); ++i) {
    const double mass = tissue_.nodeMasses()[i];
    Vector3 b = Vector3::Zero();
    if (!(*system_.fixed)[i]) b = mass * v_.col(i) + dt * loads_.col(i) + mass * fall;
    system_.b.col(i) = b;
    const Vector3 change = b - system_.mass[i] * v_.col(i);
    squared += change.squaredNorm();
    net += change;
  }
  // Lazy: Eigen's outer product would allocate.
  if (sleep_) loads_ += scene_.gravity_m_per_s2.lazyProduct(tissue_.nodeMasses().transpose());
  system_.change_n_s = std::sqrt(squared);
  system_.net_change_n_s = is_free_ ? net.norm() : -1.0;
  const bool turns = is_free_ && model_ != ElasticModel::kLinear;  // its forces do not turn with it
  if (turns && sleepers() == 0) letTurn(tissue_.nodeMasses(), x_, v_, dt, rigid_, system_);
}

bool MovingTissue::wakeHeld(std::optional<double> pressing_n, double dt, int repeats) {
  if (!sleep_ || !sleep_->wakeHeld(loads_, v_, dt, allowedHeldForce(pressing_n), repeats, woken_)) return false;
  for (const int node : woken_) system_.b.col(node) = dt * loads_.col(node);  // they were at rest
  still_changed_ = true;
  return true;
}

/// What the sleepers may be held by in all, N.
double MovingTissue::allowedHeldForce(std::optional<double> pressing_n) const {
  return scene_.advisor.sleep_error * (pressing_n ? *pressing_n : sleep_->ownForce());
}

bool MovingTissue::isPossible(double dt) const {
  return system_.asleep ||
         (v_.allFinite() && v_.cwiseAbs().maxCoeff() <= kMost && (x_ + dt * v_).cwiseAbs().maxCoeff() <= kMost);
}

void MovingTissue::keepElements(double dt) {
  if (system_.asleep) return;
  const double share = shareBeforeInversion(tissue_, x_, v_, dt, is_fast_);
  if (share < 1.0) slowDown(tissue_.nodeMasses(), is_free_, share, v_);
}

void MovingTissue::move(double dt, double contact_work_j, bool was_cut, bool is_free_of_contact) {
  if (system_.asleep) {
    momentum_rate_.clear();
    return;
  }
  energy_debt_.finish(dt, contact_work_j, was_cut, is_free_of_contact);
  momentum_rate_.step(v_ * tissue_.nodeMasses(), dt);
  x_ += dt * v_;
  if (tissue_.elasticity().hasMemory()) elastic_state_->elapsed_s += dt;
}

void MovingTissue::fallAsleep(std::optional<double> pressing_n, const std::vector<int>& touched) {
  if (!sleep_->rest(x_, loads_, allowedHeldForce(pressing_n), touched)) return;
  still_changed_ = true;
  for (int i = 0; i < tissue_.nodeCount(); ++i) {
    if (sleep_->still()[i]) v_.col(i).setZero();
  }
}

}  // namespace tissue_contact
