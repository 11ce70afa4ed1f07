#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "solver/anderson.h"
#include "solver/body_sweep.h"
#include "solver/relaxation.h"

namespace tissue_contact {
namespace {

/// Iterations before any is remembered: those that an easy step needs are not burdened.
constexpr int kPlainIterations = 2;
static_assert(kPlainIterations % 2 == 0, "pairs of sweeps are mixed: forth and back");

/// Iteration, one back, before which stiff parts are first moved as one.
constexpr int kFirstRigidMotion = 3;
static_assert(kFirstRigidMotion % 2 == 1, "between a sweep forth and the sweep back");

/// So many iterations must be to come: coarse motions cost some ten to find, and each pair of sweeps with them as much as two.
constexpr double kWorthCoarseMotions = 20.0;

/// Pairs of sweeps mixed. With 3 a grasp keeps twice the momentum defect, with 7 no scene gets faster.
constexpr int kMixedPairs = 5;

/// Bodies awake whose velocities are mixed with the same weights.
struct Mixture {
  std::vector<int> bodies;
  AndersonMixing mixing{kMixedPairs};
  std::vector<double> begun;    ///< velocities where a pair of sweeps began, one body after the other, m/s
  std::vector<double> reached;  ///< and where it led
};

void gatherVelocities(const Mixture& mixture, const std::vector<NodalVectors>& v, std::vector<double>& all) {
  all.clear();
  for (const int k : mixture.bodies) all.insert(all.end(), v[k].data(), v[k].data() + v[k].size());
}

AndersonMixing::View viewOf(std::vector<double>& all) { return {all.data(), static_cast<Eigen::Index>(all.size())}; }

class GaussSeidelRelaxation : public Relaxation {
 public:
  void prepare(const ContactProblem& problem, ContactSolution& solution) override;
  const MomentumDefect& relax(const ContactProblem& problem, int iteration, ContactCorrector& corrector,
                              ContactSolution& solution) override;
  void contactPass(const ContactProblem& problem, ContactCorrector& corrector, ContactSolution& solution) override;
  void foresee(double iterations) override {
    wants_coarse_motions_ = !has_coarse_motions_ && iterations > kWorthCoarseMotions;
  }
  void finish(const ContactProblem& problem, ContactSolution& solution) override;

 private:
  void prepareBodies(const ContactProblem& problem);
  void prepareContacts(const ContactProblem& problem, ContactSolution& solution);
  void findNodeContacts(const ContactProblem& problem);
  void findTouched(const ContactProblem& problem);
  void beginDeflation(const ContactProblem& problem, ContactSolution& solution);
  void beginRigidMotions(const ContactProblem& problem);
  void beginCoarseMotions(const ContactProblem& problem);
  template <class Begin>
  void forEachAwake(const ContactProblem& problem, const Begin& begin);
  void deflate(const ContactProblem& problem, std::vector<NodalVectors>& v);
  void followTouched(const ContactProblem& problem, const std::vector<NodalVectors>& v);
  bool contactsActOn(int body) const;
  void findHeld(const ContactProblem& problem, int body);
  bool project(const ContactProblem& problem, int contact, ContactCorrector& corrector, ContactSolution& solution);
  void correctNormal(const ContactRow& row, std::size_t contact, ContactSolution& solution);
  void apply(const ContactRow& row, const Vector3& impulse_W, std::vector<NodalVectors>& v);
  void groupBodies(const ContactProblem& problem);
  int& groupOf(int body);
  void beginMixing(const ContactProblem& problem, const std::vector<NodalVectors>& v);
  void mix(std::vector<NodalVectors>& v);

