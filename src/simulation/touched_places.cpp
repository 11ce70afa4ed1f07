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
  return half_extents_[instrument][contact_link][shape] / refinement.choice().cells_per_half_extent;
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

/// Places of one shape move alike: the frames of single contacts are tilted as the dimple is, which cancels in their mean.
void TouchedPlaces::addSpeed(std::size_t first, const Vector3& slips_W, double last_dt) {
  if (first == places_.size() || !(last_dt > 0.0)) return;
  const Vector3 velocity_W = slips_W / (-last_dt * static_cast<double>(places_.size() - first));
  for (std::size_t i = first; i < places_.size(); ++i) places_[i].velocity_W = velocity_W;
}

void TouchedPlaces::begin(int tissue, const std::vector<SolvedContact>& contacts, const NodalVectors& rest,
                          double last_dt) {
  tissue_ = tissue;
  touching_.clear();
  places_.clear();
  std::size_t first_of_shape = 0;
  Vector3 slips_W = Vector3::Zero();
  for (const SolvedContact& solved : contacts) {
    const ContactKey& key = solved.contact.key;
    if (solved.state == ContactState::kOpen) continue;
    if (key.instrument >= 0) {
      if (key.tissue != tissue) continue;
      if (touching_.empty() || !sameShapes(touching_.back(), key)) {  // they follow one another
        addSpeed(first_of_shape, slips_W, last_dt);
        first_of_shape = places_.size();
        slips_W.setZero();
        touching_.push_back(key);
      }
      add(solved.contact.nodes, solved.contact.weights, cellUnder(tissue, key.instrument, key.link, key.shape), rest);
      if (solved.state == ContactState::kKinetic) slips_W += solved.slip_W;
      continue;
    }
    addSpeed(first_of_shape, slips_W, last_dt);
    const double cell_m = refinements_[tissue].cell_m;  // between tissues no shape says how fine
    if (key.tissue == tissue) add(solved.contact.nodes, solved.contact.weights, cell_m, rest);
    if (key.other_tissue == tissue) add(solved.contact.other_nodes, solved.contact.other_weights, cell_m, rest);
    first_of_shape = places_.size();
    slips_W.setZero();
  }
  addSpeed(first_of_shape, slips_W, last_dt);
}

void TouchedPlaces::addNear(const std::vector<NearPlace>& near, const FineCells& cells, const Approaching& approaching,
                            const NodalVectors& x, const NodalVectors& rest) {
  for (const NearPlace& place : near) {
    const auto touches = [&](const ContactKey& key) {
      return key.instrument == place.instrument && key.link == place.contact_link && key.shape == place.shape;
    };
    if (place.tissue != tissue_ || std::any_of(touching_.begin(), touching_.end(), touches)) continue;
    const double cell_m = cellUnder(tissue_, place.instrument, place.contact_link, place.shape);
    if (!(cell_m > 0.0) || !(place.distance_m < cells.reach(cell_m) + approaching.ahead_m)) continue;
    const auto& [a, b, c] = place.nodes;
    const Vector3 n = (x.col(b) - x.col(a)).cross(x.col(c) - x.col(a)).stableNormalized();
    const Vector3 p_W = pointOf(x, place.nodes, place.weights);
    const Vector3 v_W = approaching.motion.pointVelocity(place.instrument, place.contact_link, p_W, approaching.dt);
    places_.push_back({pointOf(rest, place.nodes, place.weights), cell_m, v_W - n.dot(v_W) * n,
                       place.distance_m < approaching.touches_m});
  }
}

}  // namespace tissue_contact
