/// @file
/// Room `core`: where a scene places something.
#pragma once

#include <string>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A pose in the world frame W, or in a tf frame that is looked up once at start.
struct PoseDescription {
  Pose X = Pose::Identity();  ///< pose in W if `tf_frame` is empty, else in `tf_frame`
  std::string tf_frame;       ///< empty: placed by the scene alone
};

}  // namespace tissue_contact
