#include "tissue/membrane.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tissue/block_slots.h"
#include "tissue/plate_bending.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

using Matrix32 = Eigen::Matrix<double, 3, 2>;

struct MembraneTriangle {
  Triangle nodes;
  Eigen::Matrix<double, 2, 3> gradients;  ///< of the shape functions, columns, 1/m
  double volume;                          ///< A h, m^3
  LameParameters lame;                    ///< of plane stress, Pa
  double damping_s;                       ///< what of its stiffness goes into State::damping
  BlockSlots<3> slots;
};

struct Membrane::MembraneState : State {
  PlateBending::Folds folds;
};

namespace {

/// F = R U, and the stress T in the frame of U.
struct Stretch {
  Matrix32 R;
  Vector3 normal;
  Matrix2 U;
  Matrix2 T;  ///< Pa
};

/// A unit vector across both columns of F, also when they are parallel or zero.
Vector3 normalOf(const Matrix32& F, const Vector3& cross) {
  const double scale = F.squaredNorm();
  if (cross.norm() > 1e-12 * scale) return cross.normalized();
  const Vector3 longest = F.col(F.col(1).squaredNorm() > F.col(0).squaredNorm() ? 1 : 0);
  return longest.squaredNorm() > 0.0 ? longest.unitOrthogonal() : Vector3::UnitZ();
}

Stretch stretchOf(const MembraneTriangle& triangle, const NodalVectors& x) {
  Matrix32 F = Matrix32::Zero();
  for (int i = 1; i < 3; ++i) {
    F += (x.col(triangle.nodes[i]) - x.col(triangle.nodes[0])) * triangle.gradients.col(i).transpose();
  }
  Stretch stretch;
  const Vector3 cross = F.col(0).cross(F.col(1));
  stretch.normal = normalOf(F, cross);
  // In the plane, F + cof F = (sigma_1 + sigma_2) R.
  stretch.R.col(0) = F.col(0) + F.col(1).cross(stretch.normal);
  stretch.R.col(1) = F.col(1) + stretch.normal.cross(F.col(0));
  const double sum = std::sqrt(F.squaredNorm() + 2.0 * cross.norm());
  if (sum > 0.0) {
    stretch.R /= sum;
  } else {
    stretch.R << 1.0, 0.0, 0.0, 1.0, 0.0, 0.0;  // all three nodes in one place: push them apart somehow
  }
  stretch.U = stretch.R.transpose() * F;
  const Matrix2 strain = 0.5 * (stretch.U + stretch.U.transpose()) - Matrix2::Identity();
  stretch.T = 2.0 * triangle.lame.mu * strain + triangle.lame.lambda * strain.trace() * Matrix2::Identity();
  return stretch;
}

/// Stiffness across the plane per gradient of the deflection: T U^-1 without its negative part. T and U have the same
/// eigenvectors.
Matrix2 tensionAcross(const Stretch& stretch) {
  constexpr double kCollapsed = 0.1;  // the quotient is bounded where U vanishes
  const double mean = 0.5 * stretch.U.trace();
  const Vector2 deviator(0.5 * (stretch.U(0, 0) - stretch.U(1, 1)), 0.5 * (stretch.U(0, 1) + stretch.U(1, 0)));
  const double radius = deviator.norm();
  const double mean_stress = 0.5 * stretch.T.trace();
  const double shear_stress =
      radius > 0.0
          ? (deviator.x() * (stretch.T(0, 0) - stretch.T(1, 1)) + 2.0 * deviator.y() * stretch.T(0, 1)) / (2.0 * radius)
          : 0.0;
  const double high = std::max(0.0, mean_stress + shear_stress) / std::max(mean + radius, kCollapsed);
  const double low = std::max(0.0, mean_stress - shear_stress) / std::max(mean - radius, kCollapsed);
  Matrix2 result = 0.5 * (high + low) * Matrix2::Identity();
  if (radius > 0.0) {
    Matrix2 directions;
    directions << deviator.x(), deviator.y(), deviator.y(), -deviator.x();
    result += 0.5 * (high - low) / radius * directions;
  }
  return result;
}

void addStiffness(const MembraneTriangle& triangle, const Stretch& stretch, Elasticity::State& state) {
  const Matrix3 c = stretch.R * triangle.gradients;  // columns
  const double turning = stretch.T.trace() > 0.0 ? stretch.T.trace() / stretch.U.trace() : 0.0;
  const double V = triangle.volume;
  const double lambda = V * triangle.lame.lambda;
  const double straight = V * (triangle.lame.mu + 0.5 * turning);
  const double crossed = V * (triangle.lame.mu - 0.5 * turning);
  const Matrix3 across = stretch.normal * stretch.normal.transpose();
  const Matrix3 in_plane = Matrix3::Identity() - across;
  const Matrix3 tension = V * triangle.gradients.transpose() * tensionAcross(stretch) * triangle.gradients;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      if (triangle.slots(i, j) < 0) continue;
      const Matrix3 block = (lambda * c.col(i)) * c.col(j).transpose() + (crossed * c.col(j)) * c.col(i).transpose() +
                            straight * c.col(i).dot(c.col(j)) * in_plane + tension(i, j) * across;
      addBlock(i == j, triangle.slots(i, j), block, triangle.damping_s, state.stiffness, state.damping);
    }
  }
}

