#include "solver/deflation.h"

#include <algorithm>
#include <cstring>

namespace tissue_contact {
namespace {

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
  return total[0] + total[1] + total[2];
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

}  // namespace

void Deflation::beginStep(std::size_t nodes) {
  for (PaddedVectors* all : {&u_, &lower_, &first_, &begun_}) all->resize(nodes);
  along_ = false;
  forths_ = 0;
}

void Deflation::beginForth(const PaddedVectors& v) {
  std::copy(v.begin(), v.end(), begun_.begin());
  followed_ = 0.0;
  ++forths_;
}

void Deflation::beginAlong(const NodalVectors& u, const std::vector<bool>& fixed) {
  pad(u, u_);
  for (std::size_t i = 0; i < u_.size(); ++i) {
    if (fixed[i]) u_[i] = {};
  }
  along_ = true;
}

void Deflation::correct(PaddedVectors& v, PaddedVectors& lower) {
  if (isFirst()) std::copy(v.begin(), v.end(), first_.begin());
  if (along_) {
    const double work = -workOf(begun_.data(), v.data(), lower_.data(), v.size()) - followed_;
    add(work / energy_, u_.data(), v.data(), v.size());
    add(work / energy_, lower_.data(), lower.data(), v.size());
  }
  std::copy(v.begin(), v.end(), begun_.begin());
}

void Deflation::finish(const PaddedVectors& v, NodalVectors& u) const {
  u.resize(3, static_cast<Eigen::Index>(v.size()));
  double* to = u.data();
  for (std::size_t i = 0; i < v.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) *to++ = v[i].at[r] - first_[i].at[r];
  }
}

}  // namespace tissue_contact
