#include "simulation/surface_settling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tissue_contact {
namespace {

/// Time over which a surface leaves what its new triangles cut into; and, of an edge, how deep that is: less is what solves
/// leave, more was there before.
constexpr double kSettlingTime_s = 0.02;
constexpr double kShallowest = 0.01;
constexpr double kDeepest = 0.25;
/// Of an edge: one more bisection or one less makes it some 1.3 times as long.
constexpr double kGrown = 1.2;

}  // namespace

SurfaceSettling::SurfaceSettling(std::size_t tissues, const SurfaceEdges& edges) : edges_(edges), surfaces_(tissues) {}

void SurfaceSettling::clear() { surfaces_.assign(surfaces_.size(), {}); }

void SurfaceSettling::noteCells(int tissue, const std::vector<SolvedContact>& contacts) {
  double finest_m = std::numeric_limits<double>::infinity();
  for (const SolvedContact& solved : contacts) {
    const ContactKey& key = solved.contact.key;
    if (key.tissue != tissue || key.instrument < 0 || solved.state == ContactState::kOpen) continue;
    finest_m = std::min(finest_m, edges_.finer(solved.contact));
  }
  surfaces_[tissue].cell_m = std::isfinite(finest_m) ? finest_m : 0.0;
}

void SurfaceSettling::begin(const std::vector<Contact>& found) {
  for (Surface& surface : surfaces_) {
    if (surface.cell_m == 0.0) continue;
    const auto tissue = static_cast<int>(&surface - surfaces_.data());
    double finest_m = std::numeric_limits<double>::infinity();
    double deepest_m = 0.0;
    for (const Contact& contact : found) {
      if (contact.key.tissue != tissue || contact.key.instrument < 0) continue;
      const double edge_m = edges_.finer(contact);
      finest_m = std::min(finest_m, edge_m);
      const double share = -contact.gap_m / edge_m;
      if (share > kShallowest && share < kDeepest) deepest_m = std::max(deepest_m, -contact.gap_m);
    }
    if (finest_m > kGrown * surface.cell_m && deepest_m > surface.depth_m) {
      surface.depth_m = deepest_m;
      surface.speed_m_per_s = deepest_m / kSettlingTime_s;
    }
    surface.cell_m = 0.0;
  }
}

void SurfaceSettling::advance(double dt) {
  for (Surface& surface : surfaces_) surface.depth_m = std::max(surface.depth_m - surface.speed_m_per_s * dt, 0.0);
}

void SurfaceSettling::carry(StateArchive& archive) {
  for (Surface& surface : surfaces_) {
    archive.carry(surface.depth_m);
    archive.carry(surface.speed_m_per_s);
    archive.check(surface.depth_m >= 0.0 && std::isfinite(surface.depth_m) && surface.speed_m_per_s >= 0.0 &&
                      std::isfinite(surface.speed_m_per_s),
                  "a depth that no surface settles from");
  }
}

}  // namespace tissue_contact
