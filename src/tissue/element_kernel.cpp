#include "tissue/element_kernel.h"

#include <algorithm>

#include "tissue/patch_kernel.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {
namespace {

template <typename L>
struct LaneQuaternion {
  L w, x, y, z;
};

template <typename L>
TISSUE_CONTACT_INLINE void loadQuaternion(const RotationBatch* from, LaneQuaternion<L>& q) {
  loadEach(q.w, [=](std::size_t i) { return &from[i][0]; });
  loadEach(q.x, [=](std::size_t i) { return &from[i][1]; });
  loadEach(q.y, [=](std::size_t i) { return &from[i][2]; });
  loadEach(q.z, [=](std::size_t i) { return &from[i][3]; });
}

template <typename L>
TISSUE_CONTACT_INLINE void storeQuaternion(const LaneQuaternion<L>& q, RotationBatch* to) {
  storeEach(q.w, [=](std::size_t i) { return &to[i][0]; });
  storeEach(q.x, [=](std::size_t i) { return &to[i][1]; });
  storeEach(q.y, [=](std::size_t i) { return &to[i][2]; });
  storeEach(q.z, [=](std::size_t i) { return &to[i][3]; });
}

/// Rotation matrix of a quaternion of any length: exactly orthonormal up to round-off.
template <typename L>
TISSUE_CONTACT_INLINE void rotationMatrix(const LaneQuaternion<L>& q, LaneMatrixOf<L>& R) {
  const L s = 2.0 / (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  const L sx = s * q.x, sy = s * q.y, sz = s * q.z;
  const L wx = q.w * sx, wy = q.w * sy, wz = q.w * sz;
  const L xx = q.x * sx, xy = q.x * sy, xz = q.x * sz;
  const L yy = q.y * sy, yz = q.y * sz, zz = q.z * sz;
  R.m[0] = 1.0 - (yy + zz);
  R.m[1] = xy + wz;
  R.m[2] = xz - wy;
  R.m[3] = xy - wz;
  R.m[4] = 1.0 - (xx + zz);
  R.m[5] = yz + wx;
  R.m[6] = xz + wy;
  R.m[7] = yz - wx;
  R.m[8] = 1.0 - (xx + yy);
}

/// S = R' F.
template <typename L>
TISSUE_CONTACT_INLINE void rotateBack(const LaneMatrixOf<L>& R, const LaneMatrixOf<L>& F, LaneMatrixOf<L>& S) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      S.m[r + 3 * c] = R.m[3 * r] * F.m[3 * c] + R.m[3 * r + 1] * F.m[3 * c + 1] + R.m[3 * r + 2] * F.m[3 * c + 2];
    }
  }
}

/// Half the angle of the last Newton step, rad, squared. The step is quadratic: after one of 1e-4 rad the rotation is off by
/// about 1e-8, the forces by as large a share of the stress; the next update starts from there, so that nothing adds up and
/// tissue at rest has its exact rotation.
constexpr double kLastStepSquared = 0.25e-8;

