/// @file
/// Forward kinematics of urdf/psm_classic.urdf against a real robot: joint states and tip poses that a dVRK Classic PSM
/// recorded side by side. Reads the bag itself; needs no roscore.

#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/JointState.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/instrument/parse_urdf.h"

namespace tissue_contact {
namespace fk_bag_test {

const char kBag[] = TISSUE_CONTACT_SHARED_DATA "/dvrk/psm2_classic_motion.bag";

/// Joint-name map and base pose of psm_dh.md, beside the bag: the arm's base in the console frame that measured_cp
/// uses.
Instrument recordedPsm() {
  InstrumentDescription description;
  description.name = "psm";
  description.joint_state_topics = {{"/PSM2/measured_js"}};
  description.tip_link = "tip";
  for (const char* joint : {"yaw", "pitch", "insertion", "roll", "wrist_pitch", "wrist_yaw"}) {
    description.joint_names[std::string("outer_") + joint] = joint;
  }
  Pose X_WB = Pose::Identity();
  X_WB.linear() = Eigen::AngleAxisd(210.0 * M_PI / 180.0, Vector3::UnitX()).toRotationMatrix();
  X_WB.translation() = Vector3(0.2, 0.0, 0.0);
  return Instrument(description, loadUrdf(TISSUE_CONTACT_SOURCE_DIR "/urdf/psm_classic.urdf", nullptr), X_WB);
}

struct Recording {
  std::vector<sensor_msgs::JointState> joints;
  std::map<double, Pose> tips;  ///< by stamp, s
};

Recording readRecording() {
  Recording recording;
  rosbag::Bag bag(kBag);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) {
    if (message.getTopic() == "/PSM2/measured_js") {
      recording.joints.push_back(*message.instantiate<sensor_msgs::JointState>());
    } else if (message.getTopic() == "/PSM2/measured_cp") {
      const auto pose = message.instantiate<geometry_msgs::PoseStamped>();
      const auto& q = pose->pose.orientation;
      Pose X = Pose::Identity();
      X.linear() = Quaternion(q.w, q.x, q.y, q.z).normalized().toRotationMatrix();
      X.translation() = Vector3(pose->pose.position.x, pose->pose.position.y, pose->pose.position.z);
      recording.tips[pose->header.stamp.toSec()] = X;
    }
  }
  return recording;
}

std::map<double, Pose>::const_iterator nearest(const std::map<double, Pose>& tips, double stamp) {
  const auto after = tips.lower_bound(stamp);
  if (after == tips.begin()) return after;
  const auto before = std::prev(after);
  return after == tips.end() || stamp - before->first < after->first - stamp ? before : after;
}

TEST(ForwardKinematicsOfARealRobot, AgreesWithTheRecordedTipPose) {
  if (!std::filesystem::exists(kBag)) GTEST_SKIP() << "no recording at " << kBag;
  const Instrument psm = recordedPsm();
  const Recording recording = readRecording();
  ASSERT_EQ(recording.joints.size(), 3420u);

  // The robot computes measured_cp from the joint positions of the same control cycle and stamps the two messages up to
  // 1.5 ms apart; cycles are 10 ms apart. So the nearest tip pose is the one of the same positions, while interpolation
  // to the joint state's stamp mixes in a neighbouring cycle: it doubles the error (0.030 mm RMS instead of 0.014 mm).
  constexpr double kSameCycle = 0.003;  // s
  VectorX positions = psm.initialPositions();
  std::vector<Pose> X_WL;
  double position_sum = 0.0;
  double angle_sum = 0.0;
  double position_max = 0.0;
  double angle_max = 0.0;
  double stamp_max = 0.0;
  int compared = 0;
  for (const sensor_msgs::JointState& state : recording.joints) {
    const auto tip = nearest(recording.tips, state.header.stamp.toSec());
    const double apart = std::abs(tip->first - state.header.stamp.toSec());
    if (apart > kSameCycle) continue;  // recording starts or ends between the two messages
    ASSERT_EQ(state.name.size(), 6u);
    for (std::size_t i = 0; i < state.name.size(); ++i) {
      const int joint = psm.jointOfRecordedName(state.name[i]);
      ASSERT_GE(joint, 0) << state.name[i];
      positions[joint] = state.position[i];
    }
    psm.linkPoses(positions, X_WL);
    const Pose error = tip->second.inverse() * X_WL[static_cast<std::size_t>(psm.tipLink())];
    const double distance = error.translation().norm();
    const double angle = Eigen::AngleAxisd(error.linear()).angle();
    position_sum += distance * distance;
    angle_sum += angle * angle;
    position_max = std::max(position_max, distance);
    angle_max = std::max(angle_max, angle);
    stamp_max = std::max(stamp_max, apart);
    ++compared;
  }
  ASSERT_GE(compared, 3400);
  const double position_rms = std::sqrt(position_sum / compared);
  const double angle_rms = std::sqrt(angle_sum / compared);
  std::cout << compared << " poses compared, stamps at most " << stamp_max * 1e3 << " ms apart: position RMS "
            << position_rms * 1e3 << " mm, max " << position_max * 1e3 << " mm; rotation RMS " << angle_rms
            << " rad, max " << angle_max << " rad\n";
  // Measured 0.0145 mm and 7.1e-5 rad (max 7.4e-4 rad). A wrong sign, offset or joint order is wrong by centimetres, a
  // length wrong in its last digit by 0.1 mm.
  EXPECT_LE(position_rms, 0.05e-3);
  EXPECT_LE(angle_rms, 1e-3);
  EXPECT_LE(angle_max, 1e-3);
}

}  // namespace fk_bag_test
}  // namespace tissue_contact
