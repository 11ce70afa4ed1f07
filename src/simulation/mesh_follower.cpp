#include "simulation/mesh_follower.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tissue_contact {
namespace {

/// Of the reach of a focus: beyond it what touches has its mesh within the step. Cells are longer there by growth times half the reach.
constexpr double kLost = 1.5;

/// Of the reach: sliding is foreseen no farther ahead than this, since what moves that fast turns or stops before long.
constexpr double kFarthestAhead = 3.5;

/// Of the reach: how far off what comes nearer is looked for; a tool of 1 mm has its mesh in time up to some .4 m/s.
constexpr double kFarthestApproach = 17.0;

}  // namespace

MeshFollower::MeshFollower(const MeshUsers& users, TissueRefinement& refinement, BackgroundWorker& worker)
    : users_(users), refinement_(refinement), worker_(worker) {}

double MeshFollower::lead(double dt) { return std::max(kLead_s, 2.0 * dt); }

double MeshFollower::ahead(double travel_m, double dt, double reach_m) {
  const double foreseen_m = lead(dt) / dt * travel_m;  // infinite, or no number, if dt is tiny
  return foreseen_m < kFarthestApproach * reach_m ? foreseen_m : kFarthestApproach * reach_m;
}

ComingMesh* MeshFollower::follow(const std::vector<TouchedPlace>& places, const NodalVectors& x, double last_dt) {
  touched_ = !places.empty();
  if (pending_ && !is_given_) goOn();
  const bool is_due = pending_ && isDue(x, last_dt);
  if (is_due && worker_.wait(ticket_)) ++moves_.waited;
  if (is_due && comingKeeps(places)) {
    ComingMesh* const taken = take();
    if (taken != nullptr) ++moves_.prepared;
    return taken;
  }
  const auto is_lost = [&](const TouchedPlace& one) { return one.touches && !isCovered(one, 0.0, kLost); };
  const bool is_first = last_dt == 0.0;  // nobody waits for it
  if (is_due || (is_first ? !areCovered(places, 0.0) : std::any_of(places.begin(), places.end(), is_lost))) {
    drop();
    listPlaces(places, lead(last_dt));
    makeMesh();
    ComingMesh* const taken = take();
    if (taken != nullptr) ++moves_.at_once;
    return taken;
  }
  if (pending_ || areCovered(places, lead(last_dt))) return nullptr;
  listPlaces(places, 2.0 * lead(last_dt));  // the next one cannot be there any sooner
  begin();
  return nullptr;
}

/// Begins a step while a mesh is being prepared. @return whether it is to be used from now on.
bool MeshFollower::isDue(const NodalVectors& x, double last_dt) {
  constexpr double kRounding = 1.0 - 1e-9;  // of sums of time steps
  elapsed_s_ += last_dt;
  ++steps_;
  if (steps_ >= 2 && elapsed_s_ >= kRounding * kLead_s) return true;
  const bool is_next = elapsed_s_ + last_dt >= kRounding * kLead_s;
  if (!has_snapshot_ && (is_next || elapsed_s_ >= kRounding * kMeshTime_s)) beginState(x);
  return false;
}

bool MeshFollower::isCovered(const TouchedPlace& touched, double ahead_s, double share) const {
  return !touched.rest_W.allFinite() || refinement_.cells().isCovered(placeAhead(touched, ahead_s), share);
}

/// @return whether what touches now is not lost on the prepared mesh, so that it is not made coarse under load.
bool MeshFollower::comingKeeps(const std::vector<TouchedPlace>& places) const {
  if (error_ || !coming_.next.transfer) return true;
  return std::none_of(places.begin(), places.end(), [&](const TouchedPlace& one) {
    return one.touches && one.rest_W.allFinite() && !coming_.next.cells.isCovered(placeAhead(one, 0.0), kLost);
  });
}

/// @return whether all will lie well within what is fine in so much time.
bool MeshFollower::areCovered(const std::vector<TouchedPlace>& places, double ahead_s) const {
  return std::all_of(places.begin(), places.end(),
                     [&](const TouchedPlace& one) { return isCovered(one, ahead_s, FineCells::kCovered); });
}

