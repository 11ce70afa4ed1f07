#include "simulation/fine_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tissue_contact {
namespace {

/// Of the reach: once foci change, places farther than this from all get one of their own, or else each would do so at a time of its own.
constexpr double kWellCovered = 0.25;
/// Of the reach: foci lie on a lattice, so that a tool that comes back finds the same mesh. It is fine enough for a place to be
/// covered by its own focus.
constexpr double kLattice = 0.25;

/// In a saved state: each place is compared with each focus, so that more would keep a reader busy for more than some seconds.
constexpr std::size_t kMostFoci = 10'000;
constexpr std::size_t kMostPlaces = 100'000;  // of a contact one to six

void requirePossible(const StateArchive& archive, const Vector3& p_T, double cell_m, double coarsening) {
  constexpr double kMost_m = 1e6;    // so that no product of two overflows
  constexpr double kLeast_m = 1e-9;  // shapes have half extents of 1e-6 and more, and cells a tenth of that
  const bool is_possible = p_T.allFinite() && p_T.cwiseAbs().maxCoeff() <= kMost_m && cell_m >= kLeast_m &&
                           cell_m <= kMost_m && coarsening >= 1.0 && coarsening <= kMost_m;
  archive.check(is_possible, "a place of fine cells, or their length, that no scene has");
}

}  // namespace

double FineCells::reach(double cell_m) const { return reach_m_ > 0.0 ? reach_m_ : cells_of_reach_ * cell_m; }

bool FineCells::covers(const Focus& focus, const FinePlace& place, double share) const {
  return focus.asked_m <= place.cell_m &&
         (focus.p_T - place.p_T).norm() <= share * focus.coarsening * reach(focus.asked_m);
}

bool FineCells::isCovered(const FinePlace& place, double share_of_reach) const {
  return std::any_of(foci_.begin(), foci_.end(),
                     [&](const Focus& focus) { return covers(focus, place, share_of_reach); });
}

/// The longest edge is the diagonal of a cell.
double FineCells::longestEdge(const Vector3& p_T) const {
  double cell = std::numeric_limits<double>::infinity();
  for (const Focus& focus : foci_) {
    const double finest = focus.coarsening * focus.asked_m;
    if (cell <= finest) continue;
    const double reach_m = focus.coarsening * reach(focus.asked_m);
    const double lowers_within = reach_m + (cell - finest) / growth_;
    const double squared = (focus.p_T - p_T).squaredNorm();
    if (!(squared < lowers_within * lowers_within)) continue;  // most are too far: spares a root
    cell = std::min(cell, finest + growth_ * std::max(std::sqrt(squared) - reach_m, 0.0));
  }
  return std::sqrt(3.0) * cell;
}

void FineCells::clear() {
  foci_.clear();
  coarsening_ = 1.0;
}

void FineCells::dropIdle(const std::vector<FinePlace>& places) {
  const auto is_idle = [&](const Focus& focus) {
    return std::none_of(places.begin(), places.end(),
                        [&](const FinePlace& place) { return covers(focus, place, kCovered); });
  };
  foci_.erase(std::remove_if(foci_.begin(), foci_.end(), is_idle), foci_.end());
}

void FineCells::add(const std::vector<FinePlace>& places) {
  for (const FinePlace& place : places) {
    if (isCovered(place, kWellCovered)) continue;
    const double spacing = kLattice * reach(place.cell_m);
    foci_.push_back({spacing * (place.p_T / spacing).array().round().matrix(), place.cell_m, coarsening_});
  }
}

bool FineCells::anyFinerThan(double coarsening) const {
  return std::any_of(foci_.begin(), foci_.end(), [&](const Focus& focus) { return focus.coarsening < coarsening; });
}

void FineCells::carry(StateArchive& archive) {
  archive.carryList(foci_, kMostFoci, [&](Focus& focus) {
    archive.carry(focus.p_T);
    archive.carry(focus.asked_m);
    archive.carry(focus.coarsening);
    requirePossible(archive, focus.p_T, focus.asked_m, focus.coarsening);
  });
  archive.carry(coarsening_);
  requirePossible(archive, Vector3::Zero(), 1.0, coarsening_);
}

void carryPlaces(StateArchive& archive, std::vector<FinePlace>& places) {
  archive.carryList(places, kMostPlaces, [&](FinePlace& place) {
    archive.carry(place.p_T);
    archive.carry(place.cell_m);
    requirePossible(archive, place.p_T, place.cell_m, 1.0);
  });
}

}  // namespace tissue_contact
