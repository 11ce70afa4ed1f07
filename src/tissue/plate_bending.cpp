#include "tissue/plate_bending.h"

#include <algorithm>
#include <cmath>

#include "tissue/block_slots.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace {

/// Folds at rest below this (rad) are the rounding of a flat mesh.
constexpr double kFlatAngle = 1e-9;

using Vertices = std::array<Vector3, 4>;

Vertices verticesOf(const Hinge& hinge, const NodalVectors& x) {
  return {x.col(hinge.nodes[0]), x.col(hinge.nodes[1]), x.col(hinge.nodes[2]), x.col(hinge.nodes[3])};
}

/// Angle between the normals of a hinge's triangles, rad, positive where it is a valley.
double foldAngle(const Vertices& v) {
  const Vector3 edge = v[1] - v[0];
  const Vector3 n1 = edge.cross(v[2] - v[0]);
  const Vector3 n2 = (v[3] - v[0]).cross(edge);
  return std::atan2(-edge.dot(n1.cross(n2)), edge.norm() * n1.dot(n2));
}

/// A wing's share of the gradient of foldAngle(): that of its tip, and of the edge's ends.
void addWing(const Vector3& a, const Vector3& edge, const Vector3& tip, const Vector3& normal, Vertices& gradient,
             std::size_t tip_index) {
  // A wing that has collapsed to a thousandth of its edge has no direction to fold in.
  constexpr double kCollapsed = 1e-3;
  const double squared = edge.squaredNorm();
  const double twice_area = std::max(normal.norm(), kCollapsed * squared);
  if (!(twice_area > 0.0)) return;
  const Vector3 by_height = std::sqrt(squared) / (twice_area * twice_area) * normal;
  const double at = edge.dot(tip - a) / squared;
  gradient[tip_index] += by_height;
  gradient[0] -= (1.0 - at) * by_height;
  gradient[1] -= at * by_height;
}

Vertices foldGradient(const Vertices& v) {
  const Vector3 edge = v[1] - v[0];
  Vertices gradient;
  gradient.fill(Vector3::Zero());
  addWing(v[0], edge, v[2], edge.cross(v[2] - v[0]), gradient, 2);
  addWing(v[0], edge, v[3], (v[3] - v[0]).cross(edge), gradient, 3);
  return gradient;
}

double bendingStiffness(const MaterialDescription& material, double thickness) {
  if (material.bending_stiffness_n_m >= 0.0) return material.bending_stiffness_n_m;
  const double nu = material.poissons_ratio;
  return material.youngs_modulus_pa * thickness * thickness * thickness / (12.0 * (1.0 - nu * nu));
}

}  // namespace

PlateBending::PlateBending(const NodalVectors& rest, const std::vector<Triangle>& triangles, double thickness_m,
                           const ElementMaterials& materials) {
  std::vector<double> poissons_ratio(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) poissons_ratio[t] = materials.of(t).poissons_ratio;
  PlateStencils stencils = makePlateStencils(rest, triangles, poissons_ratio);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const double stiffness = bendingStiffness(materials.of(t), thickness_m);
    if (!(stiffness > 0.0) || stencils.triangles[t].count == 0) continue;
    patches_.push_back(makePatch(stencils.triangles[t], stencils.hinges));
    patches_.back().tensor = triangleArea(rest, triangles[t]) * stiffness * plateTensor(poissons_ratio[t]);
    patches_.back().damping_s = materials.dampingOf(t);
  }
  if (patches_.empty()) return;
  hinges_ = std::move(stencils.hinges);
  for (const Hinge& hinge : hinges_) {
    rest_angles_.push_back(foldAngle(verticesOf(hinge, rest)));
    flat_ = flat_ && std::abs(rest_angles_.back()) <= kFlatAngle;
  }
}

PlateBending::Patch PlateBending::makePatch(const CurvatureStencil& stencil, const std::vector<Hinge>& hinges) {
  Patch patch;
  patch.stencil = stencil;
  patch.weights.setZero();
  for (int h = 0; h < stencil.count; ++h) {
    const Hinge& hinge = hinges[stencil.hinges[h]];
    for (std::size_t i = 0; i < 4; ++i) {
      const auto end = patch.nodes.begin() + patch.count;
      const auto found = std::find(patch.nodes.begin(), end, hinge.nodes[i]);
      if (found == end) patch.nodes[patch.count++] = hinge.nodes[i];
      const auto local = found - patch.nodes.begin();
      patch.hinge_nodes[h][i] = static_cast<int>(local);
      patch.weights.col(local) += hinge.jump[i] * stencil.columns.col(h);
    }
  }
  return patch;
}

std::vector<std::vector<int>> PlateBending::patches() const {
  std::vector<std::vector<int>> nodes;
  nodes.reserve(patches_.size());
  for (const Patch& patch : patches_) nodes.emplace_back(patch.nodes.begin(), patch.nodes.begin() + patch.count);
  return nodes;
}