  std::vector<BodySweep> bodies_;
  bool forward_ = false;  ///< the last sweep was one forth
  bool wants_coarse_motions_ = false;
  bool has_coarse_motions_ = false;
  struct Touched {
    int body;
    int node;
    Vector3 v;  ///< after the sweep forth, m/s
  };
  std::vector<Touched> touched_;  ///< nodes that contacts may move between the sweeps, each once
  std::vector<Matrix3> W_;  ///< W_P per contact with its compliance, contact frame, 1/kg; W(0, 0) = 0: it cannot move
  std::vector<std::vector<int>> node_contact_;  ///< per body and node: the contact that alone holds it, else -1
  bool holding_ = false;                        ///< some node_contact_ is a contact
  std::vector<int> excluded_;                   ///< scratch: nodes of a body that contacts may move
  std::vector<int> held_;                       ///< scratch: the lanes of a body's nodes with such a contact, ascending
  std::vector<int> partner_;                    ///< per body: one of its group that comes earlier; itself: the first
  std::vector<Mixture> mixtures_;               ///< per body; only the first of a group has bodies
  MomentumDefect met_;                          ///< by the last sweep
};

void GaussSeidelRelaxation::prepare(const ContactProblem& problem, ContactSolution& solution) {
  prepareBodies(problem);
  prepareContacts(problem, solution);
  findNodeContacts(problem);
  findTouched(problem);
  wants_coarse_motions_ = has_coarse_motions_ = false;
}

void GaussSeidelRelaxation::prepareBodies(const ContactProblem& problem) {
  bodies_.resize(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    problem.bodies[k].asleep ? bodies_[k].rest() : bodies_[k].prepare(problem.bodies[k]);
  }
}

void GaussSeidelRelaxation::prepareContacts(const ContactProblem& problem, ContactSolution& solution) {
  W_.resize(problem.contacts.size());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    Matrix3 W_W = Matrix3::Zero();  // in world axes
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      W_W += (at.weight * at.weight) * bodies_[at.body].inverse(at.node);
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
    W_[c].diagonal() += compliancesOf(row);
    const Vector3 impulse_W = row.R_WC * solution.impulses[c];
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      bodies_[at.body].addImpulse(at.node, at.weight * impulse_W);
    }
  }
}

/// Nodes with one contact, which acts on no other node: those the sweep can hold.
void GaussSeidelRelaxation::findNodeContacts(const ContactProblem& problem) {
  constexpr int kNoContact = -1;
  constexpr int kShared = -2;
  const auto single = [&](std::size_t c) {
    const ContactRow& row = problem.contacts[c];
    return row.node_count == 1 && !isFrictionless(row.law) && W_[c](0, 0) > 0.0;
  };
  holding_ = false;
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) holding_ = holding_ || single(c);
  if (!holding_) return;
  node_contact_.resize(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k)
    node_contact_[k].assign(problem.bodies[k].K->rows(), kNoContact);
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    for (int a = 0; a < row.node_count; ++a) {
      int& holder = node_contact_[row.nodes[a].body][row.nodes[a].node];
      holder = holder == kNoContact && single(c) ? static_cast<int>(c) : kShared;
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

/// Tells the sweep back what contacts have changed since the sweep forth.
void GaussSeidelRelaxation::followTouched(const ContactProblem& problem, const std::vector<NodalVectors>& v) {
  for (const Touched& at : touched_) {
    const Vector3 change = v[at.body].col(at.node) - at.v;
    if (!problem.bodies[at.body].asleep && !change.isZero(0.0)) bodies_[at.body].follow(at.node, change);
  }
}

void GaussSeidelRelaxation::beginDeflation(const ContactProblem& problem, ContactSolution& solution) {
  solution.slow_changes.resize(bodies_.size());
  forEachAwake(problem, [&](std::size_t k) { bodies_[k].beginDeflation(solution.slow_changes[k], excluded_); });
}

void GaussSeidelRelaxation::beginRigidMotions(const ContactProblem& problem) {
  forEachAwake(problem, [&](std::size_t k) { bodies_[k].beginRigidMotions(excluded_); });
}

/// All bodies awake get them. What is mixed goes on: to forget it, since pairs of sweeps are another map from now on, gained nothing.
void GaussSeidelRelaxation::beginCoarseMotions(const ContactProblem& problem) {
  wants_coarse_motions_ = false;
  has_coarse_motions_ = true;
  forEachAwake(problem, [&](std::size_t k) { bodies_[k].beginCoarseMotions(excluded_); });
}

/// @param begin called with each body that is awake; excluded_ has its nodes that contacts may move.
template <class Begin>
void GaussSeidelRelaxation::forEachAwake(const ContactProblem& problem, const Begin& begin) {
  auto at = touched_.begin();
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    excluded_.clear();
    for (; at != touched_.end() && at->body == static_cast<int>(k); ++at) excluded_.push_back(at->node);
    if (!problem.bodies[k].asleep) begin(k);
  }
}

void GaussSeidelRelaxation::deflate(const ContactProblem& problem, std::vector<NodalVectors>& v) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!problem.bodies[k].asleep) bodies_[k].deflate(v[k]);
  }
}

void GaussSeidelRelaxation::finish(const ContactProblem& problem, ContactSolution& solution) {
  solution.slow_changes.resize(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!problem.bodies[k].asleep) bodies_[k].finish(forward_, solution.v[k], solution.slow_changes[k]);
  }
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

