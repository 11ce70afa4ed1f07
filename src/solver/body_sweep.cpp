#include "solver/body_sweep.h"

#include <cassert>

namespace tissue_contact {
namespace {

/// Where Matrix3 has what SymmetricBlocks have.
constexpr std::array<std::size_t, 6> kLowerPart = {0, 1, 2, 4, 5, 8};

/// What the kernels read and write, of one body.
struct Work {
  const BodySystem& body;
  const std::vector<SymmetricBlocks>& diagonal;
  const std::vector<SymmetricBlocks>& inverse;
  const std::vector<SliceVectors>& right;
  const std::vector<std::array<double, kLanes>>& free;
  PaddedVector* lower;
  PaddedVector* v;
};

/// Of four rows side by side: |defect|^2 and the defect of each that is free, else 0.
struct LaneDefects {
  Lanes squares = {0.0, 0.0, 0.0, 0.0};
  LaneVectors defects{};
};

TISSUE_CONTACT_INLINE void add(const LaneDefects& some, LaneDefects& all) {
  all.squares += some.squares;
  for (std::size_t r = 0; r < 3; ++r) all.defects[r] += some.defects[r];
}

/// b + J'lambda - A v of a slice's rows, and v there.
template <bool kDamped>
TISSUE_CONTACT_INLINE void defectsOf(const Work& all, int slice, LaneVectors& defect, LaneVectors& v) {
  const BlockMatrix& K = *all.body.K;
  const int* const rows = rowsOf(*K.pattern, slice);
  LaneVectors elastic{};
  addUpperProduct(K, slice, all.v, elastic);
  LaneVectors lower;
  load(all.right[slice], defect);
  gather(all.lower, rows, lower);
  gather(all.v, rows, v);
  const double scale = all.body.stiffness_scale;
  defect[0] -= lower[0] + scale * elastic[0];
  defect[1] -= lower[1] + scale * elastic[1];
  defect[2] -= lower[2] + scale * elastic[2];
  if (kDamped) {
    const double damping = all.body.damping_scale;
    LaneVectors viscous{};
    addUpperProduct(*all.body.D, slice, all.v, viscous);
    defect[0] -= damping * viscous[0];
    defect[1] -= damping * viscous[1];
    defect[2] -= damping * viscous[2];
  }
  LaneVectors own{};
  addProduct(all.diagonal[slice], v, own);
  defect[0] -= own[0];
  defect[1] -= own[1];
  defect[2] -= own[2];
}

/// Gauss-Seidel step of a slice's rows.
template <bool kDamped>
TISSUE_CONTACT_INLINE void relax(const Work& all, int slice, LaneDefects& met) {
  LaneVectors defect, v;
  defectsOf<kDamped>(all, slice, defect, v);
  addProduct(all.inverse[slice], defect, v);
  scatter(v, rowsOf(*all.body.K->pattern, slice), all.v);  // a slice with fewer rows repeats the first, unmoved
  Lanes free;
  load(all.free[slice].data(), free);
  met.squares = free * (defect[0] * defect[0] + defect[1] * defect[1] + defect[2] * defect[2]);
  for (std::size_t r = 0; r < 3; ++r) met.defects[r] = free * defect[r];
}

/// Adds what a slice's rows do to the rows after them.
template <bool kDamped>
TISSUE_CONTACT_INLINE void carry(const Work& all, int slice) {
  const BlockMatrix& K = *all.body.K;
  LaneVectors v;
  gather(all.v, rowsOf(*K.pattern, slice), v);
  scatterMirrored(K, slice, all.body.stiffness_scale, v, all.lower);
  if (kDamped) scatterMirrored(*all.body.D, slice, all.body.damping_scale, v, all.lower);
}

TISSUE_CONTACT_INLINE DefectsMet totalOf(const LaneDefects& met) {
  return {sum(met.squares), Vector3(sum(met.defects[0]), sum(met.defects[1]), sum(met.defects[2]))};
}

template <bool kDamped>
TISSUE_CONTACT_INLINE DefectsMet sweepForth(const Work& all, const std::vector<unsigned char>& moves, int begin,
                                            int end) {
  LaneDefects met;
  for (int slice = begin; slice < end; ++slice) {
    if (moves[slice] == 0) continue;
    LaneDefects here;
    relax<kDamped>(all, slice, here);
    carry<kDamped>(all, slice);
    add(here, met);
  }
  return totalOf(met);
}

template <bool kDamped>
TISSUE_CONTACT_INLINE DefectsMet sweepBack(const Work& all, const std::vector<unsigned char>& moves, int begin,
                                           int end) {
  LaneDefects met;
  for (int slice = end; slice-- > begin;) {
    if (moves[slice] == 0) continue;
    LaneDefects here;
    relax<kDamped>(all, slice, here);
    add(here, met);
  }
  return totalOf(met);
}

TISSUE_CONTACT_CLONES
DefectsMet runForth(const Work& all, const std::vector<unsigned char>& moves, int begin, int end) {
  return all.body.D != nullptr ? sweepForth<true>(all, moves, begin, end) : sweepForth<false>(all, moves, begin, end);
}

TISSUE_CONTACT_CLONES
DefectsMet runBack(const Work& all, const std::vector<unsigned char>& moves, int begin, int end) {
  return all.body.D != nullptr ? sweepBack<true>(all, moves, begin, end) : sweepBack<false>(all, moves, begin, end);
}

TISSUE_CONTACT_CLONES
void runRelax(const Work& all, int slice, double* squares, SliceVectors& defects) {
  LaneDefects met;
  all.body.D != nullptr ? relax<true>(all, slice, met) : relax<false>(all, slice, met);
  std::memcpy(squares, &met.squares, sizeof(met.squares));
  for (std::size_t r = 0; r < 3; ++r) std::memcpy(defects.at[r].data(), &met.defects[r], sizeof(Lanes));
}

TISSUE_CONTACT_CLONES
void runCarry(const Work& all, int slice) {
  all.body.D != nullptr ? carry<true>(all, slice) : carry<false>(all, slice);
}

/// Adds L v to lower, with L: A below the diagonal. @return v'D v, with D: the diagonal blocks of A.
template <bool kDamped>
TISSUE_CONTACT_INLINE double lowerProduct(const Work& all, const std::vector<unsigned char>& moves) {
  Lanes total = {0.0, 0.0, 0.0, 0.0};
  for (int slice = 0; slice < all.body.K->pattern->slices(); ++slice) {
    if (moves[slice] == 0) continue;
    carry<kDamped>(all, slice);
    LaneVectors v;
    gather(all.v, rowsOf(*all.body.K->pattern, slice), v);
    LaneVectors own{};
    addProduct(all.diagonal[slice], v, own);
    Lanes free;
    load(all.free[slice].data(), free);
    total += free * (v[0] * own[0] + v[1] * own[1] + v[2] * own[2]);
  }
  return sum(total);
}

/// b + J'lambda - A v, 0 of rows that are not free. @param lower L v of them all.
template <bool kDamped>
TISSUE_CONTACT_INLINE void defects(const Work& all, const std::vector<unsigned char>& moves, PaddedVector* defect) {
  for (int slice = 0; slice < all.body.K->pattern->slices(); ++slice) {
    if (moves[slice] == 0) continue;
    LaneVectors left, v;
    defectsOf<kDamped>(all, slice, left, v);
    Lanes free;
    load(all.free[slice].data(), free);
    for (std::size_t r = 0; r < 3; ++r) left[r] *= free;
    scatter(left, rowsOf(*all.body.K->pattern, slice), defect);
  }
}

TISSUE_CONTACT_CLONES
void runDefects(const Work& all, const std::vector<unsigned char>& moves, PaddedVector* defect) {
  all.body.D != nullptr ? defects<true>(all, moves, defect) : defects<false>(all, moves, defect);
}

TISSUE_CONTACT_CLONES
double runLowerProduct(const Work& all, const std::vector<unsigned char>& moves) {
  return all.body.D != nullptr ? lowerProduct<true>(all, moves) : lowerProduct<false>(all, moves);
}

/// Four numbers a node, of which the last is anything.
Eigen::Map<VectorX> allOf(PaddedVectors& vectors) {
  return {vectors.front().at.data(), static_cast<Eigen::Index>(kLanes * vectors.size())};
}

/// In closed form: cofactors over the determinant.
TISSUE_CONTACT_INLINE void invert(const SymmetricBlocks& blocks, const double* free, SymmetricBlocks& inverse) {
  Lanes m[6], by;
  load(blocks, m);
  load(free, by);
  const Lanes xx = m[3] * m[5] - m[4] * m[4];
  const Lanes xy = m[4] * m[2] - m[1] * m[5];
  const Lanes xz = m[1] * m[4] - m[3] * m[2];
  const Lanes yy = m[0] * m[5] - m[2] * m[2];
  const Lanes yz = m[2] * m[1] - m[0] * m[4];
  const Lanes zz = m[0] * m[3] - m[1] * m[1];
  by /= m[0] * xx + m[1] * xy + m[2] * xz;
  const Lanes result[6] = {by * xx, by * xy, by * xz, by * yy, by * yz, by * zz};
  for (std::size_t k = 0; k < 6; ++k) std::memcpy(inverse.at[k].data(), &result[k], sizeof(Lanes));
}

TISSUE_CONTACT_CLONES
void invertAll(const std::vector<SymmetricBlocks>& blocks, const std::vector<std::array<double, kLanes>>& free,
               std::vector<SymmetricBlocks>& inverse) {
  for (std::size_t slice = 0; slice < blocks.size(); ++slice) invert(blocks[slice], free[slice].data(), inverse[slice]);
}

}  // namespace

void BodySweep::prepare(const BodySystem& body) {
  assert(body.D == nullptr || body.D->values.size() == body.K->values.size());
  body_ = &body;
  const auto slices = static_cast<std::size_t>(pattern().slices());
  diagonal_.resize(slices);
  inverse_.resize(slices);
  right_.resize(slices);
  free_.resize(slices);
  moves_.resize(slices);
  lower_.resize(static_cast<std::size_t>(body.K->rows()));
  v_.resize(lower_.size());
  prepareSlices();
  deflation_.beginStep(v_.size());
  rigid_motions_.none();
  coarse_motions_.none();
  invertAll(diagonal_, free_, inverse_);
}

void BodySweep::prepareSlices() {
  const BodySystem& body = *body_;
  const std::vector<int>& rows = pattern().rows;
  for (std::size_t place = 0; place < rows.size(); ++place) {
    const std::size_t slice = place / kLanes;
    const std::size_t lane = place % kLanes;
    const int i = rows[place];
    const bool repeats = lane > 0 && i == rows[place - lane];
    const bool free = !repeats && !(*body.fixed)[i];
    SymmetricBlocks& block = diagonal_[slice];
    const double mass = free ? body.mass[i] : 1.0;  // of rows that stay: anything with an inverse
    std::array<double, 6> sum{};
    const auto add = [&](double scale, const Matrix3& matrix) {
      for (std::size_t k = 0; k < 6; ++k) sum[k] += scale * matrix.data()[kLowerPart[k]];
    };
    if (free) add(body.stiffness_scale, body.K->diagonal[i]);
    if (free && body.D != nullptr) add(body.damping_scale, body.D->diagonal[i]);
    for (const std::size_t k : {0, 3, 5}) sum[k] += mass;
    for (std::size_t k = 0; k < 6; ++k) block.at[k][lane] = sum[k];
    const double* const b = body.b.data() + 3 * static_cast<std::ptrdiff_t>(i);
    for (std::size_t r = 0; r < 3; ++r) right_[slice].at[r][lane] = b[r];
    free_[slice][lane] = free ? 1.0 : 0.0;
    moves_[slice] = static_cast<unsigned char>((lane > 0 ? moves_[slice] : 0) | static_cast<int>(free));
  }
}

Matrix3 BodySweep::inverse(int node) const {
  if (body_ == nullptr) return Matrix3::Zero();
  const auto place = static_cast<std::size_t>(pattern().lane_of[node]);
  Matrix3 inverse;
  for (std::size_t k = 0; k < 6; ++k) inverse.data()[kLowerPart[k]] = inverse_[place / kLanes].at[k][place % kLanes];
  return inverse.selfadjointView<Eigen::Lower>();
}

void BodySweep::addImpulse(int node, const Vector3& impulse_W) {
  if (body_ == nullptr) return;
  const auto place = static_cast<std::size_t>(pattern().lane_of[node]);
  for (std::size_t r = 0; r < 3; ++r) right_[place / kLanes].at[r][place % kLanes] += impulse_W.data()[r];
}

void BodySweep::follow(int node, const Vector3& change) {
  const auto add = [&](const BlockMatrix& matrix, double scale) {
    const Vector3 scaled = scale * change;
    matrix.pattern->forRow(node, [&](int j, int place) {
      if (j <= node) return;
      const Vector3 added = matrix.block(place).transpose() * scaled;  // A is symmetric
      vectorOf(lower_[j]) += added;
      deflation_.follow(j, added);
      rigid_motions_.follow(j, added);
    });
  };
  add(*body_->K, body_->stiffness_scale);
  if (body_->D != nullptr) add(*body_->D, body_->damping_scale);
}

void BodySweep::beginDeflation(const NodalVectors& u, const std::vector<int>& excluded) {
  if (u.cols() != body_->K->rows() || u.isZero(0.0)) return;
  deflation_.beginAlong(u, *body_->fixed);
  for (const int node : excluded) deflation_.exclude(node);
  deflation_.measure([this](PaddedVectors& along, PaddedVectors& lower) { return measure(along, lower); });
}

Deflation::Products BodySweep::measure(PaddedVectors& u, PaddedVectors& lower) const {
  std::fill(lower.begin(), lower.end(), PaddedVector{});
  Deflation::Products found;
  found.energy = runLowerProduct({*body_, diagonal_, inverse_, right_, free_, lower.data(), u.data()}, moves_);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const Vector3 at = vectorOf(u[i]);
    found.energy += 2.0 * at.dot(vectorOf(lower[i]));
    const double mass = body_->mass[static_cast<Eigen::Index>(i)];
    found.inertia += mass * at.squaredNorm();
    found.mass += mass;
  }
  return found;
}

