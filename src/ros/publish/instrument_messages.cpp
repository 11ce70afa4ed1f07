#include "ros/publish/instrument_messages.h"

#include <ros/names.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "ros/conversions.h"
#include "ros/publish/crtk_wrench.h"

namespace tissue_contact {
namespace {

void checkTopicName(const std::string& kind, const std::string& name) {
  std::string why;
  if (name.find('/') == std::string::npos && ros::names::validate("/" + name, why) && !name.empty()) return;
  throw std::invalid_argument("the " + kind + " name '" + name +
                              "' becomes part of a topic name and must consist of letters, digits and underscores" +
                              (why.empty() ? "" : " (" + why + ")"));
}

/// As tf2 calls it: links of old URDFs begin with a /, which it takes off what it is told and refuses in what it is asked.
std::string frameOf(const RobotModel::Link& link) {
  const std::size_t begin = link.name.find_first_not_of('/');
  return begin == std::string::npos ? link.name : link.name.substr(begin);
}

/// A root link that is the world frame itself, called like it and where it is.
bool isWorld(const Simulator& simulator, std::size_t instrument, const RobotModel::Link& link) {
  return link.parent < 0 && frameOf(link) == simulator.scene().world_frame &&
         simulator.linkPoses(static_cast<int>(instrument)).front().isApprox(Pose::Identity());
}

/// How many frames would be called so, were all links' called as the links are.
std::map<std::string, int> countNames(const Simulator& simulator) {
  std::map<std::string, int> counts = {{simulator.scene().world_frame, 1}};
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    for (const RobotModel::Link& link : simulator.instruments()[i].model().links()) {
      if (!isWorld(simulator, i, link)) ++counts[frameOf(link)];
    }
  }
  return counts;
}

}  // namespace

void checkNames(const Simulator& simulator) {
  for (const Instrument& instrument : simulator.instruments()) checkTopicName("instrument", instrument.name());
  for (const Tissue& tissue : simulator.tissues()) checkTopicName("tissue", tissue.name());
}

FrameNames frameNames(const Simulator& simulator) {
  const std::map<std::string, int> counts = countNames(simulator);
  FrameNames frames;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const std::vector<RobotModel::Link>& links = simulator.instruments()[i].model().links();
    // A root that is called as the world frame and stands elsewhere, as many arms' does, is renamed alone: other nodes know the others.
    const auto isNamesake = [&](const RobotModel::Link& link) {
      return link.parent < 0 && frameOf(link) == simulator.scene().world_frame;
    };
    const bool shares = std::any_of(links.begin(), links.end(), [&](const RobotModel::Link& link) {
      return !isNamesake(link) && counts.at(frameOf(link)) > 1;
    });
    std::vector<std::string>& names = frames.emplace_back();
    for (const RobotModel::Link& link : links) {
      const bool is_world = isWorld(simulator, i, link);
      names.push_back((shares || isNamesake(link)) && !is_world
                          ? simulator.instruments()[i].name() + "/" + frameOf(link)
                          : frameOf(link));
      if (is_world || taken.insert(names.back()).second) continue;
      throw std::invalid_argument("two links have the frame '" + names.back() + "'; rename one in its URDF");
    }
  }
  return frames;
}

std::vector<geometry_msgs::WrenchStamped> wrenchMessages(const Simulator& simulator, const FrameNames& frames) {
  std::vector<geometry_msgs::WrenchStamped> messages(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    messages[i].header.frame_id = frames[i][static_cast<std::size_t>(simulator.instruments()[i].tipLink())];
  }
  return messages;
}

void fillCrtk(const Simulator& simulator, const FrameNames& frames, int instrument, std::int64_t stamp_ns,
              CrtkMessages& messages) {
  const Instrument& arm = simulator.instruments()[static_cast<std::size_t>(instrument)];
  const std::vector<Pose>& X_WL = simulator.linkPoses(instrument);
  const auto tip = static_cast<std::size_t>(arm.tipLink());
  const Wrench felt = simulator.wrench(instrument);
  const std::vector<std::string>& names = frames[static_cast<std::size_t>(instrument)];
  messages.body.header.frame_id = names[tip];
  fillWrench(bodyMeasuredForce(felt), stamp_ns, messages.body);
  messages.spatial.header.frame_id = names.front();
  fillWrench(spatialMeasuredForce(felt, X_WL.front().inverse() * X_WL[tip]), stamp_ns, messages.spatial);
}

void fillTransforms(const Simulator& simulator, const FrameNames& frames, std::int64_t stamp_ns,
                    tf2_msgs::TFMessage& message) {
  message.transforms.clear();
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const std::vector<RobotModel::Link>& links = simulator.instruments()[i].model().links();
    const std::vector<Pose>& X_WL = simulator.linkPoses(static_cast<int>(i));
    for (std::size_t l = 0; l < links.size(); ++l) {
      const bool is_root = links[l].parent < 0;
      if (is_root && frames[i][l] == simulator.scene().world_frame) continue;
      const auto parent = static_cast<std::size_t>(is_root ? 0 : links[l].parent);
      geometry_msgs::TransformStamped& transform = message.transforms.emplace_back();
      transform.header.stamp = toTime(stamp_ns);
      transform.header.frame_id = is_root ? simulator.scene().world_frame : frames[i][parent];
      transform.child_frame_id = frames[i][l];
      transform.transform = toTransform(is_root ? X_WL[l] : Pose(X_WL[parent].inverse() * X_WL[l]));
    }
  }
}

}  // namespace tissue_contact
