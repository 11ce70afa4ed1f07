// Presses a probe 3 mm into the block of a scene and prints the force that the tissue exerts on it, twice: with joint
// states as a robot's driver sends them, and by advancing the simulator itself. No roscore.
#include <ros/package.h>
#include <tissue_contact/scene/load_scene.h>
#include <tissue_contact/simulation/joint_state_player.h>
#include <tissue_contact/simulation/simulator.h>
#include <tissue_contact/version.h>

#include <cstdio>
#include <exception>
#include <string>

using namespace tissue_contact;

namespace {

constexpr int kProbe = 0;                // the scene's only instrument
constexpr double kTouching_m = -0.0100;  // joint z at which the ball just touches the block
constexpr double kDepth_m = 0.003;
constexpr int kStates = 50;  // at 100 Hz

double depthAt(int state) { return kTouching_m - kDepth_m * state / kStates; }

/// Stamps and joint names as they come; the player merges topics, refuses what is late, and says when a wrench is due.
Vector3 pressByJointStates(Simulator& simulator) {
  JointStatePlayer player(simulator);
  for (int i = 0; i <= kStates; ++i) {
    const std::int64_t stamp_ns = 1000000000LL + i * 10000000LL;
    player.push(0, {stamp_ns, {"x", "y", "z"}, {0.0, 0.0, depthAt(i)}});
    while (const auto played = player.playNext()) {
      if (played->verdict != Verdict::kAccepted) std::fprintf(stderr, "refused: %s\n", played->detail.c_str());
    }
  }
  return simulator.wrench(kProbe).force;
}

/// Positions of all independent joints, in the order of Instrument::model().joints(), and seconds.
Vector3 pressByAdvancing(Simulator& simulator) {
  simulator.reset();
  simulator.placeInstrument(kProbe, Vector3(0.0, 0.0, depthAt(0)));
  for (int i = 1; i <= kStates; ++i) simulator.advance(0.01, {Vector3(0.0, 0.0, depthAt(i))});
  return simulator.wrench(kProbe).force;
}

void print(const char* how, const Vector3& force) {
  std::printf("%s: force on the probe %.6f %.6f %.6f N\n", how, force.x(), force.y(), force.z());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string file = argc > 1 ? argv[1] : "package://tissue_contact/config/press_drag.yaml";
    SceneEnvironment environment;
    environment.package_path = ros::package::getPath;
    Simulator simulator(loadScene(file, environment.package_path), environment);
    std::printf("tissue_contact %s, %ld nodes\n", TISSUE_CONTACT_VERSION, long{simulator.positions(0).cols()});
    print("joint states", pressByJointStates(simulator));
    print("advance", pressByAdvancing(simulator));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "press: %s\n", error.what());
    return 1;
  }
}
