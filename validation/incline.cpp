/// Form B: a free block on an incline. It holds exactly while tan(theta) < mu_s, slides with g (sin - mu cos), does not
/// creep; and form J: its weight is the sum of the contact forces, and it falls freely before it lands.
#include <cmath>
#include <sstream>

#include "support/text_scene.h"
#include "validation/closed_forms.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kGravity = 9.81;

/// 60 x 60 x 30 mm, 108 g, resting on a table tilted about y by `degrees`, so that +x of the table points downhill.
Simulator makeIncline(double degrees, double mu_static, double mu_kinetic, double height_m = 0.0) {
  const double theta = degrees * M_PI / 180.0;
  std::ostringstream yaml;
  yaml.precision(17);
  yaml
      << "gravity_m_per_s2: [0, 0, -9.81]\n"
      << "tissues:\n  - name: block\n    block: {size_m: [0.06, 0.06, 0.03], cells: [4, 4, 2]}\n"
      << "    pose: {position_m: [" << height_m * std::sin(theta) << ", 0, " << height_m * std::cos(theta)
      << "], rpy_rad: [0, " << theta << ", 0]}\n"
      << "    material: {model: corotational, youngs_modulus_pa: 1.0e5, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      << "    damping: {stiffness_s: 0.005}\n"
      << "instruments:\n  - name: table\n    robot_description: table\n    tip_link: table\n"
      << "    base_pose: {position_m: [0, 0, 0], rpy_rad: [0, " << theta << ", 0]}\n    contact_links: [table]\n"
      << "friction:\n  - {instrument: table, tissue: block, static: " << mu_static << ", kinetic: " << mu_kinetic
      << "}\n"
      << "step: {max_step_s: 0.001}\nsolver: {iterations: 200, tolerance: 1.0e-9}\n";
  return makeSimulator(yaml.str(), {{"table", tableUrdf()}});
}

void run(Simulator& simulator, double seconds) {
  const std::vector<VectorX> no_joints(1, VectorX());
  for (int k = 0; k < static_cast<int>(std::lround(seconds / 0.001)); ++k) simulator.advance(0.001, no_joints);
}

Vector3 massCenter(const Simulator& simulator, const NodalVectors& values) {
  const VectorX& masses = simulator.tissues()[0].nodeMasses();
  return values * masses / masses.sum();
}

/// Mean downhill acceleration over one second, after half a second in which landing vibrations die.
double downhillAcceleration(double degrees, double mu) {
  Simulator simulator = makeIncline(degrees, mu, mu);
  const double theta = degrees * M_PI / 180.0;
  const Vector3 downhill(std::cos(theta), 0.0, -std::sin(theta));
  run(simulator, 0.5);
  const double before = downhill.dot(massCenter(simulator, simulator.velocities(0)));
  run(simulator, 1.0);
  return downhill.dot(massCenter(simulator, simulator.velocities(0))) - before;
}

// Source of every angle and acceleration: the point mass, holds while tan(theta) < mu_s, else a = g (sin - mu_k cos).
constexpr const char* kPointMass = "point mass with Coulomb friction";

// mu = 0.3: the critical angle is 16.699 degrees.
void holdsWithoutCreep(Report& report) {
  Simulator simulator = makeIncline(16.6, 0.3, 0.3);
  run(simulator, 1.0);
  const Vector3 start = massCenter(simulator, simulator.positions(0));
  for (int second = 1; second <= 60; ++second) {
    run(simulator, 1.0);
    report.progress(0.8 * second / 60);
  }
  const Vector3 end = massCenter(simulator, simulator.positions(0));
  report.atMost("16.6 deg, mu .3: kinetic contacts", "", 0.0, simulator.report().kinetic_contacts, kPointMass);
  report.atLeast("16.6 deg, mu .3: static contacts", "", 4.0, simulator.report().static_contacts, kPointMass);
  // 0.3 nm per minute per newton is what double round-off alone would allow.
  report.atMost("16.6 deg, mu .3: creep in 60 s", "m", 1e-6, (end - start).norm(), "none: it holds");
}

