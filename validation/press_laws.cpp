/// What the choice of an elastic law does to the force of a press: frictionless spheres over one mesh each, linear, corotational
/// and stable neo-Hookean. The laws agree as strains go to 0 (form J), and part as they grow; which of them a tissue follows
/// is for measurements to say. Compared like with like, volume kept element by element; with patches (which the neo-Hookean law
/// lacks) beside.
#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "validation/closed_forms.h"
#include "validation/press_scene.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

struct Law {
  const char* model;
  const char* dilatation;
};
constexpr Law kNeoHookean = {"neo_hookean", ""};
constexpr Law kLaws[] = {
    {"linear", "element"}, {"corotational", "element"}, {"linear", "patch"}, {"corotational", "patch"}};

/// Forces, N, at each of the depths, m, one after the other.
std::vector<double> press(PressScene scene, const Law& law, const std::vector<double>& depths) {
  scene.model = law.model;
  scene.dilatation = law.dilatation;
  Simulator simulator = makePress(scene);
  const Vector3 away(0.0, 0.0, 0.5);
  std::vector<double> forces;
  double from = 0.0;
  for (const double depth : depths) {
    for (int k = 1; k <= 30; ++k) {
      const double share = std::min(1.0, k / 10.0);
      simulator.advance(kPressStep, {Vector3(0.0, 0.0, -(from + share * (depth - from))), away});
    }
    from = depth;
    forces.push_back(simulator.wrench(0).force.z());
  }
  return forces;
}

/// A note for each law: its force over the neo-Hookean one at each depth. Returns the first of each.
std::vector<double> compare(const std::string& name, const PressScene& scene, const std::vector<double>& depths,
                            Report& report) {
  const std::vector<double> of_neo_hookean = press(scene, kNeoHookean, depths);
  std::string text = name + ", neo-Hookean:";
  char part[80];
  for (std::size_t k = 0; k < depths.size(); ++k) {
    std::snprintf(part, sizeof part, "%s %.4g R: %.4g N", k > 0 ? "," : "", depths[k] / scene.radius_m,
                  of_neo_hookean[k]);
    text += part;
  }
  report.note(text);
  std::vector<double> first;
  for (const Law& law : kLaws) {
    const std::vector<double> forces = press(scene, law, depths);
    text = name + ", " + law.model + ", dilatation " + law.dilatation + ", over that:";
    for (std::size_t k = 0; k < depths.size(); ++k) {
      std::snprintf(part, sizeof part, "%s %.4g R: %+.1f %%", k > 0 ? "," : "", depths[k] / scene.radius_m,
                    100.0 * (forces[k] / of_neo_hookean[k] - 1.0));
      text += part;
    }
    report.note(text);
    first.push_back(forces[0] / of_neo_hookean[0]);
  }
  return first;
}

}  // namespace

void validatePressLaws(Report& report) {
  PressScene shallow;  // that of form H
  shallow.cells = {24, 24, 12};
  const std::vector<double> shallow_first =
      compare("form H, sphere of 40 mm", shallow, {6.25e-5, 0.000625, 0.0025}, report);
  report.progress(0.5);
  PressScene deep;
  deep.size_m = Vector3(0.1, 0.1, 0.04);
  deep.cells = {16, 16, 10};
  deep.growth = 1.3;
  deep.youngs_modulus_pa = 5e3;
  deep.radius_m = 0.005;
  const std::vector<double> deep_first =
      compare("deep press, sphere of 5 mm", deep, {1e-5, 0.00025, 0.0005, 0.001, 0.002, 0.003, 0.004}, report);
  const char* const source = "form J: the laws agree at small strain";
  const char* const names[] = {"linear", "corotational"};
  for (std::size_t k = 0; k < 2; ++k) {
    report.near(std::string("form H at 1/640 R: ") + names[k] + " over neo-Hookean", "", 1.0, shallow_first[k], 0.01,
                source);
    report.near(std::string("deep press at 1/500 R: ") + names[k] + " over neo-Hookean", "", 1.0, deep_first[k], 0.01,
                source);
  }
}

}  // namespace tissue_contact
