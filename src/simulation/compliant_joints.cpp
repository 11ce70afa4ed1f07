#include "simulation/compliant_joints.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

#include "tissue_contact/simulation/touched_point.h"

namespace tissue_contact {
namespace {

/// Of its smallest half extent that a shape may move in a step, by all compliant joints, beside what the joint states move it.
constexpr double kWayPerStep = 0.25;

/// In which a joint that nothing touches any more comes back by all but 1/e, s. One that moved on faster than the tissue follows would
/// otherwise be back within a step, and so on for ever.
constexpr double kReturnTime_s = 0.01;

/// Of a point that can move: those of which less can are no contacts (doc/method.md, "Finding contacts"), but for some that are only near.
constexpr double kLeastShare = 0.25;

/// rad or m: nearer than that to its joint state it is there, once nothing touches it.
constexpr double kNothing = 1e-9;

/// What contacts resist is taken for more where a joint goes back and forth, since other arms press the same nodes or tissue lies under a sheet, and for
/// less where it goes on and on, since held neighbours make nearly incompressible tissue stiff: by these factors a step, within these bounds.
constexpr double kGrows = 1.5;
constexpr double kFalls = 0.97;
constexpr double kMostCaution = 16.0;
constexpr double kLeastCaution = 0.1;
/// Of the way before: a way that turns to more than the first goes back and forth, one of more than the second goes on.
constexpr double kTurns = 0.5;
constexpr double kGoesOn = 0.8;
/// Of the effort: nearer to its balance than that a joint is there.
constexpr double kBalanced = 0.02;

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

/// Adds the nodes of a contact that can move. Where some cannot, the others go farther for the point to go its way.
void addMoved(const ContactProblem& problem, const ContactRow& row, CompliantJoints::Moved one,
              std::vector<CompliantJoints::Moved>& moved) {
  const auto canMove = [&](const RowNode& at) {
    const BodySystem& body = problem.bodies[at.body];
    return !body.asleep && !(*body.fixed)[at.node];
  };
  double share = 0.0;
  for (int a = 0; a < row.node_count; ++a) share += canMove(row.nodes[a]) ? row.nodes[a].weight : 0.0;
  one.way /= std::max(share, kLeastShare);
  for (int a = 0; a < row.node_count; ++a) {
    if (!canMove(row.nodes[a])) continue;
    one.body = row.nodes[a].body;
    one.node = row.nodes[a].node;
    one.weight = row.nodes[a].weight;
    moved.push_back(one);
  }
}

/// Where delta of a spring with a limit rests against `effort`, which falls by `resists` for each rad or m that the joint gives way.
/// @param resists > 0.
double restOf(const CompliantJoint& joint, double delta, double effort, double resists) {
  const double elastic = (effort + resists * delta) / (joint.stiffness + resists);
  if (std::abs(joint.stiffness * elastic) <= joint.effort_limit) return elastic;
  return delta + (effort - std::copysign(joint.effort_limit, elastic)) / resists;
}

/// Of the body of a node of the row, inwards.
Vector3 normalAt(const ContactRow& row, double weight) { return std::copysign(1.0, weight) * row.R_WC.col(0); }

}  // namespace

bool CompliantJoints::beforeNode(const PressedSide& one, const PressedSide& other) {
  return std::tie(one.body, one.node) < std::tie(other.body, other.node);
}

CompliantJoints::CompliantJoints(const std::vector<Instrument>& instruments, const std::vector<Tissue>& tissues,
                                 const InstrumentMotion& motion)
    : instruments_(instruments), tissues_(tissues) {
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const int instrument = static_cast<int>(i);
    const double share = kWayPerStep / static_cast<double>(instruments[i].compliantJoints().size());
    for (const CompliantJoint& joint : instruments[i].compliantJoints()) {
      joints_.push_back({instrument, joint, motion.longestWay(instrument, joint.joint, share), {}});
    }
  }
}

