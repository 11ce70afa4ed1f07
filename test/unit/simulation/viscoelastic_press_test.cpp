/// A press that is held: a tissue whose stress relaxes is at first as stiff as an elastic one of its modulus at once, and in the
/// end as one of its relaxed modulus.
#include <gtest/gtest.h>

#include <sstream>

#include "simulation/moving_tissue.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace viscoelastic_press_test {

constexpr double kYoung = 6000.0;
constexpr double kPoisson = 0.4;
constexpr double kRatio = 1.5;  // of the term
constexpr double kTime = 0.5;   // s

/// A 5 mm ball over a block whose base is fixed, 0.1 mm above its middle at joints 0.
Simulator makeScene(const std::string& model, double youngs_modulus_pa, double poissons_ratio,
                    const std::string& more = "", const std::string& lines = "") {
  std::ostringstream yaml;
  yaml.precision(17);
  yaml << "tissues:\n  - name: block\n    block: {size_m: [0.06, 0.06, 0.02], cells: [8, 8, 4]}\n"
       << "    material: {model: " << model << ", youngs_modulus_pa: " << youngs_modulus_pa
       << ", poissons_ratio: " << poissons_ratio << ", density_kg_per_m3: 1000" << more << "}\n"
       << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
       << lines << onlyBall("[0.001, 0.002, 0.0251]")
       << "friction:\n  - {instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}\n"
       << "step: {max_step_s: 0.002}\ngravity_m_per_s2: [0, 0, 0]\n";
  return makeSimulator(yaml.str(), {{"probe", probeUrdf(0.005)}});
}

/// Pressed by 1.4 mm in 20 ms and held. Force along z at `times`, s; elastic tissue has long stopped swinging at 6 s.
std::vector<double> press(Simulator simulator, const std::vector<double>& times) {
  std::vector<double> forces;
  for (int k = 1; forces.size() < times.size(); ++k) {
    const double t = 0.002 * k;
    simulator.advance(0.002, {Vector3(0.0, 0.0, -std::min(0.075 * t, 0.0015))});
    if (t + 1e-9 >= times[forces.size()]) forces.push_back(simulator.wrench(0).force.z());
  }
  return forces;
}

class ViscoelasticPress : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Models, ViscoelasticPress,
                         ::testing::Values("linear, dilatation: patch, distortion: element",
                                           "corotational, dilatation: patch, distortion: element",
                                           "neo_hookean, dilatation: element",
                                           "neo_hookean, dilatation: patch, distortion: element"));

TEST_P(ViscoelasticPress, GoesFromTheModulusAtOnceToTheRelaxedOne) {
  const double shear = kYoung / (2.0 * (1.0 + kPoisson));
  const double bulk = kYoung / (3.0 * (1.0 - 2.0 * kPoisson));
  const auto elastic = [&](double G) {
    return press(
        makeScene(GetParam(), 9.0 * bulk * G / (3.0 * bulk + G), (3.0 * bulk - 2.0 * G) / (2.0 * (3.0 * bulk + G))),
        {6.0})[0];
  };
  std::ostringstream series;
  series << ", prony_series: [{modulus_ratio: " << kRatio << ", time_s: " << kTime << "}]";
  const std::vector<double> times = {0.1, 6.0};
  const std::vector<double> forces = press(makeScene(GetParam(), kYoung, kPoisson, series.str()), times);
  // At 0.1 s, about 0.09 s after the press: by the modulus then. Volume does not relax with it, and the ball has met more nodes
  // when the tissue was stiffer, hence the tolerance.
  const double at_once = elastic(shear * (1.0 + kRatio * std::exp(-0.09 / kTime)));
  EXPECT_NEAR(forces[0], at_once, 0.03 * at_once);
  const double relaxed = elastic(shear);
  EXPECT_NEAR(forces[1], relaxed, 0.01 * relaxed);
}

bool says(const Simulator& simulator, const std::string& text) {
  for (const Advice& line : simulator.advice()) {
    if (line.text.find(text) != std::string::npos) return true;
  }
  return false;
}

TEST(Viscoelastic, NeverSleepsAndSaysSo) {
  for (const std::string& series : {std::string(), std::string(", prony_series: [{modulus_ratio: 1, time_s: 100}]")}) {
    Simulator simulator = makeScene("corotational", kYoung, kPoisson, series);
    EXPECT_EQ(says(simulator, "never sleeps"), !series.empty());
    EXPECT_FALSE(says(simulator, "brakes too much"));
    for (int k = 1; k <= 1000; ++k) simulator.advance(0.002, {Vector3(0.0, 0.0, 0.01)});
    EXPECT_EQ(simulator.report().sleeping_nodes > 0, series.empty());
  }
  EXPECT_TRUE(says(makeScene("corotational", kYoung, kPoisson, ", prony_series: [{modulus_ratio: 1, time_s: 1e-3}]"),
                   "brakes too much"));
}

std::vector<Vector3> wrenches(Simulator& simulator) {
  std::vector<Vector3> forces;
  for (int k = 1; k <= 100; ++k) {
    simulator.advance(0.002, {Vector3(0.0, 0.0, -0.00015 * std::min(k, 10))});
    forces.push_back(simulator.wrench(0).force);
  }
  return forces;
}

// Also around attachments, which pass times on, and with a damping matrix.
TEST(Viscoelastic, AResetForgets) {
  Simulator simulator =
      makeScene("corotational", kYoung, kPoisson, ", prony_series: [{modulus_ratio: 1, time_s: 0.05}]",
                "    damping: {stiffness_s: 0.001}\n"
                "    attachments: [{where: [{plane: {point_m: [0.03, 0, 0], normal: [-1, 0, 0]}}],"
                " stiffness_pa_per_m: 1e4}]\n"
                "    regions: [{name: half, where: [{box: {min_m: [-1, -1, -1], max_m: [0, 1, 1]}}],"
                " damping: {stiffness_s: 0.003}}]\n");
  const std::vector<Vector3> first = wrenches(simulator);
  EXPECT_GT(first[10].z(), 1.3 * first[99].z()) << "nothing relaxed";
  simulator.reset();
  EXPECT_EQ(wrenches(simulator), first);
}

// What is thrown away is one answer, not what the tissue has gone through.
TEST(Viscoelastic, ADiscardedStepDoesNotStartItsMemoryAnew) {
  const Simulator simulator =
      makeScene("corotational", kYoung, kPoisson, ", prony_series: [{modulus_ratio: 3, time_s: 0.1}]");
  constexpr double kStep = 0.002;
  NodalVectors x;
  NodalVectors v;
  BodySystem system;
  MovingTissue tissue(simulator.scene(), ElasticModel::kCorotational, simulator.tissues()[0], x, v, system);
  x.row(0) += 0.1 * x.row(2);
  tissue.assemble(kStep);
  const double at_once = system.b.norm();
  for (int k = 0; k < 500; ++k) {
    tissue.move(kStep, 0.0, false, true);
    tissue.assemble(kStep);
  }
  const NodalVectors relaxed = system.b;
  EXPECT_LT(relaxed.norm(), 0.5 * at_once);
  tissue.stop();
  tissue.assemble(kStep);
  EXPECT_LT((system.b - relaxed).norm(), 1e-12 * relaxed.norm());
}

}  // namespace viscoelastic_press_test
}  // namespace tissue_contact
