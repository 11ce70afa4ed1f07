/// @file
/// A call to a master that takes the connection and never answers, as one that is stopped does: it ends in time.

#include "ros/node/xml_rpc_call.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>
#include <thread>

namespace tissue_contact {
namespace xml_rpc_call_test {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

/// Far above what such a call may take on a busy machine, far below the 20 s between two looks when they were wrong.
constexpr double kSoon_s = 10.0;

/// Listens, so that the kernel takes connections, and reads nothing.
class SilentServer {
 public:
  SilentServer() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    if (bind(socket_, any, size) != 0 || listen(socket_, 4) != 0 || getsockname(socket_, any, &size) != 0) {
      throw std::runtime_error("no socket to listen on");
    }
    uri_ = "http://127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "/";
  }
  ~SilentServer() { close(socket_); }
  SilentServer(const SilentServer&) = delete;
  SilentServer& operator=(const SilentServer&) = delete;

  const std::string& uri() const { return uri_; }

 private:
  int socket_ = socket(AF_INET, SOCK_STREAM, 0);
  std::string uri_;
};

class XmlRpcCallTest : public testing::Test {
 protected:
  XmlRpcCallTest() { parameters_[0] = "/test"; }

  /// Expects no answer. @return how long that took, s.
  double call(double most_s) {
    const Clock::time_point start = Clock::now();
    EXPECT_FALSE(callRos(server_.uri(), "getPid", parameters_, Seconds(most_s), stop_));
    return Seconds(Clock::now() - start).count();
  }

  SilentServer server_;
  XmlRpc::XmlRpcValue parameters_;
  std::atomic<bool> stop_{false};
};

TEST_F(XmlRpcCallTest, SilentServerIsGivenUpWhenPatienceEnds) {
  const double took_s = call(0.3);
  EXPECT_GE(took_s, 0.3);
  EXPECT_LT(took_s, kSoon_s);
}

TEST_F(XmlRpcCallTest, StopEndsACallWhoseEndIsFar) {
  std::thread stopper([this] {
    std::this_thread::sleep_for(Seconds(0.1));
    stop_ = true;
  });
  EXPECT_LT(call(3600.0), kSoon_s);
  stopper.join();
}

}  // namespace xml_rpc_call_test
}  // namespace tissue_contact