MembraneTriangle makeTriangle(const NodalVectors& rest, const Triangle& nodes) {
  const Vector3 e1 = rest.col(nodes[1]) - rest.col(nodes[0]);
  const Vector3 e2 = rest.col(nodes[2]) - rest.col(nodes[0]);
  const Vector3 along = e1.normalized();
  Matrix2 D;
  D << e1.norm(), along.dot(e2), 0.0, e1.cross(e2).norm() / e1.norm();
  MembraneTriangle triangle{};
  triangle.nodes = nodes;
  triangle.gradients.rightCols<2>() = D.inverse().transpose();
  triangle.gradients.col(0) = -triangle.gradients.rightCols<2>().rowwise().sum();
  return triangle;
}

}  // namespace

Membrane::Membrane(const NodalVectors& rest, const std::vector<Triangle>& triangles, const std::vector<bool>& fixed,
                   double thickness_m, const ElementMaterials& materials)
    : rest_(rest) {
  requirePositive("thickness_m", thickness_m, "m");
  for (const MaterialDescription& material : materials.materials) checkMaterial(material, "");
  auto bending = std::make_unique<PlateBending>(rest, triangles, thickness_m, materials);
  std::vector<std::vector<int>> elements = bending->patches();
  for (const Triangle& triangle : triangles) elements.emplace_back(triangle.begin(), triangle.end());
  constant_stiffness_ = BlockMatrix::forElements(elements, fixed);
  if (!materials.damping_s.empty()) constant_damping_ = constant_stiffness_;
  bending->connect(fixed, constant_stiffness_, constant_damping_);
  bending_ = std::move(bending);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    triangles_.push_back(makeTriangle(rest, triangles[t]));
    triangles_.back().volume = thickness_m * triangleArea(rest, triangles[t]);
    triangles_.back().lame = planeStressParameters(materials.of(t));
    triangles_.back().damping_s = materials.dampingOf(t);
    triangles_.back().slots = findSlots(*constant_stiffness_.pattern, triangles[t], fixed);
  }
}

Membrane::~Membrane() = default;

std::unique_ptr<Elasticity::State> Membrane::makeState() const {
  auto state = std::make_unique<MembraneState>();
  state->stiffness = constant_stiffness_;
  state->damping = constant_damping_;
  state->folds = bending_->makeFolds();
  NodalVectors forces(3, rest_.cols());
  update(rest_, *state, forces);
  return state;
}

void Membrane::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<MembraneState&>(any_state);  // made by makeState()
  forces.setZero();
  state.stiffness.copyBlocks(constant_stiffness_);
  state.damping.copyBlocks(constant_damping_);
  for (const MembraneTriangle& triangle : triangles_) {
    const Stretch stretch = stretchOf(triangle, x);
    const Matrix3 pulls = triangle.volume * (stretch.R * stretch.T) * triangle.gradients;
    for (int i = 0; i < 3; ++i) forces.col(triangle.nodes[i]) -= pulls.col(i);
    addStiffness(triangle, stretch, state);
  }
  bending_->add(x, state.folds, state, forces);
}

double Membrane::energy(const NodalVectors& x) const {
  double energy = bending_->energy(x);
  for (const MembraneTriangle& triangle : triangles_) {
    const Stretch stretch = stretchOf(triangle, x);
    energy += 0.5 * triangle.volume * stretch.T.cwiseProduct(stretch.U - Matrix2::Identity()).sum();
  }
  return energy;
}

}  // namespace tissue_contact
