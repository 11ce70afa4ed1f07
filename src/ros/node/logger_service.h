/// @file
/// Room `ros`, private: the service ~get_loggers, without the fault of the one that roscpp brings.
#pragma once

#include <ros/node_handle.h>
#include <ros/service_server.h>

namespace tissue_contact {

/// Replaces roscpp's ~get_loggers by one that answers with the loggers of roscpp and of this node and their levels.
///
/// rosconsole of Debian 12 (1.14) takes ownership of log4cxx's hierarchy of loggers to list it, and frees it at the end of
/// the first call; the second ends the process. So do all nodes there, rosout included; rqt_logger_level makes that call.
/// @param private_node handle of "~", whose node has started.
ros::ServiceServer advertiseLoggers(ros::NodeHandle private_node);

}  // namespace tissue_contact
