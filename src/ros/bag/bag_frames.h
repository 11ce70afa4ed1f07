/// @file
/// Room `ros` (private): poses of frames from the /tf and /tf_static of a bag.
#pragma once

#include <ros/time.h>

#include <string>

#include "ros/frame_motion.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Pose of `frame` in `world_frame` (metres) at the earliest moment that the bag knows it. The file is not trusted: see
/// bag_reader.h.
/// @throws std::runtime_error when the bag cannot be read; std::invalid_argument when it never says, or not within its
///   first 10^6 transforms; those with frame names longer than 256 bytes are left out.
Pose frameInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file);

/// The farthest that `frame` is from where frameInBag() finds it, after any message recorded until then.
/// @throws as frameInBag().
FrameMotion farthestInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file,
                          ros::Time until = ros::TIME_MAX);

}  // namespace tissue_contact
