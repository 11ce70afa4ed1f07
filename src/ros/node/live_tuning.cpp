#include "ros/node/live_tuning.h"

#include <dynamic_reconfigure/ConfigDescription.h>
#include <ros/console.h>

#include <algorithm>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "ros/conversions.h"
#include "scene/scene_ranges.h"
#include "tissue_contact/Changes.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::ConfigDescription;

struct OwnNumber {
  Tunable about;
  double* number;
};

/// The node's own. A topic that was not advertised has no rate to change.
std::vector<OwnNumber> ownNumbers(LiveNumbers& numbers, const PublishOptions& advertised) {
  double& lag_s = numbers.scene.step.max_lag_s;
  std::vector<OwnNumber> own = {
      {{"step/max_lag_s", "how far wrenches may lag beside a robot driver, s", lag_s, kMaxLagRange}, &lag_s}};
  const auto add = [&](const std::string& topic, double advertised_hz, double& rate_hz) {
    if (!(advertised_hz > 0.0)) return;
    own.push_back({{"publish/" + topic + "_rate_hz", "rate of " + topic + " in message time, Hz; 0: none", rate_hz,
                    kPublishRateRange},
                   &rate_hz});
  };
  add("mesh", advertised.mesh_rate_hz, numbers.publish.mesh_rate_hz);
  add("contacts", advertised.contacts_rate_hz, numbers.publish.contacts_rate_hz);
  add("status", advertised.status_rate_hz, numbers.publish.status_rate_hz);
  add("markers", advertised.markers_rate_hz, numbers.publish.markers_rate_hz);
  return own;
}

/// @param value of each.
template <typename Value>
Config configOf(const std::vector<Tunable>& tunables, const Value& value) {
  Config config;
  for (const Tunable& one : tunables) {
    if (one.is_whole) {
      config.ints.emplace_back();
      config.ints.back().name = one.key;
      config.ints.back().value = static_cast<std::int32_t>(value(one));
    } else {
      config.doubles.emplace_back();
      config.doubles.back().name = one.key;
      config.doubles.back().value = value(one);
    }
  }
  config.groups.emplace_back();  // without it clients of Python find no parameters
  config.groups.back().name = "Default";
  config.groups.back().state = 1;
  return config;
}

Config configOf(const std::vector<Tunable>& tunables) {
  return configOf(tunables, [](const Tunable& one) { return one.value; });
}

ConfigDescription descriptionOf(const std::vector<Tunable>& tunables) {
  ConfigDescription description;
  description.groups.emplace_back();
  description.groups.back().name = "Default";
  for (const Tunable& one : tunables) {
    dynamic_reconfigure::ParamDescription& parameter = description.groups.back().parameters.emplace_back();
    parameter.name = one.key;
    parameter.type = one.is_whole ? "int" : "double";
    parameter.description = one.text;
  }
  description.dflt = configOf(tunables);
  description.min = configOf(tunables, [](const Tunable& one) { return one.range.low; });
  description.max = configOf(tunables, [](const Tunable& one) { return one.range.high; });
  return description;
}

}  // namespace

std::vector<Tunable> liveTunables(const LiveNumbers& numbers, const PublishOptions& advertised) {
  std::vector<Tunable> all = tunables(numbers.scene);
  LiveNumbers copy = numbers;
  for (const OwnNumber& own : ownNumbers(copy, advertised)) all.push_back(own.about);
  return all;
}

LiveNumbers tuned(const LiveNumbers& numbers, const PublishOptions& advertised,
                  const std::vector<TunedNumber>& changes) {
  LiveNumbers changed = numbers;
  const std::vector<OwnNumber> own = ownNumbers(changed, advertised);
  std::vector<TunedNumber> of_scene;
  for (const TunedNumber& change : changes) {
    const auto found =
        std::find_if(own.begin(), own.end(), [&](const OwnNumber& one) { return one.about.key == change.key; });
    if (found == own.end()) {
      of_scene.push_back(change);
    } else {
      *found->number = found->about.range.require(change.key, change.value);
    }
  }
  changed.scene = tuned(changed.scene, of_scene);
  return changed;
}

