// PressController as a node: answers every wrench with the next joint state. Its stamps count periods and come from no clock, so the
// force at each of them is the same on every machine, however slow.
//   in   wrench (geometry_msgs/WrenchStamped), start (std_msgs/Empty)    out   joint_states (sensor_msgs/JointState)
//   ~target_force_n   default 0.5
#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <std_msgs/Empty.h>

#include <cmath>

#include "press_controller.h"

namespace {

constexpr int kPeriods = 150;
const ros::Duration kPeriod(0.01);

class Node {
 public:
  explicit Node(double target_n) : controller_(target_n) {
    const ros::TransportHints at_once = ros::TransportHints().tcpNoDelay();
    publisher_ = node_.advertise<sensor_msgs::JointState>("joint_states", 10);
    wrench_ = node_.subscribe("wrench", 10, &Node::answer, this, at_once);
    start_ = node_.subscribe("start", 1, &Node::start, this, at_once);
  }

 private:
  void start(const std_msgs::Empty& /*message*/) {
    if (periods_ > 0) return;
    ros::WallRate poll(100);
    while (ros::ok() && (publisher_.getNumSubscribers() == 0 || wrench_.getNumPublishers() == 0)) poll.sleep();
    publish(0.0);
  }

  void answer(const geometry_msgs::WrenchStamped& felt) {
    if (felt.header.stamp != stamp_ || periods_ >= kPeriods) return;
    const geometry_msgs::Vector3& force = felt.wrench.force;
    publish(controller_.next(std::sqrt(force.x * force.x + force.y * force.y + force.z * force.z)));
  }

  void publish(double z_m) {
    stamp_ = ros::Time(1) + kPeriod * static_cast<double>(periods_++);
    sensor_msgs::JointState state;
    state.header.stamp = stamp_;
    state.name = {"x", "y", "z"};
    state.position = {0.0, 0.0, z_m};
    publisher_.publish(state);
  }

  ros::NodeHandle node_;
  PressController controller_;
  ros::Publisher publisher_;
  ros::Subscriber wrench_;
  ros::Subscriber start_;
  ros::Time stamp_;
  int periods_ = 0;  // published so far
};

}  // namespace

int main(int argc, char** argv) {
  ros::init(argc, argv, "press_controller");
  Node node(ros::NodeHandle("~").param("target_force_n", 0.5));
  ros::spin();
  return 0;
}
