/// Numbers that change while a scene is simulated: in force with the next step, everything else goes on, and a run in which they changed
/// before it began is the run of a scene that has them.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "support/refusal.h"
#include "support/text_scene.h"
#include "tissue_contact/scene/tuning.h"

namespace tissue_contact {
namespace retune_test {

const std::string kYoung = "tissues/block/youngs_modulus_pa";
const std::string kStatic = "friction/probe/block/static";
const std::string kKinetic = "friction/probe/block/kinetic";

/// A 5 mm ball, 0.1 mm above the middle of a block of 60 x 60 x 20 mm. @param lines of the tissue.
std::string sceneText(const std::string& material, const std::string& lines = "") {
  return blockScene("[0.06, 0.06, 0.02]", "[6, 6, 2]", material) + lines + onlyBall("[0.001, 0.002, 0.0251]") +
         "friction:\n  - {instrument: probe, tissue: block, static: 0.6, kinetic: 0.4}\nstep: {max_step_s: 0.002}\n";
}

Simulator simulatorOf(const std::string& material = "poissons_ratio: 0.4", const std::string& lines = "") {
  return makeSimulator(sceneText(material, lines), {{"probe", probeUrdf(0.005)}});
}

void change(Simulator& simulator, const std::vector<TunedNumber>& numbers) {
  simulator.retune(tuned(simulator.scene(), numbers));
}

/// Pressed 1.4 mm deep in 40 ms and held for 60 ms.
void press(Simulator& simulator) {
  for (int k = 1; k <= 50; ++k) simulator.advance(0.002, {Vector3(0.0, 0.0, -0.0015 * std::min(1.0, 0.05 * k))});
}

void hold(Simulator& simulator, int steps) {
  for (int k = 0; k < steps; ++k) simulator.advance(0.002, {simulator.jointPositions(0)});
}

double force(const Simulator& simulator) { return simulator.wrench(0).force.z(); }

// The ball holds the surface, so that the shape stays and the force is that of the new modulus at once: in the very next step.
TEST(Retune, TheForceFollowsYoungsModulusInTheNextStep) {
  for (const std::string model : {"model: linear", "model: corotational", "model: neo_hookean",
                                  "model: corotational, dilatation: patch", "model: mass_spring"}) {
    Simulator simulator = simulatorOf(model + ", poissons_ratio: 0.25");
    press(simulator);
    hold(simulator, 100);
    const double before = force(simulator);
    ASSERT_GT(before, 0.01) << model;
    change(simulator, {{kYoung, 10000.0}});
    EXPECT_EQ(force(simulator), before);  // nothing has moved yet
    hold(simulator, 1);
    EXPECT_NEAR(force(simulator), 2.0 * before, 0.05 * before) << model;
    hold(simulator, 100);
    EXPECT_NEAR(force(simulator), 2.0 * before, 0.05 * before) << model;
  }
}

TEST(Retune, UntilTheNextStepAllIsAsItWas) {
  Simulator simulator = simulatorOf();
  press(simulator);
  Simulator other = simulatorOf();
  press(other);
  change(simulator, {{kYoung, 20000.0}, {kStatic, 0.1}, {kKinetic, 0.05}, {"solver/iterations", 3.0}});
  EXPECT_EQ(simulator.scene().tissues[0].material.youngs_modulus_pa, 5000.0);
  EXPECT_EQ(simulator.residuals().momentum, other.residuals().momentum);
  EXPECT_EQ(simulator.residuals().cone_violation_n, other.residuals().cone_violation_n);
  EXPECT_EQ(simulator.forceErrors()[0].total_n(), other.forceErrors()[0].total_n());
  hold(simulator, 1);
  EXPECT_EQ(simulator.scene().tissues[0].material.youngs_modulus_pa, 20000.0);
  EXPECT_EQ(simulator.scene().solver.iterations, 3);
  EXPECT_LE(simulator.report().iterations, 3);
}

// The laws of the step before lie in a table that is made anew when the state is saved.
TEST(Retune, SavingBeforeTheNextStepLeavesItsResults) {
  const auto make = [] {
    return makeSimulator(blockScene("[0.06, 0.06, 0.02]", "[6, 6, 2]", "poissons_ratio: 0.4") +
                             onlyBall("[0.001, 0.002, 0.0251]") +
                             "friction:\n  - {instrument: probe, tissue: block, law: orthotropic, static: [0.3, 0.6], "
                             "kinetic: [0.2, 0.4], axis: {link_direction: [1, 0, 0]}}\nstep: {max_step_s: 0.002}\n",
                         {{"probe", probeUrdf(0.005)}});
  };
  Simulator simulator = make();
  Simulator other = make();
  for (Simulator* one : {&simulator, &other}) {
    press(*one);
    for (int k = 1; k <= 20; ++k) one->advance(0.002, {Vector3(1e-4 * k, 0.0, -0.0015)});
    change(*one, {{kYoung, 20000.0}});
  }
  simulator.saveState();
  EXPECT_EQ(simulator.residuals().momentum, other.residuals().momentum);
  EXPECT_EQ(simulator.residuals().cone_violation_n, other.residuals().cone_violation_n);
  EXPECT_EQ(simulator.residuals().kinetic_angle_rad, other.residuals().kinetic_angle_rad);
  EXPECT_EQ(simulator.forceErrors()[0].total_n(), other.forceErrors()[0].total_n());
  EXPECT_EQ(simulator.wrench(0).force, other.wrench(0).force);
  hold(simulator, 3);
  hold(other, 3);
  EXPECT_EQ(simulator.wrench(0).force, other.wrench(0).force);
}

std::vector<Vector3> forcesOf(Simulator& simulator) {
  std::vector<Vector3> forces;
  for (int k = 1; k <= 60; ++k) {
    simulator.advance(0.002, {Vector3(1e-4 * std::max(0, k - 30), 0.0, -0.0015 * std::min(1.0, 0.05 * k))});
    forces.push_back(simulator.wrench(0).force);
  }
  return forces;
}

struct Number {
  std::string key;
  double value;
  std::string in_scene;  ///< the text of the scene that has it
};

std::string replacedIn(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}

TEST(Retune, BeforeTheFirstStepAndAfterAResetItIsAnotherScene) {
  const std::string region =
      "    regions: [{name: stiff, where: [{box: {min_m: [-1, -1, 0.01], max_m: [0.03, 1, 1]}}], "
      "material: {youngs_modulus_pa: 9000, poissons_ratio: 0.4}}]\n";
  const std::string text = sceneText("poissons_ratio: 0.4", region);
  const std::vector<Number> numbers = {
      {kYoung, 7000.0, replacedIn(text, "youngs_modulus_pa: 5000", "youngs_modulus_pa: 7000")},
      {"tissues/block/poissons_ratio", 0.2, replacedIn(text, "poissons_ratio: 0.4", "poissons_ratio: 0.2")},
      {"tissues/block/damping_stiffness_s", 0.01, replacedIn(text, "stiffness_s: 0.003", "stiffness_s: 0.01")},
      {"tissues/block/damping_mass_per_s", 50.0,
       replacedIn(text, "stiffness_s: 0.003", "stiffness_s: 0.003, mass_per_s: 50")},
      {"tissues/block/regions/stiff/youngs_modulus_pa", 2000.0, replacedIn(text, ": 9000", ": 2000")},
      {kStatic, 0.9, replacedIn(text, "static: 0.6", "static: 0.9")},
      {kKinetic, 0.1, replacedIn(text, "kinetic: 0.4", "kinetic: 0.1")},
      {"solver/tolerance", 1e-7, text + "solver: {tolerance: 1.0e-7}\n"},
      {"solver/contact_passes", 1.0, text + "solver: {contact_passes: 1}\n"},
  };
  const std::map<std::string, std::string> urdfs = {{"probe", probeUrdf(0.005)}};
  Simulator plain = makeSimulator(text, urdfs);
  const std::vector<Vector3> plain_forces = forcesOf(plain);
  for (const Number& number : numbers) {
    Simulator wanted = makeSimulator(number.in_scene, urdfs);
    const std::vector<Vector3> forces = forcesOf(wanted);
    EXPECT_NE(forces, plain_forces) << number.key;
    Simulator simulator = makeSimulator(text, urdfs);
    change(simulator, {{number.key, number.value}});
    EXPECT_EQ(forcesOf(simulator), forces) << number.key;
    simulator.reset();
    EXPECT_EQ(forcesOf(simulator), forces) << number.key;
    simulator.reset();
    const Scene again = parseScene(text, "text scene", nullptr);
    simulator.retune(again);
    EXPECT_EQ(forcesOf(simulator), plain_forces) << number.key;
  }
}

TEST(Retune, WhatIsHeldSlidesWhereFrictionNoLongerBearsIt) {
  Simulator simulator = simulatorOf();
  press(simulator);
  for (int k = 1; k <= 20; ++k) simulator.advance(0.002, {Vector3(2e-5 * k, 0.0, -0.0015)});
  hold(simulator, 50);
  ASSERT_EQ(simulator.report().kinetic_contacts, 0);
  ASSERT_GT(simulator.report().static_contacts, 0);
  const Vector3 held = simulator.wrench(0).force;
  const double ratio = held.head<2>().norm() / held.z();
  ASSERT_GT(ratio, 0.05);
  change(simulator, {{kStatic, 0.2 * ratio}, {kKinetic, 0.2 * ratio}});
  hold(simulator, 1);
  EXPECT_GT(simulator.report().kinetic_contacts, 0);
  EXPECT_LT(simulator.wrench(0).force.head<2>().norm(), 0.5 * held.head<2>().norm());
}

// Nothing touches: the block stays at rest, and asleep parts wake without harm.
TEST(Retune, WhatIsUntouchedStaysAtRest) {
  Simulator simulator = simulatorOf();
  for (int k = 0; k < 200; ++k) simulator.advance(0.002, {Vector3::Zero()});
  change(simulator, {{kYoung, 8000.0}});
  for (int k = 0; k < 200; ++k) simulator.advance(0.002, {Vector3::Zero()});
  const double farthest_m = (simulator.positions(0) - simulator.tissues()[0].restPositions()).cwiseAbs().maxCoeff();
  EXPECT_LT(farthest_m, 1e-15);  // rounding of rotations that are none
  EXPECT_EQ(simulator.wrench(0).force, Vector3(0.0, 0.0, 0.0));
}

// A stress that has half relaxed is a multiple of the modulus: were it forgotten, the force would fall to the relaxed one.
TEST(Retune, BodiesRememberTheirStrain) {
  Simulator simulator = simulatorOf("poissons_ratio: 0.4, prony_series: [{modulus_ratio: 3, time_s: 0.3}]");
  press(simulator);
  hold(simulator, 50);
  const double before = force(simulator);
  Simulator relaxed = simulatorOf();
  press(relaxed);
  hold(relaxed, 50);
  ASSERT_GT(before, 1.5 * force(relaxed));
  change(simulator, {{kYoung, 10000.0}});
  hold(simulator, 1);
  EXPECT_NEAR(force(simulator), 2.0 * before, 0.1 * before);
}

TEST(Retune, AMeshThatFollowsHasTheNumbersToo) {
  const std::string lines = "    refinement: auto\n";
  Simulator simulator = simulatorOf("poissons_ratio: 0.4", lines);
  Simulator other = simulatorOf("poissons_ratio: 0.4", lines);
  for (Simulator* one : {&simulator, &other}) press(*one);
  change(simulator, {{kYoung, 10000.0}});
  const int revision = simulator.meshRevision(0);
  for (int k = 1; k <= 400; ++k) {
    for (Simulator* one : {&simulator, &other}) one->advance(0.002, {Vector3(5e-5 * std::min(k, 300), 0.0, -0.0015)});
  }
  ASSERT_GT(simulator.meshRevision(0), revision);
  EXPECT_NEAR(force(simulator), 2.0 * force(other), 0.05 * force(other));
}

// In a process that has been told the numbers and has not stepped yet, too.
TEST(Retune, AStateGoesOnWhereTheNumbersAreTheSame) {
  Simulator first = simulatorOf();
  change(first, {{kYoung, 10000.0}});
  press(first);
  Simulator second = simulatorOf();
  expectRefusal([&] { second.restoreState(first.saveState()); }, {"material", "change it likewise"});
  change(second, {{kYoung, 10000.0}});
  second.restoreState(first.saveState());
  for (Simulator* one : {&first, &second}) hold(*one, 5);
  EXPECT_EQ(force(first), force(second));
  EXPECT_GT(force(first), 0.0);
}

TEST(Retune, RefusesAnotherSceneAndChangesNothing) {
  Simulator simulator = simulatorOf();
  Scene other = simulator.scene();
  other.tissues[0].name = "liver";
  expectRefusal([&] { simulator.retune(other); }, {"limits of the solver only"});
  other = simulator.scene();
  other.friction.clear();
  other.tissues[0].material.youngs_modulus_pa = 1.0;
  expectRefusal([&] { simulator.retune(other); }, {"limits of the solver only"});
  hold(simulator, 1);
  EXPECT_EQ(simulator.scene().tissues[0].material.youngs_modulus_pa, 5000.0);
}

// What it does not take would go on as it was, and the forces of one scene be taken for those of the other.
TEST(Retune, RefusesAScenesOtherPartsByName) {
  Simulator simulator = simulatorOf();
  const auto expectRefused = [&](const std::string& name, const std::function<void(Scene&)>& differ) {
    Scene other = simulator.scene();
    differ(other);
    expectRefusal([&] { simulator.retune(other); }, {"limits of the solver only", "this one has other " + name});
  };
  expectRefused("the mesh of a tissue",
                [](Scene& s) { std::get<BlockDescription>(s.tissues[0].geometry).cells[0] = 7; });
  expectRefused("the mesh of a tissue", [](Scene& s) { s.tissues[0].geometry = MeshDescription(); });
  expectRefused("tissues[].refinement",
                [](Scene& s) { s.tissues[0].refinement.mode = RefinementDescription::Mode::kAuto; });
  expectRefused("a tissue's material", [](Scene& s) { s.tissues[0].material.model = ElasticModel::kNeoHookean; });
  expectRefused("tissues[].fixed", [](Scene& s) { s.tissues[0].fixed.clear(); });
  expectRefused("tissues[].pressure_pa", [](Scene& s) { s.tissues[0].pressure_pa = 100.0; });
  expectRefused("instruments", [](Scene& s) { s.instruments[0].urdf_file = "/other.urdf"; });
  expectRefused("friction", [](Scene& s) { s.friction.clear(); });
  expectRefused("gravity_m_per_s2", [](Scene& s) { s.gravity_m_per_s2.z() = -9.81; });
  expectRefused("step", [](Scene& s) { s.step.max_step_s = 0.001; });
  expectRefused("solver.method", [](Scene& s) { s.solver.method = SolverMethod::kReference; });
  expectRefused("tissues[].material.prony_series", [](Scene& s) { s.tissues[0].material.prony_series = {{0.5, 1.0}}; });
  expectRefused("tissues[].pose", [](Scene& s) { s.tissues[0].pose.X.translation().x() = 0.01; });
  expectRefused("tissues[].attachments", [](Scene& s) { s.tissues[0].attachments.emplace_back(); });
  expectRefused("tissues[].regions", [](Scene& s) { s.tissues[0].regions.emplace_back(); });
  expectRefused("instruments", [](Scene& s) { s.instruments[0].base_pose.X.translation().z() = 0.1; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.kind = FrictionLawDescription::Kind::kOrthotropic; });
  expectRefused("solver.relaxation", [](Scene& s) { s.solver.relaxation = RelaxationKind::kCholesky; });
  expectRefused("the mesh of a tissue", [](Scene& s) {
    std::get<BlockDescription>(s.tissues[0].geometry).grading[2].fine_at = AxisGrading::FineAt::kMaximum;
  });
  expectRefused("tissues[].fibre_direction", [](Scene& s) { s.tissues[0].fibre_direction = Vector3::UnitX(); });
  expectRefused("instruments", [](Scene& s) { s.instruments[0].initial_joint_positions = {{"x", 0.001}}; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.speeds_m_per_s = {0.0}; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.speed_factors = {0.5}; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.pressures_pa = {0.0}; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.pressure_factors = {0.5}; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.angles_rad = {0.0}; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.axis = FrictionLawDescription::Axis::kFibre; });
  expectRefused("friction", [](Scene& s) { s.friction[0].law.link_axis = Vector3::UnitY(); });
  expectRefused("solver.cone_sides", [](Scene& s) { s.solver.cone_sides = 16; });
  expectRefused("solver.time_budget_s", [](Scene& s) { s.solver.time_budget_s = 0.001; });
  expectRefused("advisor", [](Scene& s) { s.advisor.sleep = false; });
  expectRefused("tissue_pairs", [](Scene& s) { s.tissue_pairs.push_back({"block", "block"}); });
}

}  // namespace retune_test
}  // namespace tissue_contact
