/// @file
/// Room `ros`, private: messages of the instruments. A simulator that was just advanced in, messages out.
#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <tf2_msgs/TFMessage.h>

#include <cstdint>
#include <vector>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// @throws std::invalid_argument: a name of an instrument or tissue that cannot be part of a topic, and if `with_tf` two links with one
///   name.
void checkNames(const Simulator& simulator, bool with_tf);

/// One for each instrument, in its tip frame; for fillWrench().
std::vector<geometry_msgs::WrenchStamped> wrenchMessages(const Simulator& simulator);

/// body/measured_cf and spatial/measured_cf (crtk_wrench.h).
struct CrtkMessages {
  geometry_msgs::WrenchStamped body;
  geometry_msgs::WrenchStamped spatial;
};

void fillCrtk(const Simulator& simulator, int instrument, std::int64_t stamp_ns, CrtkMessages& messages);

/// World -> root link -> every link, of all instruments; overwrites the message, keeps its memory.
void fillTransforms(const Simulator& simulator, std::int64_t stamp_ns, tf2_msgs::TFMessage& message);

}  // namespace tissue_contact
