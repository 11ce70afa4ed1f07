/// @file
/// Room `tissue`, private: bending of a membrane. Positions in; bending forces and stiffness out.
///
/// Energy: sum over the triangles of A/2 (kappa - kappa_rest)' M (kappa - kappa_rest), M = B plateTensor(nu), B the
/// bending stiffness (N m), kappa from plate_stencil.h, in one of two forms:
/// - flat at rest: kappa is taken of the positions themselves, each coordinate like a deflection. The energy is then
///   quadratic, does not change with rigid motion, and its stiffness is constant: nothing to assemble in a step. Exact
///   for bending without stretching. Source of the idea: Bergou, Wardetzky, Harmon, Zorin, Grinspun, "A quadratic
///   bending model for inextensible surfaces", SGP 2006, on our stencil.
/// - curved at rest: kappa is taken of the angles between neighbouring triangles, and the stiffness leaves out the
///   second derivatives of the angles (Gauss-Newton): positive semidefinite, and exact where kappa = kappa_rest.
#pragma once

#include <vector>

#include "tissue/plate_stencil.h"
#include "tissue_contact/core/block_matrix.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

class PlateBending {
 public:
  static constexpr int kMaxNodes = 12;  ///< of a triangle, its neighbours and theirs

  /// Workspace for a body that is curved at rest.
  struct Folds {
    std::vector<double> angles;                     ///< per hinge, less that at rest, rad
    std::vector<std::array<Vector3, 4>> gradients;  ///< by the hinge's nodes, rad/m
  };

  PlateBending(const NodalVectors& rest, const std::vector<Triangle>& triangles, double thickness_m,
               const ElementMaterials& materials);

  /// Nodes that bend together, for the pattern of the stiffness. None if nothing resists bending.
  std::vector<std::vector<int>> patches() const;

  /// To be called once, before the rest.
  /// @param constant part of K and (if it has rows) D that never changes: added to.
  void connect(const std::vector<bool>& fixed, BlockMatrix& constant_stiffness, BlockMatrix& constant_damping);

  Folds makeFolds() const;

  /// Adds forces (N), and the part of the matrices that is not constant. No allocation.
  void add(const NodalVectors& x, Folds& folds, Elasticity::State& state, NodalVectors& forces) const;

  double energy(const NodalVectors& x) const;

 private:
  struct Patch {
    int count = 0;
    std::array<int, kMaxNodes> nodes;
    Matrix3 tensor;    ///< A M, N m^3
    double damping_s;  ///< what of its stiffness goes into State::damping
    CurvatureStencil stencil;
    std::array<std::array<int, 4>, CurvatureStencil::kMaxHinges> hinge_nodes;  ///< as indices into `nodes`
    Eigen::Matrix<double, 3, kMaxNodes> weights;  ///< curvature = weights * deflections, 1/m^2
  };
  using Slots = std::array<std::array<int, kMaxNodes>, kMaxNodes>;

  static Patch makePatch(const CurvatureStencil& stencil, const std::vector<Hinge>& hinges);
  void addFlat(const Patch& patch, const NodalVectors& x, NodalVectors& forces) const;
  void addCurved(std::size_t patch, const Folds& folds, Elasticity::State& state, NodalVectors& forces) const;

  std::vector<Hinge> hinges_;
  std::vector<double> rest_angles_;  ///< per hinge, rad
  bool flat_ = true;
  std::vector<Patch> patches_;
  std::vector<Slots> slots_;  ///< of the patches, if curved
};

}  // namespace tissue_contact
