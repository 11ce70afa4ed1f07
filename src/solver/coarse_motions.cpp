#include "solver/coarse_motions.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace tissue_contact {
namespace {

constexpr int kFar = std::numeric_limits<int>::max();

/// Room for more than that, so that another mesh of about as many nodes needs none.
template <class Value>
void makeRoom(std::size_t size, std::vector<Value>& values) {
  if (values.capacity() < size) values.reserve(size + size / 2);
}

/// 3 x 6, column by column, and two more: what the motions of a node, three shifts and three turns, bring to a row, N s.
using Six = std::array<double, 20>;

/// to += scale * from.
template <std::size_t kSize>
TISSUE_CONTACT_INLINE void addTo(double scale, const std::array<double, kSize>& from, std::array<double, kSize>& to) {
  static_assert(kSize % kLanes == 0);
  for (std::size_t k = 0; k < kSize; k += kLanes) {
    Lanes more, all;
    std::memcpy(&more, &from[k], sizeof(Lanes));
    std::memcpy(&all, &to[k], sizeof(Lanes));
    all += scale * more;
    std::memcpy(&to[k], &all, sizeof(Lanes));
  }
}

/// A block (column by column, `stride` apart) times (I, -[x]).
TISSUE_CONTACT_INLINE void multiply(const double* block, std::size_t stride, double scale, const double* x, Six& to) {
  double a[9];
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) a[r + 3 * c] = scale * block[stride * (r + 3 * c)];
  }
  for (std::size_t k = 0; k < 9; ++k) to[k] = a[k];
  for (std::size_t r = 0; r < 3; ++r) {
    to[9 + r] = x[1] * a[6 + r] - x[2] * a[3 + r];
    to[12 + r] = x[2] * a[r] - x[0] * a[6 + r];
    to[15 + r] = x[0] * a[3 + r] - x[1] * a[r];
  }
}

/// (I, -[x])' of that.
TISSUE_CONTACT_INLINE void multiplyFromLeft(const double* x, const Six& from, std::array<double, 36>& to) {
  for (std::size_t c = 0; c < 6; ++c) {
    const double* const f = &from[3 * c];
    double* const t = &to[6 * c];
    for (std::size_t r = 0; r < 3; ++r) t[r] = f[r];
    t[3] = x[1] * f[2] - x[2] * f[1];
    t[4] = x[2] * f[0] - x[0] * f[2];
    t[5] = x[0] * f[1] - x[1] * f[0];
  }
}

using Share = CoarseMotions::Share;

/// What sums over rows read and write.
struct SumWork {
  const BodySystem& body;
  const std::vector<unsigned char>& takes_part;
  const PaddedVectors& place;
  const std::vector<std::size_t>& first;
  const std::vector<Share>& shares;
  std::size_t parts;
  std::vector<std::array<double, 36>>& sums;
};

/// What parts have in a row, and which do: a bit each.
struct PartRows {
  std::array<Six, CoarseMotions::kMostParts> of;
  unsigned met = 0;
};

TISSUE_CONTACT_INLINE void addShares(const SumWork& all, std::size_t node, const Six& product, PartRows& row) {
  for (std::size_t k = all.first[node]; k < all.first[node + 1]; ++k) {
    const Share& share = all.shares[k];
    if ((row.met >> share.part & 1U) == 0) row.of[share.part] = Six{};
    row.met |= 1U << share.part;
    addTo(share.weight, product, row.of[share.part]);
  }
}

/// A_ii / 2 and A_ij, j > i, of one of the matrices.
TISSUE_CONTACT_INLINE void addRow(const SumWork& all, std::size_t i, const BlockMatrix& matrix, double scale,
                                  double mass, PartRows& row) {
  const BlockPattern& pattern = *matrix.pattern;
  Six product{};
  double own[9];
  for (std::size_t m = 0; m < 9; ++m) own[m] = 0.5 * (scale * matrix.diagonal[i].data()[m] + (m % 4 == 0 ? mass : 0.0));
  multiply(own, 1, 1.0, all.place[i].at.data(), product);
  addShares(all, i, product, row);
  const auto lane_of = static_cast<std::size_t>(pattern.lane_of[i]);
  const std::size_t slice = lane_of / kLanes, lane = lane_of % kLanes;
  for (auto k = static_cast<std::size_t>(pattern.first[slice]); k < static_cast<std::size_t>(pattern.first[slice + 1]);
       ++k) {
    const auto j = static_cast<std::size_t>(pattern.columns[kLanes * k + lane]);
    if (j == i) return;  // no more blocks
    if (all.takes_part[j] == 0) continue;
    multiply(&matrix.values[k].at[0][lane], kLanes, scale, all.place[j].at.data(), product);
    addShares(all, j, product, row);
  }
}

