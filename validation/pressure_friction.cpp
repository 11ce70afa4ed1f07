/// Friction that depends on contact pressure, mu(p), against closed forms: a plate drags a layer with p the same all over; a
/// slab lies on an incline by its weight, p = rho g h cos(theta); a sphere slides over the block of form H, where Hertz has
/// p = p0 sqrt(1 - r^2 / a^2), p0 = 3 P / (2 pi a^2), so that with mu = c p^(-1/3)
///   Q = integral of mu p = c p0^(2/3) pi a^2 3/4,   Q / P = 9/8 mu(p0)   (K. L. Johnson, Contact Mechanics, 1985, sec. 3.4).
#include <cmath>
#include <sstream>
#include <string>

#include "support/text_scene.h"
#include "validation/closed_forms.h"
#include "validation/press_scene.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

/// Tangential over normal force in the contacts' own planes.
double coefficient(const Simulator& simulator) {
  double tangential = 0.0;
  double normal = 0.0;
  for (const SolvedContact& one : simulator.contacts()) {
    const Vector3 f = one.contact.R_WC.transpose() * one.force_on_tissue_n;
    normal += f.x();
    tangential += f.tail<2>().norm();
  }
  return tangential / normal;  // NaN fails, if nothing touches
}

constexpr double kModulus = 1e4;  // Pa, nu = 0: pressed flat without sideways forces
constexpr double kHeight = 0.004;
constexpr double kMu = 0.4;
constexpr double kHalfMuAt = 2000.0;  // Pa: mu falls in a straight line to half of kMu there

/// A layer of 40 x 40 x 4 mm on a rigid base under a plate that covers it, dragged by 2 mm.
double dragPlate(double strain) {
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: layer\n    block: {size_m: [0.04, 0.04, " << kHeight << "], cells: [10, 10, 2]}\n"
       << "    material: {model: linear, youngs_modulus_pa: " << kModulus
       << ", poissons_ratio: 0, density_kg_per_m3: 1000}\n    damping: {stiffness_s: 0.01}\n"
       << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
       << "instruments:\n  - {name: plate, robot_description: probe, tip_link: tip, joint_state_topics: [/js],\n"
       << "     base_pose: {position_m: [0, 0, " << kHeight + 0.005 << "]},\n"
       << "     contact_links: [{link: tip, shapes: [{box: {size_m: [0.1, 0.1, 0.01]}}]}]}\n"
       << "friction:\n  - {instrument: plate, tissue: layer, static: " << kMu << ", pressures_pa: [0, " << kHalfMuAt
       << "], pressure_factors: [1, 0.5]}\nstep: {max_step_s: 0.005}\nsolver: {iterations: 300, tolerance: 1.0e-8}\n";
  Simulator simulator = makeSimulator(yaml.str(), {{"probe", probeUrdf(0.005)}});
  const double depth = strain * kHeight;
  for (int k = 1; k <= 40; ++k) simulator.advance(0.005, {Vector3(0.0, 0.0, -depth * k / 40.0)});
  for (int k = 1; k <= 100; ++k) simulator.advance(0.005, {Vector3(2e-5 * k, 0.0, -depth)});
  return coefficient(simulator);
}

// The free ends of a sheared layer are lifted and pressed: within a height of them p is not that of the rest.
void plateOnLayer(Report& report) {
  for (const double strain : {0.02, 0.05, 0.1}) {
    const double pressure = kModulus * strain;
    const double expected = kMu * (1.0 - 0.5 * pressure / kHalfMuAt);
    report.near("plate on a layer, p " + std::to_string(static_cast<int>(std::lround(pressure))) + " Pa: Q / P", "",
                expected, dragPlate(strain), 0.01 * expected, "mu(p)");
  }
}

constexpr double kSlab = 0.006;  // m, high; 60 mm wide: the weight's overturning moment changes p by 10 % at most
double slabPressure(double theta) { return 1000.0 * 9.81 * kSlab * std::cos(theta); }

/// mu falls with pressure and is 0.3 at that of the slab.
Simulator makeSlab(double theta) {
  std::ostringstream yaml;
  yaml.precision(17);
  yaml << "gravity_m_per_s2: [0, 0, -9.81]\n"
       << "tissues:\n  - name: slab\n    block: {size_m: [0.06, 0.06, " << kSlab << "], cells: [4, 4, 1]}\n"
       << "    pose: {rpy_rad: [0, " << theta << ", 0]}\n"
       << "    material: {youngs_modulus_pa: 1.0e5, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
       << "    damping: {stiffness_s: 0.005}\n"
       << "instruments:\n  - name: table\n    robot_description: table\n    tip_link: table\n"
       << "    base_pose: {rpy_rad: [0, " << theta << ", 0]}\n    contact_links: [table]\n"
       << "friction:\n  - {instrument: table, tissue: slab, static: 0.6, pressures_pa: [0, "
       << 2.0 * slabPressure(theta)
       << "], pressure_factors: [0.6, 0.4]}\nstep: {max_step_s: 0.001}\nsolver: {iterations: 200, tolerance: 1.0e-9}\n";
  return makeSimulator(yaml.str(), {{"table", tableUrdf()}});
}

void run(Simulator& simulator, double seconds) {
  for (long k = 0; k < std::lround(seconds / 0.001); ++k) simulator.advance(0.001, {VectorX()});
}

Vector3 massCenter(const Simulator& simulator, const NodalVectors& values) {
  const VectorX& masses = simulator.tissues()[0].nodeMasses();
  return values * masses / masses.sum();
}

