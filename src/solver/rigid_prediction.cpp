#include "solver/rigid_prediction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>

#include "solver/contact_corrector.h"
#include "solver/rigid_motions.h"

namespace tissue_contact {
namespace {

using Vector6 = RigidMotions::Vector6;
using Matrix6 = RigidMotions::Matrix6;

/// What turning costs, of what it brings at the contacts: far less than a contact that says how the body turns, more than round-off.
constexpr double kTurningCost = 1e-6;
/// Likewise of shifting, where contacts that withdraw leave it open: less than turning.
constexpr double kShiftingCost = 1e-10;

/// Of the squares of what contacts slip: what a rigid motion may leave of it. Jaws that squeeze a sheet, and the noise of one that is held, are no
/// motion that it is carried with: sheets between balls were thrown away.
constexpr double kDisagreement = 0.25;

bool mayMoveAsOne(const BodySystem& body) {
  return !body.asleep && body.x != nullptr &&
         std::find(body.fixed->begin(), body.fixed->end(), true) == body.fixed->end();
}

/// Also not one that a solve of this step has found to slide.
bool carries(const ContactProblem& problem, const ContactSolution& solution, std::size_t contact, int body) {
  const ContactRow& row = problem.contacts[contact];
  return row.was_static && solution.states[contact] == ContactState::kStatic && row.pair >= 0 &&
         row.nodes[0].body == body && !isFrictionless(row.law);
}

/// How a body is carried.
struct Carried {
  Vector6 motion;           ///< about `middle`: m/s and rad/s
  bool agree = false;       ///< the contacts, on that motion
  double normal_n_s = 0.0;  ///< impulses of the contacts that carry it, along their normals
};

Carried motionOf(const ContactProblem& problem, int body, const Vector3& middle, const ContactSolution& solution) {
  const NodalVectors& x = *problem.bodies[body].x;
  Carried carried;
  Matrix6 normal = Matrix6::Zero();
  Vector6 wanted = Vector6::Zero();
  double slips = 0.0;  // squared
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    if (!carries(problem, solution, c, body)) continue;
    const ContactRow& row = problem.contacts[c];
    carried.normal_n_s += solution.impulses[c][0];
    Vector3 arm = Vector3::Zero();
    for (int a = 0; a < row.node_count; ++a) arm += row.nodes[a].weight * (x.col(row.nodes[a].node) - middle);
    Vector3 u = relativeVelocity(row, solution.v) + compliancesOf(row).cwiseProduct(solution.impulses[c]);
    u[0] -= row.required_u_n;
    RigidMotions::Rows J = row.R_WC.transpose() * RigidMotions::motionsOf(arm);
    if (u[0] > 0.0) {  // what withdraws does not pull
      J.row(0).setZero();
      u[0] = 0.0;
    }
    slips += u.squaredNorm();
    normal += J.transpose() * J;
    wanted -= J.transpose() * u;
  }
  // Contacts that all are in one place say nothing of the turning.
  const double inertia = normal.diagonal().tail<3>().sum();
  normal.diagonal().head<3>().array() += kShiftingCost;
  normal.diagonal().tail<3>().array() += inertia > 0.0 ? kTurningCost * inertia : 1.0;
  carried.motion = normal.ldlt().solve(wanted);
  carried.agree = slips - wanted.dot(carried.motion) <= kDisagreement * slips;
  return carried;
}

}  // namespace

void predictRigidMotions(const ContactProblem& problem, ContactSolution& solution) {
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const int body = static_cast<int>(k);
    bool any = false;
    for (std::size_t c = 0; c < problem.contacts.size() && !any; ++c) any = carries(problem, solution, c, body);
    if (!any || !mayMoveAsOne(problem.bodies[k])) continue;
    const NodalVectors& x = *problem.bodies[k].x;
    const Vector3 middle = x.rowwise().mean();
    const Carried carried = motionOf(problem, body, middle, solution);
    if (!carried.agree) continue;
    // An organ that a tool touches in one place is not carried by it.
    if (problem.bodies[k].mass.sum() * carried.motion.head<3>().norm() > carried.normal_n_s) continue;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      solution.v[k].col(i) += RigidMotions::velocityOf(carried.motion, x.col(i) - middle);
    }
  }
}

}  // namespace tissue_contact