/// Half of Z'A Z, whose transpose is the other half.
template <bool kDamped>
TISSUE_CONTACT_INLINE void sumRows(const SumWork& all) {
  PartRows row;
  for (std::size_t i = 0; i < all.takes_part.size(); ++i) {
    if (all.takes_part[i] == 0) continue;
    row.met = 0;
    addRow(all, i, *all.body.K, all.body.stiffness_scale, all.body.mass[static_cast<Eigen::Index>(i)], row);
    if (kDamped) addRow(all, i, *all.body.D, all.body.damping_scale, 0.0, row);
    for (std::size_t q = 0; q < all.parts; ++q) {
      if ((row.met >> q & 1U) == 0) continue;
      std::array<double, 36> sum;
      multiplyFromLeft(all.place[i].at.data(), row.of[q], sum);
      for (std::size_t k = all.first[i]; k < all.first[i + 1]; ++k) {
        addTo(all.shares[k].weight, sum, all.sums[all.shares[k].part * all.parts + q]);
      }
    }
  }
}

TISSUE_CONTACT_CLONES void runSumRows(const SumWork& all) {
  if (all.body.D != nullptr) {
    sumRows<true>(all);
  } else {
    sumRows<false>(all);
  }
}

bool hasBlocks(const BlockPattern& pattern, int node) {
  bool has = false;
  pattern.forRow(node, [&](int /*j*/, int /*place*/) { has = true; });
  return has;
}

}  // namespace

void CoarseMotions::begin(const BodySystem& body, const std::vector<int>& excluded) {
  any_ = false;
  if (body.x == nullptr) return;
  if (pattern_ != body.K->pattern) findParts(*body.K->pattern);
  pattern_ = body.K->pattern;
  if (parts_ == 0) return;
  const std::vector<bool>& fixed = *body.fixed;
  takes_part_.resize(fixed.size());
  for (std::size_t i = 0; i < fixed.size(); ++i) takes_part_[i] = fixed[i] || first_[i] == first_[i + 1] ? 0 : 1;
  for (const int node : excluded) takes_part_[static_cast<std::size_t>(node)] = 0;
  const auto taking_part = static_cast<std::size_t>(std::count(takes_part_.begin(), takes_part_.end(), 1));
  if (taking_part < kLeastNodes) return;
  place(*body.x);
  any_ = factor(body);
}

/// Visits the nodes around one, nearest first.
/// @param visit called with a node and its hops over the blocks of a pattern; whether to go on from there.
template <class Visit>
void CoarseMotions::spread(const BlockPattern& pattern, int from, const Visit& visit) {
  front_.clear();
  if (visit(from, 0)) front_.emplace_back(from, 0);
  for (std::size_t done = 0; done < front_.size(); ++done) {
    const auto [node, hops] = front_[done];
    pattern.forRow(node, [&, next = hops + 1](int j, int /*place*/) {
      if (visit(j, next)) front_.emplace_back(j, next);
    });
  }
}