void slabOnIncline(Report& report) {
  const double holding = 16.6 * M_PI / 180.0;  // tan = 0.2981
  Simulator held = makeSlab(holding);
  run(held, 1.0);
  const Vector3 start = massCenter(held, held.positions(0));
  run(held, 10.0);
  report.atMost("slab, 16.6 deg, mu(p) .3: kinetic contacts", "", 0.0, held.report().kinetic_contacts,
                "tan(theta) < mu(p)");
  report.atMost("slab, 16.6 deg, mu(p) .3: creep in 10 s", "m", 1e-7,
                (massCenter(held, held.positions(0)) - start).norm(), "none: it holds");
  const double sliding = 20.0 * M_PI / 180.0;
  Simulator slides = makeSlab(sliding);
  run(slides, 0.5);
  const Vector3 downhill(std::cos(sliding), 0.0, -std::sin(sliding));
  const double before = downhill.dot(massCenter(slides, slides.velocities(0)));
  run(slides, 1.0);
  report.near("slab, 20 deg, mu(p) .3: acceleration", "m/s^2", 9.81 * (std::sin(sliding) - 0.3 * std::cos(sliding)),
              downhill.dot(massCenter(slides, slides.velocities(0))) - before, 1e-3 * 9.81, "point mass");
}

constexpr double kDepth = 0.000625;
constexpr double kRadius = 0.005;       // m, of the contact
constexpr double kMuAt1kPa = 0.1;       // mu = kMuAt1kPa (p / 1 kPa)^(-1/3)
constexpr double kLeastPressure = 2.0;  // Pa: held below

/// From kLeastPressure to 4 kPa in equal ratios, of which a straight line leaves less than 1e-3.
std::string cubeRootTable() {
  std::ostringstream pressures;
  std::ostringstream factors;
  constexpr int kEntries = 60;
  for (int i = 0; i <= kEntries; ++i) {
    const double p = kLeastPressure * std::pow(4000.0 / kLeastPressure, static_cast<double>(i) / kEntries);
    const char* const comma = i == 0 ? "" : ", ";
    pressures << comma << (i == 0 ? 0.0 : p);
    factors << comma << std::cbrt(1000.0 / p);
  }
  return ", pressures_pa: [" + pressures.str() + "], pressure_factors: [" + factors.str() + "]";
}

struct Slide {
  double ratio = 0.0;     ///< Q / P, mean of the last steps
  double expected = 0.0;  ///< 9/8 mu(p0)
  double noise = 0.0;     ///< standard deviation of Q / P over these steps, as a share of it
  double cell = 0.0;      ///< m
};

Slide slideSphere(int cells, const std::string& table) {
  PressScene scene;
  scene.cells = {cells, cells, cells / 2};
  scene.growth = std::pow(1.3, 10.0 / cells);
  scene.mu = kMuAt1kPa;
  scene.friction_keys = table;
  Simulator simulator = makePress(scene);
  pressSmooth(simulator, kDepth, 10);
  const Vector3 away(0.0, 0.0, 0.5);
  simulator.placeInstrument(0, away);
  simulator.placeInstrument(1, Vector3(0.0, 0.0, -kDepth));
  constexpr int kSteps = 60;
  constexpr int kMeasured = 30;
  double sum = 0.0;
  double squares = 0.0;
  double press = 0.0;
  for (int k = 1; k <= kSteps; ++k) {
    simulator.advance(kPressStep, {away, Vector3(1e-5 * k, 0.0, -kDepth)});
    if (k <= kSteps - kMeasured) continue;
    const double ratio = coefficient(simulator);
    sum += ratio / kMeasured;
    squares += ratio * ratio / kMeasured;
    press += simulator.wrench(1).force.z() / kMeasured;
  }
  const double peak = 1.5 * press / (M_PI * kRadius * kRadius);
  return {sum, 9.0 / 8.0 * kMuAt1kPa * std::cbrt(1000.0 / peak), std::sqrt(std::max(0.0, squares - sum * sum)) / sum,
          scene.finestCell()};
}

// The contact's edge runs through cells, and mu is largest there. What area a node has there is a guess (contact_pressure.h),
// which changes where the edge passes a node: 3 % of friction, 2 % from step to step.
void sphereOnBlock(Report& report) {
  const char* const source = "Hertz, mu ~ p^(-1/3)";
  const Slide coarse = slideSphere(20, cubeRootTable());
  report.progress(0.6);
  const Slide fine = slideSphere(30, cubeRootTable());
  report.near("sphere, 1.6 mm cells: Q / P", "", coarse.expected, coarse.ratio, 0.03 * coarse.expected, source);
  report.near("sphere, 1.0 mm cells: Q / P", "", fine.expected, fine.ratio, 0.03 * fine.expected, source);
  report.convergence({"sphere: Q / P over 9/8 mu(p0)",
                      "",
                      "finest cell, m",
                      {{coarse.cell, coarse.ratio / coarse.expected}, {fine.cell, fine.ratio / fine.expected}},
                      1.0});
  report.atMost("sphere, 1.6 mm cells: change of Q / P from step to step", "", 0.02, coarse.noise, "steady sliding");
}

}  // namespace

void validatePressureFriction(Report& report) {
  plateOnLayer(report);
  report.progress(0.2);
  slabOnIncline(report);
  report.progress(0.4);
  sphereOnBlock(report);
}

}  // namespace tissue_contact