/// One Newton step of nearestRotation() in the active lanes; leaves active those that need another.
/// `failed` collects those that Newton must not be trusted with. Both are 1 where they hold, else 0.
template <typename L>
TISSUE_CONTACT_INLINE void newtonStep(const LaneMatrixOf<L>& S, LaneQuaternion<L>& q, L& active, L& failed) {
  const L ax = S.m[5] - S.m[7], ay = S.m[6] - S.m[2], az = S.m[1] - S.m[3];
  const L trace = S.m[0] + S.m[4] + S.m[8];
  const L dx = trace - S.m[0], dy = trace - S.m[4], dz = trace - S.m[8];
  const L ox = -0.5 * (S.m[5] + S.m[7]), oy = -0.5 * (S.m[6] + S.m[2]), oz = -0.5 * (S.m[1] + S.m[3]);
  const L mx = dy * dz - ox * ox, my = dx * dz - oy * oy, mz = dx * dy - oz * oz;
  const L nx = oy * oz - ox * dx, ny = ox * oz - oy * dy, nz = ox * oy - oz * dz;
  const L determinant = dx * mx + oz * nz + oy * ny;
  const L axial_squared = ax * ax + ay * ay + az * az;
  const L scale = 0.5 / determinant;
  const L hx = scale * (mx * ax + nz * ay + ny * az);
  const L hy = scale * (nz * ax + my * ay + nx * az);
  const L hz = scale * (ny * ax + nx * ay + mz * az);
  const L squared = hx * hx + hy * hy + hz * hz;
  // Trusted where dx, mz, determinant and room are all above 0: where the least of them is, since GCC 12 takes conditions of eight lanes
  // that are joined by & apart. Where any of them is no number, room is none either, and it comes last.
  const L room = 0.25 - squared;
  L least = dx < mz ? dx : mz;
  least = determinant < least ? determinant : least;
  least = least < room ? least : room;
  const L trusted = least > 0.0 ? active : L{};
  failed += active - trusted;
  const L move = axial_squared < 1e-31 * trace * trace ? L{} : trusted;
  // q (1, h), its length brought back towards 1 by one Newton step of the inverse square root.
  const L w = q.w - q.x * hx - q.y * hy - q.z * hz;
  const L x = q.x + q.w * hx + q.y * hz - q.z * hy;
  const L y = q.y + q.w * hy + q.z * hx - q.x * hz;
  const L z = q.z + q.w * hz + q.x * hy - q.y * hx;
  const L shrink = 1.5 - 0.5 * (w * w + x * x + y * y + z * z);
  q.w = move > 0.0 ? w * shrink : q.w;
  q.x = move > 0.0 ? x * shrink : q.x;
  q.y = move > 0.0 ? y * shrink : q.y;
  q.z = move > 0.0 ? z * shrink : q.z;
  active = squared < kLastStepSquared ? L{} : move;
}

/// The slow, always right way for the lanes in `failed`.
template <typename L>
__attribute__((noinline)) void rotateBySvd(const LaneMatrixOf<L>& F, const L& failed, LaneQuaternion<L>& q) {
  for (std::size_t lane = 0; lane < kLanes * kFours<L>; ++lane) {
    if (failed[lane] == 0.0) continue;
    Matrix3 gradient;
    for (int i = 0; i < 9; ++i) gradient.data()[i] = F.m[i][lane];
    const Quaternion rotation = nearestRotation(gradient, Quaternion::Identity());
    q.w[lane] = rotation.w();
    q.x[lane] = rotation.x();
    q.y[lane] = rotation.y();
    q.z[lane] = rotation.z();
  }
}

/// Newton from the last rotation; leaves R and S = R'F of the answer.
template <typename L>
TISSUE_CONTACT_INLINE void updateRotation(const LaneMatrixOf<L>& F, LaneQuaternion<L>& q, LaneMatrixOf<L>& R,
                                          LaneMatrixOf<L>& S) {
  constexpr int kMaxSteps = 8;
  L active = L{} + 1.0;
  L failed = {};
  for (int step = 0; step < kMaxSteps && sum(active) > 0.0; ++step) {
    rotationMatrix(q, R);
    rotateBack(R, F, S);
    newtonStep(S, q, active, failed);
  }
  failed += active;
  if (sum(failed) > 0.0) rotateBySvd(F, failed, q);
  rotationMatrix(q, R);
  rotateBack(R, F, S);
}

/// R P.
template <typename L>
TISSUE_CONTACT_INLINE void rotate(const LaneMatrixOf<L>& R, const LaneMatrixOf<L>& P, LaneMatrixOf<L>& turned) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) {
      turned.m[r + 3 * c] = R.m[r] * P.m[3 * c] + R.m[r + 3] * P.m[3 * c + 1] + R.m[r + 6] * P.m[3 * c + 2];
    }
  }
}

