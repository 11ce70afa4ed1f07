/// P is A of an earlier step, so one relaxation is a back-substitution. Of W_P = J P^-1 J' only the compliance between the
/// touched nodes S is kept (FactoredBody); a pass over the contacts tracks the velocities of S alone.
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "solver/factored_body.h"
#include "solver/momentum_defect.h"
#include "solver/relaxation.h"

namespace tissue_contact {
namespace {

/// Share of the defect that one relaxation may leave before the factor is renewed at the next step.
constexpr double kStaleContraction = 0.3;
/// Share above which it is renewed at once: with less contraction a contact pass on the old compliances can bring back
/// more defect than a relaxation takes (seen on a taut membrane at 0.7).
constexpr double kUselessContraction = 0.5;
/// Round-off leaves a defect of its own (relative to the loads), which says nothing about the factor.
constexpr double kDefectRoundOff = 1e-12;

double normOf(const std::vector<NodalVectors>& defects) {
  double sum = 0.0;
  for (const NodalVectors& defect : defects) sum += defect.squaredNorm();
  return std::sqrt(sum);
}

class CholeskyRelaxation : public Relaxation {
 public:
  void prepare(const ContactProblem& problem, ContactSolution& solution) override;
  const MomentumDefect& relax(const ContactProblem& problem, int iteration, ContactCorrector& corrector,
                              ContactSolution& solution) override;
  void beginPasses(const ContactSolution& solution) override;
  void contactPass(const ContactProblem& problem, ContactCorrector& corrector, ContactSolution& solution) override;
  void finish(const ContactProblem& problem, ContactSolution& solution) override;
  bool resumePasses(const ContactProblem& problem, const ContactSolution& solution) override;
  void reset() override { bodies_.clear(); }

 private:
  /// A contact's nodes as indices into the touched nodes of their bodies.
  struct Local {
    std::array<int, 4> index;
    Matrix3 W;  ///< contact frame, 1/kg; W(0, 0) = 0: nothing of it can move
  };

  const MomentumDefect& leaving(const ContactProblem& problem, double norm_n_s);
  double computeDefect(const ContactProblem& problem, const ContactSolution& solution);
  double relaxOnce(const ContactProblem& problem, ContactSolution& solution, double before);
  double relaxSafely(const ContactProblem& problem, ContactSolution& solution);
  void prepareContact(const ContactProblem& problem, std::size_t contact, ContactSolution& solution);
  Vector3 trackedVelocity(const ContactRow& row, const Local& local) const;
  void press(const ContactRow& row, const Local& local, const Vector3& impulse_W);

  std::deque<FactoredBody> bodies_;     ///< a factor cannot be moved
  std::vector<NodalVectors> impulses_;  ///< J'lambda per body
  std::vector<NodalVectors> defect_;    ///< b + J'lambda - A v per body, kept up to date
  std::vector<VectorX> tracked_;        ///< per body: velocities of its touched nodes during the passes
  std::vector<Local> contacts_;
  std::vector<NodalVectors> saved_;  ///< velocities before a relaxation
  double loads_ = 0.0;               ///< |b|, N s
  double left_ = 0.0;                ///< defect that the last relaxation of this step left, N s
  MomentumDefect met_;               ///< by the last relaxation
  bool lost_compliances_ = false;    ///< in finish(), with an old factor
  bool fresh_ = false;               ///< all factors are of this step: to renew them would change nothing
};

void CholeskyRelaxation::prepare(const ContactProblem& problem, ContactSolution& solution) {
  bodies_.resize(problem.bodies.size());
  impulses_.resize(bodies_.size());
  defect_.resize(bodies_.size());
  tracked_.resize(bodies_.size());
  contacts_.resize(problem.contacts.size());
  loads_ = 0.0;
  fresh_ = true;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const BodySystem& body = problem.bodies[k];
    impulses_[k].setZero(3, body.K->rows());
    if (body.asleep) {
      defect_[k].setZero(3, body.K->rows());
      continue;
    }
    fresh_ = bodies_[k].prepare(body) && fresh_;
    defect_[k].resize(3, body.K->rows());
    loads_ += body.b.squaredNorm();
  }
  loads_ = std::sqrt(loads_);
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    addImpulse(problem.contacts[c], problem.contacts[c].R_WC * solution.impulses[c], impulses_);
  }
  // The first relaxation comes before the compliances, which would be lost with a factor that proves useless.
  left_ = std::numeric_limits<double>::infinity();
  computeDefect(problem, solution);
  relaxSafely(problem, solution);
  left_ = std::numeric_limits<double>::infinity();  // what the first contact passes bring is news, not growth
  for (FactoredBody& body : bodies_) body.beginTouching();
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) prepareContact(problem, c, solution);
}

/// Relaxes; where an old factor makes things worse or hardly better, or leaves a stale share that is more than the relaxation
/// before the last contact passes left, it is renewed at once and the relaxation done again with A itself. A part of the answer
/// that the factor drives apart may be small at first, so every relaxation is watched. More left with a good share is what the
/// passes brought, where contacts change their states, and no fault of the factor.
/// @return the defect left, N s.
double CholeskyRelaxation::relaxSafely(const ContactProblem& problem, ContactSolution& solution) {
  const double before = normOf(defect_);
  saved_ = solution.v;
  const double after = relaxOnce(problem, solution, before);
  const bool grows = after > left_ && after > kStaleContraction * before;
  const bool serves = after <= kUselessContraction * before && !grows;
  left_ = after;
  if (serves || fresh_ || after <= kDefectRoundOff * loads_) return after;
  solution.v = saved_;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!problem.bodies[k].asleep) bodies_[k].renew(problem.bodies[k]);
  }
  fresh_ = true;
  left_ = relaxOnce(problem, solution, computeDefect(problem, solution));
  return left_;
}

