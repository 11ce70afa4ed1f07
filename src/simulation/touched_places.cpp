#include "simulation/touched_places.h"

#include <algorithm>

#include "tissue_contact/mesh/tissue_surface.h"

namespace tissue_contact {

TouchedPlaces::TouchedPlaces(const Scene& scene, const std::vector<Instrument>& instruments) {
  for (const TissueDescription& tissue : scene.tissues) refinements_.push_back(tissue.refinement);
  for (const Instrument& instrument : instruments) {
    std::vector<std::vector<double>>& links = half_extents_.emplace_back();
    for (const ContactLink& link : instrument.contactLinks()) {
      std::vector<double>& shapes = links.emplace_back();
      for (const CollisionShape& shape : link.shapes) shapes.push_back(smallestHalfExtent(shape));
    }
  }
}

double TouchedPlaces::cellUnder(int tissue, int instrument, int contact_link, int shape) const {
  const RefinementDescription& refinement = refinements_[tissue];
  if (refinement.mode == RefinementDescription::Mode::kNever) return 0.0;
  if (refinement.cell_m > 0.0) return refinement.cell_m;
  return half_extents_[instrument][contact_link][shape] / kCellsPerHalfExtent;
}

std::vector<double> TouchedPlaces::cellsOn(int tissue) const {
  std::vector<double> cells;
  if (refinements_[tissue].cell_m > 0.0) cells.push_back(refinements_[tissue].cell_m);
  for (std::size_t i = 0; i < half_extents_.size(); ++i) {
    for (std::size_t l = 0; l < half_extents_[i].size(); ++l) {
      for (std::size_t s = 0; s < half_extents_[i][l].size(); ++s) {
        const double cell = cellUnder(tissue, static_cast<int>(i), static_cast<int>(l), static_cast<int>(s));
        if (cell > 0.0) cells.push_back(cell);
      }
    }
  }
  std::sort(cells.begin(), cells.end());
  return cells;
}

HalfExtents TouchedPlaces::halfExtents() const {
  HalfExtents all;
  for (const auto& links : half_extents_) {
    for (const auto& shapes : links) {
      for (const double half_extent : shapes) {
        if (!(half_extent > 0.0)) continue;  // a flat mesh
        all.smallest_m = all.smallest_m > 0.0 ? std::min(all.smallest_m, half_extent) : half_extent;
        all.largest_m = std::max(all.largest_m, half_extent);
      }
    }
  }
  return all;
}

void TouchedPlaces::add(const std::array<int, 3>& nodes, const Vector3& weights, double cell_m,
                        const NodalVectors& rest) {
  if (cell_m > 0.0) places_.push_back({pointOf(rest, nodes, weights), cell_m});
}

void TouchedPlaces::begin(int tissue, const std::vector<SolvedContact>& contacts, const NodalVectors& rest) {
  tissue_ = tissue;
  touching_.clear();
  places_.clear();
  for (const SolvedContact& solved : contacts) {
    const ContactKey& key = solved.contact.key;
    if (solved.state == ContactState::kOpen) continue;
    if (key.instrument >= 0) {
      if (key.tissue != tissue) continue;
      add(solved.contact.nodes, solved.contact.weights, cellUnder(tissue, key.instrument, key.link, key.shape), rest);
      if (touching_.empty() || !sameShapes(touching_.back(), key)) touching_.push_back(key);  // they follow one another
      continue;
    }
    const double cell_m = refinements_[tissue].cell_m;  // between tissues no shape says how fine
    if (key.tissue == tissue) add(solved.contact.nodes, solved.contact.weights, cell_m, rest);
    if (key.other_tissue == tissue) add(solved.contact.other_nodes, solved.contact.other_weights, cell_m, rest);
  }
}

void TouchedPlaces::addNear(const std::vector<NearPlace>& near, const TissueRefinement& refinement, double ahead_m,
                            const NodalVectors& rest) {
  for (const NearPlace& place : near) {
    const auto touches = [&](const ContactKey& key) {
      return key.instrument == place.instrument && key.link == place.contact_link && key.shape == place.shape;
    };
    if (place.tissue != tissue_ || std::any_of(touching_.begin(), touching_.end(), touches)) continue;
    const double cell_m = cellUnder(tissue_, place.instrument, place.contact_link, place.shape);
    if (place.distance_m < refinement.reach(cell_m) + ahead_m) add(place.nodes, place.weights, cell_m, rest);
  }
}

}  // namespace tissue_contact
