/// Form J: tissue held by springs and tissue under pressure. A block of height h on a bed of springs sinks by rho g h / k;
/// let go on springs of k_n in all, a stiff body of mass m turns after pi sqrt(m / k_n). A free body under pressure p shrinks
/// uniformly by e, where 3 K e = -p (1 + e)^2 (stress on undeformed, pressure on deformed areas; to first order -p / (3 K)).
/// A slab pressed from above loses p h / M, with the oedometer modulus M = E where Poisson's ratio is 0.
#include <cmath>
#include <string>

#include "support/held_block.h"
#include "validation/closed_forms.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kHeight = 0.02;  // m
constexpr double kPressure = 1600.0;
constexpr double kYoung = 2e4;

Simulator makeBlock(const std::string& material, const std::string& tissue, const std::string& scene) {
  return makeHeldBlock(material, tissue, scene + kCholesky + kAwake);
}

void rest(Simulator& simulator) {
  for (int k = 0; k < 400; ++k) simulator.advance(0.01, {});
}

// What is left after 4 s of damped motion is round-off of coordinates; 1e-6 of the sinking is what we ask for.
void sinks(Report& report) {
  constexpr double kBed = 1e5;  // Pa/m
  for (const char* model : {"corotational", "neo_hookean"}) {
    Simulator simulator = makeBlock(std::string("youngs_modulus_pa: 5000, poissons_ratio: 0.45, model: ") + model,
                                    "    attachments: [{where: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}], "
                                    "stiffness_pa_per_m: 1e5}]\n    damping: {mass_per_s: 20, stiffness_s: 0.01}\n",
                                    kHeavy);
    rest(simulator);
    const double expected = 1000.0 * kGravity * kHeight / kBed;
    report.near(std::string(model) + " block on a bed of springs: mean sinking", "m", expected, meanSinking(simulator),
                1e-6 * expected, "rho g h / k");
    report.progress(0.2);
  }
}

// The turn is known to a step of 0.1 ms, 0.2 % of the time to it.
void swings(Report& report) {
  Simulator simulator = makeBlock(
      "youngs_modulus_pa: 1e7, poissons_ratio: 0.3",
      "    attachments: [{where: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, 1]}}], stiffness_n_per_m: 2}]\n", kHeavy);
  const Tissue& tissue = simulator.tissues()[0];
  const double mass = tissue.nodeMasses().sum();
  const double stiffness = 2.0 * tissue.nodeCount();
  const double expected = M_PI * std::sqrt(mass / stiffness);
  constexpr double kStep = 1e-4;  // s
  double lowest = 0.0;
  double time = 0.0;
  for (int k = 1; k * kStep < 1.5 * expected; ++k) {
    simulator.advance(kStep, {});
    const double height = displacement(simulator).row(2).dot(tissue.nodeMasses().transpose()) / mass;
    if (height >= lowest) continue;
    lowest = height;
    time = k * kStep;
  }
  report.near("stiff block let go on springs: time to the turn", "s", expected, time, 2.0 * kStep, "pi sqrt(m / k)");
  // Implicit Euler takes (pi / 4) omega dt = 0.55 % off the swing.
  const double depth = 2.0 * mass * kGravity / stiffness;
  report.near("stiff block let go on springs: depth of the turn", "m", depth, -lowest, 0.01 * depth, "2 m g / k");
}

// The pressure is taken at the start of a step, which at rest is no other than at its end.
void shrinks(Report& report) {
  for (const double nu : {0.2, 0.45}) {
    Simulator simulator = makeBlock("youngs_modulus_pa: 2e4, poissons_ratio: " + std::to_string(nu),
                                    "    pressure_pa: 1600\n    damping: {stiffness_s: 0.01}\n", "");
    rest(simulator);
    const double bulk = kYoung / (3.0 * (1.0 - 2.0 * nu));
    const double strain = uniformStrain(kPressure, bulk);
    const NodalVectors& at_rest = simulator.tissues()[0].restPositions();
    const VectorX& masses = simulator.tissues()[0].nodeMasses();
    const Vector3 centre = at_rest * masses / masses.sum();
    const NodalVectors expected = strain * (at_rest.colwise() - centre);
    const std::string what = "free block, nu " + std::to_string(nu).substr(0, 4) + ", 1.6 kPa all around: ";
    report.near(what + "strain", "", strain,
                displacement(simulator).cwiseProduct(expected).sum() * strain / expected.squaredNorm(),
                1e-6 * std::abs(strain), "3 K e = -p (1 + e)^2");
    report.atMost(what + "largest departure from a uniform strain, of the size", "", 1e-6 * std::abs(strain),
                  (displacement(simulator) - expected).cwiseAbs().maxCoeff() / 0.04,
                  "linear tetrahedra hold uniform strain exactly");
  }
}

void isCompressed(Report& report) {
  Simulator simulator =
      makeBlock("youngs_modulus_pa: 2e4, poissons_ratio: 0",
                "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n    damping: {stiffness_s: 0.01}\n"
                "    pressure_pa: 1600\n    pressure_where: [{plane: {point_m: [0, 0, 0.02], normal: [0, 0, -1]}}]\n",
                "");
  rest(simulator);
  const double expected = kPressure * kHeight / kYoung;
  report.near("slab, 1.6 kPa on its upper face: compression", "m", expected, -displacement(simulator).row(2).minCoeff(),
              1e-6 * expected, "p h / M, M = E at nu 0");
}

}  // namespace

void validateHeldAndPressed(Report& report) {
  sinks(report);
  swings(report);
  report.progress(0.6);
  shrinks(report);
  isCompressed(report);
}

}  // namespace tissue_contact
