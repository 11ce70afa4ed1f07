/// @file
/// Room `ros`: see node_usage.h.
#include "tissue_contact/ros/node_usage.h"

#include <algorithm>
#include <string_view>

namespace tissue_contact {

bool asksForHelp(int argc, const char* const* argv) {
  return std::any_of(argv + 1, argv + argc,
                     [](const std::string_view argument) { return argument == "--help" || argument == "-h"; });
}

std::string nodeUsage() {
  return R"(usage: rosrun tissue_contact tissue_contact_node _scene:=SCENE.yaml [_parameter:=value] [from:=to] [__name:=name]

Contact forces between instruments and soft tissue: joint states in, wrenches and deformed tissue out. Needs a ROS master
(roscore, or roslaunch). Without one: tissue_contact_replay.

private parameters
  ~scene               the scene (doc/scene.md): a path, or package://PACKAGE/PATH
  ~robot_description   text of a URDF, for scenes that take it from this parameter (or from another that they name);
                       looked for here, then in every namespace up to /
  ~tf_timeout_s        how long to wait for tf frames that the scene names, s; default 10
  ~markers/...         force_arrow_m_per_n, displacement_full_scale_m: sizes in RViz
  any other argument, also _parameter:=value, is refused; of what is set on the parameter server, misspelt names only

subscribed topics
  as the scene names them  sensor_msgs/JointState

published topics
  ~INSTRUMENT/wrench   geometry_msgs/WrenchStamped of the tissue on the instrument, one per state of the arm stepped to
  ~TISSUE/topology     tissue_contact/TissueTopology, latched
  ~TISSUE/mesh         tissue_contact/TissueMesh
  ~contacts            tissue_contact/ContactArray
  ~status              tissue_contact/Status
  ~markers             visualization_msgs/MarkerArray
  /diagnostics         diagnostic_msgs/DiagnosticArray

example
  rosrun tissue_contact tissue_contact_node _scene:=package://tissue_contact/config/press_drag.yaml
)";
}

}  // namespace tissue_contact
