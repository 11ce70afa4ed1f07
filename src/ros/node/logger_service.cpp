#include "ros/node/logger_service.h"

#include <ros/console.h>
#include <ros/console_impl.h>
#include <ros/service_manager.h>
#include <roscpp/GetLoggers.h>

#include <array>
#include <cstddef>

namespace tissue_contact {
namespace {

/// By ros::console::Level.
constexpr std::array<const char*, 5> kLevelNames = {"debug", "info", "warn", "error", "fatal"};

const char* levelOf(const std::string& logger) {
  void* const handle = ros::console::impl::getHandle(logger);
  for (std::size_t level = 0; level < kLevelNames.size(); ++level) {
    if (ros::console::impl::isEnabledFor(handle, static_cast<ros::console::Level>(level))) return kLevelNames[level];
  }
  return kLevelNames.back();
}

bool listLoggers(roscpp::GetLoggers::Request& /*request*/, roscpp::GetLoggers::Response& response) {
  for (const char* name : {ROSCONSOLE_ROOT_LOGGER_NAME, "ros.roscpp", ROSCONSOLE_DEFAULT_NAME}) {
    roscpp::Logger& logger = response.loggers.emplace_back();
    logger.name = name;
    logger.level = levelOf(name);
  }
  return true;
}

}  // namespace

ros::ServiceServer advertiseLoggers(ros::NodeHandle private_node) {
  ros::ServiceManager::instance()->unadvertiseService(private_node.resolveName("get_loggers"));
  return private_node.advertiseService("get_loggers", listLoggers);
}

}  // namespace tissue_contact
