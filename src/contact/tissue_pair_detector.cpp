#include "tissue_contact/contact/tissue_pair_detector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "contact/edge_edge.h"
#include "contact/vertex_face.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("tissue pairs: " + what); }

/// No allocation while all is well.
void requireSameSize(const char* what, std::size_t size, std::size_t expected) {
  if (size == expected) return;
  refuse(std::string(what) + ": " + std::to_string(size) + " given; there must be " + std::to_string(expected));
}

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
  std::vector<std::optional<PairSurface>> surfaces;  ///< per tissue; none for tissues without a pair
  std::vector<Eigen::Index> node_counts;
  VertexFace vertex_face;
  EdgeEdge edge_edge;
  std::vector<bool> placed;  ///< scratch, per tissue

  void place(int tissue, const std::vector<NodalVectors>& positions);
  void detectPair(const SurfacePair& pair, std::vector<Contact>& contacts);
};

TissuePairDetector::TissuePairDetector(std::vector<TouchingTissues> pairs, std::vector<TissueSurface> surfaces,
                                       const std::vector<NodalVectors>& rest)
    : implementation_(std::make_unique<Implementation>()) {
  Implementation& self = *implementation_;
  requireSameSize("positions at rest", rest.size(), surfaces.size());
  requireKnownAndOnce(pairs, surfaces.size());
  self.pairs = std::move(pairs);
  self.surfaces.resize(surfaces.size());
  for (const NodalVectors& one : rest) self.node_counts.push_back(one.cols());
  for (const TouchingTissues& pair : self.pairs) {
    for (const int tissue : {pair.tissue, pair.other}) {
      if (!self.surfaces[tissue]) self.surfaces[tissue].emplace(tissue, std::move(surfaces[tissue]), rest[tissue]);
    }
  }
}

TissuePairDetector::~TissuePairDetector() = default;
TissuePairDetector::TissuePairDetector(TissuePairDetector&&) noexcept = default;
TissuePairDetector& TissuePairDetector::operator=(TissuePairDetector&&) noexcept = default;

void TissuePairDetector::detect(const std::vector<NodalVectors>& positions, double margin_m,
                                const std::vector<bool>& apart, std::vector<Contact>& contacts) {
  Implementation& self = *implementation_;
  if (!(margin_m >= 0.0 && std::isfinite(margin_m)))
    requireNonNegative("tissue pairs: margin", margin_m, "m");  // no string else
  requireSameSize("positions of tissues", positions.size(), self.surfaces.size());
  const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(contacts.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    requireSameSize("nodes of a tissue", positions[i].cols(), self.node_counts[i]);
  }
  self.placed.assign(positions.size(), false);
  for (std::size_t p = 0; p < self.pairs.size(); ++p) {
    if (!apart.empty() && apart[p]) continue;
    const TouchingTissues& pair = self.pairs[p];
    self.place(pair.tissue, positions);
    self.place(pair.other, positions);
    self.detectPair({*self.surfaces[pair.tissue], *self.surfaces[pair.other], margin_m}, contacts);
  }
  const auto order = [](const Contact& a, const Contact& b) {
    return std::tie(a.key, a.gap_m) < std::tie(b.key, b.gap_m);
  };
  std::sort(contacts.begin() + first, contacts.end(), order);
  const auto same = [](const Contact& a, const Contact& b) { return a.key == b.key; };
  contacts.erase(std::unique(contacts.begin() + first, contacts.end(), same), contacts.end());
}

void TissuePairDetector::Implementation::place(int tissue, const std::vector<NodalVectors>& positions) {
  if (!placed[tissue]) surfaces[tissue]->place(positions[tissue]);
  placed[tissue] = true;
}

void TissuePairDetector::Implementation::detectPair(const SurfacePair& pair, std::vector<Contact>& contacts) {
  Eigen::AlignedBox3d near = pair.own.box();
  near.min().array() -= pair.reach();
  near.max().array() += pair.reach();
  if (!near.intersects(pair.other.box())) return;
  pair.own.refit();
  pair.other.refit();
  vertex_face.find(pair, false, contacts);
  if (!pair.folds()) vertex_face.find({pair.other, pair.own, pair.margin}, true, contacts);
  edge_edge.find(pair, contacts);
}

}  // namespace tissue_contact
