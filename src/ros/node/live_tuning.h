/// @file
/// Room `ros`, private: numbers that people change while the node runs, by the protocol of dynamic_reconfigure. Requests in; what the
/// stepping thread is to go on with, and an echo for recordings, out.
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_server.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "ros/publish/publish_options.h"
#include "tissue_contact/scene/tuning.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// Everything that may change, as it is to be.
struct LiveNumbers {
  Scene scene;  ///< with step.max_lag_s
  PublishOptions publish;
};

/// Those of tunables(), the lag bound, and the rates of the topics that were advertised.
std::vector<Tunable> liveTunables(const LiveNumbers& numbers, const PublishOptions& advertised);

/// @throws std::invalid_argument as tuned() of a scene.
LiveNumbers tuned(const LiveNumbers& numbers, const PublishOptions& advertised,
                  const std::vector<TunedNumber>& changes);

/// What a request asks for. @throws std::invalid_argument naming a parameter that is no number.
std::vector<TunedNumber> requestedNumbers(const dynamic_reconfigure::Config& request);

/// Topics, below the node's private namespace:
///   set_parameters          service: a request is taken as a whole, or refused with a reason in the log; answers with what holds then
///   parameter_descriptions  latched: names, units, ranges, values at the start
///   parameter_updates       latched: what holds
///   changes                 latched: see Changes.msg; nothing until something of the scene was changed
/// Requests are judged where they are received, from numbers alone, so that nobody waits for a step.
class LiveTuning {
 public:
  LiveTuning(const ros::NodeHandle& private_node, LiveNumbers at_start);

  /// Advertises.
  /// @param on_change called, from roscpp's thread, when take() has something.
  void start(std::function<void()> on_change);

  std::string serviceName() const { return service_.getService(); }  ///< from / on

  /// What has changed since the last call; nothing: nothing has. For the stepping thread, before each moment: else one look at an atomic.
  std::optional<LiveNumbers> take();

  /// No request is judged from now on.
  void stop() { service_.shutdown(); }

  /// Echoes what was taken, if it changes what is simulated.
  /// @param stamp_ns of the moment played last, 0: none yet. @param loop see Changes.msg.
  void echo(const LiveNumbers& taken, std::int64_t stamp_ns, std::int64_t loop);
  /// Says what was taken last once more, when a loop begins or another state is loaded: so a recording knows the loop that it begins in.
  void tell(std::int64_t stamp_ns, std::int64_t loop);

 private:
  bool setParameters(const dynamic_reconfigure::Reconfigure::Request& request,
                     dynamic_reconfigure::Reconfigure::Response& response);
  std::vector<Tunable> inForce(const LiveNumbers& numbers) const;
  void change(const std::vector<TunedNumber>& requested);

  ros::NodeHandle node_;
  const LiveNumbers at_start_;
  Scene echoed_;  ///< the stepping thread's alone
  std::function<void()> on_change_;
  std::mutex mutex_;
  LiveNumbers numbers_;  ///< guarded by mutex_
  std::atomic<bool> changed_{false};
  ros::ServiceServer service_;
  ros::Publisher descriptions_;
  ros::Publisher updates_;
  ros::Publisher changes_;
};

}  // namespace tissue_contact
