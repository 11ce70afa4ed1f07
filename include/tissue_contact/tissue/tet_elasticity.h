/// @file
/// Room `tissue`: linear and corotational elasticity on four-node tetrahedra. Positions in; elastic forces and the
/// stiffness matrix of the step's linearisation out.
///
/// Per element, with D = [x1-x0, x2-x0, x3-x0], F = D D_rest^-1 and R the rotation nearest to F (R = I when linear):
///   strain  e = sym(R'F) - I,   stress  P = R (2 mu e + lambda tr(e) I),   force on node i  f_i = -V P grad N_i.
/// Stiffness blocks with c_i = R grad N_i:  K_ij = V (lambda c_i c_j' + mu c_j c_i' + mu (c_i . c_j) I),
/// the stiffness-warping tangent, which leaves out dR/dx and is therefore symmetric positive semidefinite.
/// Source: Mueller & Gross, "Interactive Virtual Materials", GI 2004, eq. 10-13; the rotation is the polar factor of F
/// (Etzmuss, Keckeisen, Strasser, PG 2003).
#pragma once

#include <vector>

#include "tissue_contact/core/block_matrix.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/scene/scene.h"
#include "tissue_contact/tissue/elasticity.h"

namespace tissue_contact {

struct ElementBatch;

/// Model: const after construction. Thread-safe for different states.
class TetElasticity : public Elasticity {
 public:
  /// Rotations are kept four elements at a time, as (w, x, y, z) of any length.
  struct RotationState : State {
    std::vector<std::array<std::array<double, 4>, 4>> rotations;          ///< of each element at the last update
    std::vector<std::array<std::array<double, 4>, 4>> tangent_rotations;  ///< those `stiffness` was computed with
    std::vector<unsigned char> turned;                                    ///< scratch: elements to refresh, a bit each
  };

  /// @param rest 3 x n, m. @throws std::invalid_argument for a material out of range.
  TetElasticity(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
                const MaterialDescription& material);
  ~TetElasticity() override;

  std::unique_ptr<State> makeState() const override;

  /// An element's share of the stiffness is recomputed only when it has turned by more than kTangentAngle since; forces
  /// are always exact.
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;

  /// sum V (mu e:e + lambda/2 tr(e)^2).
  double energy(const NodalVectors& x) const override;

  /// 0.01 rad: the tangent is then off by 1 % of the force increment within one step, below the first-order error of
  /// the implicit Euler step itself.
  static constexpr double kTangentAngle = 0.01;

 private:
  struct Element {
    Tetrahedron nodes;
    Matrix3 rest_inverse;  ///< D_rest^-1, 1/m; its rows are grad N_1..N_3
    double volume;         ///< m^3
    std::array<std::array<int, 4>, 4>
        at;  ///< where block (i, j) is in K: index into values, the node if i = j; -1: not stored
  };

  void addElement(const NodalVectors& rest, const Tetrahedron& tet, const std::vector<bool>& fixed);
  void fillBatches();
  void addStiffness(const Element& element, const Quaternion& rotation, double sign, BlockMatrix& K) const;
  void refreshStiffness(std::size_t batch, RotationState& state) const;

  bool corotational_;
  double lame_lambda_;  ///< Pa
  double lame_mu_;      ///< Pa
  std::vector<Element> elements_;
  std::vector<ElementBatch> batches_;  ///< the same elements, laid out for the force kernel
  BlockMatrix pattern_;
};

/// Rotation nearest to F (polar factor; where F is inverted, the nearest proper rotation), starting from a guess.
/// Newton on the stationarity of tr(R'F), falling back to an SVD; converged to round-off, so the guess only saves time.
Quaternion nearestRotation(const Matrix3& F, const Quaternion& guess);

}  // namespace tissue_contact
