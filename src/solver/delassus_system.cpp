#include <Eigen/SparseCholesky>
#include <deque>
#include <stdexcept>
#include <string>

#include "solver/sparse_system.h"
#include "tissue_contact/solver/delassus.h"

namespace tissue_contact {
namespace {

struct FactoredSystem {
  SparseSystem system;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;  ///< cannot be moved
  VectorX free_velocity;                                     ///< A^-1 b
};

}  // namespace

struct DelassusSystem::Bodies {
  const ContactProblem& contacts;
  std::deque<FactoredSystem> bodies;
  DelassusProblem problem;

  explicit Bodies(const ContactProblem& all) : contacts(all) {
    if (contacts.contacts.size() > static_cast<std::size_t>(kMostDenseContacts)) {
      throw std::invalid_argument(
          std::to_string(contacts.contacts.size()) + " contacts in one step; a dense problem has at most " +
          std::to_string(kMostDenseContacts) + "; use method: predictor_corrector or a coarser mesh");
    }
    for (std::size_t k = 0; k < contacts.bodies.size(); ++k) addBody(k);
    const Eigen::Index n = static_cast<Eigen::Index>(contacts.contacts.size());
    problem.W.setZero(3 * n, 3 * n);
    problem.q.setZero(3 * n);
    for (Eigen::Index c = 0; c < n; ++c) addContact(c);
    problem.W = (0.5 * (problem.W + problem.W.transpose())).eval();  // symmetric but for round-off
  }

  void addBody(std::size_t k) {
    FactoredSystem& body = bodies.emplace_back();
    body.system.assemble(contacts.bodies[k]);
    body.system.gather(contacts.bodies[k].b, body.free_velocity);
    if (body.system.size() == 0) return;
    body.factor.compute(body.system.matrix());
    if (body.factor.info() != Eigen::Success) {
      throw std::runtime_error("the system matrix of body " + std::to_string(k) +
                               " is not positive definite; its stiffness must not be negative along any motion");
    }
    body.free_velocity = body.factor.solve(body.free_velocity);
  }

  bool canMove(const ContactRow& row) const {
    for (int a = 0; a < row.node_count; ++a) {
      if (bodies[row.nodes[a].body].system.firstRow(row.nodes[a].node) >= 0) return true;
    }
    return false;
  }

  /// Row's part of J times a body's velocities (columns: cases), contact frame.
  void addRelative(const ContactRow& row, std::size_t k, const Eigen::MatrixXd& v,
                   Eigen::Ref<Eigen::MatrixXd> u) const {
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      const int first = bodies[at.body].system.firstRow(at.node);
      if (static_cast<std::size_t>(at.body) != k || first < 0) continue;
      u += at.weight * (row.R_WC.transpose() * v.middleRows<3>(first));
    }
  }

  /// Body k's rows of J_c'.
  bool distribute(const ContactRow& row, std::size_t k, Eigen::MatrixXd& impulses) const {
    bool touched = false;
    impulses.setZero(bodies[k].system.size(), 3);
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      const int first = bodies[at.body].system.firstRow(at.node);
      if (static_cast<std::size_t>(at.body) != k || first < 0) continue;
      impulses.middleRows<3>(first) += at.weight * row.R_WC;
      touched = true;
    }
    return touched;
  }

  void addContact(Eigen::Index c) {
    const ContactRow& row = contacts.contacts[c];
    problem.laws.push_back(row.law);
    problem.was_sliding.push_back(row.was_sliding);
    if (!canMove(row)) return;
    problem.q.segment<3>(3 * c) = -row.u_tool - Vector3(row.required_u_n, 0.0, 0.0);
    Eigen::MatrixXd impulses;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      if (!distribute(row, k, impulses)) continue;
      addRelative(row, k, bodies[k].free_velocity, problem.q.segment<3>(3 * c));
      const Eigen::MatrixXd v = bodies[k].factor.solve(impulses);
      for (std::size_t d = 0; d < contacts.contacts.size(); ++d) {
        addRelative(contacts.contacts[d], k, v, problem.W.block<3, 3>(3 * static_cast<Eigen::Index>(d), 3 * c));
      }
    }
  }
};

DelassusSystem::DelassusSystem(const ContactProblem& contacts) : bodies_(std::make_unique<Bodies>(contacts)) {}

DelassusSystem::~DelassusSystem() = default;

const DelassusProblem& DelassusSystem::problem() const { return bodies_->problem; }

void DelassusSystem::recoverVelocities(const VectorX& r, std::vector<NodalVectors>& v) const {
  const std::vector<ContactRow>& contacts = bodies_->contacts.contacts;
  v.resize(bodies_->bodies.size());
  for (std::size_t k = 0; k < v.size(); ++k) {
    const FactoredSystem& body = bodies_->bodies[k];
    v[k].setZero(3, bodies_->contacts.bodies[k].K->rows());
    if (body.system.size() == 0) continue;
    VectorX impulses = VectorX::Zero(body.system.size());
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const Vector3 impulse_W = contacts[c].R_WC * r.segment<3>(3 * static_cast<Eigen::Index>(c));
      for (int a = 0; a < contacts[c].node_count; ++a) {
        const RowNode& at = contacts[c].nodes[a];
        const int first = bodies_->bodies[at.body].system.firstRow(at.node);
        if (static_cast<std::size_t>(at.body) == k && first >= 0) impulses.segment<3>(first) += at.weight * impulse_W;
      }
    }
    body.system.scatterAdd(body.free_velocity + body.factor.solve(impulses), v[k]);
  }
}

DelassusProblem makeDelassusProblem(const ContactProblem& contacts) { return DelassusSystem(contacts).problem(); }

}  // namespace tissue_contact
