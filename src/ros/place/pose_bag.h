/// @file
/// Room `ros/place`, private: measured poses of a bag. A topic in, poses in the order of their stamps out.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "ros/place/registration.h"

namespace tissue_contact {

struct MeasuredPoses {
  std::string frame;  ///< of the first
  std::vector<StampedPose> poses;
  std::size_t unusable = 0;  ///< messages that were left out, their numbers being no pose
};

/// Of a topic of geometry_msgs/PoseStamped or TransformStamped. The file is not trusted: see bag_reader.h. Poses that are not finite, or
/// whose quaternion is zero, are left out and counted.
/// @throws std::runtime_error when there are none, when they are of another type, or more than a million.
MeasuredPoses readPoses(const std::string& bag_file, const std::string& topic);

}  // namespace tissue_contact