/// As far from each other over the blocks as can be, one after the other; the first far from the first node. So they depend on the pattern
/// alone, and a step on no step before.
void CoarseMotions::findParts(const BlockPattern& pattern) {
  const auto nodes = static_cast<std::size_t>(pattern.nodes);
  makeRoom(nodes, front_);
  makeRoom(nodes, joined_);
  makeRoom(nodes, nearest_);
  makeRoom(nodes, takes_part_);
  makeRoom(nodes, place_);
  joined_.clear();
  for (int i = 0; i < pattern.nodes; ++i) {
    if (hasBlocks(pattern, i)) joined_.push_back(i);
  }
  parts_ = std::min(kMostParts, joined_.size() / kLeastNodes);
  if (parts_ == 0) return;
  const auto begin = [&] { nearest_.assign(nodes, kFar); };
  const auto take = [&](int middle) {
    spread(pattern, middle, [&](int node, int hops) {
      int& at = nearest_[static_cast<std::size_t>(node)];
      if (at <= hops) return false;
      at = hops;
      return true;
    });
  };
  const auto farthest = [&] {
    return *std::max_element(joined_.begin(), joined_.end(), [&](int a, int b) {
      return nearest_[static_cast<std::size_t>(a)] < nearest_[static_cast<std::size_t>(b)];
    });
  };
  begin();
  take(joined_.front());
  std::array<int, kMostParts> middles{};
  for (std::size_t p = 0; p < parts_; ++p) {
    middles[p] = farthest();
    if (p == 0) begin();
    take(middles[p]);
  }
  int reach = 0;
  for (const int node : joined_) {
    const int at = nearest_[static_cast<std::size_t>(node)];
    if (at != kFar) reach = std::max(reach, at);
  }
  blend(pattern, middles, reach + 1);
}

/// Weights that fall to 0 at `end` hops from a part's middle, and sum up to 1 at each node.
void CoarseMotions::blend(const BlockPattern& pattern, const std::array<int, kMostParts>& middles, int end) {
  const auto nodes = static_cast<std::size_t>(pattern.nodes);
  met_.clear();
  nearest_.assign(nodes, -1);  // the part that came last
  makeRoom(nodes + 1, first_);
  first_.assign(nodes + 1, 0);
  for (std::size_t p = 0; p < parts_; ++p) {
    spread(pattern, middles[p], [&](int node, int hops) {
      int& last = nearest_[static_cast<std::size_t>(node)];
      if (hops >= end || last == static_cast<int>(p)) return false;
      last = static_cast<int>(p);
      const double near = 1.0 - hops / static_cast<double>(end);
      makeRoom(met_.size() + 1, met_);
      met_.push_back({static_cast<std::size_t>(node), {p, near * near}});
      ++first_[static_cast<std::size_t>(node) + 1];
      return true;
    });
  }
  for (std::size_t i = 0; i < nodes; ++i) first_[i + 1] += first_[i];
  makeRoom(met_.size(), shares_);
  shares_.resize(met_.size());
  for (const auto& [node, share] : met_) shares_[first_[node]++] = share;  // first_ of the next one then
  for (std::size_t i = nodes; i > 0; --i) first_[i] = first_[i - 1];
  first_[0] = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    double sum = 0.0;
    for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) sum += shares_[k].weight;
    for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) shares_[k].weight /= sum;
  }
}

/// Where the nodes are, and what parts are about.
void CoarseMotions::place(const NodalVectors& x) {
  Vector3 low = x.col(0), high = low;
  for (Eigen::Index i = 1; i < x.cols(); ++i) {
    low = low.cwiseMin(x.col(i));
    high = high.cwiseMax(x.col(i));
  }
  const Vector3 middle = 0.5 * (low + high);
  const double size = std::max(0.5 * (high - low).norm(), std::numeric_limits<double>::min());
  place_.resize(static_cast<std::size_t>(x.cols()));
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const Vector3 at = (x.col(static_cast<Eigen::Index>(i)) - middle) / size;
    place_[i] = {{at.x(), at.y(), at.z(), 0.0}};
  }
  struct Moments {
    double weight = 0.0;
    Vector3 first = Vector3::Zero();
    double second = 0.0;
  };
  std::array<Moments, kMostParts> moments;
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (takes_part_[i] == 0) continue;
    const Vector3 at = vectorOf(place_[i]);
    for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) {
      Moments& of = moments[shares_[k].part];
      of.weight += shares_[k].weight;
      of.first += shares_[k].weight * at;
      of.second += shares_[k].weight * at.squaredNorm();
    }
  }
  about_middle_.resize(parts_);
  for (std::size_t p = 0; p < parts_; ++p) {
    const Moments& of = moments[p];
    about_middle_[p].setIdentity();
    if (!(of.weight > 0.0)) continue;
    const Vector3 c = of.first / of.weight;
    constexpr double kLeastRadius = 0.01;  // parts that little is left of: what is less turns on round-off
    const double radius = std::max(std::sqrt(std::max(of.second / of.weight - c.squaredNorm(), 0.0)), kLeastRadius);
    Matrix3 cross;
    cross << 0.0, -c.z(), c.y(), c.z(), 0.0, -c.x(), -c.y(), c.x(), 0.0;
    about_middle_[p].topRightCorner<3, 3>() = cross / radius;
    about_middle_[p].bottomRightCorner<3, 3>() /= radius;
  }
}