std::vector<TunedNumber> requestedNumbers(const Config& request) {
  const auto refuse = [](const std::string& name, const std::string& kind) {
    constexpr std::size_t kMaxName = 256;
    throw std::invalid_argument("parameter '" + printable(name, kMaxName) + "' is a " + kind + "; all are numbers");
  };
  for (const auto& one : request.bools) refuse(one.name, "bool");
  for (const auto& one : request.strs) refuse(one.name, "text");
  std::vector<TunedNumber> numbers;
  for (const auto& one : request.ints) numbers.push_back({one.name, static_cast<double>(one.value)});
  for (const auto& one : request.doubles) numbers.push_back({one.name, one.value});
  return numbers;
}

LiveTuning::LiveTuning(const ros::NodeHandle& private_node, LiveNumbers at_start)
    : node_(private_node), at_start_(std::move(at_start)), echoed_(at_start_.scene), numbers_(at_start_) {}

std::vector<Tunable> LiveTuning::inForce(const LiveNumbers& numbers) const {
  return liveTunables(numbers, at_start_.publish);
}

void LiveTuning::start(std::function<void()> on_change) {
  on_change_ = std::move(on_change);
  descriptions_ = node_.advertise<ConfigDescription>("parameter_descriptions", 1, true);
  updates_ = node_.advertise<Config>("parameter_updates", 1, true);
  changes_ = node_.advertise<Changes>("changes", 1000, true);
  const std::vector<Tunable> all = inForce(at_start_);
  descriptions_.publish(descriptionOf(all));
  updates_.publish(configOf(all));
  service_ =
      node_.advertiseService<dynamic_reconfigure::Reconfigure::Request, dynamic_reconfigure::Reconfigure::Response>(
          "set_parameters", [this](auto& request, auto& response) { return setParameters(request, response); });
}

bool LiveTuning::setParameters(const dynamic_reconfigure::Reconfigure::Request& request,
                               dynamic_reconfigure::Reconfigure::Response& response) {
  try {
    change(requestedNumbers(request.config));
  } catch (const std::exception& error) {
    ROS_ERROR_STREAM("set_parameters: nothing was changed: " << error.what());
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  response.config = configOf(inForce(numbers_));
  return true;
}

void LiveTuning::change(const std::vector<TunedNumber>& requested) {
  const std::unique_lock<std::mutex> lock(mutex_);
  const std::vector<Tunable> before = inForce(numbers_);
  numbers_ = tuned(numbers_, at_start_.publish, requested);
  const std::vector<Tunable> now = inForce(numbers_);
  bool any = false;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i].value == before[i].value) continue;
    any = true;
    ROS_INFO_STREAM("set_parameters: " << now[i].key << " is " << now[i].value << " " << now[i].range.unit
                                       << " from the next step on, no longer " << before[i].value);
  }
  if (!any) return;
  updates_.publish(configOf(now));
  changed_ = true;
  on_change_();
}

std::optional<LiveNumbers> LiveTuning::take() {
  if (!changed_.load(std::memory_order_acquire)) return std::nullopt;
  const std::lock_guard<std::mutex> lock(mutex_);
  changed_ = false;
  return numbers_;
}

void LiveTuning::echo(const LiveNumbers& taken, std::int64_t stamp_ns, std::int64_t loop) {
  if (differences(echoed_, taken.scene).empty()) return;
  echoed_ = taken.scene;
  tell(stamp_ns, loop);
}

void LiveTuning::tell(std::int64_t stamp_ns, std::int64_t loop) {
  Changes message;
  message.header.stamp = toTime(stamp_ns);
  message.loop = static_cast<std::uint32_t>(loop);
  for (const TunedNumber& number : differences(at_start_.scene, echoed_)) {
    message.keys.push_back(number.key);
    message.values.push_back(number.value);
  }
  changes_.publish(message);
}

}  // namespace tissue_contact
