#include "simulation/instrument_motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tissue_contact/contact/contact_detector.h"

namespace tissue_contact {
namespace {

/// Share of its smallest half extent that a shape may move in one step.
constexpr double kTravelPerStep = 0.5;

/// A mesh without thickness is treated as if it reached this share of its radius where it is thinnest.
constexpr double kThinnest = 0.01;

/// Distance from the shape's origin to its farthest point, m.
double boundingRadius(const CollisionShape& shape) {
  if (const auto* sphere = std::get_if<SphereGeometry>(&shape.geometry)) return sphere->radius_m;
  if (const auto* box = std::get_if<BoxGeometry>(&shape.geometry)) return 0.5 * box->size_m.norm();
  if (const auto* cylinder = std::get_if<CylinderGeometry>(&shape.geometry)) {
    return std::hypot(cylinder->radius_m, 0.5 * cylinder->length_m);
  }
  return shape.mesh->vertices.colwise().norm().maxCoeff();
}

double travel(const Vector3& center, double bounding_radius, const Pose& X_start, const Pose& X_end) {
  const double angle = Eigen::AngleAxisd(X_start.linear().transpose() * X_end.linear()).angle();
  return (X_end * center - X_start * center).norm() + angle * bounding_radius;
}

/// Largest angle, rad, by which a joint of the model would turn at its fastest, mimic joints included. What slides ends farther off the
/// farther it went; what turns need not.
double farthestTurn(const RobotModel& model, const VectorX& start, const VectorX& target,
                    const std::vector<JointWay>& ways) {
  double farthest = 0.0;
  for (const RobotModel::Link& link : model.links()) {
    if (link.motion != RobotModel::Link::Motion::kRevolute) continue;
    const double turn = std::abs(target[link.joint] - start[link.joint]) + ways[link.joint].excess();
    farthest = std::max(farthest, std::abs(link.multiplier) * turn);
  }
  return farthest;
}

/// Bound on travel() in a step of a motion times the number of steps, however many they are, m: each joint moves what lies beyond it,
/// which is never farther off than the offsets in between are long.
double travelBound(const RobotModel& model, const VectorX& start, const VectorX& target,
                   const std::vector<JointWay>& ways, int link, const Vector3& center, double bounding_radius) {
  double reach = center.norm(), way = 0.0, turn = 0.0;  // reach: from the frame of the link to the center
  for (; link >= 0; link = model.links()[link].parent) {
    const RobotModel::Link& one = model.links()[link];
    if (one.motion != RobotModel::Link::Motion::kFixed) {
      const double from = one.multiplier * start[one.joint] + one.offset;
      const double to = one.multiplier * target[one.joint] + one.offset;
      const bool turns = one.motion == RobotModel::Link::Motion::kRevolute;
      const double excess = std::abs(one.multiplier) * ways[one.joint].excess();
      const double moved = std::abs(to - from) + excess;
      way += moved * (turns ? reach : 1.0);
      (turns ? turn : reach) += turns ? moved : std::max(std::abs(from), std::abs(to)) + excess;
    }
    reach += one.X_PJ.translation().norm();
  }
  return way + turn * bounding_radius;
}

}  // namespace

InstrumentMotion::InstrumentMotion(const std::vector<Instrument>& instruments)
    : instruments_(instruments), states_(instruments.size()), X_WL_(instruments.size()), X_WL_end_(instruments.size()) {
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    for (const ContactLink& contact_link : instruments[i].contactLinks()) {
      MovingLink link{contact_link.link, {}};
      for (const CollisionShape& shape : contact_link.shapes) {
        const double radius = boundingRadius(shape);
        const double half_extent = std::max(tissue_contact::smallestHalfExtent(shape), kThinnest * radius);
        link.shapes.push_back({shape.X_LS.translation(), half_extent, radius});
      }
      states_[i].links.push_back(link);
    }
    states_[i].ways.resize(instruments[i].model().joints().size());
    if (instruments[i].compliantJoints().empty()) continue;
    states_[i].deflections.setZero(instruments[i].initialPositions().size());
    states_[i].loads.resize(instruments[i].model().joints().size());
  }
  reset();
  X_WL_before_ = X_WL_;  // so that begin() allocates nothing
}

void InstrumentMotion::reset() {
  for (std::size_t i = 0; i < instruments_.size(); ++i) place(static_cast<int>(i), instruments_[i].initialPositions());
}

void InstrumentMotion::place(int instrument, const VectorX& positions) {
  State& state = states_[instrument];
  state.deflections.setZero();
  std::fill(state.loads.begin(), state.loads.end(), JointLoad());
  put(instrument, positions);
}

