#include "validation/hard/hard_run.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {
namespace {

/// What an answer needs to judge another by. 1e-10 is the aim; where a face carries as many points as it has degrees of
/// freedom W is singular and 1e-6 is met, still a thousandth of what the defaults leave.
constexpr double kExactEnough = 1e-5;

/// Relative difference of forces from which on a contact that sticks here and slides there counts as such.
constexpr double kNoticed = 0.01;

/// std::max would drop a NaN.
void worsen(double& worst, double value) {
  if (!(value <= worst)) worst = value;
}

/// Force on the tissue, N, summed for each instrument, from impulses in the order of `contacts`.
template <typename ImpulseOf>
std::vector<Vector3> forcesOf(const Simulator& simulator, const ImpulseOf& impulse) {
  std::vector<Vector3> forces(simulator.instruments().size(), Vector3::Zero());
  const ContactProblem& problem = simulator.lastProblem();
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const int instrument = simulator.contacts()[c].contact.key.instrument;
    if (instrument >= 0) forces[instrument] += problem.contacts[c].R_WC * impulse(c) / problem.dt_s;
  }
  return forces;
}

/// Whether a contact that presses in both answers sticks in the one and slides in the other.
bool letsGoElse(const ContactSolution& a, const DelassusSolution& b) {
  for (std::size_t c = 0; c < a.states.size(); ++c) {
    const bool presses = a.impulses[c][0] > 0.0 && b.r[3 * static_cast<Eigen::Index>(c)] > 0.0;
    if (presses && (a.states[c] == ContactState::kStatic) != (b.states[c] == ContactState::kStatic)) return true;
  }
  return false;
}

}  // namespace

HardRun::HardRun(Simulator& simulator, int reference_every)
    : simulator_(simulator),
      reference_every_(reference_every),
      edge_(meanSurfaceEdge(simulator.tissues().data(), simulator.tissues().size())) {
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    X_WL_.push_back(simulator.linkPoses(static_cast<int>(i)));
  }
  energy_ = totalEnergy();
  simulator.setStepObserver([this] { observe(); });
}

HardRun::~HardRun() { simulator_.setStepObserver({}); }

double HardRun::elasticEnergy() const {
  double energy = 0.0;
  for (std::size_t t = 0; t < simulator_.tissues().size(); ++t) {
    energy += simulator_.tissues()[t].elasticity().energy(simulator_.positions(static_cast<int>(t)));
  }
  return energy;
}

double HardRun::totalEnergy() const {
  double energy = elasticEnergy();
  const Vector3& g = simulator_.scene().gravity_m_per_s2;
  for (std::size_t t = 0; t < simulator_.tissues().size(); ++t) {
    const VectorX& masses = simulator_.tissues()[t].nodeMasses();
    const NodalVectors& v = simulator_.velocities(static_cast<int>(t));
    energy += 0.5 * v.colwise().squaredNorm().dot(masses);
    energy -= g.dot(simulator_.positions(static_cast<int>(t)) * masses);
  }
  return energy;
}

void HardRun::observe() {
  ++steps_;
  const StepReport& report = simulator_.report();
  finite_ = finite_ && !report.discarded;
  for (std::size_t t = 0; t < simulator_.tissues().size(); ++t) {
    finite_ = finite_ && simulator_.positions(static_cast<int>(t)).allFinite() &&
              simulator_.velocities(static_cast<int>(t)).allFinite();
  }
  met_ += report.stop == StopReason::kTolerance;
  addWork();
  const double energy = totalEnergy();
  worsen(gained_, gained_ + energy - energy_ - work_ - pushed_out_);
  energy_ = energy;
  total_work_ += std::abs(work_);
  total_pushed_ += pushed_out_;
  const Residuals& residuals = simulator_.residuals();
  worsen(worst_.momentum, residuals.momentum);
  worsen(worst_.penetration_m, residuals.penetration_m);
  worsen(worst_.adhesion_n, residuals.adhesion_n);
  worsen(worst_.complementarity_w, residuals.complementarity_w);
  worsen(worst_.cone_violation_n, residuals.cone_violation_n);
  worsen(worst_.static_slip_m_per_s, residuals.static_slip_m_per_s);
  worsen(worst_.kinetic_angle_rad, residuals.kinetic_angle_rad);
  most_contacts_ = std::max(most_contacts_, report.static_contacts + report.kinetic_contacts);
  if (reference_every_ > 0 && steps_ % reference_every_ == 0 && !report.discarded) compareWithExact();
}

/// Work of each contact's force over the way of the instrument's point at it, and over the penetration taken back.
void HardRun::addWork() {
  const ContactProblem& problem = simulator_.lastProblem();
  const ContactSolution& solution = simulator_.lastSolution();
  for (std::size_t i = 0; i < X_WL_.size() && simulator_.report().jumped; ++i) {
    X_WL_[i] = simulator_.linkPoses(static_cast<int>(i));  // a jump is no way
  }
  work_ = 0.0;
  pushed_out_ = 0.0;
  std::vector<Vector3> forces(X_WL_.size(), Vector3::Zero());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const SolvedContact& one = simulator_.contacts()[c];
    const ContactKey& key = one.contact.key;
    const ContactRow& row = problem.contacts[c];
    worsen(deepest_, -one.contact.gap_m);
    if (one.state == ContactState::kOpen) continue;
    pushed_out_ += solution.impulses[c][0] * std::max(0.0, row.required_u_n);
    if (one.state == ContactState::kKinetic) {  // what is left of a static contact's slip the next step takes back
      worsen(driven_,
             driven_ + std::max(0.0, solution.impulses[c].tail<2>().dot(relativeVelocity(row, solution.v).tail<2>())));
    }
    if (key.instrument < 0) continue;
    const Instrument& instrument = simulator_.instruments()[key.instrument];
    const int link = instrument.contactLinks()[key.link].link;
    const Pose& end = simulator_.linkPoses(key.instrument)[link];
    const Vector3& p = one.contact.p_WC;
    work_ += one.force_on_tissue_n.dot(p - X_WL_[key.instrument][link] * (end.inverse() * p));
    forces[key.instrument] += one.force_on_tissue_n;
  }
  for (std::size_t i = 0; i < X_WL_.size(); ++i) {
    X_WL_[i] = simulator_.linkPoses(static_cast<int>(i));
    worsen(largest_force_, forces[i].norm());
  }
}

