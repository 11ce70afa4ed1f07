#include "simulation/tissue_refinement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "tissue/placed_mesh.h"

namespace tissue_contact {
namespace {

constexpr double kCellsOfReach = 3.0;
/// Of the reach: a contact that far from a focus has as much of fine cells beyond it.
constexpr double kCovered = 0.5;
/// Of the reach: once foci change, places farther than this from all get one of their own, or else each would do so at a time of its own.
constexpr double kWellCovered = 0.25;
/// Of the reach: foci lie on a lattice, so that a tool that comes back finds the same mesh. It is fine enough for a place to be
/// covered by its own focus.
constexpr double kLattice = 0.25;
/// Where new foci would need cells so many times longer than those that stay have, all get the same: else the first touch would
/// take all nodes.
constexpr double kMostUneven = 2.0;
/// Of the nodes that may come to the unrefined mesh: with fewer, cells need not be as long as they had to be before.
constexpr double kRoom = 0.6;
constexpr double kCoarser = 1.189207115002721;  // fourth root of 2

std::array<int, 2> sorted(const std::array<int, 2>& edge) {
  return {std::min(edge[0], edge[1]), std::max(edge[0], edge[1])};
}

/// Nodes of the unrefined mesh are the same, and those that halve the same edge.
NodeTransfer matchNodes(const BisectedMesh& before, const BisectedMesh& now) {
  const int unrefined = now.unrefinedNodes();
  NodeTransfer transfer;
  transfer.to_new.assign(static_cast<std::size_t>(before.mesh.positions.cols()), -1);
  transfer.from_old.assign(static_cast<std::size_t>(now.mesh.positions.cols()), -1);
  transfer.parents = now.parents;
  std::iota(transfer.to_new.begin(), transfer.to_new.begin() + unrefined, 0);
  std::iota(transfer.from_old.begin(), transfer.from_old.begin() + unrefined, 0);
  std::map<std::array<int, 2>, int> halving;  // an edge, lower node first: the node before in the middle of it
  for (std::size_t k = 0; k < before.parents.size(); ++k) {
    halving[sorted(before.parents[k])] = unrefined + static_cast<int>(k);
  }
  for (std::size_t k = 0; k < now.parents.size(); ++k) {  // parents come before
    const int a = transfer.from_old[now.parents[k][0]];
    const int b = transfer.from_old[now.parents[k][1]];
    const auto same = a < 0 || b < 0 ? halving.end() : halving.find(sorted({a, b}));
    if (same == halving.end()) continue;
    const int node = unrefined + static_cast<int>(k);
    transfer.from_old[node] = same->second;
    transfer.to_new[same->second] = node;
  }
  return transfer;
}

}  // namespace

NodalVectors NodeTransfer::carried(const NodalVectors& before) const {
  NodalVectors now(3, static_cast<Eigen::Index>(from_old.size()));
  const std::size_t unrefined = from_old.size() - parents.size();
  for (std::size_t i = 0; i < from_old.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (from_old[i] >= 0) {
      now.col(column) = before.col(from_old[i]);
    } else {
      const std::array<int, 2>& ends = parents[i - unrefined];
      now.col(column) = 0.5 * (now.col(ends[0]) + now.col(ends[1]));
    }
  }
  return now;
}

TissueRefinement::TissueRefinement(const TissueDescription& description, const Pose& X_WT, const MeshSizeCheck& on_size,
                                   const MeshPreparation& preparation)
    : TissueRefinement(refinableMesh(description, on_size, preparation), X_WT) {}

TissueRefinement::TissueRefinement(RefinableMesh&& mesh, const Pose& X_WT)
    : description_(std::move(mesh.description)),
      X_WT_(X_WT),
      X_TW_(X_WT.inverse()),
      bisection_(std::move(mesh.bisection)),
      nodes_at_most_(
          static_cast<int>(mostNodes(description_.refinement, static_cast<std::size_t>(bisection_.unrefinedNodes())))) {
  refineWithin(mesh_);
}

bool TissueRefinement::reset() {
  const bool changes = !mesh_.parents.empty();
  foci_.clear();
  coarsening_ = 1.0;
  refineWithin(mesh_);
  if (changes) ++revision_;
  return changes;
}

void TissueRefinement::carry(StateArchive& archive) {
  constexpr std::size_t kMost = 100'000;
  constexpr double kMost_m = 1e6;  // so that no product of two overflows
  const auto require = [&](const Vector3& p_T, double cell_m, double coarsening) {
    const bool is_possible = p_T.cwiseAbs().maxCoeff() <= kMost_m && cell_m >= 1.0 / kMost_m && cell_m <= kMost_m &&
                             coarsening >= 1.0 && coarsening <= kMost_m;
    archive.check(is_possible, "a place of fine cells, or their length, that no scene has");
  };
  archive.carryList(foci_, kMost, [&](Focus& focus) {
    archive.carry(focus.p_T);
    archive.carry(focus.asked_m);
    archive.carry(focus.coarsening);
    require(focus.p_T, focus.asked_m, focus.coarsening);
  });
  archive.carryList(places_, kMost, [&](Place& place) {
    archive.carry(place.p_T);
    archive.carry(place.cell_m);
    require(place.p_T, place.cell_m, 1.0);
  });
  archive.carry(coarsening_);
  require(Vector3::Zero(), 1.0, coarsening_);
  int revision = revision_;
  archive.carry(revision);
  std::uint64_t nodes = static_cast<std::uint64_t>(mesh_.mesh.positions.cols());
  archive.carry(nodes);
  if (!archive.isReading()) return;
  const bool is_same = refineWithin(mesh_) && static_cast<std::uint64_t>(mesh_.mesh.positions.cols()) == nodes;
  archive.check(is_same, "the mesh comes out another one than that of the state");
  constexpr int kMostRevisions = 1'000'000'000;
  archive.check(revision >= 0 && revision < kMostRevisions, "a number of meshes that is none");
  revision_ = std::max(revision_, revision) + 1;
}

double TissueRefinement::reach(double cell_m) const {
  const double asked = description_.refinement.reach_m;
  return asked > 0.0 ? asked : kCellsOfReach * cell_m;
}

bool TissueRefinement::covers(const Focus& focus, const Place& place, double share) const {
  return focus.asked_m <= place.cell_m &&
         (focus.p_T - place.p_T).norm() <= share * focus.coarsening * reach(focus.asked_m);
}

bool TissueRefinement::isCovered(const Place& place, double share) const {
  return std::any_of(foci_.begin(), foci_.end(), [&](const Focus& focus) { return covers(focus, place, share); });
}

/// The longest edge is the diagonal of a cell.
double TissueRefinement::longestEdge(const Vector3& p_T) const {
  double cell = std::numeric_limits<double>::infinity();
  for (const Focus& focus : foci_) {
    const double finest = focus.coarsening * focus.asked_m;
    if (cell <= finest) continue;
    const double reach_m = focus.coarsening * reach(focus.asked_m);
    const double lowers_within = reach_m + (cell - finest) / kGrowth;
    const double squared = (focus.p_T - p_T).squaredNorm();
    if (!(squared < lowers_within * lowers_within)) continue;  // most are too far: spares a root
    cell = std::min(cell, finest + kGrowth * std::max(std::sqrt(squared) - reach_m, 0.0));
  }
  return std::sqrt(3.0) * cell;
}

/// Those near to which nothing touches.
void TissueRefinement::dropFoci() {
  const auto is_idle = [&](const Focus& focus) {
    return std::none_of(places_.begin(), places_.end(),
                        [&](const Place& place) { return covers(focus, place, kCovered); });
  };
  foci_.erase(std::remove_if(foci_.begin(), foci_.end(), is_idle), foci_.end());
}

/// Of places that none covers.
void TissueRefinement::addFoci() {
  for (const Place& place : places_) {
    if (isCovered(place, kWellCovered)) continue;
    const double spacing = kLattice * reach(place.cell_m);
    foci_.push_back({spacing * (place.p_T / spacing).array().round().matrix(), place.cell_m, coarsening_});
  }
}

bool TissueRefinement::refineWithin(BisectedMesh& refined) {
  const auto limit = [this](const Vector3& p_T) { return longestEdge(p_T); };
  return bisection_.refine(limit, static_cast<std::size_t>(nodes_at_most_), refined);
}

/// Adds foci with the shortest cells that keep to the number of nodes, in steps of kCoarser: doubles the steps until it does, then
/// halves between. With long enough cells new foci ask for nothing.
void TissueRefinement::refineBeside(const std::vector<Focus>& kept, BisectedMesh& refined) {
  const double start = coarsening_;
  const auto fits = [&](int steps) {
    coarsening_ = start;
    for (int i = 0; i < steps; ++i) coarsening_ *= kCoarser;
    foci_ = kept;
    addFoci();
    return refineWithin(refined);
  };
  if (fits(0)) return;
  int enough = 1;
  while (!fits(enough)) enough *= 2;
  int too_few = enough / 2;
  int tried = enough;
  while (enough - too_few > 1) {
    tried = (too_few + enough) / 2;
    (fits(tried) ? enough : too_few) = tried;
  }
  if (tried != enough) fits(enough);
}

std::optional<NodeTransfer> TissueRefinement::follow(const std::vector<TouchedPlace>& places) {
  places_.clear();
  for (const TouchedPlace& place : places) {  // of nodes that have run away not even weights are finite
    if (place.rest_W.allFinite()) places_.push_back({X_TW_ * place.rest_W, place.cell_m});
  }
  if (std::all_of(places_.begin(), places_.end(), [&](const Place& place) { return isCovered(place, kCovered); })) {
    return std::nullopt;
  }
  dropFoci();
  const int unrefined = bisection_.unrefinedNodes();
  const bool has_room = static_cast<double>(mesh_.parents.size()) < kRoom * (nodes_at_most_ - unrefined);
  if (foci_.empty() || has_room) coarsening_ = foci_.empty() ? 1.0 : std::max(1.0, coarsening_ / kCoarser);
  const std::vector<Focus> kept = foci_;
  BisectedMesh refined;
  refineBeside(kept, refined);
  const auto is_finer = [&](const Focus& focus) { return coarsening_ > kMostUneven * focus.coarsening; };
  if (std::any_of(kept.begin(), kept.end(), is_finer)) {
    coarsening_ = 1.0;
    refineBeside({}, refined);
  }
  const NodalVectors& before = mesh_.mesh.positions;
  if (refined.mesh.positions.cols() == before.cols() && refined.mesh.positions == before) return std::nullopt;
  NodeTransfer transfer = matchNodes(mesh_, refined);
  mesh_ = std::move(refined);
  ++revision_;
  return transfer;
}

}  // namespace tissue_contact
