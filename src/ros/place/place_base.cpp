#include <Eigen/Geometry>
#include <cmath>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "ros/place/place.h"
#include "ros/place/placed_scene.h"
#include "ros/place/pose_bag.h"
#include "ros/place/recorded_motion.h"
#include "ros/place/registration.h"
#include "ros/place/roll_pitch_yaw.h"

namespace tissue_contact {
namespace {

std::string listOfThree(const Vector3& v) {
  std::ostringstream text;
  text.precision(9);
  text << '[' << v.x() + 0.0 << ", " << v.y() + 0.0 << ", " << v.z() + 0.0 << ']';
  return text.str();
}

const Instrument& chosenInstrument(const std::vector<Instrument>& instruments, const std::string& name) {
  for (const Instrument& instrument : instruments) {
    if (name.empty() ? !instrument.isObstacle() : instrument.name() == name) return instrument;
  }
  throw std::invalid_argument(name.empty() ? "the scene has no instrument that moves"
                                           : "--instrument '" + name + "': the scene has no instrument of that name");
}

/// With the joint positions of every moment.
std::vector<StampedPose> tipsInBase(const PlaceOptions& options, const PlacedScene& placed) {
  std::vector<StampedPose> tips;
  const auto take = [&](std::int64_t stamp_ns, const Simulator& simulator) {
    const Instrument& instrument = chosenInstrument(simulator.instruments(), options.instrument);
    const auto index = static_cast<int>(&instrument - simulator.instruments().data());
    const std::vector<Pose>& X_WL = simulator.linkPoses(index);
    tips.push_back({stamp_ns, X_WL.front().inverse() * X_WL[static_cast<std::size_t>(instrument.tipLink())]});
  };
  playMotion(placed.scene, placed.environment, options.bag_file, take);
  return tips;
}

void print(const PlaceOptions& options, const std::string& frame, std::size_t count, const Registration& found) {
  const Vector3 spread_mm = 1e3 * found.spread_m;
  constexpr double kDegrees = 180.0 / M_PI;
  std::cout << "# by " << count << " poses of " << options.measured << " in frame '" << frame << "'\n"
            << "base_pose:\n"
            << "  position_m: " << listOfThree(found.X_WB.translation()) << "\n"
            << "  rpy_rad: " << listOfThree(rollPitchYaw(found.X_WB.linear())) << "\n";
  std::cout.precision(3);
  std::cout << "# residual " << 1e3 * found.rms_m << " mm RMS, " << 1e3 * found.largest_m
            << " mm at most; the tip goes " << spread_mm[0] << " x " << spread_mm[1] << " x " << spread_mm[2]
            << " mm (RMS)\n"
            << "# measured tip frame turned against tip_link by " << kDegrees * found.tip_turn_rad << " deg, "
            << kDegrees * found.turn_rms_rad << " deg RMS around that\n";
}

}  // namespace

void placeBase(const PlaceOptions& options) {
  const PlacedScene placed(options);
  const MeasuredPoses measured = readPoses(options.bag_file, options.measured);
  if (measured.unusable > 0) {
    std::cerr << "tissue_contact_place: warning: " << measured.unusable << " of "
              << measured.unusable + measured.poses.size() << " poses on " << options.measured
              << " are left out, since a number is not finite or the quaternion is zero\n";
  }
  const std::vector<PosePair> pairs = pairPoses(tipsInBase(options, placed), measured.poses);
  if (pairs.empty()) {
    throw std::runtime_error("no pose of " + options.measured +
                             " was measured within 0.1 s of a joint state, by their stamps");
  }
  const Registration found = registerBase(pairs);
  requireTrustworthy(found);
  print(options, measured.frame, pairs.size(), found);
  constexpr double kKinematics_m = 1e-3;
  if (found.rms_m > kKinematics_m) {
    std::cerr << "tissue_contact_place: warning: a residual of " << 1e3 * found.rms_m
              << " mm RMS; where a robot computes these poses from its joints, next to nothing is left: look at "
                 "joint_names, tip_link "
                 "and the tool's lengths in the URDF, and at what the topic means\n";
  }
  if (measured.frame == placed.scene.world_frame) return;
  std::cerr << "tissue_contact_place: warning: the poses are in frame '" << measured.frame
            << "', and so is this base, but the scene's world_frame is '" << placed.scene.world_frame << "'\n";
}

}  // namespace tissue_contact
