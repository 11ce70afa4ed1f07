#include "simulation/fold_watch.h"

namespace tissue_contact {

FoldWatch::FoldWatch(const std::vector<TouchingTissues>& pairs, const std::vector<Tissue>& tissues) {
  bool any = false;
  bodies_.resize(pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const Tissue& tissue = tissues[pairs[p].tissue];
    tissue_.push_back(pairs[p].tissue);
    if (pairs[p].tissue != pairs[p].other || tissue.tetrahedra().empty()) continue;
    if (!isConvex(tissue.restPositions(), tissue.surface())) continue;
    bodies_[p].emplace(tissue.restPositions(), tissue.tetrahedra());
    any = true;
  }
  if (!any) bodies_.clear();
  apart_.assign(bodies_.size(), false);
}

const std::vector<bool>& FoldWatch::apart(const std::vector<NodalVectors>& positions,
                                          const std::vector<double>& travels_m) {
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    apart_[p] = bodies_[p].has_value() && bodies_[p]->cannotFold(positions[tissue_[p]], travels_m[tissue_[p]]);
  }
  return apart_;
}

}  // namespace tissue_contact