void BodySweep::beginRigidMotions(const std::vector<int>& excluded) {
  if (body_->stiff_parts != nullptr && !body_->stiff_parts->empty()) rigid_motions_.begin(*body_, excluded);
}

void BodySweep::beginCoarseMotions(const std::vector<int>& excluded) {
  coarse_motions_.begin(*body_, excluded);
  if (!coarse_motions_.any()) return;
  defect_.assign(v_.size(), PaddedVector{});  // stays 0 where slices do not move
  along_.resize(v_.size());
  along_lower_.resize(v_.size());
}

void BodySweep::deflate(NodalVectors& v) {
  pad(v, v_);
  rigid_motions_.correct(deflation_.begun(), v_, lower_,
                         [this](int j, const Vector3& changed) { deflation_.follow(j, changed); });
  deflation_.correct(v_, lower_);
  if (coarse_motions_.any()) correctCoarsely();
  if (deflation_.hasAlong() || rigid_motions_.any() || coarse_motions_.any()) unpad(v_, v);
}

/// Moves v_ along the coarse motions to where the energy is least, and lower_ with it.
void BodySweep::correctCoarsely() {
  runDefects({*body_, diagonal_, inverse_, right_, free_, lower_.data(), v_.data()}, moves_, defect_.data());
  coarse_motions_.direction(defect_, along_);
  const Deflation::Products found = measure(along_, along_lower_);
  if (!(found.energy >= Deflation::kLeastEnergy * found.inertia) || found.inertia == 0.0) return;
  allOf(v_) += allOf(along_);
  allOf(lower_) += allOf(along_lower_);
  deflation_.correctedElsewhere(v_);
}

