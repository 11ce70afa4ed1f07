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
///
/// With State::adapt_rotations a corotational body is linear, R = I, while no element of it has turned by kTurnOn, and
/// again once all have been below kTurnOff for kCalmUpdates updates. R passes between I and the nearest rotation in
/// kBlendUpdates equal parts of the angle, so that forces and energy go over smoothly. What R = I neglects at a turn theta:
/// a spurious strain of theta^2 / 2, and the turn of the stress by theta.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

struct BatchRange;
struct TetElements;

/// Model: const after construction. Thread-safe for different states.
class TetElasticity : public Elasticity {
 public:
  /// @param rest 3 x n, m.
  /// @throws std::invalid_argument for a material out of range.
  TetElasticity(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
                const ElementMaterials& materials);
  ~TetElasticity() override;

  std::unique_ptr<State> makeState() const override;
  std::unique_ptr<State> makeStateAt(const NodalVectors& x) const override;

  /// An element's share of the stiffness is recomputed only when it has turned by more than kTangentAngle since; forces
  /// are always exact.
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;

  void holdStill(const std::vector<bool>& still, const NodalVectors& x, State& state) const override;

  /// sum V (mu e:e + lambda/2 tr(e)^2).
  double energy(const NodalVectors& x) const override;

  /// 0.01 rad: the tangent is then off by 1 % of the force increment within one step, below the first-order error of
  /// the implicit Euler step itself.
  static constexpr double kTangentAngle = 0.01;

  static constexpr double kTurnOn = 0.02;  ///< rad: a spurious strain of 2e-4
  static constexpr double kTurnOff = 0.01;
  static constexpr int kCalmUpdates = 200;
  static constexpr int kBlendUpdates = 20;

 protected:
  struct RotationState;

  /// For models that add to this one: with their own parameters in the place of Lame's, and more couplings. They follow
  /// rotations always.
  TetElasticity(bool corotational, std::unique_ptr<const TetElements> tets);

  const TetElements& tets() const { return *tets_; }
  /// @param x null: undeformed.
  void prepare(const NodalVectors* x, RotationState& state) const;
  void updateElements(const NodalVectors& x, RotationState& state) const;
  /// Of the elements of a batch that have turned.
  void refreshStiffness(std::size_t batch, RotationState& state) const;

 private:
  void evaluateStill(const NodalVectors& x, RotationState& state) const;
  void evaluate(const std::vector<BatchRange>& ranges, RotationState& state) const;
  void findRotations(const NodalVectors& x, RotationState& state) const;
  void addStiffness(std::size_t element, const Quaternion& rotation, State& state) const;
  void turnStiffness(std::size_t element, const Quaternion& old, const Quaternion& rotation, State& state) const;
  void adaptRotations(const NodalVectors& x, RotationState& state) const;

  bool corotational_;
  bool adapts_;  ///< may be linear for a while
  std::unique_ptr<const TetElements> tets_;
};

/// Rotation nearest to F (polar factor; where F is inverted, the nearest proper rotation), starting from a guess.
/// Newton on the stationarity of tr(R'F), falling back to an SVD; converged to round-off, so the guess only saves time.
Quaternion nearestRotation(const Matrix3& F, const Quaternion& guess);

}  // namespace tissue_contact
