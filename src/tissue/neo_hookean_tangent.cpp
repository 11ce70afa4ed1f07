#include "tissue/neo_hookean_tangent.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tissue_contact/tissue/tet_elasticity.h"

// Lanes are returned below by functions that are all inlined: no call passes them.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace tissue_contact {
namespace {

/// What stands for an eigenvalue: nothing for a negative one down to -mu, and what it is more negative by than that beyond.
double madePositive(double value, double mu) { return value > 0.0 ? value : std::max(0.0, -value - mu); }

Matrix3 withoutNegativeEigenvalues(const Matrix3& symmetric, double mu) {
  const double minor = symmetric(0, 0) * symmetric(1, 1) - symmetric(1, 0) * symmetric(1, 0);
  if (symmetric(0, 0) > 0.0 && minor > 0.0 && symmetric.determinant() > 0.0) return symmetric;
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(symmetric);
  const Vector3 values = eigen.eigenvalues().unaryExpr([mu](double value) { return madePositive(value, mu); });
  return eigen.eigenvectors() * values.asDiagonal() * eigen.eigenvectors().transpose();
}

/// Symmetric 3 x 3 matrices.
struct LaneSymmetric {
  Lanes xx, yy, zz, xy, yz, zx;
};

TISSUE_CONTACT_INLINE Lanes root(const Lanes& a) {
  return Lanes{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}

/// As madePositive().
TISSUE_CONTACT_INLINE Lanes madePositive(const Lanes& a, const Lanes& mu) {
  const Lanes beyond = -a - mu;
  return a > 0.0 ? a : (beyond > 0.0 ? beyond : Lanes{});
}

/// Jacobi's rotation that makes A_pq zero, also of the columns p and q of V; r is the third place. Where A_pq is round-off beside the
/// diagonal the lane stays as it is, so that other lanes may go on.
TISSUE_CONTACT_INLINE Mask turn(Lanes& pp, Lanes& qq, Lanes& pq, Lanes& rp, Lanes& rq, Lanes* Vp, Lanes* Vq) {
  constexpr double kRoundOffSquared = 1e-32;
  const Mask active = pq * pq > kRoundOffSquared * (pp * pp + qq * qq);
  if (!any(active)) return active;
  const Lanes difference = qq - pp;
  const Lanes length = root(difference * difference + 4.0 * pq * pq);
  const Lanes signed_length = difference < 0.0 ? difference - length : difference + length;
  const Lanes tangent = active ? 2.0 * pq / signed_length : Lanes{};
  const Lanes cosine = 1.0 / root(1.0 + tangent * tangent);
  const Lanes sine = tangent * cosine;
  const Lanes shift = tangent * pq;
  pp -= shift;
  qq += shift;
  pq = active ? Lanes{} : pq;
  const Lanes old_rp = rp;
  rp = cosine * old_rp - sine * rq;
  rq = sine * old_rp + cosine * rq;
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes old = Vp[k];
    Vp[k] = cosine * old - sine * Vq[k];
    Vq[k] = sine * old + cosine * Vq[k];
  }
  return active;
}

/// A = V diag(A.xx, A.yy, A.zz) V', V a proper rotation (Golub & Van Loan, Matrix Computations, section 8.5).
TISSUE_CONTACT_INLINE void diagonalise(LaneSymmetric& A, LaneMatrix& V) {
  constexpr int kMostSweeps = 8;  // three or four are usual
  const Lanes one = {1.0, 1.0, 1.0, 1.0};
  for (std::size_t i = 0; i < 9; ++i) V.m[i] = i % 4 == 0 ? one : Lanes{};
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    Mask active = turn(A.xx, A.yy, A.xy, A.zx, A.yz, V.m, V.m + 3);
    active |= turn(A.xx, A.zz, A.zx, A.xy, A.yz, V.m, V.m + 6);
    active |= turn(A.yy, A.zz, A.yz, A.xy, A.zx, V.m + 3, V.m + 6);
    if (!any(active)) break;
  }
}

