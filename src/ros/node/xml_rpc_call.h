/// @file
/// Room `ros`, private: one call by the protocol that ROS masters and nodes speak, bounded in time (ros::master::execute waits for
/// ever for a master that is stopped).
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <atomic>
#include <chrono>
#include <optional>
#include <string>

namespace tissue_contact {

/// What ROS masters and nodes answer.
struct RosAnswer {
  int code = 0;  ///< 1: done; 0: failed; -1: the question was wrong, e.g. about a node that is not known
  std::string message;
  XmlRpc::XmlRpcValue value;
};

/// @param uri "http://host:port/".
/// @param parameters an array.
/// @param most_s gives up after so long, or soon after `stop`.
/// @return nothing if no answer came in time, or none that this protocol allows.
std::optional<RosAnswer> callRos(const std::string& uri, const std::string& method,
                                 const XmlRpc::XmlRpcValue& parameters, std::chrono::duration<double> most_s,
                                 const std::atomic<bool>& stop);

}  // namespace tissue_contact