/// Stress P = 2 mu e + lambda tr(e) I, turned by R when there is one.
template <typename L, typename Value>
TISSUE_CONTACT_INLINE void stress(const Value& lambda, const Value& mu, const LaneMatrixOf<L>* R,
                                  const LaneMatrixOf<L>& S, LaneMatrixOf<L>& P) {
  LaneMatrixOf<L> unturned;
  const L pressure = lambda * (S.m[0] + S.m[4] + S.m[8] - 3.0);
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t r = 0; r < 3; ++r) unturned.m[r + 3 * c] = mu * (S.m[r + 3 * c] + S.m[c + 3 * r]);
    unturned.m[4 * c] += pressure - 2.0 * mu;
  }
  if (R == nullptr) {
    P = unturned;
  } else {
    rotate(*R, unturned, P);
  }
}

/// |vec(q conj(t))| = sin(angle/2) |q| |t|.
template <typename L>
TISSUE_CONTACT_INLINE unsigned turnedLanes(const LaneQuaternion<L>& q, const LaneQuaternion<L>& t, double angle) {
  const L x = q.x * t.w - q.w * t.x - q.y * t.z + q.z * t.y;
  const L y = q.y * t.w - q.w * t.y - q.z * t.x + q.x * t.z;
  const L z = q.z * t.w - q.w * t.z - q.x * t.y + q.y * t.x;
  const L q_squared = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  const L t_squared = t.w * t.w + t.x * t.x + t.y * t.y + t.z * t.z;
  return bitsWhere<L>(x * x + y * y + z * z > 0.25 * angle * angle * q_squared * t_squared);
}

/// Brings the rotations up to date with F; leaves R and S = R'F.
/// @return those that have turned away from `tangent`.
template <typename L>
TISSUE_CONTACT_INLINE unsigned turn(const LaneMatrixOf<L>& F, const RotationBatch* tangent, double tangent_angle,
                                    RotationBatch* rotation, LaneMatrixOf<L>& R, LaneMatrixOf<L>& S) {
  LaneQuaternion<L> q, t;
  loadQuaternion(rotation, q);
  loadQuaternion(tangent, t);
  updateRotation(F, q, R, S);
  storeQuaternion(q, rotation);
  return turnedLanes(q, t, tangent_angle);
}

/// About that share of the angle of q, of length 1.
template <typename L>
TISSUE_CONTACT_INLINE LaneQuaternion<L> shareOf(const LaneQuaternion<L>& q, double share) {
  const L along = q.w < 0.0 ? L{} - share : L{} + share;
  return {1.0 - share + along * q.w, along * q.x, along * q.y, along * q.z};
}

template <typename Material>
TISSUE_CONTACT_INLINE void corotational(const std::vector<ElementBatch>& batches, BatchRange range,
                                        const Material& material, double tangent_angle, double share,
                                        const PaddedVector* x, const std::vector<RotationBatch>& tangents,
                                        std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned,
                                        PaddedVector* forces) {
  forBatches(range, [&](std::size_t b, auto width) TISSUE_CONTACT_ALWAYS_INLINE {
    using L = typename decltype(width)::Type;
    LaneMatrixOf<L> F, R, S, P;
    typename Material::template Value<L> lambda, mu;
    deformationGradients(&batches[b], x, F);
    storeBits<L>(turn(F, &tangents[b], tangent_angle, &rotations[b], R, S), &turned[b]);
    if (share < 1.0) {
      LaneQuaternion<L> q;
      loadQuaternion(&rotations[b], q);
      rotationMatrix(shareOf(q, share), R);
      rotateBack(R, F, S);
    }
    material.get(b, lambda, mu);
    stress(lambda, mu, &R, S, P);
    addStressForces(&batches[b], P, forces);
  });
}

/// Raises `most` to the squared sine of the turn, as the axial part of F has it to first order.
template <typename L>
TISSUE_CONTACT_INLINE void watchTurn(const LaneMatrixOf<L>& F, Lanes& most) {
  const L x = F.m[5] - F.m[7], y = F.m[6] - F.m[2], z = F.m[1] - F.m[3];
  Lanes fours[kFours<L>];
  split(0.25 * (x * x + y * y + z * z), fours);
  for (const Lanes& squared : fours) most = squared > most ? squared : most;
}