TISSUE_CONTACT_INLINE Lanes dot(const Lanes* a, const Lanes* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Columns a and b of B and V changed for each other where a's of B is the shorter, one of them turned round: V stays proper.
TISSUE_CONTACT_INLINE void longerFirst(std::size_t a, std::size_t b, LaneMatrix& B, LaneMatrix& V) {
  const Mask shorter = dot(B.m + 3 * a, B.m + 3 * a) < dot(B.m + 3 * b, B.m + 3 * b);
  for (LaneMatrix* const matrix : {&B, &V}) {
    for (std::size_t k = 0; k < 3; ++k) {
      Lanes& at_a = matrix->m[3 * a + k];
      Lanes& at_b = matrix->m[3 * b + k];
      const Lanes old = at_a;
      at_a = shorter ? at_b : old;
      at_b = shorter ? -old : at_b;
    }
  }
}

/// F = U diag(sigma) V' with proper rotations U and V: the last sigma carries the sign of det F.
/// @return lanes where it is not so.
TISSUE_CONTACT_INLINE Mask decompose(const LaneMatrix& F, LaneMatrix& U, Lanes* sigma, LaneMatrix& V) {
  constexpr double kLineSquared = 1e-8;  // second to first singular value: below, V is lost to the round-off of F'F
  constexpr double kMostSquared = 1e60;  // fourth powers, squared, are numbers
  constexpr double kLeastSquared = 1e-60;
  const Lanes *const x = F.m, *const y = F.m + 3, *const z = F.m + 6;
  LaneSymmetric A = {dot(x, x), dot(y, y), dot(z, z), dot(x, y), dot(y, z), dot(z, x)};
  diagonalise(A, V);
  LaneMatrix B;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      B.m[r + 3 * c] = F.m[r] * V.m[3 * c] + F.m[r + 3] * V.m[3 * c + 1] + F.m[r + 6] * V.m[3 * c + 2];
    }
  }
  longerFirst(0, 1, B, V);
  longerFirst(0, 2, B, V);
  longerFirst(1, 2, B, V);
  const Lanes squared = dot(B.m, B.m);
  const Lanes length = root(squared);
  for (std::size_t k = 0; k < 3; ++k) U.m[k] = B.m[k] / length;
  const Lanes along = dot(U.m, B.m + 3);
  Lanes second[3];
  for (std::size_t k = 0; k < 3; ++k) second[k] = B.m[3 + k] - along * U.m[k];
  const Lanes second_squared = dot(second, second);
  const Lanes second_length = root(second_squared);
  for (std::size_t k = 0; k < 3; ++k) U.m[3 + k] = second[k] / second_length;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3;
    const std::size_t j = (k + 2) % 3;
    U.m[6 + k] = U.m[i] * U.m[3 + j] - U.m[j] * U.m[3 + i];
  }
  sigma[0] = length;
  sigma[1] = second_length;
  sigma[2] = dot(U.m + 6, B.m + 6);
  return ~((second_squared > kLineSquared * squared) & (squared > kLeastSquared) & (squared < kMostSquared));
}

TISSUE_CONTACT_INLINE void dropNegativeEigenvalues(LaneSymmetric& A, const Lanes& mu) {
  const Lanes minor = A.xx * A.yy - A.xy * A.xy;
  const Lanes determinant = A.zz * minor - A.yz * (A.xx * A.yz - A.xy * A.zx) + A.zx * (A.xy * A.yz - A.yy * A.zx);
  const Mask is_positive = (A.xx > 0.0) & (minor > 0.0) & (determinant > 0.0);
  if (!any(~is_positive)) return;
  LaneSymmetric D = A;
  LaneMatrix V;
  diagonalise(D, V);
  const Lanes values[3] = {madePositive(D.xx, mu), madePositive(D.yy, mu), madePositive(D.zz, mu)};
  const auto entry = [&](std::size_t r, std::size_t c) {
    return values[0] * V.m[r] * V.m[c] + values[1] * V.m[r + 3] * V.m[c + 3] + values[2] * V.m[r + 6] * V.m[c + 6];
  };
  A.xx = is_positive ? A.xx : entry(0, 0);
  A.yy = is_positive ? A.yy : entry(1, 1);
  A.zz = is_positive ? A.zz : entry(2, 2);
  A.xy = is_positive ? A.xy : entry(0, 1);
  A.yz = is_positive ? A.yz : entry(1, 2);
  A.zx = is_positive ? A.zx : entry(2, 0);
}

/// As Tangent, times the volume; direct[k] and crossed[k] are of the pair without k.
struct LaneTangent {
  LaneSymmetric stretch;
  Lanes direct[3], crossed[3];
};

