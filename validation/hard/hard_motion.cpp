/// Hard cases of motion: fast entry, starting inside the tissue, teleporting, and joint states with gaps, duplicates
/// and time that runs backwards.
#include <limits>

#include "tissue_contact/simulation/joint_state_player.h"
#include "validation/hard/hard_cases.h"
#include "validation/hard/hard_scene.h"

namespace tissue_contact {
namespace {

double farthestFromRest(const Simulator& simulator) {
  return (simulator.positions(0) - simulator.tissues()[0].restPositions()).colwise().norm().maxCoeff();
}

/// Force into the probe after it has stood `depth_m` deep, reached slowly, for a second.
double slowPress(const PadScene& scene, double depth_m) {
  Simulator simulator = makePad(scene);
  for (int k = 1; k <= 2000; ++k) {
    simulator.advance(0.001, {Vector3(0.0, 0.0, -depth_m * std::min(1.0, k / 1000.0))});
  }
  return simulator.wrench(0).force.z();
}

/// Down at 0.5 m/s, rest, up at 0.5 m/s, again and again.
void enterFast(const std::string& name, const PadScene& scene, double depth_m, Report& report, double from, double to) {
  Simulator simulator = makePad(scene);
  HardRun run(simulator, 41);
  constexpr double kSpeed = 0.5;
  constexpr double kAbove = 0.01;
  const double travel = (kAbove + depth_m) / kSpeed;
  const double period = 2.0 * travel + 0.1;
  int above_tool = 0;
  const int steps = static_cast<int>(std::lround(2000.0 * 0.001 / scene.step_s));
  for (int k = 1; run.steps() < 2000; ++k) {
    const double t = std::fmod(k * scene.step_s, period);
    const double down = std::min(1.0, t / travel) - std::max(0.0, std::min(1.0, (t - travel - 0.05) / travel));
    simulator.advance(scene.step_s, {Vector3(0.0, 0.0, kAbove - down * (kAbove + depth_m))});
    // Tissue that began below the tool and is above its middle now has been passed through.
    const Vector3 center = simulator.linkPoses(0)[3].translation();
    const NodalVectors& x = simulator.positions(0);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      above_tool += (x.col(i) - center).head<2>().norm() < 0.5 * scene.radius_m && x(2, i) > center.z();
    }
    if (k % 50 == 0) report.progress(from + (to - from) * std::min(1.0, static_cast<double>(k) / steps));
  }
  // A step sees the ball as the planes that touch it: after a way w the curved ball is up to w^2 / (2 R) deeper. A way
  // is cut at half the ball's radius.
  const double way = std::min(kSpeed * scene.step_s, 0.5 * scene.radius_m);
  HardBands bands;
  bands.penetration_edges += way * way / (2.0 * scene.radius_m) / run.meanEdge();
  run.report(name, bands, report);
  report.atMost(name + ": nodes passed through", "", 0.0, above_tool, "no tunnelling");
}

/// Starts inside without any motion: freed over some steps, then the force of the same depth reached slowly.
void startInside(Report& report) {
  PadScene scene;
  scene.mu_static = scene.mu_kinetic = 0.0;  // else the force keeps the history of the way
  const double wanted = slowPress(scene, 0.008);
  scene.start_m = -0.008;
  Simulator simulator = makePad(scene);
  HardRun run(simulator, 41);
  const Vector3 there(0.0, 0.0, -0.008);
  for (int k = 1; k <= 2000; ++k) simulator.advance(0.001, {there});
  HardBands bands;
  bands.penetration_edges = 0.008 / run.meanEdge();  // as deep as it starts, and never deeper
  run.report("starts 8 mm inside", bands, report);
  const std::vector<SolvedContact>& contacts = simulator.contacts();
  double deepest = 0.0;
  for (const SolvedContact& one : contacts) deepest = std::max(deepest, -one.contact.gap_m);
  report.atMost("starts 8 mm inside: penetration left after 2 s", "m", 1e-6, deepest, "pushed out");
  report.near("starts 8 mm inside: force after 2 s", "N", wanted, simulator.wrench(0).force.z(), 5e-3 * wanted,
              "the same depth reached slowly");
}

/// With its middle inside no side is the nearer one: documented as not pushed out. It must do no harm, and work as ever
/// once it has been outside.
void startTooDeep(Report& report) {
  PadScene scene;
  scene.start_m = -0.015;
  Simulator simulator = makePad(scene);
  HardRun run(simulator, 0);
  for (int k = 1; k <= 500; ++k) simulator.advance(0.001, {Vector3(0.0, 0.0, scene.start_m)});
  for (int k = 1; k <= 1000; ++k) simulator.advance(0.001, {Vector3(0.0, 0.0, scene.start_m + 0.02 * k / 1000.0)});
  for (int k = 1; k <= 1000; ++k) simulator.advance(0.001, {Vector3(0.0, 0.0, 0.005 - 0.009 * k / 1000.0)});
  for (int k = 1; k <= 1000; ++k) simulator.advance(0.001, {Vector3(0.0, 0.0, -0.004)});
  const double wanted = slowPress(scene, 0.004);
  report.require("starts 15 mm inside: finite, no step discarded", run.finite(), "stability");
  report.near("starts 15 mm inside: force once it came back", "N", wanted, simulator.wrench(0).force.z(), 5e-3 * wanted,
              "the same depth reached slowly");
}

/// Half a kilometre and back, onto the tissue, into it, out of it: between two steps, without a way.
void teleport(Report& report) {
  PadScene scene;
  scene.mu_static = scene.mu_kinetic = 0.0;
  const double wanted = slowPress(scene, 0.004);
  Simulator simulator = makePad(scene);
  HardRun run(simulator, 41);
  const Vector3 deep(0.0, 0.0, -0.004);
  const Vector3 away(500.0, 0.0, 0.5);
  bool jumped = true;
  double worst = 0.0;
  double rest = 0.0;
  for (int round = 0; round < 5; ++round) {
    simulator.advance(0.001, {deep});
    jumped = jumped && (round == 0 || simulator.report().jumped);
    for (int k = 1; k < 500; ++k) simulator.advance(0.001, {deep});
    worst = std::max(worst, std::abs(simulator.wrench(0).force.z() - wanted));
    simulator.advance(0.001, {away});
    jumped = jumped && simulator.report().jumped;
    for (int k = 1; k < 500; ++k) simulator.advance(0.001, {away});
    rest = std::max(rest, farthestFromRest(simulator));
    report.progress(0.5 + 0.1 * round);
  }
  HardBands bands;
  bands.penetration_edges = 0.004 / run.meanEdge();  // as deep as it is put, and never deeper
  run.report("teleports", bands, report);
  report.require("teleports: each is reported as a jump", jumped, "StepReport::jumped");
  // Cells nearly as wide as the ball: contacts inside faces begin at other places than where the ball comes slowly, and there are two
  // ways to rest, 2 % apart.
  report.near("teleports: worst force 0.5 s after", "N", wanted, wanted + worst, 3e-2 * wanted,
              "the same depth reached slowly");
  report.atMost("teleports: left of the deformation 0.5 s after", "m", 1e-5, rest, "elastic");
}

JointStateSample sampleAt(double t, double z) {
  return {static_cast<std::int64_t>(std::llround((100.0 + t) * 1e9)), {"x", "y", "z"}, {0.0, 0.0, z}};
}

/// Force along z at every accepted sample.
std::vector<double> play(Simulator& simulator, JointStatePlayer& player, const std::vector<JointStateSample>& samples) {
  std::vector<double> forces;
  for (const JointStateSample& sample : samples) {
    player.push(0, sample);
    while (const auto played = player.playNext()) {
      if (played->verdict == Verdict::kAccepted) forces.push_back(simulator.wrench(0).force.z());
    }
  }
  return forces;
}

/// Two seconds at 100 Hz, pressing 4 mm deep twice.
std::vector<JointStateSample> smoothSamples() {
  std::vector<JointStateSample> samples;
  for (int k = 0; k <= 200; ++k)
    samples.push_back(sampleAt(0.01 * k, 0.001 - 0.005 * std::pow(std::sin(0.01 * M_PI * k), 2)));
  return samples;
}

}  // namespace