template <bool kWatch, typename Material>
TISSUE_CONTACT_INLINE void linear(const std::vector<ElementBatch>& batches, BatchRange range, const Material& material,
                                  const PaddedVector* x, PaddedVector* forces, double* turn_squared) {
  Lanes most = {0.0, 0.0, 0.0, 0.0};
  forBatches(range, [&](std::size_t b, auto width) TISSUE_CONTACT_ALWAYS_INLINE {
    using L = typename decltype(width)::Type;
    LaneMatrixOf<L> F, P;
    typename Material::template Value<L> lambda, mu;
    deformationGradients(&batches[b], x, F);
    material.get(b, lambda, mu);
    stress(lambda, mu, static_cast<const LaneMatrixOf<L>*>(nullptr), F, P);
    addStressForces(&batches[b], P, forces);
    if (kWatch) watchTurn(F, most);
  });
  for (int lane = 0; kWatch && lane < kLanes; ++lane) *turn_squared = std::max(*turn_squared, most[lane]);
}

TISSUE_CONTACT_INLINE void deviator(const LaneMatrix& S, Lanes* d) {
  const Lanes mean = (S.m[0] + S.m[4] + S.m[8]) * (1.0 / 3.0);
  for (std::size_t i = 0; i < 3; ++i) d[i] = S.m[4 * i] - mean;
  d[3] = 0.5 * (S.m[1] + S.m[3]);
  d[4] = 0.5 * (S.m[5] + S.m[7]);
  d[5] = 0.5 * (S.m[2] + S.m[6]);
}

/// Brings what the terms hold up to date with the deviator d.
/// @param stress gets the sum of their shares.
TISSUE_CONTACT_INLINE void relax(const Lanes* d, const std::vector<PronyStep>& steps, StrainBatch& last,
                                 StrainBatch* held, Lanes* stress) {
  for (std::size_t i = 0; i < 6; ++i) {
    Lanes before;
    load(last[i], before);
    store(d[i], last[i]);
    stress[i] = Lanes{};
    for (std::size_t k = 0; k < steps.size(); ++k) {
      Lanes h;
      load(held[k][i], h);
      h = steps[k].decay * h + steps[k].gain * (d[i] - before);
      store(h, held[k][i]);
      stress[i] += steps[k].share * h;
    }
  }
}

template <typename Material>
TISSUE_CONTACT_INLINE void overstress(const std::vector<ElementBatch>& batches, const Material& material, bool turns,
                                      double tangent_angle, const PaddedVector* x,
                                      const std::vector<RotationBatch>& tangents, std::vector<RotationBatch>& rotations,
                                      std::vector<unsigned char>& turned, const std::vector<PronyStep>& steps,
                                      std::vector<StrainBatch>& strains, std::vector<StrainBatch>& held,
                                      PaddedVector* forces) {
  constexpr std::size_t kPlace[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};  // of a matrix entry among the six
  for (std::size_t b = 0; b < batches.size(); ++b) {
    LaneMatrix F, R, S, P;
    typename Material::template Value<Lanes> lambda, mu;
    deformationGradients(&batches[b], x, F);
    if (turns) {
      storeBits<Lanes>(turn(F, &tangents[b], tangent_angle, &rotations[b], R, S), &turned[b]);
    } else {
      S = F;
    }
    Lanes d[6], stress[6];
    deviator(S, d);
    relax(d, steps, strains[b], &held[b * steps.size()], stress);
    material.get(b, lambda, mu);
    for (std::size_t i = 0; i < 9; ++i) P.m[i] = 2.0 * mu * stress[kPlace[i]];
    if (turns) {
      LaneMatrix turned_stress;
      rotate(R, P, turned_stress);
      P = turned_stress;
    }
    addStressForces(&batches[b], P, forces);
  }
}

}  // namespace

