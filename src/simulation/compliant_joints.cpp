#include "simulation/compliant_joints.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tissue_contact {
namespace {

/// Of its smallest half extent that a shape may move in a step, beside what the joint states move it.
constexpr double kWayPerStep = 0.25;

/// In which a joint that nothing touches any more comes back by all but 1/e, s. One that moved on faster than the tissue follows would
/// otherwise be back within a step, and so on for ever.
constexpr double kReturnTime_s = 0.01;

/// rad or m: nearer than that to its joint state it is there, once nothing touches it.
constexpr double kNothing = 1e-9;

/// A v of a node, N s. @param v 0 for nodes that cannot move.
Vector3 momentumOf(const BodySystem& body, int node, const NodalVectors& v) {
  const auto times = [&](const BlockMatrix& matrix) -> Vector3 {
    return matrix.diagonal[node] * v.col(node) + matrix.offDiagonalProduct(node, v);
  };
  Vector3 momentum = body.mass[node] * v.col(node) + body.stiffness_scale * times(*body.K);
  if (body.D != nullptr) momentum += body.damping_scale * times(*body.D);
  return momentum;
}

/// Way of a link's material point at p_W for each rad or m of an independent joint.
Vector3 pointWay(const RobotModel& model, const std::vector<Pose>& X_WL, int link, int joint, const Vector3& p_W) {
  Vector3 way = Vector3::Zero();
  for (; link >= 0; link = model.links()[link].parent) {
    const RobotModel::Link& one = model.links()[link];
    if (one.joint != joint) continue;
    const Vector3 axis_W = X_WL[link].linear() * one.axis;
    const bool turns = one.motion == RobotModel::Link::Motion::kRevolute;
    way += one.multiplier * (turns ? axis_W.cross(p_W - X_WL[link].translation()).eval() : axis_W);
  }
  return way;
}

/// Where delta of a spring with a limit rests against `effort`, which falls by `resists` for each rad or m that the joint gives way.
/// @param resists > 0.
double restOf(const CompliantJoint& joint, double delta, double effort, double resists) {
  const double elastic = (effort + resists * delta) / (joint.stiffness + resists);
  if (std::abs(joint.stiffness * elastic) <= joint.effort_limit) return elastic;
  return delta + (effort - std::copysign(joint.effort_limit, elastic)) / resists;
}

}  // namespace

CompliantJoints::CompliantJoints(const std::vector<Instrument>& instruments, const InstrumentMotion& motion)
    : instruments_(instruments) {
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const int instrument = static_cast<int>(i);
    for (const CompliantJoint& joint : instruments[i].compliantJoints()) {
      joints_.push_back({instrument, joint, motion.longestWay(instrument, joint.joint, kWayPerStep), {}});
    }
  }
}

/// Effort of the contacts on a joint, and the nodes that they move with it.
double CompliantJoints::effortOn(Joint& joint, const ContactProblem& problem, const ContactSolution& solution,
                                 const std::vector<SolvedContact>& contacts, const std::vector<Pose>& X_WL) {
  const Instrument& instrument = instruments_[joint.instrument];
  double effort = 0.0;
  bool touches = false;
  joint.moved.clear();
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const Contact& contact = contacts[c].contact;
    if (contact.key.instrument != joint.instrument) continue;
    const int link = instrument.contactLinks()[contact.key.link].link;
    const Vector3 way = pointWay(instrument.model(), X_WL, link, joint.compliance.joint, contact.p_WC);
    if (way.isZero(0.0)) continue;
    touches = touches || !solution.impulses[c].isZero(0.0);
    effort -= way.dot(contacts[c].force_on_tissue_n);
    const ContactRow& row = problem.contacts[c];
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      const BodySystem& body = problem.bodies[at.body];
      if (body.asleep || (*body.fixed)[at.node]) continue;
      joint.moved.push_back({at.body, at.node, at.weight * way, at.weight});
    }
  }
  if (!touches) joint.moved.clear();  // what is only near does not hold it up
  return effort;
}

/// What the touched nodes, moved with the joint and all others held, add to its effort for each rad or m in a step.
double CompliantJoints::resistance(Joint& joint, const ContactProblem& problem) {
  const auto key = [](const Moved& one) { return std::make_pair(one.body, one.node); };
  std::sort(joint.moved.begin(), joint.moved.end(),
            [&](const Moved& one, const Moved& other) { return key(one) < key(other); });
  std::size_t nodes = 0;
  for (std::size_t m = 0; m < joint.moved.size(); ++m) {
    const Moved one = joint.moved[m];
    if (nodes > 0 && key(joint.moved[nodes - 1]) == key(one)) {
      joint.moved[nodes - 1].way += one.way;
      joint.moved[nodes - 1].weight += one.weight;
    } else {
      joint.moved[nodes++] = one;
    }
  }
  joint.moved.resize(nodes);
  ways_.resize(problem.bodies.size());
  for (const Moved& one : joint.moved) {
    NodalVectors& ways = ways_[one.body];
    if (ways.cols() != problem.bodies[one.body].mass.size()) ways.setZero(3, problem.bodies[one.body].mass.size());
    ways.col(one.node) = one.way / one.weight;
  }
  double energy = 0.0;
  for (const Moved& one : joint.moved) {
    const NodalVectors& ways = ways_[one.body];
    energy += ways.col(one.node).dot(momentumOf(problem.bodies[one.body], one.node, ways));
  }
  for (const Moved& one : joint.moved) ways_[one.body].col(one.node).setZero();
  return energy / (problem.dt_s * problem.dt_s);
}

void CompliantJoints::load(const ContactProblem& problem, const ContactSolution& solution,
                           const std::vector<SolvedContact>& contacts, InstrumentMotion& motion) {
  for (Joint& joint : joints_) {
    const double effort = effortOn(joint, problem, solution, contacts, motion.startPoses()[joint.instrument]);
    const double before = motion.load(joint.instrument, joint.compliance.joint).effort;
    motion.setLoad(joint.instrument, joint.compliance.joint, {effort, before, resistance(joint, problem)});
  }
  // Joints that give way to the same nodes at once take them as far as their sum: so each meets the resistance of all.
  for (const Joint& joint : joints_) {
    InstrumentMotion::JointLoad load = motion.load(joint.instrument, joint.compliance.joint);
    load.resists *= static_cast<double>(std::count_if(joints_.begin(), joints_.end(), [&](const Joint& other) {
      return other.instrument == joint.instrument && !other.moved.empty();
    }));
    motion.setLoad(joint.instrument, joint.compliance.joint, load);
  }
}

void CompliantJoints::give(double dt, InstrumentMotion& motion) const {
  for (const Joint& joint : joints_) {
    const int index = joint.compliance.joint;
    const InstrumentMotion::JointLoad& load = motion.load(joint.instrument, index);
    const double delta = motion.deflections(joint.instrument)[index];
    double next = delta * kReturnTime_s / (kReturnTime_s + dt);
    if (load.resists > 0.0) {
      const double moved = motion.wayOf(joint.instrument, index);
      const double stays = delta - moved;  // where it would be, had it not moved with its joint state
      const double most = joint.longest_way + std::abs(moved);
      const double effort = 0.5 * (load.effort + load.effort_before);
      next = std::clamp(restOf(joint.compliance, stays, effort, load.resists), stays - most, stays + most);
    } else {
      next = std::clamp(next, delta - joint.longest_way, delta + joint.longest_way);
      if (std::abs(next) < kNothing) next = 0.0;
    }
    motion.deflect(joint.instrument, index, next);
    motion.poseDeflected(joint.instrument);
  }
}

}  // namespace tissue_contact