/// Effort of the contacts on a joint, and the nodes that they move with it.
void CompliantJoints::findEffort(Joint& joint, const ContactProblem& problem, const ContactSolution& solution,
                                 const std::vector<SolvedContact>& contacts, const std::vector<Pose>& X_WL,
                                 InstrumentMotion::JointLoad& load) {
  const Instrument& instrument = instruments_[joint.instrument];
  load.effort = load.friction = 0.0;
  bool touches = false;
  joint.moved.clear();
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const Contact& contact = contacts[c].contact;
    if (contact.key.instrument != joint.instrument) continue;
    const int link = instrument.contactLinks()[contact.key.link].link;
    const Vector3 p_W = touchedPoint(contact, tissues_);
    const Vector3 way = pointWay(instrument.model(), X_WL, link, joint.compliance.joint, p_W);
    if (way.isZero(0.0)) continue;
    touches = touches || !solution.impulses[c].isZero(0.0);
    const Vector3& force_n = contacts[c].force_on_tissue_n;
    load.effort -= way.dot(force_n);
    // What slides, or is only near, resists along its normal alone.
    const Vector3 n = problem.contacts[c].R_WC.col(0);
    const bool held = solution.states[c] == ContactState::kStatic;
    const Vector3 resisted = held ? way : n * n.dot(way);
    if (!held) load.friction -= way.dot(force_n - n * n.dot(force_n));
    addMoved(problem, problem.contacts[c], {contact.key.link, 0, 0, static_cast<int>(c), resisted, 0.0}, joint.moved);
  }
  if (!touches) joint.moved.clear();  // what is only near does not hold it up
}

/// What contacts add to the effort on a joint, backwards, for each rad or m that it moves in a step of the problem's length: the sum over the
/// links of n' A n / dt^2, times their number, since of n fields of velocities the sum has n times the energies of all at most.
double CompliantJoints::resistance(Joint& joint, const ContactProblem& problem, const ContactSolution& solution) {
  const auto key = [](const Moved& one) { return std::make_tuple(one.link, one.body, one.node, one.contact); };
  std::sort(joint.moved.begin(), joint.moved.end(),
            [&](const Moved& one, const Moved& other) { return key(one) < key(other); });
  double energy = 0.0;
  int links = 0;
  for (auto begin = joint.moved.begin(); begin != joint.moved.end(); ++links) {
    const auto end = std::find_if(begin, joint.moved.end(), [&](const Moved& one) { return one.link != begin->link; });
    energy += energyOf(problem, begin, end);
    begin = end;
  }
  return links * energy / (problem.dt_s * problem.dt_s) + squeezing(joint, problem, solution);
}

void CompliantJoints::findPressed(const ContactProblem& problem, const ContactSolution& solution) {
  pressed_.clear();
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    if (row.normal_compliance == 0.0 || solution.impulses[c].isZero(0.0)) continue;
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      pressed_.push_back({at.body, at.node, normalAt(row, at.weight)});
    }
  }
  std::sort(pressed_.begin(), pressed_.end(), beforeNode);
}

/// Whether the node is of a sheet that something presses from the other side.
bool CompliantJoints::isPressedBehind(const ContactProblem& problem, const Moved& one) const {
  const Vector3 normal = normalAt(problem.contacts[one.contact], one.weight);
  const auto [begin, end] =
      std::equal_range(pressed_.begin(), pressed_.end(), PressedSide{one.body, one.node, normal}, beforeNode);
  return std::any_of(begin, end, [&](const PressedSide& side) { return side.normal_W.dot(normal) < 0.0; });
}

/// A sheet between two sides resists by its thickness, however light it is: what half of it takes, for each rad or m of the joint.
double CompliantJoints::squeezing(const Joint& joint, const ContactProblem& problem,
                                  const ContactSolution& solution) const {
  double sum = 0.0;
  for (const Moved& one : joint.moved) {
    const ContactRow& row = problem.contacts[one.contact];
    if (row.normal_compliance == 0.0 || solution.impulses[one.contact].isZero(0.0)) continue;
    if (!isPressedBehind(problem, one)) continue;
    const double way = row.R_WC.col(0).dot(one.way);
    sum += std::abs(one.weight) * way * way / (row.normal_compliance * problem.dt_s * problem.dt_s);
  }
  return sum;
}

/// n' A n, n the mean way of the contacts on each node; all other nodes are held.
double CompliantJoints::energyOf(const ContactProblem& problem, MovedNodes begin, MovedNodes end) {
  ways_.resize(problem.bodies.size());
  const auto sameNode = [](const Moved& one, const Moved& other) {
    return one.body == other.body && one.node == other.node;
  };
  for (auto one = begin; one != end;) {
    NodalVectors& ways = ways_[one->body];
    const Eigen::Index nodes = problem.bodies[one->body].mass.size();
    if (ways.cols() != nodes) ways.setZero(3, nodes);
    Vector3 sum = Vector3::Zero();
    double weight = 0.0;
    const auto first = one;
    for (; one != end && sameNode(*one, *first); ++one) {
      sum += one->weight * one->way;
      weight += one->weight;
    }
    ways.col(first->node) = sum / weight;
  }
  double energy = 0.0;
  for (auto one = begin; one != end; ++one) {
    if (one != begin && sameNode(*one, *std::prev(one))) continue;
    const NodalVectors& ways = ways_[one->body];
    energy += ways.col(one->node).dot(momentumOf(problem.bodies[one->body], one->node, ways));
  }
  for (auto one = begin; one != end; ++one) ways_[one->body].col(one->node).setZero();
  return energy;
}