void validateHardFastEntry(Report& report) {
  PadScene scene;
  enterFast("0.5 m/s, 1 ms", scene, 0.008, report, 0.0, 0.3);
  scene.solver = "{relaxation: cholesky}";
  scene.step_s = 0.01;
  enterFast("0.5 m/s, 10 ms", scene, 0.008, report, 0.3, 0.6);
  scene = PadScene();
  scene.radius_m = 0.002;
  enterFast("2 mm ball, 0.5 m/s", scene, 0.005, report, 0.6, 1.0);
}

void validateHardPlacement(Report& report) {
  startInside(report);
  startTooDeep(report);
  teleport(report);
}

void validateHardJointStates(Report& report) {
  Simulator smooth = makePad({});
  JointStatePlayer smooth_player(smooth);
  const std::vector<double> wanted = play(smooth, smooth_player, smoothSamples());

  Simulator simulator = makePad({});
  HardRun run(simulator, 41);
  JointStatePlayer player(simulator);
  std::vector<JointStateSample> rough;
  for (const JointStateSample& sample : smoothSamples()) {
    rough.push_back(sample);
    rough.push_back(sample);  // a duplicate
    JointStateSample broken = sample;
    broken.stamp_ns += 1000;
    broken.positions[2] = std::numeric_limits<double>::quiet_NaN();
    rough.push_back(broken);
  }
  const std::vector<double> first = play(simulator, player, rough);
  report.require("duplicates and NaN change no bit", first == wanted, "they are ignored");
  report.near("duplicates refused", "", 201, static_cast<double>(player.count(Verdict::kDuplicateStamp)), 0,
              "one each");
  report.near("NaN refused", "", 201, static_cast<double>(player.count(Verdict::kNotFinite)), 0, "one each");
  const std::vector<double> second = play(simulator, player, rough);  // its stamps begin 2 s earlier
  report.require("time backwards: the second loop is the first, to the bit", second == wanted,
                 "the scene starts again");
  report.near("time backwards: resets", "", 1, static_cast<double>(player.resets()), 0, "one loop");
  // A gap of an hour, in which the probe went 5 mm deep.
  const std::vector<double> after = play(simulator, player, {sampleAt(3600.0, -0.004)});
  report.near("a gap of an hour: gaps counted", "", 1, static_cast<double>(player.gaps()), 0, "max_gap_s of 1 s");
  const double slowly = slowPress({}, 0.004);
  report.near("a gap of an hour: force after", "N", slowly, after.back(), 0.05 * slowly,
              "the same depth reached slowly");
  run.report("rough joint states", {}, report);
}

}  // namespace tissue_contact
