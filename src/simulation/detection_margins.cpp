#include "simulation/detection_margins.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace tissue_contact {
namespace {

/// Contacts are looked for this much beyond what present speeds can close in the step.
constexpr double kMarginFactor = 1.5;
constexpr double kMarginPerEdge = 0.01;

/// Beyond so many edges nothing touches in one step; the bound also keeps an overflow of the speeds out.
constexpr double kMostEdges = 1e6;

/// Tissues are looked for this many edges of the coarser one from each other at most: pairs of features grow with the square
/// of it, up to which they are a few for each feature of the finer one.
constexpr double kMostPairEdges = 2.0;

/// A mesh of which no place is more than so many times finer or coarser than the mean is even.
constexpr double kEven = 2.0;

/// Mean length at rest of the sides of the surface's triangles at each node, m; 0 for nodes inside.
VectorX edgesAtNodes(const Tissue& tissue) {
  const NodalVectors& rest = tissue.restPositions();
  VectorX sums = VectorX::Zero(rest.cols());
  VectorX counts = VectorX::Zero(rest.cols());
  for (const Triangle& triangle : tissue.surface()) {
    for (int side = 0; side < 3; ++side) {
      const int ends[] = {triangle[side], triangle[(side + 1) % 3]};
      const double length = (rest.col(ends[0]) - rest.col(ends[1])).norm();
      for (const int node : ends) {
        sums[node] += length;
        counts[node] += 1.0;
      }
    }
  }
  return sums.cwiseQuotient(counts.cwiseMax(1.0));
}

/// Of each tissue one that stands for all that pairs join it to.
std::vector<std::size_t> groupsOf(const std::vector<TouchingTissues>& pairs, std::size_t tissues) {
  std::vector<std::size_t> group(tissues);
  std::iota(group.begin(), group.end(), 0);
  for (const TouchingTissues& pair : pairs) {
    std::replace(group.begin(), group.end(), std::size_t{group[pair.other]}, std::size_t{group[pair.tissue]});
  }
  return group;
}

}  // namespace

SurfaceEdges::SurfaceEdges(const std::vector<Tissue>& tissues) {
  for (const Tissue& tissue : tissues) surfaces_.push_back(lengthsOf(tissue));
}

SurfaceEdges::Lengths SurfaceEdges::lengthsOf(const Tissue& tissue) {
  Lengths lengths;
  const VectorX& edges = lengths.at_nodes = edgesAtNodes(tissue);
  const double mean = lengths.mean = meanSurfaceEdge(&tissue, 1);
  const double finest = (edges.array() > 0.0).select(edges.array(), mean).minCoeff();
  lengths.graded = finest < mean / kEven || edges.maxCoeff() > mean * kEven;
  lengths.largest = lengths.graded ? edges.maxCoeff() : mean;
  return lengths;
}

double SurfaceEdges::at(int tissue, const std::array<int, 3>& nodes, const Vector3& weights) const {
  double edge = 0.0;
  for (int i = 0; i < 3; ++i) edge += weights[i] == 0.0 ? 0.0 : weights[i] * surfaces_[tissue].at_nodes[nodes[i]];
  return edge;
}

double SurfaceEdges::finer(const Contact& contact) const {
  const double own = at(contact.key.tissue, contact.nodes, contact.weights);
  if (contact.key.other_tissue < 0) return own;
  return std::min(own, at(contact.key.other_tissue, contact.other_nodes, contact.other_weights));
}

double SurfaceEdges::scaleAt(int tissue, const std::array<int, 3>& nodes, const Vector3& weights) const {
  return surfaces_[tissue].graded ? at(tissue, nodes, weights) : surfaces_[tissue].largest;
}

double SurfaceEdges::coarserScale(const Contact& contact) const {
  const double own = scaleAt(contact.key.tissue, contact.nodes, contact.weights);
  if (contact.key.other_tissue < 0) return own;
  return std::max(own, scaleAt(contact.key.other_tissue, contact.other_nodes, contact.other_weights));
}

DetectionMargins::DetectionMargins(const SurfaceEdges& edges, std::size_t tissues, std::vector<TouchingTissues> pairs)
    : edges_(edges),
      pairs_(std::move(pairs)),
      group_(groupsOf(pairs_, tissues)),
      ways_m_(tissues, 0.0),
      travels_m_(tissues, 0.0),
      of_tissues_(tissues, 0.0),
      of_pairs_(pairs_.size(), 0.0) {}

void DetectionMargins::begin(const std::vector<NodalVectors>& v, const Vector3& gravity, double dt,
                             double instruments_m) {
  instruments_m_ = instruments_m;
  for (std::size_t t = 0; t < ways_m_.size(); ++t) {
    ways_m_[t] = dt * (std::sqrt(v[t].colwise().squaredNorm().maxCoeff()) + dt * gravity.norm());
  }
  for (std::size_t t = 0; t < travels_m_.size(); ++t) {
    travels_m_[t] = 0.0;
    for (std::size_t other = 0; other < ways_m_.size(); ++other) {
      if (group_[other] == group_[t]) travels_m_[t] = std::max(travels_m_[t], ways_m_[other]);
    }
    of_tissues_[t] = alone(static_cast<int>(t), edges_.largestScale(static_cast<int>(t)));
  }
  for (std::size_t p = 0; p < pairs_.size(); ++p) {
    const double edge = std::max(edges_.largestScale(pairs_[p].tissue), edges_.largestScale(pairs_[p].other));
    of_pairs_[p] = between(pairs_[p].tissue, pairs_[p].other, edge);
  }
}

double DetectionMargins::at(const Contact& contact) const {
  const double edge = edges_.coarserScale(contact);
  if (contact.key.other_tissue < 0) return alone(contact.key.tissue, edge);
  return between(contact.key.tissue, contact.key.other_tissue, edge);
}

/// Of a tissue against instruments.
double DetectionMargins::alone(int tissue, double edge_m) const {
  const double margin = kMarginFactor * (instruments_m_ + travels_m_[tissue]) + kMarginPerEdge * edge_m;
  return std::min(margin, kMostEdges * edge_m);
}

/// The tool counts as well: what it touches in the step gets its speed.
double DetectionMargins::between(int tissue, int other, double edge_m) const {
  return std::min(alone(tissue, edge_m) + kMarginFactor * travels_m_[other], kMostPairEdges * edge_m);
}

}  // namespace tissue_contact
