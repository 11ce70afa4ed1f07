/// @file
/// Executable tissue_contact_node: see ros/node.h.
#include <iostream>

#include "tissue_contact/ros/node.h"
#include "tissue_contact/ros/node_usage.h"

int main(int argc, char** argv) {
  // Before anything of ROS, which would wait for a master.
  if (tissue_contact::asksForHelp(argc, argv)) {
    std::cout << tissue_contact::nodeUsage();
    return 0;
  }
  return tissue_contact::runNode(argc, argv);
}