/// There at once, as deflected as before: what one arm holds is not let go when another one jumps.
void InstrumentMotion::put(int instrument, const VectorX& positions) {
  State& state = states_[instrument];
  state.start = state.target = state.positions = positions;
  std::fill(state.ways.begin(), state.ways.end(), JointWay());
  if (state.deflections.size() > 0) state.positions_before = positions;
  poseEnd(instrument);
  X_WL_[instrument] = X_WL_end_[instrument];
}

void InstrumentMotion::carry(int instrument, StateArchive& archive) {
  State& state = states_[instrument];
  VectorX positions = state.positions;
  archive.carry(positions);
  archive.check(positions.allFinite(), "a joint position that is not finite");
  if (archive.isReading()) place(instrument, positions);
  if (state.deflections.size() == 0) return;
  archive.carry(state.deflections);
  archive.check(state.deflections.allFinite(), "a deflection of a joint that is not finite");
  for (JointLoad& load : state.loads) {
    archive.carry(load.effort);
    archive.carry(load.effort_before);
    archive.carry(load.friction);
    archive.carry(load.friction_before);
    archive.carry(load.stiffness);
    archive.carry(load.step_s);
    archive.carry(load.way);
    archive.carry(load.caution);
    archive.carry(load.least_caution);
    archive.check(std::isfinite(load.effort + load.effort_before) && std::isfinite(load.stiffness + load.step_s) &&
                      std::isfinite(load.way + load.caution + load.friction + load.friction_before) &&
                      load.stiffness >= 0.0 && load.step_s >= 0.0 && load.caution > 0.0 && load.least_caution > 0.0 &&
                      load.least_caution <= 1.0,
                  "an effort of a joint that is not finite");
  }
  if (!archive.isReading()) return;
  poseEnd(instrument);
  X_WL_[instrument] = X_WL_end_[instrument];
}

int InstrumentMotion::begin(double duration_s, double max_step_s, const std::vector<VectorX>& targets, int most_steps,
                            const JointVelocities* velocities) {
  // A duration that is a whole number of steps up to round-off of the stamps must not get one step more.
  constexpr double kRoundOff = 1e-9;
  constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
  constexpr double kLargestTurn = 1.0;    // rad
  constexpr double kSurely = 1.0 - 1e-6;  // that round-off, of positions over a billion steps, makes no step too long
  double joint_steps = 1.0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    State& state = states_[i];
    state.start = state.positions;
    state.target = targets[i];
    if (instruments_[i].isObstacle()) continue;
    for (std::size_t k = 0; k < state.ways.size(); ++k) {
      const auto joint = static_cast<Eigen::Index>(k);
      const double start_velocity = velocities == nullptr ? kUnknown : velocities->start[i][joint];
      const double end_velocity = velocities == nullptr ? kUnknown : velocities->end[i][joint];
      state.ways[k] = JointWay(state.target[joint] - state.start[joint], duration_s, start_velocity, end_velocity);
    }
    const double turn = farthestTurn(instruments_[i].model(), state.start, state.target, state.ways);
    joint_steps = std::max(joint_steps, std::ceil(turn / kLargestTurn));
  }
  const double by_time = std::max(1.0, std::ceil(duration_s / max_step_s - kRoundOff));
  double steps = std::max(by_time, joint_steps);
  const double most = std::max(by_time, std::min(kMaxTravelSteps, kMaxTravelStepsPerSecond * duration_s));
  if (joint_steps <= kMaxTravelSteps && !(travelBound() <= kSurely * kTravelPerStep * steps)) {
    double parts = longestTravelOver(steps, kTravelPerStep * most / steps) / kTravelPerStep;
    steps *= std::max(1.0, std::ceil(parts));
    while (parts > 1.0 && steps <= most && anyBent()) {  // the fastest part of a cubic may lie within one of them
      parts = longestTravelOver(steps, kTravelPerStep * most / steps) / kTravelPerStep;
      if (parts > 1.0) steps = std::ceil(steps * parts);
    }
  }
  jumped_ = !(steps <= most);
  if (jumped_) {
    for (std::size_t i = 0; i < states_.size(); ++i) put(static_cast<int>(i), targets[i]);
    steps = by_time;
  }
  return most_steps > 0 ? std::min(most_steps, static_cast<int>(steps)) : static_cast<int>(steps);
}

bool InstrumentMotion::anyBent() const {
  return std::any_of(states_.begin(), states_.end(), [](const State& state) {
    return std::any_of(state.ways.begin(), state.ways.end(), [](const JointWay& way) { return !way.isStraight(); });
  });
}