void PlateBending::connect(const std::vector<bool>& fixed, BlockMatrix& constant_stiffness,
                           BlockMatrix& constant_damping) {
  for (const Patch& patch : patches_) {
    Slots slots{};
    for (int i = 0; i < patch.count; ++i) {
      for (int j = 0; j < patch.count; ++j) {
        slots[i][j] = slotOf(*constant_stiffness.pattern, fixed, patch.nodes[i], patch.nodes[j]);
        if (!flat_ || j < i || slots[i][j] < 0) continue;
        const Matrix3 block = patch.weights.col(i).dot(patch.tensor * patch.weights.col(j)) * Matrix3::Identity();
        addBlock(i == j, slots[i][j], block, patch.damping_s, constant_stiffness, constant_damping);
      }
    }
    if (!flat_) slots_.push_back(slots);
  }
}

PlateBending::Folds PlateBending::makeFolds() const {
  Folds folds;
  if (flat_) return folds;
  folds.angles.resize(hinges_.size());
  folds.gradients.resize(hinges_.size());
  return folds;
}

void PlateBending::add(const NodalVectors& x, Folds& folds, Elasticity::State& state, NodalVectors& forces) const {
  if (flat_) {
    for (const Patch& patch : patches_) addFlat(patch, x, forces);
    return;
  }
  for (std::size_t h = 0; h < hinges_.size(); ++h) {
    const Vertices vertices = verticesOf(hinges_[h], x);
    folds.angles[h] = foldAngle(vertices) - rest_angles_[h];
    folds.gradients[h] = foldGradient(vertices);
  }
  for (std::size_t p = 0; p < patches_.size(); ++p) addCurved(p, folds, state, forces);
}

void PlateBending::addFlat(const Patch& patch, const NodalVectors& x, NodalVectors& forces) const {
  Matrix3 curvature = Matrix3::Zero();           // a column per coordinate
  const Vector3 origin = x.col(patch.nodes[0]);  // the weights sum to zero: only rounding depends on it
  for (int i = 1; i < patch.count; ++i) {
    curvature += patch.weights.col(i) * (x.col(patch.nodes[i]) - origin).transpose();
  }
  const Matrix3 moment = curvature.transpose() * patch.tensor;
  for (int i = 0; i < patch.count; ++i) forces.col(patch.nodes[i]) -= moment * patch.weights.col(i);
}

void PlateBending::addCurved(std::size_t index, const Folds& folds, Elasticity::State& state,
                             NodalVectors& forces) const {
  const Patch& patch = patches_[index];
  Vector3 curvature = Vector3::Zero();
  std::array<Matrix3, kMaxNodes> gradients;  // of the curvature, by node
  gradients.fill(Matrix3::Zero());
  for (int h = 0; h < patch.stencil.count; ++h) {
    const Vector3 column = patch.stencil.columns.col(h);
    const std::array<Vector3, 4>& by_node = folds.gradients[patch.stencil.hinges[h]];
    curvature += folds.angles[patch.stencil.hinges[h]] * column;
    for (std::size_t i = 0; i < 4; ++i) gradients[patch.hinge_nodes[h][i]] += column * by_node[i].transpose();
  }
  const Vector3 moment = patch.tensor * curvature;
  for (int i = 0; i < patch.count; ++i) {
    forces.col(patch.nodes[i]) -= gradients[i].transpose() * moment;
    const Matrix3 left = gradients[i].transpose() * patch.tensor;
    for (int j = i; j < patch.count; ++j) {
      const int slot = slots_[index][i][j];
      if (slot < 0) continue;
      const Matrix3 block = left * gradients[j];
      addBlock(i == j, slot, block, patch.damping_s, state.stiffness, state.damping);
    }
  }
}

double PlateBending::energy(const NodalVectors& x) const {
  double energy = 0.0;
  for (const Patch& patch : patches_) {
    if (flat_) {
      Matrix3 curvature = Matrix3::Zero();
      for (int i = 1; i < patch.count; ++i) {
        curvature += patch.weights.col(i) * (x.col(patch.nodes[i]) - x.col(patch.nodes[0])).transpose();
      }
      energy += 0.5 * (curvature.transpose() * patch.tensor * curvature).trace();
    } else {
      Vector3 curvature = Vector3::Zero();
      for (int h = 0; h < patch.stencil.count; ++h) {
        const int hinge = patch.stencil.hinges[h];
        curvature += (foldAngle(verticesOf(hinges_[hinge], x)) - rest_angles_[hinge]) * patch.stencil.columns.col(h);
      }
      energy += 0.5 * curvature.dot(patch.tensor * curvature);
    }
  }
  return energy;
}

}  // namespace tissue_contact