/// @return false where K, which may be indefinite, takes energy away: its least is nowhere to go to then.
bool CoarseMotions::factor(const BodySystem& body) {
  sums_.assign(parts_ * parts_, {});
  runSumRows(SumWork{body, takes_part_, place_, first_, shares_, parts_, sums_});
  const auto size = static_cast<Eigen::Index>(6 * parts_);
  energy_.resize(size, size);
  const auto sumOf = [&](std::size_t p, std::size_t q) {
    return Eigen::Map<const Eigen::Matrix<double, 6, 6>>(sums_[p * parts_ + q].data());
  };
  for (std::size_t p = 0; p < parts_; ++p) {
    for (std::size_t q = 0; q <= p; ++q) {
      energy_.block<6, 6>(static_cast<Eigen::Index>(6 * p), static_cast<Eigen::Index>(6 * q)) =
          about_middle_[p].transpose() * (sumOf(p, q) + sumOf(q, p).transpose()) * about_middle_[q];
    }
  }
  // Motions of parts without nodes, and turns of nodes in a line, move nothing.
  constexpr double kRoundOff = 1e-10;
  energy_.diagonal().array() += kRoundOff * energy_.diagonal().maxCoeff();
  factor_.compute(energy_);  // reads what is below the diagonal
  motion_.resize(size);
  return factor_.info() == Eigen::Success;
}

/// motion_ becomes (Z'A Z)^-1 motion_. What factor_.solveInPlace() does, without the memory that it may ask for.
void CoarseMotions::solve() {
  const Eigen::MatrixXd& L = factor_.matrixLLT();
  const Eigen::Index size = motion_.size();
  for (Eigen::Index r = 0; r < size; ++r) {
    motion_[r] = (motion_[r] - L.row(r).head(r).dot(motion_.head(r))) / L(r, r);
  }
  for (Eigen::Index r = size - 1; r >= 0; --r) {
    const Eigen::Index later = size - 1 - r;
    motion_[r] = (motion_[r] - L.col(r).tail(later).dot(motion_.tail(later))) / L(r, r);
  }
}

void CoarseMotions::direction(const PaddedVectors& defect, PaddedVectors& along) {
  std::array<Vector6, kMostParts> of;
  of.fill(Vector6::Zero());
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (takes_part_[i] == 0) continue;
    const Vector3 here = vectorOf(defect[i]);
    Vector6 motion;
    motion << here, vectorOf(place_[i]).cross(here);
    for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) of[shares_[k].part] += shares_[k].weight * motion;
  }
  for (std::size_t p = 0; p < parts_; ++p) {
    motion_.segment<6>(static_cast<Eigen::Index>(6 * p)) = about_middle_[p].transpose() * of[p];
  }
  solve();
  for (std::size_t p = 0; p < parts_; ++p)
    of[p] = about_middle_[p] * motion_.segment<6>(static_cast<Eigen::Index>(6 * p));
  for (std::size_t i = 0; i < place_.size(); ++i) {
    Vector6 motion = Vector6::Zero();
    if (takes_part_[i] != 0) {
      for (std::size_t k = first_[i]; k < first_[i + 1]; ++k) motion += shares_[k].weight * of[shares_[k].part];
    }
    const Vector3 moved = motion.head<3>() + motion.tail<3>().cross(Vector3(vectorOf(place_[i])));
    along[i] = {{moved.x(), moved.y(), moved.z(), 0.0}};
  }
}

}  // namespace tissue_contact
