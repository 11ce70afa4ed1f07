#include "tissue_contact/instrument/robot_model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

using Motion = RobotModel::Link::Motion;

void checkLink(const RobotModel::Link& link, int index, int joint_count) {
  const std::string who = "link '" + link.name + "'";
  // The root alone has parent -1; every other parent must have been placed before its child.
  if (index == 0 ? link.parent != -1 : !(link.parent >= 0 && link.parent < index)) {
    throw std::invalid_argument(who + " has parent index " + std::to_string(link.parent) + " at position " +
                                std::to_string(index) + "; parents come before children, the root (-1) first");
  }
  if (!link.X_PJ.matrix().allFinite()) throw std::invalid_argument(who + " has a joint origin that is not finite");
  if (link.motion == Motion::kFixed) return;
  if (!(link.joint >= 0 && link.joint < joint_count)) {
    throw std::invalid_argument(who + " moves with joint index " + std::to_string(link.joint) + "; the model has " +
                                std::to_string(joint_count) + " independent joints");
  }
  constexpr double kUnitTolerance = 1e-9;  // dimensionless; a longer axis would scale the motion
  if (!(std::abs(link.axis.norm() - 1.0) < kUnitTolerance)) {
    throw std::invalid_argument(who + " has a joint axis of length " + std::to_string(link.axis.norm()) +
                                "; it must be 1");
  }
  if (!std::isfinite(link.multiplier) || !std::isfinite(link.offset)) {
    throw std::invalid_argument(who + " has a mimic multiplier or offset that is not finite");
  }
}

/// Applies the joint's own motion to the joint frame: X * Rot(axis, q) or X * Trans(q axis).
void applyMotion(const RobotModel::Link& link, double position, Pose& X) {
  if (link.motion == Motion::kRevolute) {
    X.linear() = X.linear() * Eigen::AngleAxisd(position, link.axis).toRotationMatrix();
  } else {
    X.translation() += X.linear() * (position * link.axis);
  }
}

template <typename Named>
int indexOf(const std::vector<Named>& all, const std::string& name) {
  const auto found = std::find_if(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
  return found == all.end() ? -1 : static_cast<int>(found - all.begin());
}

template <typename Named>
void requireDifferentNames(const std::vector<Named>& all, const std::string& complaint) {
  std::set<std::string> names;
  for (const Named& one : all) {
    if (!names.insert(one.name).second) throw std::invalid_argument(complaint + " named '" + one.name + "'");
  }
}

}  // namespace

double IndependentJoint::nearest(double position, double to) const {
  const double way = position - to;
  if (!turns_on || std::abs(way) <= M_PI || !std::isfinite(way)) return position;
  return to + std::remainder(way, 2.0 * M_PI);
}

double IndependentJoint::turnsLeftOut(double before, double now, double interval_s) const {
  const double way = now - before;
  if (!wraps || !(std::abs(way) > std::max(M_PI, kFastest_rad_per_s * interval_s)) || !std::isfinite(way)) return 0.0;
  return std::remainder(way, 2.0 * M_PI) - way;
}

RobotModel::RobotModel(std::string name, std::vector<Link> links, std::vector<IndependentJoint> joints)
    : name_(std::move(name)), links_(std::move(links)), joints_(std::move(joints)) {
  if (links_.empty()) throw std::invalid_argument("robot '" + name_ + "' has no link; it needs at least a root link");
  for (std::size_t i = 0; i < links_.size(); ++i) {
    checkLink(links_[i], static_cast<int>(i), static_cast<int>(joints_.size()));
  }
  requireDifferentNames(links_, "robot '" + name_ + "' has two links");
  requireDifferentNames(joints_, "robot '" + name_ + "' has two joints");
}

int RobotModel::findLink(const std::string& name) const { return indexOf(links_, name); }

std::string RobotModel::mimicsText(const std::vector<std::string>& names) const {
  const std::set<std::string_view> given(names.begin(), names.end());  // a message may name a million
  std::vector<std::string> mimics;
  for (const Link& link : links_) {
    if (link.mimic.empty() || given.count(link.mimic) == 0) continue;
    mimics.push_back(link.mimic + " of " + joints_[static_cast<std::size_t>(link.joint)].name);
  }
  return mimics.empty() ? std::string()
                        : "mimics, which only follow a joint: " + listOf(mimics) + "; give that joint's position";
}

int RobotModel::findJoint(const std::string& name) const { return indexOf(joints_, name); }

void RobotModel::forwardKinematics(const VectorX& positions, std::vector<Pose>& X_BL) const {
  if (positions.size() != static_cast<Eigen::Index>(joints_.size())) {
    throw std::invalid_argument("forward kinematics of robot '" + name_ + "' got " + std::to_string(positions.size()) +
                                " joint positions; it has " + std::to_string(joints_.size()) + " independent joints");
  }
  X_BL.resize(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    Pose& X = X_BL[i];
    X = link.parent < 0 ? link.X_PJ : X_BL[static_cast<std::size_t>(link.parent)] * link.X_PJ;
    if (link.motion != Motion::kFixed) {
      applyMotion(link, link.multiplier * positions[link.joint] + link.offset, X);
    }
  }
}

}  // namespace tissue_contact
