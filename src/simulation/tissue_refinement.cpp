#include "simulation/tissue_refinement.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "tissue/placed_mesh.h"

namespace tissue_contact {
namespace {

/// Where new foci would need cells so many times longer than those that stay have, all get the same: else the first touch would
/// take all nodes.
constexpr double kMostUneven = 2.0;
/// Of the nodes that may come to the mesh that nothing touches: with fewer, cells need not be as long as they had to be before.
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
      body_coarsening_(mesh.body_coarsening),
      nodes_at_most_(
          static_cast<int>(mostNodes(description_.refinement, static_cast<std::size_t>(bisection_.unrefinedNodes())))),
      cells_(description_.refinement) {
  refineWithin(cells_, mesh_);
}

bool TissueRefinement::reset() {
  const bool changes = static_cast<int>(mesh_.parents.size()) != mesh_.lasting;
  cells_.clear();
  refineWithin(cells_, mesh_);
  if (changes) ++revision_;
  return changes;
}

void TissueRefinement::carry(StateArchive& archive) {
  cells_.carry(archive);
  int revision = revision_;
  archive.carry(revision);
  std::uint64_t nodes = static_cast<std::uint64_t>(mesh_.mesh.positions.cols());
  archive.carry(nodes);
  if (!archive.isReading()) return;
  const bool is_same = refineWithin(cells_, mesh_) && static_cast<std::uint64_t>(mesh_.mesh.positions.cols()) == nodes;
  archive.check(is_same, "the mesh comes out another one than that of the state: is the tissue's refinement the same?");
  constexpr int kMostRevisions = 1'000'000'000;
  archive.check(revision >= 0 && revision < kMostRevisions, "a number of meshes that is none");
  revision_ = std::max(revision_, revision) + 1;
}

bool TissueRefinement::refineWithin(const FineCells& cells, BisectedMesh& refined) {
  const auto limit = [&cells](const Vector3& p_T) { return cells.longestEdge(p_T); };
  return bisection_.refine(limit, static_cast<std::size_t>(nodes_at_most_), refined);
}

/// Adds foci with the shortest cells that keep to the number of nodes, in steps of kCoarser: doubles the steps until it does, then
/// halves between. With long enough cells new foci ask for nothing.
void TissueRefinement::refineBeside(const FineCells& kept, const std::vector<FinePlace>& places, NextMesh& next) {
  const auto fits = [&](int steps) {
    double coarsening = kept.coarsening();
    for (int i = 0; i < steps; ++i) coarsening *= kCoarser;
    next.cells = kept;
    next.cells.setCoarsening(coarsening);
    next.cells.add(places);
    return refineWithin(next.cells, next.mesh);
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

NextMesh TissueRefinement::plan(const std::vector<FinePlace>& places) {
  NextMesh next = {cells_, {}, std::nullopt};
  FineCells kept = cells_;
  kept.dropIdle(places);
  const auto come = static_cast<int>(mesh_.parents.size()) - mesh_.lasting;
  const bool has_room = come < kRoom * (nodes_at_most_ - bisection_.unrefinedNodes() - mesh_.lasting);
  if (kept.empty()) {
    kept.setCoarsening(1.0);
  } else if (has_room) {
    kept.setCoarsening(std::max(1.0, kept.coarsening() / kCoarser));
  }
  refineBeside(kept, places, next);
  if (kept.anyFinerThan(next.cells.coarsening() / kMostUneven)) {
    kept.clear();
    refineBeside(kept, places, next);
  }
  const NodalVectors& before = mesh_.mesh.positions;
  const NodalVectors& now = next.mesh.mesh.positions;
  if (now.cols() != before.cols() || now != before) next.transfer = matchNodes(mesh_, next.mesh);
  return next;
}

void TissueRefinement::take(NextMesh& next) {
  std::swap(cells_, next.cells);
  if (!next.transfer) return;
  std::swap(mesh_, next.mesh);
  ++revision_;
}

}  // namespace tissue_contact
