#include "simulation/fold_watch.h"

#include <algorithm>

namespace tissue_contact {

FoldWatch::FoldWatch(const std::vector<TouchingTissues>& pairs, const std::vector<Tissue>& tissues)
    : pairs_(pairs), bodies_(pairs.size()), apart_(pairs.size()) {
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    std::optional<ConvexBody> body = bodyOf(static_cast<int>(t), tissues[t]);
    swapMesh(static_cast<int>(t), body);
  }
}

std::optional<ConvexBody> FoldWatch::bodyOf(int index, const Tissue& tissue) const {
  const auto folds = [&](const TouchingTissues& pair) { return pair.tissue == index && pair.other == index; };
  if (std::none_of(pairs_.begin(), pairs_.end(), folds)) return std::nullopt;
  if (tissue.tetrahedra().empty() || !isConvex(tissue.restPositions(), tissue.surface())) return std::nullopt;
  return ConvexBody(tissue.restPositions(), tissue.tetrahedra());
}

void FoldWatch::swapMesh(int index, std::optional<ConvexBody>& body) {
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (pairs_[p].tissue == index && pairs_[p].other == index) bodies_[p].swap(body);
  }
}

const std::vector<bool>& FoldWatch::apart(const std::vector<NodalVectors>& positions,
                                          const std::vector<double>& travels_m) {
  for (std::size_t p = 0; p < bodies_.size(); ++p) {
    const int tissue = pairs_[p].tissue;
    apart_[p] = bodies_[p].has_value() && bodies_[p]->cannotFold(positions[tissue], travels_m[tissue]);
  }
  return apart_;
}

}  // namespace tissue_contact
