#include "ros/node/xml_rpc_call.h"

#include <ros/network.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <cstdint>

namespace tissue_contact {

std::optional<RosAnswer> callRos(const std::string& uri, const std::string& method,
                                 const XmlRpc::XmlRpcValue& parameters, std::chrono::duration<double> most_s,
                                 const std::atomic<bool>& stop) {
  using Clock = std::chrono::steady_clock;
  // How long `stop` and the end may go unseen. In seconds, which is what work() of libxmlrpcpp 1.15 counts in: its header
  // says milliseconds.
  constexpr double kLook_s = 0.02;
  const Clock::time_point end = Clock::now() + std::chrono::duration_cast<Clock::duration>(most_s);
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(uri, host, port)) return std::nullopt;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  if (!client.executeNonBlock(method.c_str(), parameters)) return std::nullopt;
  try {
    XmlRpc::XmlRpcValue result;
    while (!client.executeCheckDone(result)) {
      // A connection that failed is no longer among the dispatcher's.
      if (stop || Clock::now() >= end || client._disp._sources.empty()) return std::nullopt;
      client._disp.work(kLook_s);
    }
    constexpr int kParts = 3;
    if (client.isFault() || result.getType() != XmlRpc::XmlRpcValue::TypeArray || result.size() != kParts) {
      return std::nullopt;
    }
    return RosAnswer{static_cast<int>(result[0]), static_cast<std::string>(result[1]), result[2]};
  } catch (const XmlRpc::XmlRpcException&) {
    return std::nullopt;  // of another type than the protocol's
  }
}

}  // namespace tissue_contact