void GaussSeidelRelaxation::findHeld(const ContactProblem& problem, int body) {
  held_.clear();
  if (!holding_) return;
  const std::vector<int>& lane_of = problem.bodies[body].K->pattern->lane_of;
  for (const Touched& at : touched_) {
    if (at.body == body && node_contact_[body][at.node] >= 0) held_.push_back(lane_of[at.node]);
  }
  std::sort(held_.begin(), held_.end());
}

bool GaussSeidelRelaxation::contactsActOn(int body) const {
  const auto first =
      std::lower_bound(touched_.begin(), touched_.end(), body, [](const Touched& at, int k) { return at.body < k; });
  return first != touched_.end() && first->body == body;
}

const MomentumDefect& GaussSeidelRelaxation::relax(const ContactProblem& problem, int iteration,
                                                   ContactCorrector& corrector, ContactSolution& solution) {
  const bool forward = iteration % 2 == 0;
  if (iteration == kPlainIterations) beginMixing(problem, solution.v);
  if (forward && iteration > kPlainIterations) mix(solution.v);
  if (iteration == 1) beginDeflation(problem, solution);
  if (iteration == kFirstRigidMotion) beginRigidMotions(problem);
  if (!forward && wants_coarse_motions_) beginCoarseMotions(problem);
  if (!forward) {
    followTouched(problem, solution.v);
    deflate(problem, solution.v);
  }
  forward_ = forward;
  met_.net_n_s.assign(problem.bodies.size(), 0.0);
  double squared = 0.0;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    if (problem.bodies[k].asleep) continue;
    findHeld(problem, static_cast<int>(k));
    const auto hold = [&](int i) { return project(problem, node_contact_[k][i], corrector, solution); };
    const DefectsMet of_body = bodies_[k].sweep(forward, held_, solution.v[k], hold);
    squared += of_body.squared;
    if (contactsActOn(static_cast<int>(k))) met_.net_n_s[k] = of_body.sum.norm();
  }
  if (forward) {
    for (Touched& at : touched_) at.v = solution.v[at.body].col(at.node);
  }
  met_.norm_n_s = std::sqrt(squared);
  return met_;
}

/// Bodies that contacts of this step join share one map of velocities; those that nothing joins have maps of their own,
/// with weights of their own (doc/method.md).
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
    gatherVelocities(mixture, v, mixture.begun);
  }
}

/// A sweep forth and one back, each with its passes over the contacts, are a map of velocities, nearly the same one
/// throughout a step and nearly linear while no contact changes its state. The impulses are not mixed: the next passes
/// bring them in line, and every answer lies in its cone.
void GaussSeidelRelaxation::mix(std::vector<NodalVectors>& v) {
  for (Mixture& mixture : mixtures_) {
    if (mixture.bodies.empty()) continue;
    gatherVelocities(mixture, v, mixture.reached);
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
    v[at.body].col(at.node) += bodies_[at.body].inverse(at.node) * share;
    bodies_[at.body].addImpulse(at.node, share);
  }
}

/// Solves a frictionless contact: nothing tangential is computed.
void GaussSeidelRelaxation::correctNormal(const ContactRow& row, std::size_t contact, ContactSolution& solution) {
  const Vector3 n = row.R_WC.col(0);
  const double u_n = n.dot(tissueVelocity(row, solution.v)) - row.u_tool[0];
  Vector3& impulse = solution.impulses[contact];
  const double lacking = row.required_u_n - u_n - row.normal_compliance * impulse[0];
  const double wanted = impulse[0] + lacking / W_[contact](0, 0);
  const double normal = wanted > 0.0 ? wanted : 0.0;
  const double change = normal - impulse[0];
  impulse = Vector3(normal, 0.0, 0.0);
  solution.states[contact] = normal > 0.0 ? ContactState::kKinetic : ContactState::kOpen;
  if (change != 0.0) apply(row, n * change, solution.v);
}

void GaussSeidelRelaxation::contactPass(const ContactProblem& problem, ContactCorrector& corrector,
                                        ContactSolution& solution) {
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    if (!(W_[c](0, 0) > 0.0)) continue;
    const ContactRow& row = problem.contacts[c];
    if (isFrictionless(row.law)) {
      correctNormal(row, c, solution);
      continue;
    }
    const Vector3 delta = corrector.correct(problem, c, W_[c], relativeVelocity(row, solution.v), solution);
    apply(row, row.R_WC * delta, solution.v);
  }
}

}  // namespace

std::unique_ptr<Relaxation> makeGaussSeidelRelaxation() { return std::make_unique<GaussSeidelRelaxation>(); }

}  // namespace tissue_contact