FinePlace MeshFollower::placeAhead(const TouchedPlace& touched, double ahead_s) const {
  const bool is_known = touched.velocity_W.allFinite();
  const Vector3 way_W = is_known ? Vector3(ahead_s * touched.velocity_W) : Vector3(Vector3::Zero());
  const double farthest = kFarthestAhead * refinement_.cells().reach(touched.cell_m);
  const double share = way_W.norm() > farthest ? farthest / way_W.norm() : 1.0;
  return {refinement_.worldToTissue() * Vector3(touched.rest_W + share * way_W), touched.cell_m};
}

/// Those of now first, then those between there and where they will be.
void MeshFollower::listPlaces(const std::vector<TouchedPlace>& touched, double ahead_s) {
  places_.clear();
  for (const TouchedPlace& one : touched) {  // of nodes that have run away not even weights are finite
    if (one.rest_W.allFinite()) places_.push_back(placeAhead(one, 0.0));
  }
  std::size_t k = 0;
  for (const TouchedPlace& one : touched) {
    if (!one.rest_W.allFinite()) continue;
    const FinePlace from = places_[k++];
    const FinePlace to = placeAhead(one, ahead_s);
    const double apart = FineCells::kCovered * refinement_.cells().reach(one.cell_m);
    const auto parts = static_cast<int>(std::ceil((to.p_T - from.p_T).norm() / apart));
    for (int i = 1; i <= parts; ++i) places_.push_back({from.p_T + i * (to.p_T - from.p_T) / parts, one.cell_m});
  }
}

void MeshFollower::begin() {
  pending_ = true;
  elapsed_s_ = 0.0;
  steps_ = 0;
  has_snapshot_ = false;
  goOn();
}

void MeshFollower::beginState(const NodalVectors& x) {
  snapshot_ = x;
  has_snapshot_ = true;
  ticket_ = worker_.start([this] { makeState(); });
}

void MeshFollower::goOn() {
  if (!pending_) return;
  is_given_ = true;
  ticket_ = worker_.start([this] { makeMesh(); });
  if (has_snapshot_) ticket_ = worker_.start([this] { makeState(); });
}

void MeshFollower::makeMesh() {
  error_ = nullptr;
  try {
    coming_ = ComingMesh();
    coming_.next = refinement_.plan(places_);
    if (coming_.next.transfer) makeParts(refinement_.tissue(coming_.next.mesh), users_, coming_);
  } catch (...) {
    error_ = std::current_exception();
  }
}

void MeshFollower::makeState() {
  if (error_ || !coming_.next.transfer) return;
  try {
    makeStateAt(coming_.next.transfer->carried(snapshot_), coming_);
  } catch (...) {
    error_ = std::current_exception();
  }
}

/// The mesh is ready.
ComingMesh* MeshFollower::take() {
  pending_ = false;
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  const bool moves = coming_.next.transfer.has_value();
  refinement_.take(coming_.next);
  return moves ? &coming_ : nullptr;
}

void MeshFollower::pause() {
  if (pending_) worker_.wait(ticket_);
}

void MeshFollower::drop() {
  pause();
  pending_ = false;
}

void MeshFollower::carry(StateArchive& archive, int nodes) {
  archive.carry(pending_);
  if (archive.isReading()) is_given_ = false;
  if (!pending_) return;
  carryPlaces(archive, places_);
  archive.carry(elapsed_s_);
  archive.carry(steps_);
  archive.check(elapsed_s_ >= 0.0 && elapsed_s_ <= 1e9 && steps_ >= 0 && steps_ <= 1'000'000'000,
                "a mesh begun at a time that is none");
  archive.carry(has_snapshot_);
  if (has_snapshot_) {
    snapshot_.resize(3, nodes);
    archive.carry(snapshot_);
    archive.check(snapshot_.allFinite() && snapshot_.cwiseAbs().maxCoeff() <= 1e9, "a position that no tissue has");
  }
}

}  // namespace tissue_contact
