/// @file
/// For changing_mesh.py: a block whose mesh changes on demand, published as the node publishes it. Reads a revision per line from standard
/// input and shows a mesh of that revision at rest, with other nodes and another surface than the one before.
#include <ros/init.h>
#include <ros/spinner.h>

#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "ros/publish/snapshot_publisher.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace {

std::unique_ptr<SceneSnapshot> snapshotOf(int revision, std::int64_t stamp_ns, SnapshotPublisher& publisher) {
  const std::string cells = "[4, 4, " + std::to_string(2 + revision % 4) + "]";
  const Simulator simulator = makeSimulator(blockScene("[0.06, 0.06, 0.02]", cells));
  std::unique_ptr<SceneSnapshot> snapshot = publisher.queue().buffer();
  snapshot->stamp_ns = stamp_ns;
  snapshot->topologies = true;
  snapshot->mesh = publisher.meshIsWanted();
  snapshot->markers = publisher.markersAreWanted();
  snapshot->revisions = {std::make_shared<MeshRevision>(simulator.tissues()[0], revision)};
  snapshot->positions = {simulator.positions(0)};
  return snapshot;
}

void show() {
  constexpr std::int64_t kSecond = 1000000000;
  const Simulator simulator = makeSimulator(blockScene());
  SnapshotPublisher publisher(simulator, PublishOptions(), MarkerStyle());
  ros::AsyncSpinner spinner(1);
  spinner.start();
  publisher.start(ros::NodeHandle("~"), [] {});
  std::int64_t stamp_ns = 0;
  for (int revision = 0; std::cin >> revision;) {
    publisher.queue().put(snapshotOf(revision, stamp_ns += kSecond, publisher));
  }
}

}  // namespace
}  // namespace tissue_contact

int main(int argc, char** argv) {
  ros::init(argc, argv, "tissue_contact");
  try {
    tissue_contact::show();
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
