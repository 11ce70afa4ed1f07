#include "solver/contact_momentum.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace tissue_contact {
namespace {

/// Cosine from which on a normal counts as opposed to a node's first one: three that lock a node are at 120 degrees, and sides of
/// boxes, at 90, are to be told alike however the scene is turned.
constexpr double kOpposed = -0.2;

constexpr int kNone = -1;

}  // namespace

void ContactMomentum::prepare(const ContactProblem& problem) {
  seen_.clear();
  sides_.resize(problem.contacts.size());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    sides_[c].fill(kNone);
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      if (problem.bodies[at.body].asleep || (*problem.bodies[at.body].fixed)[at.node]) continue;
      const double sign = at.weight < 0.0 ? -1.0 : 1.0;
      seen_.push_back({at.body, at.node, row.pair, static_cast<int>(c), a, sign * row.R_WC.col(0)});
    }
  }
  const auto order = [](const Seen& one) { return std::make_tuple(one.body, one.node, one.pair, one.contact); };
  std::sort(seen_.begin(), seen_.end(), [&](const Seen& one, const Seen& two) { return order(one) < order(two); });

  int sides = 0;
  const Seen* first = nullptr;  // of a node and pair
  std::array<int, 2> of_both{};
  for (const Seen& one : seen_) {
    if (first == nullptr || one.body != first->body || one.node != first->node || one.pair != first->pair) {
      first = &one;
      of_both.fill(kNone);
    }
    int& side = of_both[one.normal_W.dot(first->normal_W) < kOpposed ? 1 : 0];
    if (side == kNone) side = sides++;
    sides_[one.contact][one.place] = side;
  }
  sums_.reserve(seen_.capacity());  // no more sides than those; a step that has had as many allocates nothing
  sums_.resize(sides);
}

double ContactMomentum::change(const ContactProblem& problem, const std::vector<Vector3>& before,
                               const std::vector<Vector3>& after) {
  std::fill(sums_.begin(), sums_.end(), Vector3::Zero());
  for (std::size_t c = 0; c < after.size(); ++c) {
    const Vector3 change = after[c] - before[c];
    if (change.isZero(0.0)) continue;
    const ContactRow& row = problem.contacts[c];
    const Vector3 change_W = row.R_WC * change;
    for (int a = 0; a < row.node_count; ++a) {
      if (sides_[c][a] != kNone) sums_[sides_[c][a]] += row.nodes[a].weight * change_W;
    }
  }
  double squared = 0.0;
  for (const Vector3& sum : sums_) squared += sum.squaredNorm();
  return std::sqrt(squared);
}

}  // namespace tissue_contact
