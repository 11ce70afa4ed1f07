#include "baselines/delassus_system.h"

#include <stdexcept>
#include <string>

namespace tissue_contact {

DelassusSystem::DelassusSystem(const ContactProblem& contacts) : contacts_(contacts) {
  if (contacts.contacts.size() > static_cast<std::size_t>(kMostDenseContacts)) {
    throw std::invalid_argument(
        std::to_string(contacts.contacts.size()) + " contacts in one step; a dense problem has at most " +
        std::to_string(kMostDenseContacts) + "; use method: predictor_corrector or a coarser mesh");
  }
  for (const BodySystem& body : contacts.bodies) addBody(body);
  const auto n = static_cast<Eigen::Index>(contacts.contacts.size());
  problem_.W.setZero(3 * n, 3 * n);
  problem_.q.setZero(3 * n);
  for (Eigen::Index c = 0; c < n; ++c) addContact(c);
  problem_.W = (0.5 * (problem_.W + problem_.W.transpose())).eval();  // symmetric but for round-off
}

void DelassusSystem::addBody(const BodySystem& body) {
  Body& added = bodies_.emplace_back();
  added.system.assemble(body);
  added.system.gather(body.b, added.free_velocity);
  if (added.system.size() == 0) return;
  added.factor.compute(added.system.matrix());
  if (added.factor.info() != Eigen::Success) {
    throw std::runtime_error("the system matrix of body " + std::to_string(bodies_.size() - 1) +
                             " is not positive definite; its stiffness must not be negative along any motion");
  }
  added.free_velocity = added.factor.solve(added.free_velocity);
}

void DelassusSystem::addContact(Eigen::Index c) {
  const ContactRow& row = contacts_.contacts[c];
  problem_.laws.push_back(row.law);
  problem_.was_sliding.push_back(row.was_sliding);
  problem_.q.segment<3>(3 * c) = -row.u_tool - Vector3(row.required_u_n, 0.0, 0.0);
  bool can_move = false;
  Eigen::MatrixXd impulses;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!distribute(row, k, impulses)) continue;
    can_move = true;
    addRelative(row, k, bodies_[k].free_velocity, problem_.q.segment<3>(3 * c));
    const Eigen::MatrixXd v = bodies_[k].factor.solve(impulses);
    for (std::size_t d = 0; d < contacts_.contacts.size(); ++d) {
      addRelative(contacts_.contacts[d], k, v, problem_.W.block<3, 3>(3 * static_cast<Eigen::Index>(d), 3 * c));
    }
  }
  if (!can_move) {
    problem_.q.segment<3>(3 * c).setZero();
  } else {
    problem_.W.diagonal().segment<3>(3 * c) += compliancesOf(row);
  }
}

/// Row's part of J times body k's velocities (columns: cases), contact frame.
void DelassusSystem::addRelative(const ContactRow& row, std::size_t k, const Eigen::MatrixXd& v,
                                 Eigen::Ref<Eigen::MatrixXd> u) const {
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    const int first = bodies_[at.body].system.firstRow(at.node);
    if (static_cast<std::size_t>(at.body) != k || first < 0) continue;
    u += at.weight * (row.R_WC.transpose() * v.middleRows<3>(first));
  }
}

/// Body k's rows of J_c'.
/// @return false: it has none.
bool DelassusSystem::distribute(const ContactRow& row, std::size_t k, Eigen::MatrixXd& impulses) const {
  bool touched = false;
  impulses.setZero(bodies_[k].system.size(), 3);
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    const int first = bodies_[at.body].system.firstRow(at.node);
    if (static_cast<std::size_t>(at.body) != k || first < 0) continue;
    impulses.middleRows<3>(first) += at.weight * row.R_WC;
    touched = true;
  }
  return touched;
}

void DelassusSystem::recoverVelocities(const VectorX& r, std::vector<NodalVectors>& v) const {
  v.resize(bodies_.size());
  for (std::size_t k = 0; k < v.size(); ++k) v[k].setZero(3, contacts_.bodies[k].K->rows());
  for (std::size_t c = 0; c < contacts_.contacts.size(); ++c) {  // J' r for now
    const ContactRow& row = contacts_.contacts[c];
    addImpulse(row, row.R_WC * r.segment<3>(3 * static_cast<Eigen::Index>(c)), v);
  }
  for (std::size_t k = 0; k < v.size(); ++k) {
    VectorX impulses;
    bodies_[k].system.gather(v[k], impulses);
    v[k].setZero();
    if (impulses.size() == 0) continue;
    bodies_[k].system.scatterAdd(bodies_[k].free_velocity + bodies_[k].factor.solve(impulses), v[k]);
  }
}

DelassusProblem makeDelassusProblem(const ContactProblem& contacts) { return DelassusSystem(contacts).problem(); }

}  // namespace tissue_contact
