/// @file
/// Room `ros`, private: the node as a nodelet: drivers in the same manager hand joint states over without a connection.
#include <nodelet/nodelet.h>

#include <exception>
#include <memory>
#include <pluginlib/class_list_macros.hpp>
#include <vector>

#include "ros/node/node.h"
#include "ros/node/private_parameters.h"

namespace tissue_contact {

/// Topics, services and parameters are those of the node, below the nodelet's name.
class TissueContactNodelet : public nodelet::Nodelet {
 public:
  /// The manager says that it could not be loaded when this throws.
  void onInit() override {
    std::vector<const char*> arguments = {""};
    for (const std::string& argument : getMyArgv()) arguments.push_back(argument.c_str());
    try {
      node_ = std::make_unique<Node>(getMTNodeHandle(), getMTPrivateNodeHandle(), getName(),
                                     privateArguments(static_cast<int>(arguments.size()), arguments.data()));
      node_->start();
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());
      throw;
    }
  }

 private:
  std::unique_ptr<Node> node_;
};

}  // namespace tissue_contact

PLUGINLIB_EXPORT_CLASS(tissue_contact::TissueContactNodelet, nodelet::Nodelet)
