#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/row_product.h"
#include "solver/anderson.h"
#include "solver/relaxation.h"

namespace tissue_contact {
namespace {

/// Iterations before any is remembered: those that an easy step needs are not burdened.
constexpr int kPlainIterations = 2;
static_assert(kPlainIterations % 2 == 0, "pairs of sweeps are mixed: forth and back");

/// Pairs of sweeps mixed. With 3 a grasp keeps twice the momentum defect, with 7 no scene gets faster.
constexpr int kMixedPairs = 5;

/// Bodies awake whose velocities are mixed with the same weights.
struct Mixture {
  std::vector<int> bodies;
  AndersonMixing mixing{kMixedPairs};
  std::vector<double> begun;    ///< velocities where a pair of sweeps began, one body after the other, m/s
  std::vector<double> reached;  ///< and where it led
};

void gather(const Mixture& mixture, const std::vector<NodalVectors>& v, std::vector<double>& all) {
  all.clear();
  for (const int k : mixture.bodies) all.insert(all.end(), v[k].data(), v[k].data() + v[k].size());
}

AndersonMixing::View viewOf(std::vector<double>& all) { return {all.data(), static_cast<Eigen::Index>(all.size())}; }

class GaussSeidelRelaxation : public Relaxation {
 public:
  void prepare(const ContactProblem& problem, ContactSolution& solution) override;
  double relax(const ContactProblem& problem, int iteration, ContactCorrector& corrector,
               ContactSolution& solution) override;
  double contactPass(const ContactProblem& problem, ContactCorrector& corrector, ContactSolution& solution) override;

 private:
  void prepareBodies(const ContactProblem& problem);
  void prepareContacts(const ContactProblem& problem, ContactSolution& solution);
  void findNodeContacts(const ContactProblem& problem);
  void findTouched(const ContactProblem& problem);
  void followTouched(const ContactProblem& problem, const std::vector<NodalVectors>& v);
  void findHeld(int body, bool forward);
  bool project(const ContactProblem& problem, int contact, ContactCorrector& corrector, ContactSolution& solution);
  double correctNormal(const ContactRow& row, std::size_t contact, ContactSolution& solution);
  void apply(const ContactRow& row, const Vector3& impulse_W, std::vector<NodalVectors>& v);
  void groupBodies(const ContactProblem& problem);
  int& groupOf(int body);
  void beginMixing(const ContactProblem& problem, const std::vector<NodalVectors>& v);
  void mix(std::vector<NodalVectors>& v);

  std::vector<std::vector<Matrix3>> block_inverse_;  ///< P_i^-1 per body and node; 0 for fixed nodes
  std::vector<NodalVectors> contact_impulses_;       ///< J'lambda per body
  std::vector<NodalVectors> lower_;                  ///< per body: sum_{j<i} A_ij v_j after the sweep forth, N s
  struct Touched {
    int body;
    int node;
    Vector3 v;  ///< after the sweep forth, m/s
  };
  std::vector<Touched> touched_;                ///< nodes that contacts may move between the sweeps, each once
  std::vector<Matrix3> W_;                      ///< W_P per contact, contact frame, 1/kg; W(0, 0) = 0: it cannot move
  std::vector<std::vector<int>> node_contact_;  ///< per body and node: the contact that alone holds it, else -1
  bool holding_ = false;                        ///< some node_contact_ is a contact
  std::vector<int> held_;          ///< scratch: nodes of a body with such a contact, in the order of a sweep
  std::vector<int> partner_;       ///< per body: one of its group that comes earlier; itself: the first
  std::vector<Mixture> mixtures_;  ///< per body; only the first of a group has bodies
};

void GaussSeidelRelaxation::prepare(const ContactProblem& problem, ContactSolution& solution) {
  prepareBodies(problem);
  prepareContacts(problem, solution);
  findNodeContacts(problem);
  findTouched(problem);
}

void GaussSeidelRelaxation::prepareBodies(const ContactProblem& problem) {
  block_inverse_.resize(problem.bodies.size());
  contact_impulses_.resize(problem.bodies.size());
  lower_.resize(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const BodySystem& body = problem.bodies[k];
    if (body.asleep) continue;
    const int nodes = body.K->rows();
    block_inverse_[k].resize(nodes);
    for (int i = 0; i < nodes; ++i) {
      if ((*body.fixed)[i]) {
        block_inverse_[k][i].setZero();
        continue;
      }
      Matrix3 block = body.stiffness_scale * body.K->diagonal[i];
      if (body.D != nullptr) block += body.damping_scale * body.D->diagonal[i];
      block.diagonal().array() += body.mass[i];
      block_inverse_[k][i] = block.inverse();
    }
    contact_impulses_[k].setZero(3, nodes);
    lower_[k].resize(3, nodes);
  }
}

void GaussSeidelRelaxation::prepareContacts(const ContactProblem& problem, ContactSolution& solution) {
  W_.resize(problem.contacts.size());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    Matrix3 W_W = Matrix3::Zero();  // in world axes
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      W_W += (at.weight * at.weight) * block_inverse_[at.body][at.node];
    }
    if (isFrictionless(row.law)) {
      const Vector3 n = row.R_WC.col(0);
      const Vector3 response = W_W * n;
      W_[c](0, 0) = n.dot(response);
      // The frame has turned since: no friction may be left in the warm start.
      solution.impulses[c].tail<2>().setZero();
    } else {
      W_[c] = row.R_WC.transpose() * W_W * row.R_WC;
    }
    if (!(W_[c](0, 0) > 0.0)) {
      solution.impulses[c].setZero();
      solution.states[c] = ContactState::kOpen;
      continue;
    }
    addImpulse(row, row.R_WC * solution.impulses[c], contact_impulses_);
  }
}