void HardRun::compareWithExact() {
  const ContactProblem& problem = simulator_.lastProblem();
  const ContactSolution& solution = simulator_.lastSolution();
  const auto count = static_cast<Eigen::Index>(problem.contacts.size());
  if (count == 0) return;
  DelassusProblem exact = makeDelassusProblem(problem);
  // With mu_s > mu_k sticking and sliding can both be exact: the one found is compared with itself.
  for (Eigen::Index c = 0; c < count; ++c) {
    if (solution.states[c] == ContactState::kKinetic) exact.was_sliding[c] = true;
  }
  DelassusSolution answer;
  answer.r.resize(3 * count);
  for (Eigen::Index c = 0; c < count; ++c) answer.r.segment<3>(3 * c) = solution.impulses[c];
  answer.u = exact.W * answer.r + exact.q;
  answer.states = solution.states;
  worsen(natural_map_, computeResiduals(exact, answer.r).scaled_natural_map);
  SolverDescription reference;
  reference.method = SolverMethod::kReference;
  ++references_;
  solveDelassus(exact, reference, answer);
  if (!(computeResiduals(exact, answer.r).scaled_natural_map <= kExactEnough)) return;
  ++references_met_;
  const std::vector<Vector3> got = forcesOf(simulator_, [&](std::size_t c) { return solution.impulses[c]; });
  const std::vector<Vector3> wanted = forcesOf(
      simulator_, [&](std::size_t c) -> Vector3 { return answer.r.segment<3>(3 * static_cast<Eigen::Index>(c)); });
  double error = 0.0;
  double force = 0.0;
  for (std::size_t i = 0; i < got.size(); ++i) {
    error += (got[i] - wanted[i]).squaredNorm();
    force += wanted[i].squaredNorm();
  }
  // Called static or kinetic right at the limit, both with the same force, is no difference.
  const bool let_go_else = error > kNoticed * kNoticed * force && letsGoElse(solution, answer);
  let_go_else_ += let_go_else;
  (let_go_else ? squared_error_else_ : squared_error_) += error;
  squared_force_ += force;
  if (simulator_.report().stop != StopReason::kTolerance) return;
  squared_error_where_met_ += error;
  squared_force_where_met_ += force;
}

double HardRun::errorWhereMet() const { return std::sqrt(squared_error_where_met_ / squared_force_where_met_); }

void HardRun::report(const std::string& name, const HardBands& bands, Report& report) const {
  report.atLeast(name + ": implicit steps", "", 2000, static_cast<double>(steps_), "length of a hard case");
  report.require(name + ": finite, no step discarded", finite_, "stability");
  report.atMost(name + ": energy from nothing over work done", "", bands.energy,
                gained_ / (total_work_ + total_pushed_), "energy balance, summed over the steps that gained");
  report.atMost(name + ": work of friction that drives, share", "", bands.energy,
                driven_ / (total_work_ + total_pushed_), "friction dissipates");
  report.atMost(name + ": deepest penetration over edge", "", bands.penetration_edges, deepest_ / edge_,
                "non-penetration");
  if (reference_every_ > 0) {
    // Where no exact answer was found nothing was compared: that must stay rare.
    report.atLeast(name + ": steps solved exactly, share", "", 0.9, static_cast<double>(references_met_) / references_,
                   "scaled natural map of 1e-5");
    report.atMost(name + ": force error of a step, RMS / RMS", "", bands.force,
                  std::sqrt(squared_error_ / squared_force_), "reference solver on the same step");
    report.atMost(name + ": steps that stick or slide otherwise, share", "", bands.let_go_else,
                  static_cast<double>(let_go_else_) / references_met_, "reference solver on the same step");
  }
  std::ostringstream note;
  note.precision(2);
  note << name << ": worst scaled natural map " << natural_map_ << ", momentum " << worst_.momentum << ", penetration "
       << worst_.penetration_m << " m, adhesion " << worst_.adhesion_n << " N, complementarity "
       << worst_.complementarity_w << " W, cone " << worst_.cone_violation_n << " N, static slip "
       << worst_.static_slip_m_per_s << " m/s, kinetic angle " << worst_.kinetic_angle_rad << " rad; force up to "
       << largest_force_ << " N, " << most_contacts_ << " contacts; tolerance met in "
       << std::lround(100.0 * static_cast<double>(met_) / static_cast<double>(std::max(1L, steps_))) << " % of "
       << steps_ << " steps; pushed out " << total_pushed_ << " of " << total_work_ << " J";
  if (let_go_else_ > 0) {
    note << "; force error with the " << let_go_else_ << " of " << references_met_
         << " steps that stick or slide otherwise: "
         << std::sqrt((squared_error_ + squared_error_else_) / squared_force_);
  }
  report.note(note.str());
}

}  // namespace tissue_contact
