/// @file
/// Room `ros`: see master_watch.h. Methods and their arguments: the ROS master API and slave API.
#include "ros/node/master_watch.h"

#include <ros/connection_manager.h>
#include <ros/console.h>
#include <ros/master.h>
#include <ros/names.h>
#include <ros/network.h>
#include <ros/service_manager.h>
#include <ros/this_node.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <cstddef>
#include <set>
#include <vector>

#include "ros/node/xml_rpc_call.h"

namespace tissue_contact {
namespace {

using XmlRpc::XmlRpcValue;

constexpr std::chrono::seconds kPeriod(1);
/// A master that takes longer is taken for stopped: a busy machine must not look like it.
constexpr std::chrono::seconds kPatience(5);

struct Topic {
  std::string name;
  std::string type;
};

XmlRpcValue toArray(const std::vector<std::string>& texts) {
  XmlRpcValue array;
  array.setSize(static_cast<int>(texts.size()));
  for (std::size_t i = 0; i < texts.size(); ++i) array[static_cast<int>(i)] = texts[i];
  return array;
}

std::vector<std::string> toTexts(XmlRpcValue array) {
  std::vector<std::string> texts;
  texts.reserve(static_cast<std::size_t>(array.size()));
  for (int i = 0; i < array.size(); ++i) texts.push_back(static_cast<std::string>(array[i]));
  return texts;
}

/// Calls of one registration; each throws NoAnswer, so that all of it is tried again a second later.
class Registrar {
 public:
  struct NoAnswer {};

  Registrar(const std::atomic<bool>& stop, const std::set<std::string>& services) : stop_(stop), services_(services) {}

  std::vector<Topic> own(const std::string& method) {
    std::vector<Topic> topics;
    XmlRpcValue pairs = ask(own_uri_, method, toArray({node_}));
    topics.reserve(static_cast<std::size_t>(pairs.size()));
    for (int i = 0; i < pairs.size(); ++i) {
      topics.push_back({static_cast<std::string>(pairs[i][0]), static_cast<std::string>(pairs[i][1])});
    }
    return topics;
  }

  void publisher(const Topic& topic) {
    ask(ros::master::getURI(), "registerPublisher", toArray({node_, topic.name, topic.type, own_uri_}));
  }

  /// roscpp drops connections to publishers that are not in the list it is given: those that live, of nodes that have not
  /// registered again themselves, are kept in it.
  void subscriber(const Topic& topic) {
    const XmlRpcValue registered =
        ask(ros::master::getURI(), "registerSubscriber", toArray({node_, topic.name, topic.type, own_uri_}));
    const std::set<std::string> connected = connectedPublishers(topic.name);
    std::set<std::string> publishers = connected;
    for (const std::string& uri : toTexts(registered)) publishers.insert(uri);
    if (publishers.size() == connected.size()) return;
    XmlRpcValue update = toArray({"/master", topic.name});
    update[2] = toArray({publishers.begin(), publishers.end()});
    ask(own_uri_, "publisherUpdate", update);
  }

  void services() {
    for (const std::string& name : services_) {
      if (!ros::ServiceManager::instance()->lookupServicePublication(name)) continue;
      const std::string service_uri = "rosrpc://" + ros::network::getHost() + ":" +
                                      std::to_string(ros::ConnectionManager::instance()->getTCPPort());
      ask(ros::master::getURI(), "registerService", toArray({node_, name, service_uri, own_uri_}));
    }
  }

 private:
  XmlRpcValue ask(const std::string& uri, const std::string& method, const XmlRpcValue& parameters) {
    const std::optional<RosAnswer> answer = callRos(uri, method, parameters, kPatience, stop_);
    if (!answer || answer->code != 1) throw NoAnswer();
    return answer->value;
  }