/// Nodes with one contact, which acts on no other node: those the sweep can hold.
void GaussSeidelRelaxation::findNodeContacts(const ContactProblem& problem) {
  constexpr int kNone = -1;
  constexpr int kShared = -2;
  const auto single = [&](std::size_t c) {
    const ContactRow& row = problem.contacts[c];
    return row.node_count == 1 && !isFrictionless(row.law) && W_[c](0, 0) > 0.0;
  };
  holding_ = false;
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) holding_ = holding_ || single(c);
  if (!holding_) return;
  node_contact_.resize(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) node_contact_[k].assign(problem.bodies[k].K->rows(), kNone);
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    for (int a = 0; a < row.node_count; ++a) {
      int& holder = node_contact_[row.nodes[a].body][row.nodes[a].node];
      holder = holder == kNone && single(c) ? static_cast<int>(c) : kShared;
    }
  }
}

void GaussSeidelRelaxation::findTouched(const ContactProblem& problem) {
  touched_.clear();
  for (const ContactRow& row : problem.contacts) {
    for (int a = 0; a < row.node_count; ++a)
      touched_.push_back({row.nodes[a].body, row.nodes[a].node, Vector3::Zero()});
  }
  const auto key = [](const Touched& at) { return std::make_pair(at.body, at.node); };
  std::sort(touched_.begin(), touched_.end(), [&](const Touched& a, const Touched& b) { return key(a) < key(b); });
  const auto same = [&](const Touched& a, const Touched& b) { return key(a) == key(b); };
  touched_.erase(std::unique(touched_.begin(), touched_.end(), same), touched_.end());
}

/// Brings lower_ in line with what contacts have changed since the sweep forth.
void GaussSeidelRelaxation::followTouched(const ContactProblem& problem, const std::vector<NodalVectors>& v) {
  for (const Touched& at : touched_) {
    const BodySystem& body = problem.bodies[at.body];
    const Vector3 change = v[at.body].col(at.node) - at.v;
    if (body.asleep || change.isZero(0.0)) continue;
    const auto add = [&](const BlockMatrix& matrix, double scale) {
      const Vector3 scaled = scale * change;
      for (int k = matrix.row_middle[at.node]; k < matrix.row_start[at.node + 1]; ++k) {
        lower_[at.body].col(matrix.columns[k]) += matrix.values[k].transpose() * scaled;  // A is symmetric
      }
    };
    add(*body.K, body.stiffness_scale);
    if (body.D != nullptr) add(*body.D, body.damping_scale);
  }
}

/// Of one body.
struct Sweep {
  const BodySystem& body;
  const std::vector<Matrix3>& block_inverse;
  const NodalVectors& impulses;
  NodalVectors& lower;
  NodalVectors& v;
};