double InstrumentMotion::travelBound() const {
  double longest = 0.0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (instruments_[i].isObstacle()) continue;
    const State& state = states_[i];
    for (const MovingLink& link : state.links) {
      for (const MovingShape& shape : link.shapes) {
        const double travel = tissue_contact::travelBound(instruments_[i].model(), state.start, state.target,
                                                          state.ways, link.link, shape.center, shape.bounding_radius);
        longest = std::max(longest, travel / shape.smallest_half_extent);
      }
    }
  }
  return longest;
}

double InstrumentMotion::longestTravelOver(double steps, double most) {
  double longest = 0.0;
  X_WL_before_ = X_WL_;
  for (int k = 1; k <= static_cast<int>(steps) && longest <= most; ++k) {
    moveTo(k / steps);
    longest = std::max(longest, longestTravel(true));
    finishStep();
  }
  X_WL_ = X_WL_before_;
  for (State& state : states_) {
    if (state.deflections.size() > 0) state.positions_before = state.start;
  }
  return longest;
}

void InstrumentMotion::moveTo(double fraction) {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    State& state = states_[i];
    if (instruments_[i].isObstacle()) continue;
    // The last step must end exactly at the target, whatever round-off the interpolation has.
    state.positions = state.target;
    for (std::size_t k = 0; fraction < 1.0 && k < state.ways.size(); ++k) {
      const auto joint = static_cast<Eigen::Index>(k);
      state.positions[joint] = state.start[joint] + state.ways[k].at(fraction);
    }
    poseEnd(static_cast<int>(i));
  }
}

void InstrumentMotion::poseEnd(int instrument) {
  State& state = states_[instrument];
  if (state.deflections.size() == 0) {
    instruments_[instrument].linkPoses(state.positions, X_WL_end_[instrument]);
    return;
  }
  state.deflected = state.positions + state.deflections;
  instruments_[instrument].linkPoses(state.deflected, X_WL_end_[instrument]);
}

void InstrumentMotion::poseDeflected() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    if (states_[i].deflections.size() > 0) poseEnd(static_cast<int>(i));
  }
}

void InstrumentMotion::finishStep() {
  for (std::size_t i = 0; i < states_.size(); ++i) {
    X_WL_[i] = X_WL_end_[i];
    if (states_[i].deflections.size() > 0) states_[i].positions_before = states_[i].positions;
  }
}

Vector3 InstrumentMotion::pointVelocity(int instrument, int contact_link, const Vector3& p_W, double dt_s) const {
  const int link = states_[instrument].links[contact_link].link;
  const Pose& start = X_WL_[instrument][link];
  return (X_WL_end_[instrument][link] * (start.inverse() * p_W) - p_W) / dt_s;
}

double InstrumentMotion::longestTravel(bool per_half_extent) const {
  double longest = 0.0;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    for (const MovingLink& link : states_[i].links) {
      for (const MovingShape& shape : link.shapes) {
        const double moved = travel(shape.center, shape.bounding_radius, X_WL_[i][link.link], X_WL_end_[i][link.link]);
        longest = std::max(longest, per_half_extent ? moved / shape.smallest_half_extent : moved);
      }
    }
  }
  return longest;
}

double InstrumentMotion::longestWay(int instrument, int joint, double share) const {
  const RobotModel& model = instruments_[instrument].model();
  double longest = std::numeric_limits<double>::infinity();
  for (const MovingLink& moving : states_[instrument].links) {
    for (const MovingShape& shape : moving.shapes) {
      double reach = shape.center.norm() + shape.bounding_radius;
      double way = 0.0;  // for each rad or m
      for (int link = moving.link; link >= 0; link = model.links()[link].parent) {
        const RobotModel::Link& one = model.links()[link];
        const bool slides = one.motion == RobotModel::Link::Motion::kPrismatic;
        if (one.joint == joint) way += std::abs(one.multiplier) * (slides ? 1.0 : reach);
        if (slides) {
          const IndependentJoint& driver = model.joints()[one.joint];
          const double farthest = std::max(std::abs(driver.lower), std::abs(driver.upper));
          reach += std::abs(one.offset) + (std::isfinite(farthest) ? std::abs(one.multiplier) * farthest : 0.0);
        }
        reach += one.X_PJ.translation().norm();
      }
      if (way > 0.0) longest = std::min(longest, share * shape.smallest_half_extent / way);
    }
  }
  return longest;
}

double InstrumentMotion::smallestHalfExtent(int instrument, int contact_link, int shape) const {
  return states_[instrument].links[contact_link].shapes[shape].smallest_half_extent;
}

}  // namespace tissue_contact
