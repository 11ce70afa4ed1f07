#include "ros/publish/instrument_messages.h"

#include <ros/names.h>

#include <cstddef>
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

/// A tf tree has one parent per frame, so links of different instruments need different names. A root link may be the
/// world frame itself when it lies there.
void checkFrameNames(const Simulator& simulator) {
  std::set<std::string> names = {simulator.scene().world_frame};
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const Instrument& instrument = simulator.instruments()[i];
    for (const RobotModel::Link& link : instrument.model().links()) {
      const bool is_world = link.parent < 0 && link.name == simulator.scene().world_frame &&
                            simulator.linkPoses(static_cast<int>(i)).front().isApprox(Pose::Identity());
      if (names.insert(link.name).second || is_world) continue;
      throw std::invalid_argument("publish.tf: link '" + link.name + "' of instrument '" + instrument.name() +
                                  "' has the name of the world frame or of another instrument's link; rename one or "
                                  "set publish.tf to false");
    }
  }
}

}  // namespace

void checkNames(const Simulator& simulator, bool with_tf) {
  for (const Instrument& instrument : simulator.instruments()) checkTopicName("instrument", instrument.name());
  for (const Tissue& tissue : simulator.tissues()) checkTopicName("tissue", tissue.name());
  if (with_tf) checkFrameNames(simulator);
}

std::vector<geometry_msgs::WrenchStamped> wrenchMessages(const Simulator& simulator) {
  std::vector<geometry_msgs::WrenchStamped> messages;
  for (const Instrument& instrument : simulator.instruments()) {
    messages.emplace_back();
    messages.back().header.frame_id = instrument.model().links()[static_cast<std::size_t>(instrument.tipLink())].name;
  }
  return messages;
}

void fillCrtk(const Simulator& simulator, int instrument, std::int64_t stamp_ns, CrtkMessages& messages) {
  const Instrument& arm = simulator.instruments()[static_cast<std::size_t>(instrument)];
  const std::vector<Pose>& X_WL = simulator.linkPoses(instrument);
  const auto tip = static_cast<std::size_t>(arm.tipLink());
  const Wrench felt = simulator.wrench(instrument);
  messages.body.header.frame_id = arm.model().links()[tip].name;
  fillWrench(bodyMeasuredForce(felt), stamp_ns, messages.body);
  messages.spatial.header.frame_id = arm.model().links().front().name;
  fillWrench(spatialMeasuredForce(felt, X_WL.front().inverse() * X_WL[tip]), stamp_ns, messages.spatial);
}

void fillTransforms(const Simulator& simulator, std::int64_t stamp_ns, tf2_msgs::TFMessage& message) {
  message.transforms.clear();
  for (std::size_t i = 0; i < simulator.instruments().size(); ++i) {
    const std::vector<RobotModel::Link>& links = simulator.instruments()[i].model().links();
    const std::vector<Pose>& X_WL = simulator.linkPoses(static_cast<int>(i));
    for (std::size_t l = 0; l < links.size(); ++l) {
      const bool is_root = links[l].parent < 0;
      if (is_root && links[l].name == simulator.scene().world_frame) continue;
      const auto parent = static_cast<std::size_t>(is_root ? 0 : links[l].parent);
      geometry_msgs::TransformStamped& transform = message.transforms.emplace_back();
      transform.header.stamp = toTime(stamp_ns);
      transform.header.frame_id = is_root ? simulator.scene().world_frame : links[parent].name;
      transform.child_frame_id = links[l].name;
      transform.transform = toTransform(is_root ? X_WL[l] : Pose(X_WL[parent].inverse() * X_WL[l]));
    }
  }
}

}  // namespace tissue_contact
