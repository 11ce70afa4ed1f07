#include "solver/rigid_prediction.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>

#include "solver/rigid_motions.h"

namespace tissue_contact {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// What turning costs, of what it brings at the contacts: far less than a contact that says how the body turns, more than round-off.
constexpr double kTurningCost = 1e-6;

bool mayMoveAsOne(const BodySystem& body) {
  return !body.asleep && body.x != nullptr &&
         std::find(body.fixed->begin(), body.fixed->end(), true) == body.fixed->end();
}

bool carries(const ContactRow& row, int body) { return row.was_static && row.pair >= 0 && row.nodes[0].body == body; }

/// (shift in m/s, turning in rad/s about `middle`) that ends the slip of the contacts that carry the body.
Vector6 motionOf(const ContactProblem& problem, int body, const Vector3& middle, const std::vector<NodalVectors>& v) {
  const NodalVectors& x = *problem.bodies[body].x;
  Matrix6 normal = Matrix6::Zero();
  Vector6 wanted = Vector6::Zero();
  for (const ContactRow& row : problem.contacts) {
    if (!carries(row, body)) continue;
    Vector3 arm = Vector3::Zero();
    for (int a = 0; a < row.node_count; ++a) arm += row.nodes[a].weight * (x.col(row.nodes[a].node) - middle);
    Vector3 u = relativeVelocity(row, v);
    u[0] -= row.required_u_n;
    const RigidMotions::Rows J = RigidMotions::motionsOf(arm);
    normal += J.transpose() * J;
    wanted -= J.transpose() * (row.R_WC * u);
  }
  // Contacts that all are in one place say nothing of the turning.
  const double inertia = normal.diagonal().tail<3>().sum();
  normal.diagonal().tail<3>().array() += inertia > 0.0 ? kTurningCost * inertia : 1.0;
  return normal.ldlt().solve(wanted);
}

}  // namespace

void predictRigidMotions(const ContactProblem& problem, ContactSolution& solution) {
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const int body = static_cast<int>(k);
    const auto carried = [&](const ContactRow& row) { return carries(row, body); };
    if (std::none_of(problem.contacts.begin(), problem.contacts.end(), carried)) continue;
    if (!mayMoveAsOne(problem.bodies[k])) continue;
    const NodalVectors& x = *problem.bodies[k].x;
    const Vector3 middle = x.rowwise().mean();
    const Vector6 motion = motionOf(problem, body, middle, solution.v);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      solution.v[k].col(i) += motion.head<3>() + motion.tail<3>().cross(x.col(i) - middle);
    }
  }
}

}  // namespace tissue_contact