  std::set<std::string> connectedPublishers(const std::string& topic) {
    enum { kPeer = 1, kDirection = 2, kTopic = 4 };  // of an entry of getBusInfo
    std::set<std::string> uris;
    XmlRpcValue links = ask(own_uri_, "getBusInfo", toArray({node_}));
    for (int i = 0; i < links.size(); ++i) {
      if (static_cast<std::string>(links[i][kDirection]) != "i") continue;
      if (static_cast<std::string>(links[i][kTopic]) == topic) uris.insert(static_cast<std::string>(links[i][kPeer]));
    }
    return uris;
  }

  const std::atomic<bool>& stop_;
  const std::set<std::string>& services_;
  const std::string node_ = ros::this_node::getName();
  const std::string own_uri_ = ros::XMLRPCManager::instance()->getServerURI();
};

}  // namespace

void MasterWatch::start(const std::vector<std::string>& services) {
  services_ = {services.begin(), services.end()};
  for (const char* name : {"/get_loggers", "/set_logger_level"}) services_.insert(ros::this_node::getName() + name);
  thread_ = std::thread([this] { run(); });
}

void MasterWatch::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MasterWatch::run() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!changed_.wait_for(lock, kPeriod, [this] { return stop_.load(); })) {
    lock.unlock();
    look();
    lock.lock();
  }
}

void MasterWatch::look() {
  const std::string& node = ros::this_node::getName();
  const std::optional<RosAnswer> answer =
      callRos(ros::master::getURI(), "lookupNode", toArray({node, node}), kPatience, stop_);
  if (stop_) return;
  if (answer && answer->code != 1) noteKnown(false);
  noteAnswer(answer.has_value());
  if (answer && !known_ && registerAgain()) noteKnown(true);
}

void MasterWatch::noteKnown(bool known) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (known) ++registrations_;
  known_ = known;
}

void MasterWatch::noteAnswer(bool came) {
  std::unique_lock<std::mutex> lock(mutex_);
  if (came != lost_.has_value()) return;
  if (came) {
    lost_.reset();
  } else {
    lost_ = Clock::now();
    ++losses_;
  }
  lock.unlock();  // a log that blocks must not hold up the diagnostics
  if (came) {
    ROS_INFO_STREAM("the ROS master at " << ros::master::getURI() << " answers again");
  } else {
    ROS_WARN_STREAM("the ROS master at " << ros::master::getURI()
                                         << " does not answer: connections live on, but new ones cannot be made");
  }
}

bool MasterWatch::registerAgain() {
  try {
    Registrar registrar(stop_, services_);
    const std::vector<Topic> published = registrar.own("getPublications");
    const std::vector<Topic> subscribed = registrar.own("getSubscriptions");
    for (const Topic& topic : published) registrar.publisher(topic);
    for (const Topic& topic : subscribed) registrar.subscriber(topic);
    registrar.services();
    ROS_WARN_STREAM("the ROS master did not know this node any more (was it restarted?): registered again, "
                    << published.size() << " topics published and " << subscribed.size() << " subscribed to");
  } catch (const Registrar::NoAnswer&) {
    return false;
  } catch (const XmlRpc::XmlRpcException&) {
    return false;  // an answer of another type than the protocol's
  }
  return true;
}

void MasterWatch::fill(diagnostic_updater::DiagnosticStatusWrapper& status) const {
  using Level = diagnostic_msgs::DiagnosticStatus;
  const std::lock_guard<std::mutex> lock(mutex_);
  const double lost_s = lost_ ? std::chrono::duration<double>(Clock::now() - *lost_).count() : 0.0;
  if (lost_) {
    status.summaryf(Level::WARN, "does not answer, since %.0f s", lost_s);
  } else if (!known_) {
    status.summary(Level::WARN, "does not know this node; registering again");
  } else {
    status.summary(Level::OK, "knows this node");
  }
  status.add("uri", ros::master::getURI());
  status.add("lost_s", lost_s);
  status.add("times lost", losses_);
  status.add("times registered again", registrations_);
}

}  // namespace tissue_contact