// tan 20 = 0.364. Gravity sets in at once, so shear overshoots to up to twice its final value: mu_s must cover that.
void staticHoldsWhatKineticWouldNot(Report& report) {
  Simulator simulator = makeIncline(20.0, 0.8, 0.3);
  run(simulator, 1.0);
  const Vector3 start = massCenter(simulator, simulator.positions(0));
  run(simulator, 1.0);
  report.atMost("20 deg, mu .8 / .3: creep in 1 s", "m", 1e-7,
                (massCenter(simulator, simulator.positions(0)) - start).norm(), "none: it holds");
}

void weightIsTheContactForce(Report& report) {
  Simulator simulator = makeIncline(10.0, 0.5, 0.5);
  run(simulator, 1.5);
  const double weight = kGravity * simulator.tissues()[0].nodeMasses().sum();
  const double theta = 10.0 * M_PI / 180.0;
  const Wrench on_table = simulator.wrench(0);  // in table axes
  const Vector3 expected = weight * Vector3(std::sin(theta), 0.0, -std::cos(theta));
  // The solver stops at a relative change of 1e-9; 1e-5 of the motion is left after 1.5 s.
  report.near("10 deg: force along the table", "N", expected.x(), on_table.force.x(), 1e-5 * weight, "weight");
  report.near("10 deg: force across the table", "N", 0.0, on_table.force.y(), 1e-5 * weight, "weight");
  report.near("10 deg: force into the table", "N", expected.z(), on_table.force.z(), 1e-5 * weight, "weight");
  // The table feels the weight through the block's mass centre.
  const Vector3 moment_W = massCenter(simulator, simulator.positions(0)).cross(Vector3(0.0, 0.0, -weight));
  const Vector3 moment = Eigen::AngleAxisd(-theta, Vector3::UnitY()) * moment_W;
  report.atMost("10 deg: moment that weight does not explain", "N m", 1e-5 * weight * 0.03,
                (on_table.torque - moment).norm(), "weight at the mass centre");
}

void fallsFreelyUntilItLands(Report& report) {
  Simulator simulator = makeIncline(0.0, 0.3, 0.3, 0.1);
  const Vector3 start = massCenter(simulator, simulator.positions(0));
  run(simulator, 0.1);
  const int steps = 100;
  const double fallen = kGravity * 1e-6 * 0.5 * steps * (steps + 1);
  // The solver stops at a relative change of 1e-9 in each of the 100 steps.
  report.near("free fall in 0.1 s", "m", -fallen, massCenter(simulator, simulator.positions(0)).z() - start.z(),
              1e-7 * fallen, "implicit Euler: sum of k g dt^2");
  report.atMost("contacts that touch while it falls", "", 0.0,
                simulator.report().static_contacts + simulator.report().kinetic_contacts, "it touches nothing");
  run(simulator, 1.5);
  // It settles under its weight by 1 um.
  report.near("height of the mass centre after landing", "m", 0.015, massCenter(simulator, simulator.positions(0)).z(),
              1e-4, "half the block's height");
}

}  // namespace

void validateIncline(Report& report) {
  holdsWithoutCreep(report);
  const double tolerance = 1e-3 * kGravity;  // vibrations that have not died yet
  report.near("16.8 deg, mu .3: acceleration", "m/s^2", 0.0180, downhillAcceleration(16.8, 0.3), tolerance, kPointMass);
  report.near("20 deg, mu .3: acceleration", "m/s^2", 0.5897, downhillAcceleration(20.0, 0.3), tolerance, kPointMass);
  staticHoldsWhatKineticWouldNot(report);
  weightIsTheContactForce(report);
  fallsFreelyUntilItLands(report);
}

}  // namespace tissue_contact
