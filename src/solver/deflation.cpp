#include "solver/deflation.h"

#include <algorithm>
#include <cstring>

namespace tissue_contact {
namespace {

TISSUE_CONTACT_INLINE double sum(const Lanes& lanes) { return lanes[0] + lanes[1] + lanes[2]; }

/// (to - from)'along, over all nodes.
TISSUE_CONTACT_CLONES
double workOf(const PaddedVector* from, const PaddedVector* to, const PaddedVector* along, std::size_t nodes) {
  Lanes total = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < nodes; ++i) {
    Lanes a, b, direction;
    load(from[i], a);
    load(to[i], b);
    load(along[i], direction);
    total += (b - a) * direction;
  }
  return sum(total);
}

/// to += scale * from.
TISSUE_CONTACT_CLONES
void add(double scale, const PaddedVector* from, PaddedVector* to, std::size_t nodes) {
  for (std::size_t i = 0; i < nodes; ++i) {
    Lanes more, all;
    load(from[i], more);
    load(to[i], all);
    all += scale * more;
    std::memcpy(&to[i], &all, sizeof(Lanes));
  }
}

/// to = from - to.
TISSUE_CONTACT_CLONES
void subtractFrom(const PaddedVector* from, PaddedVector* to, std::size_t nodes) {
  for (std::size_t i = 0; i < nodes; ++i) {
    Lanes a, b;
    load(from[i], a);
    load(to[i], b);
    a -= b;
    std::memcpy(&to[i], &a, sizeof(Lanes));
  }
}

Eigen::Map<const Vector3> at(const PaddedVectors& vectors, int node) {
  return Eigen::Map<const Vector3>(vectors[static_cast<std::size_t>(node)].at.data());
}

}  // namespace

void Deflation::prepare(const BodySystem& body) {
  body_ = &body;
  forths_ = 0;
  if (pattern_ != body.K->pattern) forget();
  pattern_ = body.K->pattern;
  for (PaddedVectors* all : {&u_, &lower_, &first_, &first_lower_, &begun_}) {
    all->resize(static_cast<std::size_t>(body.K->rows()));
  }
  if (kept_) rescale();
  stiffness_scale_ = body.stiffness_scale;
  damping_scale_ = dampingScale();
  for (int i = 0; kept_ && i < body.K->rows(); ++i) {
    if ((*body.fixed)[static_cast<std::size_t>(i)]) clear(i);
  }
}

/// To another length of the step. Where damping differs by region, L u has two parts that are not known apart.
void Deflation::rescale() {
  if (body_->stiffness_scale == stiffness_scale_ && dampingScale() == damping_scale_) return;
  if (dampingScale() != 0.0 || damping_scale_ != 0.0) return forget();
  const double ratio = body_->stiffness_scale / stiffness_scale_;
  for (PaddedVector& vector : lower_) vectorOf(vector) *= ratio;
  energy_ = inertia_ + ratio * (energy_ - inertia_);
}

/// A_ii.
Matrix3 Deflation::diagonal(int node) const {
  const auto i = static_cast<std::size_t>(node);
  Matrix3 block = body_->stiffness_scale * body_->K->diagonal[i];
  if (body_->D != nullptr) block += body_->damping_scale * body_->D->diagonal[i];
  block.diagonal().array() += body_->mass[node];
  return block;
}

/// Calls use(j, A_ji) for the nodes j after i = `node` that share an element with it.
template <class Use>
void Deflation::forFollowers(int node, const Use& use) const {
  const auto followers = [&](const BlockMatrix& matrix, double scale) {
    matrix.pattern->forRow(node, [&](int j, int place) {
      if (j > node) use(j, scale * matrix.block(place).transpose());  // A is symmetric
    });
  };
  followers(*body_->K, body_->stiffness_scale);
  if (body_->D != nullptr) followers(*body_->D, body_->damping_scale);
}

/// u without a node's part e: its energy is less by 2 e'A u - e'A e.
void Deflation::clear(int node) {
  const Vector3 e = at(u_, node);
  if (e.isZero(0.0)) return;
  const Vector3 own = diagonal(node) * e;
  Vector3 product = at(lower_, node) + own;  // A u
  forFollowers(node, [&](int j, const Matrix3& block) {
    product += block.transpose() * at(u_, j);
    vectorOf(lower_[static_cast<std::size_t>(j)]) -= block * e;
  });
  energy_ -= e.dot(2.0 * product - own);
  inertia_ -= body_->mass[node] * e.squaredNorm();
  vectorOf(u_[static_cast<std::size_t>(node)]).setZero();
}

void Deflation::exclude(int node) {
  if (kept_) clear(node);
}

void Deflation::beginForth(const PaddedVectors& v) {
  std::copy(v.begin(), v.end(), begun_.begin());
  followed_ = 0.0;
  ++forths_;
}

void Deflation::follow(int node, const Vector3& change, PaddedVectors& lower) {
  forFollowers(node, [&](int j, const Matrix3& block) {
    const Vector3 added = block * change;
    vectorOf(lower[static_cast<std::size_t>(j)]) += added;
    if (kept_) followed_ += added.dot(at(u_, j));
  });
}

void Deflation::goAlong(PaddedVectors& v, PaddedVectors& lower) {
  const double work = -workOf(begun_.data(), v.data(), lower_.data(), v.size()) - followed_;
  const double way = work / energy_;
  const double gain = work * way;
  if (forths_ == 1) most_gained_ = gain;
  // More than before is to be gained where u leads away, since A is another one now. A u without energy has no way either.
  if (!(gain >= 0.0 && gain <= most_gained_)) return forget();
  add(way, u_.data(), v.data(), v.size());
  add(way, lower_.data(), lower.data(), v.size());
}

void Deflation::correct(PaddedVectors& v, PaddedVectors& lower) {
  if (forths_ == 1) {
    std::copy(v.begin(), v.end(), first_.begin());
    std::copy(lower.begin(), lower.end(), first_lower_.begin());
  }
  if (kept_) goAlong(v, lower);
  std::copy(v.begin(), v.end(), begun_.begin());
}

void Deflation::finish(const PaddedVectors& v, const PaddedVectors& lower) {
  if (forths_ < 2) return;
  subtractFrom(v.data(), first_.data(), v.size());
  subtractFrom(lower.data(), first_lower_.data(), v.size());
  u_.swap(first_);
  lower_.swap(first_lower_);
  kept_ = true;
  energy_ = 0.0;
  inertia_ = 0.0;
  for (int i = 0; i < body_->K->rows(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    const auto u = at(u_, i);
    inertia_ += body_->mass[i] * u.squaredNorm();
    energy_ += u.dot(2.0 * at(lower_, i) + body_->stiffness_scale * (body_->K->diagonal[place] * u));
    if (body_->D != nullptr) energy_ += body_->damping_scale * u.dot(body_->D->diagonal[place] * u);
  }
  energy_ += inertia_;
}

}  // namespace tissue_contact
