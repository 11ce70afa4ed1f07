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

#include <array>
#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

struct TetElement;
struct TetElements;

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
                const ElementMaterials& materials);
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

 protected:
  /// For models that add to this one: with their own parameters in the place of Lame's, and more couplings.
  TetElasticity(bool corotational, std::unique_ptr<const TetElements> tets);

  const TetElements& tets() const { return *tets_; }
  void prepare(RotationState& state) const;

 private:
  template <bool kDamps>
  static void addStiffness(const TetElement& element, const Quaternion& rotation, double sign, State& state);
  void refreshStiffness(std::size_t batch, RotationState& state) const;

  bool corotational_;
  std::unique_ptr<const TetElements> tets_;
};

/// Rotation nearest to F (polar factor; where F is inverted, the nearest proper rotation), starting from a guess.
/// Newton on the stationarity of tr(R'F), falling back to an SVD; converged to round-off, so the guess only saves time.
Quaternion nearestRotation(const Matrix3& F, const Quaternion& guess);

}  // namespace tissue_contact
