/// @file
/// A body to be swept, and the textbook's sweep over it.
#pragma once

#include <Eigen/LU>
#include <array>
#include <functional>
#include <random>
#include <vector>

#include "solver/body_sweep.h"

namespace tissue_contact {

/// A body with blocks of no symmetry of their own in K and in D, which is no multiple of K.
struct RandomBody {
  std::vector<bool> fixed;
  BlockMatrix K, D;
  BodySystem system;

  /// @param pattern_fixed nodes without blocks; `held_still` are fixed too, but have blocks.
  RandomBody(int nodes, double joined, const std::vector<int>& pattern_fixed, const std::vector<int>& held_still,
             bool damped) {
    std::vector<std::array<int, 2>> pairs;
    for (int i = 0; i < nodes; ++i) {
      for (int j = 0; j < i; ++j) {
        if (uniform_(random_) < joined) pairs.push_back({i, j});
      }
    }
    fixed.assign(static_cast<std::size_t>(nodes), false);
    for (const int i : pattern_fixed) fixed[i] = true;
    K = BlockMatrix::forElements(pairs, fixed);
    D = BlockMatrix(K.pattern);
    fill(K, 8.0 + nodes);
    fill(D, 5.0);
    for (const int i : held_still) fixed[i] = true;
    system.K = &K;
    system.D = damped ? &D : nullptr;
    system.fixed = &fixed;
    system.stiffness_scale = 0.7;
    system.damping_scale = 0.2;
    system.mass.resize(nodes);
    system.b.resize(3, nodes);
    for (int i = 0; i < nodes; ++i) {
      system.mass[i] = 1.0 + uniform_(random_);
      system.b.col(i) = fixed[i] ? Vector3(Vector3::Zero()) : randomVector();
    }
  }
  RandomBody(const RandomBody&) = delete;
  RandomBody& operator=(const RandomBody&) = delete;

  Vector3 randomVector() { return {uniform_(random_) - 0.5, uniform_(random_) - 0.5, uniform_(random_) - 0.5}; }
  bool chance(double of) { return uniform_(random_) < of; }

 private:
  void fill(BlockMatrix& matrix, double diagonal) {
    for (int i = 0; i < matrix.rows(); ++i) {
      if (fixed[i]) continue;
      Matrix3 own;
      own << randomVector(), randomVector(), randomVector();
      matrix.diagonal[i] = diagonal * Matrix3::Identity() + own + own.transpose();
      matrix.pattern->forRow(i, [&](int j, int place) {
        if (j < i) return;
        Matrix3 block;
        block << randomVector(), randomVector(), randomVector();
        matrix.add(place, block);
      });
    }
  }

  std::mt19937 random_{5};
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

/// What a contact makes of a node that it may hold: true, it holds it.
using Hold = std::function<bool(int node, Vector3& v)>;

/// The textbook's sweep. @return the defects met at nodes that nothing holds.
inline DefectsMet plainSweep(const BodySystem& body, const NodalVectors& impulses, bool forward,
                             const std::vector<bool>& may_hold, const Hold& hold, NodalVectors& v) {
  const int nodes = body.K->rows();
  DefectsMet met;
  for (int step = 0; step < nodes; ++step) {
    const int i = forward ? step : nodes - 1 - step;
    if ((*body.fixed)[i]) continue;
    Vector3 defect = body.b.col(i) + impulses.col(i) - body.mass[i] * v.col(i);
    Matrix3 block = body.mass[i] * Matrix3::Identity();
    const auto take = [&](const BlockMatrix& matrix, double scale) {
      defect -= scale * (matrix.diagonal[i] * v.col(i));
      matrix.pattern->forRow(i, [&](int j, int place) { defect -= scale * (matrix.block(place) * v.col(j)); });
      block += scale * matrix.diagonal[i];
    };
    take(*body.K, body.stiffness_scale);
    if (body.D != nullptr) take(*body.D, body.damping_scale);
    v.col(i) += block.inverse() * defect;
    Vector3 moved = v.col(i);
    const bool held = may_hold[i] && hold(i, moved);
    v.col(i) = moved;
    if (!held) met += {defect.squaredNorm(), defect};
  }
  return met;
}

inline const auto kHoldsNothing = [](int /*node*/) { return false; };

inline NodalVectors randomVectors(RandomBody& body) {
  NodalVectors u = NodalVectors::Zero(3, body.K.rows());
  for (int i = 0; i < body.K.rows(); ++i) u.col(i) = body.randomVector();
  return u;
}

}  // namespace tissue_contact