void CholeskyRelaxation::prepareContact(const ContactProblem& problem, std::size_t contact, ContactSolution& solution) {
  const ContactRow& row = problem.contacts[contact];
  Local& local = contacts_[contact];
  Matrix3 W_W = Matrix3::Zero();
  for (int a = 0; a < row.node_count; ++a) local.index[a] = bodies_[row.nodes[a].body].touch(row.nodes[a].node);
  for (int a = 0; a < row.node_count; ++a) {
    for (int b = 0; b < row.node_count; ++b) {
      const RowNode& one = row.nodes[a];
      const RowNode& two = row.nodes[b];
      if (one.body != two.body || local.index[a] < 0 || local.index[b] < 0) continue;
      W_W += (one.weight * two.weight) * bodies_[one.body].compliance(local.index[a], local.index[b]);
    }
  }
  local.W = row.R_WC.transpose() * W_W * row.R_WC;
  if (local.W(0, 0) > 0.0) {
    local.W.diagonal() += compliancesOf(row);
    return;
  }
  solution.impulses[contact].setZero();
  solution.states[contact] = ContactState::kOpen;
}

double CholeskyRelaxation::computeDefect(const ContactProblem& problem, const ContactSolution& solution) {
  double sum = 0.0;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!problem.bodies[k].asleep) sum += bodyDefect(problem.bodies[k], solution.v[k], impulses_[k], defect_[k]);
  }
  return std::sqrt(sum);
}

/// v += P^-1 defect.
/// @return the defect it leaves, N s.
double CholeskyRelaxation::relaxOnce(const ContactProblem& problem, ContactSolution& solution, double before) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!problem.bodies[k].asleep) bodies_[k].relax(defect_[k], solution.v[k]);
  }
  const double after = computeDefect(problem, solution);
  if (!(after <= kStaleContraction * before) && !(after <= kDefectRoundOff * loads_)) {
    for (FactoredBody& body : bodies_) body.markStale();
  }
  return after;
}

const MomentumDefect& CholeskyRelaxation::relax(const ContactProblem& problem, int iteration,
                                                ContactCorrector& /*corrector*/, ContactSolution& solution) {
  if (iteration == 0) return leaving(problem, normOf(defect_));  // prepare() has relaxed already
  const bool was_fresh = fresh_;
  const double left = relaxSafely(problem, solution);
  if (fresh_ != was_fresh) {  // the compliances went with the old factor
    for (std::size_t c = 0; c < problem.contacts.size(); ++c) prepareContact(problem, c, solution);
  }
  return leaving(problem, left);
}

/// @param norm_n_s of defect_.
const MomentumDefect& CholeskyRelaxation::leaving(const ContactProblem& problem, double norm_n_s) {
  met_.norm_n_s = norm_n_s;
  met_.net_n_s.assign(bodies_.size(), 0.0);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const bool touched = !impulses_[k].isZero(0.0);
    if (!problem.bodies[k].asleep && touched) met_.net_n_s[k] = defect_[k].rowwise().sum().norm();
  }
  return met_;
}

Vector3 CholeskyRelaxation::trackedVelocity(const ContactRow& row, const Local& local) const {
  Vector3 tissue = Vector3::Zero();
  for (int a = 0; a < row.node_count; ++a) {
    if (local.index[a] < 0) continue;
    tissue +=
        row.nodes[a].weight * tracked_[row.nodes[a].body].segment<3>(3 * static_cast<Eigen::Index>(local.index[a]));
  }
  return row.R_WC.transpose() * tissue - row.u_tool;
}

void CholeskyRelaxation::press(const ContactRow& row, const Local& local, const Vector3& impulse_W) {
  for (int a = 0; a < row.node_count; ++a) {
    if (local.index[a] < 0) continue;
    const RowNode& at = row.nodes[a];
    const Vector3 share = at.weight * impulse_W;
    impulses_[at.body].col(at.node) += share;
    defect_[at.body].col(at.node) += share;
    bodies_[at.body].addResponse(local.index[a], share, tracked_[at.body]);
  }
}

void CholeskyRelaxation::contactPass(const ContactProblem& problem, ContactCorrector& corrector,
                                     ContactSolution& solution) {
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const Local& local = contacts_[c];
    if (!(local.W(0, 0) > 0.0)) continue;
    const ContactRow& row = problem.contacts[c];
    const Vector3 delta = corrector.correct(problem, c, local.W, trackedVelocity(row, local), solution);
    if (!delta.isZero(0.0)) press(row, local, row.R_WC * delta);
  }
}

void CholeskyRelaxation::beginPasses(const ContactSolution& solution) {
  for (std::size_t k = 0; k < bodies_.size(); ++k) bodies_[k].gatherTouched(solution.v[k], tracked_[k]);
}

void CholeskyRelaxation::finish(const ContactProblem& problem, ContactSolution& solution) {
  const bool was_fresh = fresh_;
  relaxSafely(problem, solution);
  lost_compliances_ = fresh_ != was_fresh;
}

/// Not with a factor of the last moment: to make its compliances would change the bits of steps to come.
bool CholeskyRelaxation::resumePasses(const ContactProblem& problem, const ContactSolution& solution) {
  const bool is_of_step = bodies_.size() == problem.bodies.size() && contacts_.size() == problem.contacts.size();
  if (!is_of_step || lost_compliances_) return false;
  beginPasses(solution);
  return true;
}

}  // namespace

std::unique_ptr<Relaxation> makeCholeskyRelaxation() { return std::make_unique<CholeskyRelaxation>(); }

}  // namespace tissue_contact
