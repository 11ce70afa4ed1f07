/// @file
/// For driver_nodelet.py: a nodelet manager with a driver in it, beside the node as a nodelet. Reads "seconds nanoseconds x y z" per line from
/// standard input, which the driver publishes as a joint state, and says at the end how many it serialized: for a subscriber within the
/// manager none is.
#include <nodelet/loader.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <ros/serialization.h>
#include <sensor_msgs/JointState.h>

#include <atomic>
#include <boost/make_shared.hpp>
#include <iostream>
#include <pluginlib/class_loader.hpp>
#include <string>
#include <vector>

namespace {

std::atomic<long> g_serialized{0};

}  // namespace

namespace ros {
namespace serialization {

/// roscpp's own, counted.
template <>
inline SerializedMessage serializeMessage(const sensor_msgs::JointState& message) {
  ++g_serialized;
  SerializedMessage serialized;
  const std::uint32_t length = serializationLength(message);
  serialized.num_bytes = length + 4;
  serialized.buf.reset(new std::uint8_t[serialized.num_bytes]);
  OStream stream(serialized.buf.get(), static_cast<std::uint32_t>(serialized.num_bytes));
  serialize(stream, length);
  serialized.message_start = stream.getData();
  serialize(stream, message);
  return serialized;
}

}  // namespace serialization
}  // namespace ros

namespace {

class DriverNodelet : public nodelet::Nodelet {
 public:
  void onInit() override {
    publisher_ = getNodeHandle().advertise<sensor_msgs::JointState>("/probe/joint_states", 1000);
  }

  void publish(const ros::Time& stamp, const std::vector<double>& positions) const {
    const auto message = boost::make_shared<sensor_msgs::JointState>();
    message->header.stamp = stamp;
    message->name = {"x", "y", "z"};
    message->position = positions;
    publisher_.publish(message);
  }

 private:
  ros::Publisher publisher_;
};

int run(const std::string& scene) {
  pluginlib::ClassLoader<nodelet::Nodelet> plugins("nodelet", "nodelet::Nodelet");
  DriverNodelet* driver = nullptr;  // the manager's, which it must not outlive
  const boost::function<boost::shared_ptr<nodelet::Nodelet>(const std::string&)> make = [&](const std::string& type) {
    if (type == "driver") return boost::shared_ptr<nodelet::Nodelet>(driver = new DriverNodelet);
    return boost::shared_ptr<nodelet::Nodelet>(plugins.createInstance(type));
  };
  nodelet::Loader manager(make);
  if (!manager.load("/driver", "driver", {}, {})) return 1;
  if (!manager.load("/tissue_contact", "tissue_contact/TissueContact", {}, {"_scene:=" + scene})) return 1;
  long published = 0;
  std::uint32_t seconds = 0;
  std::uint32_t nanoseconds = 0;
  std::vector<double> positions(3);
  while (std::cin >> seconds >> nanoseconds >> positions[0] >> positions[1] >> positions[2]) {
    driver->publish(ros::Time(seconds, nanoseconds), positions);
    ++published;
  }
  std::cout << g_serialized << " of " << published << " serialized" << std::endl;
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "manager");
  if (argc != 2) {
    std::cerr << "usage: driver_nodelet SCENE\n";
    return 2;
  }
  ros::AsyncSpinner spinner(1);  // of what nodelets do not spin
  spinner.start();
  return run(argv[1]);
}