TISSUE_CONTACT_CLONES
void addCorotationalForces(const std::vector<ElementBatch>& batches, BatchRange range, const LameParameters& material,
                           double tangent_angle, double share, const PaddedVector* x,
                           const std::vector<RotationBatch>& tangents, std::vector<RotationBatch>& rotations,
                           std::vector<unsigned char>& turned, PaddedVector* forces) {
  corotational(batches, range, UniformMaterial{material}, tangent_angle, share, x, tangents, rotations, turned, forces);
}

TISSUE_CONTACT_CLONES
void addCorotationalForces(const std::vector<ElementBatch>& batches, BatchRange range,
                           const std::vector<BatchMaterial>& materials, double tangent_angle, double share,
                           const PaddedVector* x, const std::vector<RotationBatch>& tangents,
                           std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned,
                           PaddedVector* forces) {
  corotational(batches, range, VaryingMaterial{materials}, tangent_angle, share, x, tangents, rotations, turned,
               forces);
}

TISSUE_CONTACT_CLONES
void addLinearForces(const std::vector<ElementBatch>& batches, BatchRange range, const LameParameters& material,
                     const PaddedVector* x, PaddedVector* forces, double* turn_squared) {
  turn_squared == nullptr ? linear<false>(batches, range, UniformMaterial{material}, x, forces, nullptr)
                          : linear<true>(batches, range, UniformMaterial{material}, x, forces, turn_squared);
}

TISSUE_CONTACT_CLONES
void addLinearForces(const std::vector<ElementBatch>& batches, BatchRange range,
                     const std::vector<BatchMaterial>& materials, const PaddedVector* x, PaddedVector* forces,
                     double* turn_squared) {
  turn_squared == nullptr ? linear<false>(batches, range, VaryingMaterial{materials}, x, forces, nullptr)
                          : linear<true>(batches, range, VaryingMaterial{materials}, x, forces, turn_squared);
}

TISSUE_CONTACT_CLONES
void addPatchForces(const PatchElements& patches, BatchRange range, bool turns, double tangent_angle,
                    const PaddedVector* x, const std::vector<RotationBatch>& tangents,
                    std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned, PaddedVector* forces) {
  const VaryingMaterial material{patches.materials};
  forPatchBatches(patches, range, [&](std::size_t b, auto width) TISSUE_CONTACT_ALWAYS_INLINE {
    using L = typename decltype(width)::Type;
    LaneMatrixOf<L> F, R, S, P;
    L lambda, mu;
    meanGradients(patches, b, x, F);
    if (turns) {
      storeBits<L>(turn(F, &tangents[b], tangent_angle, &rotations[b], R, S), &turned[b]);
    } else {
      S = F;
    }
    material.get(b, lambda, mu);
    stress(lambda, mu, turns ? &R : nullptr, S, P);
    addPatchStressForces(patches, b, P, forces);
  });
}

TISSUE_CONTACT_CLONES
void addOverstressForces(const std::vector<ElementBatch>& batches, const LameParameters& material, bool turns,
                         double tangent_angle, const PaddedVector* x, const std::vector<RotationBatch>& tangents,
                         std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned,
                         const std::vector<PronyStep>& steps, std::vector<StrainBatch>& strains,
                         std::vector<StrainBatch>& held, PaddedVector* forces) {
  overstress(batches, UniformMaterial{material}, turns, tangent_angle, x, tangents, rotations, turned, steps, strains,
             held, forces);
}

TISSUE_CONTACT_CLONES
void addOverstressForces(const std::vector<ElementBatch>& batches, const std::vector<BatchMaterial>& materials,
                         bool turns, double tangent_angle, const PaddedVector* x,
                         const std::vector<RotationBatch>& tangents, std::vector<RotationBatch>& rotations,
                         std::vector<unsigned char>& turned, const std::vector<PronyStep>& steps,
                         std::vector<StrainBatch>& strains, std::vector<StrainBatch>& held, PaddedVector* forces) {
  overstress(batches, VaryingMaterial{materials}, turns, tangent_angle, x, tangents, rotations, turned, steps, strains,
             held, forces);
}

}  // namespace tissue_contact