TISSUE_CONTACT_INLINE void spectralTangents(const TangentLanes& all, const Lanes* sigma, LaneTangent& tangent) {
  Lanes lambda, mu, pressure, flat_modulus, volume;
  load(all.lambda, lambda);
  load(all.mu, mu);
  load(all.pressure, pressure);
  load(all.flat_modulus, flat_modulus);
  load(all.volume, volume);
  const Lanes I_1 = dot(sigma, sigma) + 1.0;
  const Lanes J = sigma[0] * sigma[1] * sigma[2];
  const Lanes along_F = mu - mu / I_1;
  const Lanes flat = J < kFlat ? flat_modulus : Lanes{};
  const Lanes along_C = lambda * (J - 1.0) - 0.75 * mu + flat * (J - kFlat) + pressure;
  const Lanes by_sigma = 2.0 * mu / (I_1 * I_1);
  const Lanes by_cofactor = lambda + flat;
  const Lanes c[3] = {sigma[1] * sigma[2], sigma[2] * sigma[0], sigma[0] * sigma[1]};
  LaneSymmetric& stretch = tangent.stretch;
  stretch.xx = by_sigma * sigma[0] * sigma[0] + by_cofactor * c[0] * c[0] + along_F;
  stretch.yy = by_sigma * sigma[1] * sigma[1] + by_cofactor * c[1] * c[1] + along_F;
  stretch.zz = by_sigma * sigma[2] * sigma[2] + by_cofactor * c[2] * c[2] + along_F;
  stretch.xy = by_sigma * sigma[0] * sigma[1] + by_cofactor * c[0] * c[1] + along_C * sigma[2];
  stretch.yz = by_sigma * sigma[1] * sigma[2] + by_cofactor * c[1] * c[2] + along_C * sigma[0];
  stretch.zx = by_sigma * sigma[2] * sigma[0] + by_cofactor * c[2] * c[0] + along_C * sigma[1];
  dropNegativeEigenvalues(stretch, mu);
  for (Lanes* const entry : {&stretch.xx, &stretch.yy, &stretch.zz, &stretch.xy, &stretch.yz, &stretch.zx}) {
    *entry *= volume;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    const Lanes twist = madePositive(along_F + along_C * sigma[k], mu);
    const Lanes flip = madePositive(along_F - along_C * sigma[k], mu);
    tangent.direct[k] = 0.5 * volume * (flip + twist);
    tangent.crossed[k] = 0.5 * volume * (flip - twist);
  }
}

/// U Y U' of the nodes whose shape functions have the gradients bn and bm in the frame V.
TISSUE_CONTACT_INLINE void block(const LaneTangent& tangent, const LaneMatrix& U, const Lanes* bn, const Lanes* bm,
                                 MatrixBatch& result) {
  const LaneSymmetric& s = tangent.stretch;
  const Lanes *const direct = tangent.direct, *const crossed = tangent.crossed;
  LaneMatrix Y;
  Y.m[0] = s.xx * bn[0] * bm[0] + direct[2] * bn[1] * bm[1] + direct[1] * bn[2] * bm[2];
  Y.m[4] = s.yy * bn[1] * bm[1] + direct[0] * bn[2] * bm[2] + direct[2] * bn[0] * bm[0];
  Y.m[8] = s.zz * bn[2] * bm[2] + direct[1] * bn[0] * bm[0] + direct[0] * bn[1] * bm[1];
  Y.m[3] = s.xy * bn[0] * bm[1] + crossed[2] * bn[1] * bm[0];
  Y.m[1] = s.xy * bn[1] * bm[0] + crossed[2] * bn[0] * bm[1];
  Y.m[7] = s.yz * bn[1] * bm[2] + crossed[0] * bn[2] * bm[1];
  Y.m[5] = s.yz * bn[2] * bm[1] + crossed[0] * bn[1] * bm[2];
  Y.m[2] = s.zx * bn[2] * bm[0] + crossed[1] * bn[0] * bm[2];
  Y.m[6] = s.zx * bn[0] * bm[2] + crossed[1] * bn[2] * bm[0];
  LaneMatrix UY;
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      UY.m[r + 3 * c] = U.m[r] * Y.m[3 * c] + U.m[r + 3] * Y.m[3 * c + 1] + U.m[r + 6] * Y.m[3 * c + 2];
    }
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      store(UY.m[r] * U.m[c] + UY.m[r + 3] * U.m[c + 3] + UY.m[r + 6] * U.m[c + 6], result[r + 3 * c]);
    }
  }
}