/// Gauss-Seidel step of the free nodes from `first` to before `end`, with the impulses held. A sweep forth leaves sum_{j<i}
/// A_ij v_j of every node in `lower`, which the sweep back then need not compute (Conrad & Wallach, "Alternating Methods for
/// Sets of Linear Equations", Numer. Math. 32 (1979) 105-108).
/// @return change + |defects met|^2, (N s)^2.
template <bool kDamped, bool kForward>
TISSUE_CONTACT_INLINE double sweepNodes(const Sweep& all, int first, int end, double change) {
  const BodySystem& body = all.body;
  const BlockMatrix& K = *body.K;
  const BlockMatrix& D = kDamped ? *body.D : K;
  for (int i = first; i != end; i += kForward ? 1 : -1) {
    if ((*body.fixed)[i]) continue;
    const Vector3 v_i = all.v.col(i);
    if (kForward) {
      Vector3 sum = body.stiffness_scale * rowProduct(K, K.row_start[i], K.row_middle[i], all.v);
      if (kDamped) sum += body.damping_scale * rowProduct(D, D.row_start[i], D.row_middle[i], all.v);
      all.lower.col(i) = sum;
    }
    const Vector3 elastic =
        rowProduct(K, K.row_middle[i], K.row_start[i + 1], all.v) + blockProduct(K.diagonal[i], v_i);
    Vector3 defect =
        body.b.col(i) + all.impulses.col(i) - all.lower.col(i) - body.mass[i] * v_i - body.stiffness_scale * elastic;
    if (kDamped) {
      defect -= body.damping_scale *
                (rowProduct(D, D.row_middle[i], D.row_start[i + 1], all.v) + blockProduct(D.diagonal[i], v_i));
    }
    all.v.col(i) = v_i + blockProduct(all.block_inverse[i], defect);
    change += defect.squaredNorm();
  }
  return change;
}

TISSUE_CONTACT_CLONES
double sweepForth(const Sweep& all, int first, int end, double change) {
  return all.body.D != nullptr ? sweepNodes<true, true>(all, first, end, change)
                               : sweepNodes<false, true>(all, first, end, change);
}

TISSUE_CONTACT_CLONES
double sweepBack(const Sweep& all, int first, int end, double change) {
  return all.body.D != nullptr ? sweepNodes<true, false>(all, first, end, change)
                               : sweepNodes<false, false>(all, first, end, change);
}

/// All nodes of a body.
/// @param held nodes that a contact may hold, in the order of the sweep.
/// @param hold called with each of them after its step; true: its contact holds it, so that its defect does not count.
/// @return |defects met|^2, (N s)^2.
template <class Hold>
double sweepBody(const Sweep& all, bool forward, const std::vector<int>& held, const Hold& hold) {
  const auto run = forward ? sweepForth : sweepBack;
  const int way = forward ? 1 : -1;
  const int nodes = all.body.K->rows();
  int at = forward ? 0 : nodes - 1;
  double change = 0.0;
  for (const int node : held) {
    change = run(all, at, node, change);
    at = node + way;
    const double with = run(all, node, at, change);
    if (!hold(node)) change = with;
  }
  return run(all, at, forward ? nodes : -1, change);
}

/// A node whose own contact is static is projected at once: its tangential velocity becomes the tool's, its impulse the
/// reaction. A reaction that leaves the limit releases the node.
/// @return it was projected.
bool GaussSeidelRelaxation::project(const ContactProblem& problem, int contact, ContactCorrector& corrector,
                                    ContactSolution& solution) {
  if (contact < 0 || solution.states[contact] != ContactState::kStatic) return false;
  const ContactRow& row = problem.contacts[contact];
  const Vector3 u = relativeVelocity(row, solution.v);
  apply(row, row.R_WC * corrector.correct(problem, contact, W_[contact], u, solution), solution.v);
  return true;
}

void GaussSeidelRelaxation::findHeld(int body, bool forward) {
  held_.clear();
  if (!holding_) return;
  for (const Touched& at : touched_) {  // ascending
    if (at.body == body && node_contact_[body][at.node] >= 0) held_.push_back(at.node);
  }
  if (!forward) std::reverse(held_.begin(), held_.end());
}

double GaussSeidelRelaxation::relax(const ContactProblem& problem, int iteration, ContactCorrector& corrector,
                                    ContactSolution& solution) {
  const bool forward = iteration % 2 == 0;
  if (iteration == kPlainIterations) beginMixing(problem, solution.v);
  if (forward && iteration > kPlainIterations) mix(solution.v);
  if (!forward) followTouched(problem, solution.v);
  double change = 0.0;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const BodySystem& body = problem.bodies[k];
    if (body.asleep) continue;
    findHeld(static_cast<int>(k), forward);
    const auto hold = [&](int i) { return project(problem, node_contact_[k][i], corrector, solution); };
    const Sweep all{body, block_inverse_[k], contact_impulses_[k], lower_[k], solution.v[k]};
    change += sweepBody(all, forward, held_, hold);
  }
  if (forward) {
    for (Touched& at : touched_) at.v = solution.v[at.body].col(at.node);
  }
  return std::sqrt(change);
}

