/// @file
/// Room `ros`, private: messages of the instruments. A simulator that was just advanced in, messages out.
#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <tf2_msgs/TFMessage.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// @throws std::invalid_argument: a name of an instrument or tissue that cannot be part of a topic.
void checkNames(const Simulator& simulator);

/// Per instrument and link: its frame. As the link is called; in instruments that have a link of the same name as another or as the world frame
/// `<instrument>/<link>`, since a tf tree has one frame of a name, and a wrench's must tell whose it is.
using FrameNames = std::vector<std::vector<std::string>>;

/// @throws std::invalid_argument when two are the same all the same.
FrameNames frameNames(const Simulator& simulator);

/// One for each instrument, in its tip frame; for fillWrench().
std::vector<geometry_msgs::WrenchStamped> wrenchMessages(const Simulator& simulator, const FrameNames& frames);

/// body/measured_cf and spatial/measured_cf (crtk_wrench.h).
struct CrtkMessages {
  geometry_msgs::WrenchStamped body;
  geometry_msgs::WrenchStamped spatial;
};

void fillCrtk(const Simulator& simulator, const FrameNames& frames, int instrument, std::int64_t stamp_ns,
              CrtkMessages& messages);

/// World -> root link -> every link, of all instruments; overwrites the message, keeps its memory.
void fillTransforms(const Simulator& simulator, const FrameNames& frames, std::int64_t stamp_ns,
                    tf2_msgs::TFMessage& message);

}  // namespace tissue_contact
