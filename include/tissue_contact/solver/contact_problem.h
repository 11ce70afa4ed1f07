/// @file
/// Room `solver`: the contact problem of one step. Linear systems of the tissues and contact rows in; velocities,
/// impulses and states out.
///
///   A v = b + J' lambda,   u = J v - u_tool + C lambda,   0 <= lambda_n  _|_  u_n + gap/dt >= 0,   Coulomb friction per contact by
///   u_t, C: diagonal, normal_compliance and twice tangential_compliance of its row.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/core/block_matrix.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/coulomb.h"

namespace tissue_contact {

/// Linear system of one tissue, A = diag(mass) + stiffness_scale * K + damping_scale * D, with K and D symmetric, which
/// solvers rely on. K is not copied, so a change of dt costs nothing. For an implicit Euler step with Rayleigh
/// damping alpha M + beta K: mass_i = (1 + alpha dt) m_i, stiffness_scale = dt (dt + beta), b = M v0 + dt f(x0).
struct BodySystem {
  const BlockMatrix* K = nullptr;  ///< N/m
  /// N s/m, of K's pattern, added as dt * D; null: damping is all in stiffness_scale and mass.
  const BlockMatrix* D = nullptr;
  const std::vector<bool>* fixed = nullptr;  ///< per node: its velocity is 0; may differ from step to step
  /// All nodes rest in this step: b = 0, v = 0 is the answer, the rest of this may be old. For solvers that carry
  /// something from step to step; the others may go by `fixed` alone.
  bool asleep = false;
  /// Nodes of each part that is far stiffer than most of the body, ascending, none in two parts; null: there is none. For solvers that look
  /// for the rigid motions of such parts; answers do not depend on it beyond their tolerance.
  const std::vector<std::vector<int>>* stiff_parts = nullptr;
  /// Where the nodes are, m; needed with stiff_parts. Without it no solver looks for motions of parts that blend into each other either.
  const NodalVectors* x = nullptr;
  double stiffness_scale = 0.0;  ///< s^2
  double damping_scale = 0.0;    ///< s: dt where there is a D
  VectorX mass;                  ///< kg, per node
  NodalVectors b;                ///< N s; finite, of fixed nodes too
  /// |b - M v0|, N s: what changes velocities in the step, which a solver's tolerance is a part of. Negative: |b|.
  double change_n_s = -1.0;
  /// Of a body that neither fixed nodes nor springs hold: |sum of b - M v0 over its nodes|, N s. What such a body lacks in all moves it, so a
  /// solver's tolerance is a part of this and of what its contacts bring it in all as well. Negative: something holds the body.
  double net_change_n_s = -1.0;
};

/// A node a contact acts on.
struct RowNode {
  int body = 0;  ///< index into ContactProblem::bodies
  int node = 0;
  double weight = 0.0;  ///< barycentric, never 0; negative on the side n points away from (tissue against tissue)
};

/// One contact as the solver sees it.
struct ContactRow {
  std::array<RowNode, 4> nodes;        ///< no node twice
  int node_count = 0;                  ///< 1 to 4
  Matrix3 R_WC = Matrix3::Identity();  ///< columns (n, t1, t2), n from the instrument into the tissue
  double gap_m = 0.0;                  ///< at the start of the step
  /// u_n + normal_compliance * lambda_n must be at least this, m/s: -gap/dt, limited when penetrating deeply.
  double required_u_n = 0.0;
  double normal_compliance = 0.0;  ///< 1/kg: c / dt^2 where a sheet gives way through its thickness by c, m/N
  /// Likewise where it shears, in both tangential directions: what is stuck has u_t + tangential_compliance * lambda_t = 0, what slides
  /// does so along that. u_tool has what the force of the step before shears it by, so that only a change of force moves it.
  double tangential_compliance = 0.0;
  /// Velocity of the instrument's material point, contact frame, m/s; tangentially with what the simulation lets the
  /// contact do besides (a landing, a slip taken back, a sheet's shear).
  Vector3 u_tool = Vector3::Zero();
  CoulombLaw law;
  bool was_sliding = false;  ///< it was kinetic at the end of the previous step
  bool was_static = false;   ///< it was static at the end of the previous step
  /// The contact pair, by what touches the nodes: an instrument, or -1 - a tissue. Answers do not depend on it, but steps go on
  /// until the forces of each are known.
  int pair = 0;
};

/// Of the directions of its frame, 1/kg: what its sheets add to the diagonal of its local operator.
inline Vector3 compliancesOf(const ContactRow& row) {
  return {row.normal_compliance, row.tangential_compliance, row.tangential_compliance};
}

struct ContactProblem {
  double dt_s = 0.0;
  std::vector<BodySystem> bodies;
  std::vector<ContactRow> contacts;
};

/// Also the warm start: a solver begins from what it finds here.
struct ContactSolution {
  std::vector<NodalVectors> v;       ///< per body, m/s
  std::vector<Vector3> impulses;     ///< per contact, contact frame, N s, acting on the tissue
  std::vector<ContactState> states;  ///< per contact
  /// Per body: what the last step that took long was slow to find of its velocities, 3 x nodes, m/s. 0, or empty: not known. For solvers
  /// that begin with it; answers do not depend on it beyond their tolerance.
  std::vector<NodalVectors> slow_changes;
};

/// Adds J' of one contact times an impulse.
/// @param impulse_W in world axes, N s.
/// @param nodal per body, N s.
inline void addImpulse(const ContactRow& row, const Vector3& impulse_W, std::vector<NodalVectors>& nodal) {
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    nodal[at.body].col(at.node) += at.weight * impulse_W;
  }
}

/// Velocity of the tissue at a contact, world axes, m/s.
inline Vector3 tissueVelocity(const ContactRow& row, const std::vector<NodalVectors>& v) {
  Vector3 tissue = Vector3::Zero();
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    tissue += at.weight * v[at.body].col(at.node);
  }
  return tissue;
}

/// Relative velocity u = J v - u_tool of a contact in its frame, m/s.
inline Vector3 relativeVelocity(const ContactRow& row, const std::vector<NodalVectors>& v) {
  return row.R_WC.transpose() * tissueVelocity(row, v) - row.u_tool;
}

/// How fast a contact slides, contact frame, m/s: without what a sheet shears by.
/// @param impulse of the contact, contact frame, N s.
inline Vector2 slidingVelocity(const ContactRow& row, const std::vector<NodalVectors>& v, const Vector3& impulse) {
  return relativeVelocity(row, v).tail<2>() + row.tangential_compliance * impulse.tail<2>();
}

}  // namespace tissue_contact
