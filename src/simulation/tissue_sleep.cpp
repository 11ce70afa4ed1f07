#include "simulation/tissue_sleep.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tissue_contact {
namespace {

/// Of the allowed sum, so that what falls asleep does not wake at the next breath.
constexpr double kMargin = 0.5;

/// Solves of one step in which sleepers wake ring by ring; after them all wake.
constexpr int kMostRepeats = 3;

}  // namespace

TissueSleep::TissueSleep(const std::vector<bool>& fixed, const BodySystem& body, double edge_m,
                         double attachment_n_per_m, bool by_parts)
    : fixed_(fixed), body_(body), radius_(kStillPerEdge * edge_m), by_parts_(by_parts), still_(fixed) {
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i]) continue;
    ++free_nodes_;
    own_force_ += edge_m * body.K->diagonal[i].trace() / 3.0;
  }
  own_force_ = std::max(0.0, own_force_ - edge_m * attachment_n_per_m);  // K has the springs of attachments in it
  if (free_nodes_ > 0) own_force_ /= free_nodes_;
  const bool any_fixed = free_nodes_ < static_cast<int>(fixed.size());
  may_drift_ = !any_fixed && attachment_n_per_m == 0.0;
  if (!any_fixed && !may_drift_) own_force_ = std::min(own_force_, edge_m * attachment_n_per_m);
  near_.resize(fixed.size());
  wakeAll();
}

void TissueSleep::wakeAll() {
  still_ = fixed_;
  sleepers_.clear();
  still_checks_.assign(fixed_.size(), 0);
  anchors_.setConstant(3, static_cast<Eigen::Index>(fixed_.size()), std::numeric_limits<double>::quiet_NaN());
  since_check_ = 0.0;
  held_force_ = 0.0;
}

void TissueSleep::carry(StateArchive& archive) {
  archive.carry(still_);
  archive.carry(anchors_);
  archive.carry(still_checks_);
  archive.carry(since_check_);
  archive.carry(held_force_);
  if (!archive.isReading()) return;
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    archive.check(still_[i] || !fixed_[i], "a fixed node that moves");
  }
  listSleepers();
}

void TissueSleep::wakeRing(int node) {
  wake(node);
  body_.K->pattern->forRow(node, [this](int other, int /*place*/) { wake(other); });
}

void TissueSleep::touch(int node) {
  if (sleepers_.empty() || !still_[node] || fixed_[node]) return;
  if (allAsleep()) {
    wakeAll();
    return;
  }
  wakeRing(node);
  listSleepers();
}

/// What holding a node takes: what its equation of motion leaves with v = 0.
Vector3 TissueSleep::heldBy(int node, const NodalVectors& loads, const NodalVectors& v, double dt) const {
  Vector3 held = loads.col(node) - body_.stiffness_scale / dt * body_.K->offDiagonalProduct(node, v);
  if (body_.D != nullptr) held -= body_.damping_scale / dt * body_.D->offDiagonalProduct(node, v);
  return held;
}

bool TissueSleep::wakeHeld(const NodalVectors& loads, const NodalVectors& v, double dt, double allowed_n, int repeats,
                           std::vector<int>& woken) {
  woken.clear();
  if (allAsleep()) return false;
  held_.reserve(still_.size());  // once for all
  held_.resize(sleepers_.size());
  for (std::size_t s = 0; s < sleepers_.size(); ++s) {
    const int node = sleepers_[s];
    held_[s] = beside_awake_[s] ? heldBy(node, loads, v, dt).norm() : loads.col(node).norm();
  }
  held_force_ = std::accumulate(held_.begin(), held_.end(), 0.0);
  if (held_force_ <= allowed_n) return false;
  woken.reserve(still_.size());  // once for all
  woken = sleepers_;
  if (repeats >= kMostRepeats) {
    wakeAll();
    return true;
  }
  const double share = kMargin * allowed_n / sleepers();
  for (std::size_t s = 0; s < sleepers_.size(); ++s) {
    if (held_[s] > share) wakeRing(sleepers_[s]);
  }
  listSleepers();
  const auto asleep = [this](int node) { return static_cast<bool>(still_[node]); };
  woken.erase(std::remove_if(woken.begin(), woken.end(), asleep), woken.end());
  return true;
}

void TissueSleep::listSleepers() {
  sleepers_.clear();
  beside_awake_.clear();
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (fixed_[i] || !still_[i]) continue;
    sleepers_.push_back(static_cast<int>(i));
    bool beside_awake = false;
    body_.K->pattern->forRow(sleepers_.back(),
                             [&](int other, int /*place*/) { beside_awake = beside_awake || !still_[other]; });
    beside_awake_.push_back(beside_awake);
  }
}

bool TissueSleep::isTimeToCheck(double dt) {
  if (allAsleep()) return false;
  since_check_ += dt;
  if (since_check_ < kCheckTime) return false;
  since_check_ = 0.0;
  return true;
}

bool TissueSleep::rest(const NodalVectors& x, const NodalVectors& loads, double allowed_n,
                       const std::vector<int>& touched) {
  if (may_drift_) return false;
  countStillTime(x);
  if (!by_parts_ && !touched.empty()) return false;
  findReady(loads, allowed_n, touched);
  if (touched.empty()) {
    // Without a contact nothing tells the quiet part of a swing from rest but that all of the tissue is quiet.
    double held = held_force_;
    for (const int node : ready_) held += loads.col(node).norm();
    if (static_cast<int>(ready_.size()) + sleepers() < free_nodes_ || !(held <= allowed_n)) return false;
    held_force_ = held;
  } else if (static_cast<double>(ready_.size()) < kWorthwhile * free_nodes_) {
    return false;
  }
  for (const int node : ready_) still_[node] = true;
  listSleepers();
  return !ready_.empty();
}

/// Who has been still, and for how long.
void TissueSleep::countStillTime(const NodalVectors& x) {
  constexpr unsigned char kMost = 255;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    unsigned char& checks = still_checks_[i];
    if ((x.col(i) - anchors_.col(i)).squaredNorm() <= radius_ * radius_) {
      if (checks < kMost) ++checks;
    } else {
      checks = 0;
      anchors_.col(i) = x.col(i);
    }
  }
}

/// The nodes that may fall asleep.
void TissueSleep::findReady(const NodalVectors& loads, double allowed_n, const std::vector<int>& touched) {
  std::fill(near_.begin(), near_.end(), false);
  for (const int node : touched) {
    near_[node] = true;
    body_.K->pattern->forRow(node, [this](int other, int /*place*/) { near_[other] = true; });
  }
  constexpr double kChecks = kStillTime / kCheckTime;
  const double share = touched.empty() ? allowed_n : kMargin * allowed_n / free_nodes_;
  ready_.clear();
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (still_[i] || near_[i] || still_checks_[i] < kChecks) continue;
    if (loads.col(static_cast<Eigen::Index>(i)).norm() <= share) ready_.push_back(static_cast<int>(i));
  }
}

}  // namespace tissue_contact