/// V' grad N.
TISSUE_CONTACT_INLINE void turnBack(const LaneMatrix& V, const GradientLanes* gradients, std::size_t count,
                                    GradientLanes* turned) {
  for (std::size_t n = 0; n < count; ++n) {
    Lanes gradient[3];
    for (std::size_t k = 0; k < 3; ++k) load(gradients[n][k], gradient[k]);
    for (std::size_t i = 0; i < 3; ++i) store(dot(V.m + 3 * i, gradient), turned[n][i]);
  }
}

}  // namespace

Tangent::Tangent(const TangentPoint& point) {
  // F = R S = (R V) diag(sigma) V', R a proper rotation: J = product of sigma carries the sign of det F.
  const Matrix3 R = nearestRotation(point.F, Quaternion::Identity()).toRotationMatrix();
  const Matrix3 S = R.transpose() * point.F;
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(0.5 * (S + S.transpose()));
  const Vector3& sigma = eigen.eigenvalues();
  const LameParameters& material = point.material;
  V_ = eigen.eigenvectors();
  U_ = R * V_;
  const double I = sigma.squaredNorm();
  const double along_F = material.mu - material.mu / (I + 1.0);
  const double J = sigma.prod();
  const double flat = J < kFlat ? point.patch.flat_modulus : 0.0;
  const double along_C = material.lambda * (J - 1.0) - 0.75 * material.mu + flat * (J - kFlat) + point.patch.pressure;
  const Vector3 cofactors(sigma[1] * sigma[2], sigma[2] * sigma[0], sigma[0] * sigma[1]);
  stretch_ = 2.0 * material.mu / ((I + 1.0) * (I + 1.0)) * sigma * sigma.transpose() +
             (material.lambda + flat) * cofactors * cofactors.transpose();
  stretch_.diagonal().array() += along_F;
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3;
    const int j = (k + 2) % 3;
    stretch_(i, j) += along_C * sigma[k];
    stretch_(j, i) += along_C * sigma[k];
    const double twist = madePositive(along_F + along_C * sigma[k], material.mu);
    const double flip = madePositive(along_F - along_C * sigma[k], material.mu);
    direct_(i, j) = direct_(j, i) = 0.5 * (flip + twist);
    crossed_(i, j) = crossed_(j, i) = 0.5 * (flip - twist);
  }
  stretch_ = withoutNegativeEigenvalues(stretch_, material.mu);
}

Matrix3 Tangent::block(const Vector3& gradient_n, const Vector3& gradient_m) const {
  const Vector3 n = V_.transpose() * gradient_n;
  const Vector3 m = V_.transpose() * gradient_m;
  Matrix3 inner;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    inner(i, i) = stretch_(i, i) * n[i] * m[i] + direct_(i, j) * n[j] * m[j] + direct_(i, k) * n[k] * m[k];
    inner(i, j) = stretch_(i, j) * n[i] * m[j] + crossed_(i, j) * n[j] * m[i];
    inner(j, i) = stretch_(i, j) * n[j] * m[i] + crossed_(i, j) * n[i] * m[j];
  }
  return U_ * inner * U_.transpose();
}

TISSUE_CONTACT_CLONES
unsigned char computeTangents(const TangentLanes& lanes, const GradientLanes* gradients, std::size_t count,
                              GradientLanes* turned, MatrixBatch* blocks) {
  LaneMatrix F, U, V;
  Lanes sigma[3];
  for (std::size_t i = 0; i < 9; ++i) load(lanes.F[i], F.m[i]);
  const Mask failed = decompose(F, U, sigma, V);
  LaneTangent tangent;
  spectralTangents(lanes, sigma, tangent);
  turnBack(V, gradients, count, turned);
  for (std::size_t n = 0; n < count; ++n) {
    Lanes of_n[3], of_m[3];
    for (std::size_t k = 0; k < 3; ++k) load(turned[n][k], of_n[k]);
    for (std::size_t m = n; m < count; ++m) {
      for (std::size_t k = 0; k < 3; ++k) load(turned[m][k], of_m[k]);
      block(tangent, U, of_n, of_m, *blocks++);
    }
  }
  return bits(failed);
}

}  // namespace tissue_contact