void CompliantJoints::load(const ContactProblem& problem, const ContactSolution& solution,
                           const std::vector<SolvedContact>& contacts, InstrumentMotion& motion) {
  if (!joints_.empty()) findPressed(problem, solution);
  for (Joint& joint : joints_) {
    InstrumentMotion::JointLoad load = motion.load(joint.instrument, joint.compliance.joint);
    load.effort_before = load.effort;
    load.friction_before = load.friction;
    findEffort(joint, problem, solution, contacts, motion.startPoses()[joint.instrument], load);
    load.stiffness = resistance(joint, problem, solution);
    load.step_s = problem.dt_s;
    motion.setLoad(joint.instrument, joint.compliance.joint, load);
  }
  // Joints that give way to the same nodes at once take them as far as their sum: so each meets the resistance of all.
  for (const Joint& joint : joints_) {
    InstrumentMotion::JointLoad load = motion.load(joint.instrument, joint.compliance.joint);
    load.stiffness *= static_cast<double>(std::count_if(joints_.begin(), joints_.end(), [&](const Joint& other) {
      return other.instrument == joint.instrument && !other.moved.empty();
    }));
    motion.setLoad(joint.instrument, joint.compliance.joint, load);
  }
}

void CompliantJoints::give(double dt, InstrumentMotion& motion) const {
  for (const Joint& joint : joints_) {
    const int index = joint.compliance.joint;
    InstrumentMotion::JointLoad load = motion.load(joint.instrument, index);
    const double delta = motion.deflections(joint.instrument)[index];
    double next = delta * kReturnTime_s / (kReturnTime_s + dt);
    if (load.stiffness > 0.0) {
      // Of A / dt^2 a shorter step has (dt / dt')^2 as much at most, a longer one no more.
      const double shorter = std::max(1.0, load.step_s / dt);
      const double moved = motion.wayOf(joint.instrument, index);
      const double stays = delta - moved;  // where it would be, had it not moved with its joint state
      const double most = joint.longest_way + std::abs(moved);
      const double effort = 0.5 * (load.effort + load.effort_before);
      const double resists = load.caution * load.stiffness * shorter * shorter;
      next = restOf(joint.compliance, stays, effort, resists);
      // Friction opposes sliding. A way against that is made only where friction turned round cannot hold the joint either.
      const double friction = 0.5 * (load.friction + load.friction_before);
      if ((next - stays) * friction > 0.0) {
        const double turned = restOf(joint.compliance, stays, effort - 2.0 * friction, resists);
        next = (turned - stays) * friction > 0.0 ? turned : stays;
      }
      if (next * effort < 0.0) next = 0.0;  // what pushes the other way holds no joint back from its joint state
      next = std::clamp(next, stays - most, stays + most);
      const double way = next - stays;
      const double lacks = effort - std::clamp(joint.compliance.stiffness * next, -joint.compliance.effort_limit,
                                               joint.compliance.effort_limit);
      if (way * load.way < 0.0 && std::abs(way) > kTurns * std::abs(load.way)) {
        load.caution = std::min(kGrows * std::max(load.caution, load.least_caution), kMostCaution);
        load.least_caution = 1.0;
      } else if (way * load.way > 0.0 && std::abs(way) > kGoesOn * std::abs(load.way) &&
                 std::abs(lacks) > kBalanced * std::abs(effort)) {
        load.caution = std::max(kFalls * load.caution, load.least_caution);
      }
      load.way = way;
    } else {
      next = std::clamp(next, delta - joint.longest_way, delta + joint.longest_way);
      if (std::abs(next) < kNothing) next = 0.0;
      const bool is_back = next == 0.0;
      load.least_caution = is_back ? kLeastCaution : 1.0;
      load.caution = is_back ? 1.0 : std::max(load.caution, 1.0);
      load.way = 0.0;
    }
    motion.setLoad(joint.instrument, index, load);
    motion.deflect(joint.instrument, index, next);
  }
  if (!joints_.empty()) motion.poseDeflected();
}

}  // namespace tissue_contact