/// Bodies that contacts of this step join share one map of velocities; those that nothing joins have maps of their own, with
/// weights of their own (doc/method.md).
void GaussSeidelRelaxation::groupBodies(const ContactProblem& problem) {
  partner_.resize(problem.bodies.size());
  std::iota(partner_.begin(), partner_.end(), 0);
  for (const ContactRow& row : problem.contacts) {
    for (int a = 1; a < row.node_count; ++a) {
      int& one = groupOf(row.nodes[0].body);
      int& other = groupOf(row.nodes[a].body);
      one = other = std::min(one, other);
    }
  }
}

/// The first body of a body's group.
int& GaussSeidelRelaxation::groupOf(int body) {
  while (partner_[body] != body) body = partner_[body];
  return partner_[body];
}

void GaussSeidelRelaxation::beginMixing(const ContactProblem& problem, const std::vector<NodalVectors>& v) {
  groupBodies(problem);
  mixtures_.resize(problem.bodies.size());
  for (Mixture& mixture : mixtures_) mixture.bodies.clear();
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    if (!problem.bodies[k].asleep) mixtures_[groupOf(static_cast<int>(k))].bodies.push_back(static_cast<int>(k));
  }
  for (Mixture& mixture : mixtures_) {
    mixture.mixing.restart();
    gather(mixture, v, mixture.begun);
  }
}

/// A sweep forth and one back, each with its passes over the contacts, are a map of velocities, nearly the same one
/// throughout a step and nearly linear while no contact changes its state. The impulses are not mixed: the next passes
/// bring them in line, and every answer lies in its cone.
void GaussSeidelRelaxation::mix(std::vector<NodalVectors>& v) {
  for (Mixture& mixture : mixtures_) {
    if (mixture.bodies.empty()) continue;
    gather(mixture, v, mixture.reached);
    viewOf(mixture.begun) = mixture.mixing.next(viewOf(mixture.begun), viewOf(mixture.reached));
    const double* from = mixture.begun.data();
    for (const int k : mixture.bodies) {
      std::copy_n(from, v[k].size(), v[k].data());
      from += v[k].size();
    }
  }
}

/// v += P^-1 J' impulse of one contact; `impulse_W` in world axes, N s.
void GaussSeidelRelaxation::apply(const ContactRow& row, const Vector3& impulse_W, std::vector<NodalVectors>& v) {
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    const Vector3 share = at.weight * impulse_W;
    v[at.body].col(at.node) += block_inverse_[at.body][at.node] * share;
    contact_impulses_[at.body].col(at.node) += share;
  }
}

/// Solves a frictionless contact: nothing tangential is computed.
/// @return the change of its impulse, N s.
double GaussSeidelRelaxation::correctNormal(const ContactRow& row, std::size_t contact, ContactSolution& solution) {
  const Vector3 n = row.R_WC.col(0);
  const double u_n = n.dot(tissueVelocity(row, solution.v)) - row.u_tool[0];
  Vector3& impulse = solution.impulses[contact];
  const double wanted = impulse[0] - (u_n - row.required_u_n) / W_[contact](0, 0);
  const double normal = wanted > 0.0 ? wanted : 0.0;
  const double change = normal - impulse[0];
  impulse = Vector3(normal, 0.0, 0.0);
  solution.states[contact] = normal > 0.0 ? ContactState::kKinetic : ContactState::kOpen;
  if (change != 0.0) apply(row, n * change, solution.v);
  return change;
}

double GaussSeidelRelaxation::contactPass(const ContactProblem& problem, ContactCorrector& corrector,
                                          ContactSolution& solution) {
  double change = 0.0;
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    if (!(W_[c](0, 0) > 0.0)) continue;
    const ContactRow& row = problem.contacts[c];
    if (isFrictionless(row.law)) {
      const double normal = correctNormal(row, c, solution);
      change += normal * normal;
      continue;
    }
    const Vector3 delta = corrector.correct(problem, c, W_[c], relativeVelocity(row, solution.v), solution);
    apply(row, row.R_WC * delta, solution.v);
    change += delta.squaredNorm();
  }
  return std::sqrt(change);
}

}  // namespace

std::unique_ptr<Relaxation> makeGaussSeidelRelaxation() { return std::make_unique<GaussSeidelRelaxation>(); }

}  // namespace tissue_contact
