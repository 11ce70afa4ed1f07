/// Form I: a block on an incline with friction that depends on direction. Orthotropic: it leaves the fall line at the angle
/// that the law wants. Asymmetric: it holds one way up and slides the other. With the law's axis on the incline, and
/// with the fibres of the block.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "validation/text_scene.h"

namespace tissue_contact {
namespace {

constexpr double kGravity = 9.81;
constexpr double kStep = 0.001;

/// A block of 60 x 60 x 30 mm on a table that is tilted by turning gravity, so that +x runs downhill. `turned_rad` turns
/// the block about the table's normal.
Simulator makeIncline(double degrees, double turned_rad, const std::string& law) {
  const double theta = degrees * M_PI / 180.0;
  std::ostringstream yaml;
  yaml.precision(17);
  yaml
      << "gravity_m_per_s2: [" << kGravity * std::sin(theta) << ", 0, " << -kGravity * std::cos(theta) << "]\n"
      << "tissues:\n  - name: block\n    block: {size_m: [0.06, 0.06, 0.03], cells: [4, 4, 2]}\n"
      << "    pose: {position_m: [0, 0, 0], rpy_rad: [0, 0, " << turned_rad << "]}\n"
      << "    material: {model: corotational, youngs_modulus_pa: 1.0e5, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      << "    damping: {stiffness_s: 0.005}\n    fibre_direction: [1, 0, 0]\n"
      << "instruments:\n  - {name: table, robot_description: table, tip_link: table, contact_links: [table]}\n"
      << "friction:\n  - {instrument: table, tissue: block, " << law << "}\n"
      << "solver: {iterations: 200, tolerance: 1.0e-8}\n";
  return makeSimulator(yaml.str(), {{"table", tableUrdf()}});
}

void run(Simulator& simulator, double seconds) {
  for (int k = 0; k < static_cast<int>(std::lround(seconds / kStep)); ++k) simulator.advance(kStep, {VectorX()});
}

Vector3 meanOf(const Simulator& simulator, const NodalVectors& values) {
  const VectorX& masses = simulator.tissues()[0].nodeMasses();
  return values * masses / masses.sum();
}

/// Acceleration of the mass centre over half a second, after 0.3 s in which the landing's vibrations die.
Vector2 acceleration(Simulator& simulator) {
  run(simulator, 0.3);
  const Vector3 before = meanOf(simulator, simulator.velocities(0));
  run(simulator, 0.5);
  return (meanOf(simulator, simulator.velocities(0)) - before).head<2>() / 0.5;
}

/// Friction per normal force on a body that slides along d over an orthotropic surface with axis 1 at `axis_rad`.
Vector2 orthotropic(double mu1, double mu2, double axis_rad, const Vector2& d) {
  const Eigen::Rotation2Dd turn(axis_rad);
  const Vector2 local = turn.inverse() * d;
  const Vector2 scaled(mu1 * mu1 * local.x(), mu2 * mu2 * local.y());
  return turn * Vector2(-scaled / Vector2(mu1 * local.x(), mu2 * local.y()).norm());
}

/// From rest a body keeps to the direction d in which gravity and its friction leave an acceleration along d alone:
/// found by bisection between downhill and `axis_rad`, the direction of least friction.
double pathAngle(double degrees, double mu1, double mu2, double axis_rad) {
  const double theta = degrees * M_PI / 180.0;
  const auto aside = [&](double angle) {
    const Vector2 d(std::cos(angle), std::sin(angle));
    const Vector2 a = kGravity * (Vector2(std::sin(theta), 0.0) + std::cos(theta) * orthotropic(mu1, mu2, axis_rad, d));
    return d.x() * a.y() - d.y() * a.x();  // > 0: turns further from the fall line
  };
  double low = 0.0;
  double high = axis_rad;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (aside(middle) > 0.0 ? low : high) = middle;
  }
  return low;
}

void expectOrthotropicPath(Simulator& simulator, double degrees, double mu1, double mu2, double axis_rad) {
  const double angle = pathAngle(degrees, mu1, mu2, axis_rad);
  const double theta = degrees * M_PI / 180.0;
  const Vector2 d(std::cos(angle), std::sin(angle));
  const Vector2 force = Vector2(std::sin(theta), 0.0) + std::cos(theta) * orthotropic(mu1, mu2, axis_rad, d);
  const Vector2 a = acceleration(simulator);
  const Vector3 v = meanOf(simulator, simulator.velocities(0));
  std::cout << "path at " << std::atan2(v.y(), v.x()) * 180.0 / M_PI << " degrees from the fall line ("
            << angle * 180.0 / M_PI << "), acceleration " << a.norm() << " m/s^2 (" << kGravity * force.norm() << ")\n";
  // What form B allows for, 1e-3 g, in the acceleration; half a degree in the direction, which the landing has disturbed.
  EXPECT_NEAR(a.norm(), kGravity * force.norm(), 1e-3 * kGravity);
  EXPECT_NEAR(std::atan2(v.y(), v.x()), angle, 0.5 * M_PI / 180.0);
  EXPECT_GT(angle, 5.0 * M_PI / 180.0);
}

TEST(AnisotropicIncline, OrthotropicAxisOnTheInclineTurnsThePath) {
  for (const double axis : {0.5236, 0.7854}) {
    std::ostringstream law;
    law << "law: orthotropic, static: [0.2, 0.35], axis: {link_direction: [" << std::cos(axis) << ", " << std::sin(axis)
        << ", 0]}";
    Simulator simulator = makeIncline(25.0, 0.0, law.str());
    expectOrthotropicPath(simulator, 25.0, 0.2, 0.35, axis);
  }
}

TEST(AnisotropicIncline, OrthotropicFibresOfTheBlockTurnThePath) {
  const double axis = 0.7854;
  Simulator simulator = makeIncline(25.0, axis, "law: orthotropic, static: [0.2, 0.35], axis: fibre");
  expectOrthotropicPath(simulator, 25.0, 0.2, 0.35, axis);
}

/// Of a block on 20 degrees, whose tangent is 0.364: gravity sets in at once, so shear overshoots to twice as much.
void expectHolds(Simulator& simulator) {
  run(simulator, 1.0);
  const Vector3 start = meanOf(simulator, simulator.positions(0));
  run(simulator, 1.0);
  EXPECT_LE((meanOf(simulator, simulator.positions(0)) - start).norm(), 1e-7);
  EXPECT_EQ(simulator.report().kinetic_contacts, 0);
}

void expectSlides(Simulator& simulator, double mu) {
  const double theta = 20.0 * M_PI / 180.0;
  const Vector2 a = acceleration(simulator);
  EXPECT_NEAR(a.x(), kGravity * (std::sin(theta) - mu * std::cos(theta)), 1e-3 * kGravity);
  EXPECT_NEAR(a.y(), 0.0, 1e-3 * kGravity);
}

// Forward is where the INSTRUMENT moves along +axis over the tissue: under a block that slides downhill, uphill.
const char* const kAsymmetric = "law: asymmetric, static: [0.2, 0.8, 0.4], ";

TEST(AnisotropicIncline, AsymmetricInclineHoldsOneWayUpAndLetsSlideTheOther) {
  Simulator holding = makeIncline(20.0, 0.0, std::string(kAsymmetric) + "axis: {link_direction: [1, 0, 0]}");
  expectHolds(holding);
  Simulator sliding = makeIncline(20.0, 0.0, std::string(kAsymmetric) + "axis: {link_direction: [-1, 0, 0]}");
  expectSlides(sliding, 0.2);
}

TEST(AnisotropicIncline, AsymmetricFibresHoldOneWayRoundAndSlideTheOther) {
  Simulator holding = makeIncline(20.0, 0.0, std::string(kAsymmetric) + "axis: fibre");
  expectHolds(holding);
  Simulator sliding = makeIncline(20.0, M_PI, std::string(kAsymmetric) + "axis: fibre");
  expectSlides(sliding, 0.2);
}

}  // namespace
}  // namespace tissue_contact
