#include "tissue_contact/contact/tissue_pair_detector.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "contact/pair/edge_edge.h"
#include "contact/pair/vertex_face.h"
#include "mesh/mesh_checks.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("tissue pairs: " + what); }

void requireKnownAndOnce(const std::vector<TouchingTissues>& pairs, std::size_t tissue_count) {
  std::set<std::pair<int, int>> seen;
  for (const TouchingTissues& pair : pairs) {
    for (const int tissue : {pair.tissue, pair.other}) {
      if (tissue >= 0 && tissue < static_cast<int>(tissue_count)) continue;
      refuse("tissue " + std::to_string(tissue) + " is unknown; it must be in [0, " +
             std::to_string(static_cast<int>(tissue_count) - 1) + "]");
    }
    if (seen.insert(std::minmax({pair.tissue, pair.other})).second) continue;
    refuse("tissues " + std::to_string(pair.tissue) + " and " + std::to_string(pair.other) +
           " are listed twice; each pair must be listed once, in either order");
  }
}

}  // namespace

struct TissuePairDetector::Implementation {
  std::vector<TouchingTissues> pairs;
  SharedSurfaces surfaces;
  VertexFace vertex_face;
  EdgeEdge edge_edge;

  void detectPair(const SurfacePair& pair, const std::vector<ContactKey>& known, std::vector<Contact>& contacts);
};

TissuePairDetector::TissuePairDetector(std::vector<TouchingTissues> pairs, SharedSurfaces surfaces)
    : implementation_(std::make_unique<Implementation>()) {
  requireKnownAndOnce(pairs, surfaces->size());
  implementation_->pairs = std::move(pairs);
  implementation_->surfaces = std::move(surfaces);
}

TissuePairDetector::~TissuePairDetector() = default;
TissuePairDetector::TissuePairDetector(TissuePairDetector&&) noexcept = default;
TissuePairDetector& TissuePairDetector::operator=(TissuePairDetector&&) noexcept = default;

void TissuePairDetector::detect(const std::vector<NodalVectors>& positions, double margin_m,
                                std::vector<Contact>& contacts) {
  detect(positions, std::vector<double>(implementation_->pairs.size(), margin_m), {}, {}, contacts);
}

void TissuePairDetector::detect(const std::vector<NodalVectors>& positions, const std::vector<double>& margins_m,
                                const std::vector<bool>& apart, const std::vector<ContactKey>& known,
                                std::vector<Contact>& contacts) {
  Implementation& self = *implementation_;
  requireCount("margins of pairs of tissues", margins_m.size(), self.pairs.size());
  for (const double margin_m : margins_m) {
    if (!(margin_m >= 0.0 && std::isfinite(margin_m)))
      requireNonNegative("tissue pairs: margin", margin_m, "m");  // no string else
  }
  std::vector<MovingSurface>& surfaces = *self.surfaces;
  placeAll(surfaces, positions);
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(contacts.size());
  for (std::size_t p = 0; p < self.pairs.size(); ++p) {
    if (!apart.empty() && apart[p]) continue;
    self.detectPair({surfaces[self.pairs[p].tissue], surfaces[self.pairs[p].other], margins_m[p]}, known, contacts);
  }
  const auto order = [](const Contact& a, const Contact& b) {
    return std::tie(a.key, a.gap_m) < std::tie(b.key, b.gap_m);
  };
  std::sort(contacts.begin() + first, contacts.end(), order);
  const auto same = [](const Contact& a, const Contact& b) { return a.key == b.key; };
  contacts.erase(std::unique(contacts.begin() + first, contacts.end(), same), contacts.end());
}

void TissuePairDetector::Implementation::detectPair(const SurfacePair& pair, const std::vector<ContactKey>& known,
                                                    std::vector<Contact>& contacts) {
  Eigen::AlignedBox3d near = pair.own.box();
  near.min().array() -= pair.reach();
  near.max().array() += pair.reach();
  if (!near.intersects(pair.other.box())) return;
  vertex_face.find(pair, false, contacts);
  if (!pair.folds()) vertex_face.find({pair.other, pair.own, pair.margin}, true, contacts);
  edge_edge.find(pair, known, contacts);
}

}  // namespace tissue_contact
