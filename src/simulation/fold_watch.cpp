#include "simulation/fold_watch.h"

namespace tissue_contact {

FoldWatch::FoldWatch(const std::vector<TouchingTissues>& pairs, const std::vector<Tissue>& tissues)
    : pairs_(pairs), bodies_(pairs.size()), apart_(pairs.size()) {
  for (std::size_t t = 0; t < tissues.size(); ++t) setMesh(static_cast<int>(t), tissues[t]);
}

void FoldWatch::setMesh(int index, const Tissue& tissue) {
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    if (pairs_[p].tissue != index || pairs_[p].other != index) continue;
    bodies_[p].reset();
    if (tissue.tetrahedra().empty() || !isConvex(tissue.restPositions(), tissue.surface())) continue;
    bodies_[p].emplace(tissue.restPositions(), tissue.tetrahedra());
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