void BodySweep::finish(bool forth, const NodalVectors& v, NodalVectors& u) {
  if (deflation_.isFirst()) return;  // that was all: nothing was found since
  if (!forth) return deflation_.finish(u);
  pad(v, v_);
  deflation_.finish(v_, u);
}

DefectsMet BodySweep::forth(int begin, int end) {
  return runForth({*body_, diagonal_, inverse_, right_, free_, lower_.data(), v_.data()}, moves_, begin, end);
}

DefectsMet BodySweep::back(int begin, int end) {
  return runBack({*body_, diagonal_, inverse_, right_, free_, lower_.data(), v_.data()}, moves_, begin, end);
}

BodySweep::SliceDefects BodySweep::relaxSlice(int slice) {
  SliceDefects met;
  runRelax({*body_, diagonal_, inverse_, right_, free_, lower_.data(), v_.data()}, slice, met.squares.data(),
           met.defects);
  return met;
}

DefectsMet BodySweep::SliceDefects::total() const {
  DefectsMet met;
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    met.squared += squares[lane];
    for (std::size_t r = 0; r < 3; ++r) met.sum.data()[r] += defects.at[r][lane];
  }
  return met;
}

void BodySweep::carrySlice(int slice) {
  runCarry({*body_, diagonal_, inverse_, right_, free_, lower_.data(), v_.data()}, slice);
}

}  // namespace tissue_contact
