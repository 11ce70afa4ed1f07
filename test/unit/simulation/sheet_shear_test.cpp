/// Sheets that two tools hold between them: what each of the tools feels along the sheet (SheetThickness).
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/text_scene.h"

namespace tissue_contact {
namespace sheet_shear_test {

constexpr double kStep = 0.002;
constexpr double kThickness = 1e-3;  // m
constexpr double kHalfBox = 1e-3;    // m

/// A box of 2 mm height on joints along x and z.
std::string boxUrdf(const std::string& sides) {
  return "<robot name='box'><link name='base'/><link name='slide'/>"
         "<joint name='x' type='prismatic'><parent link='base'/><child link='slide'/><axis xyz='1 0 0'/>"
         "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
         "<joint name='z' type='prismatic'><parent link='slide'/><child link='tip'/><axis xyz='0 0 1'/>"
         "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
         "<link name='tip'><collision><geometry><box size='" +
         sides + " 0.002'/></geometry></collision></link></robot>";
}

std::string toolEntry(const std::string& name) {
  return "  - {name: " + name +
         ", robot_description: box, tip_link: tip, contact_links: [tip], joint_state_topics: [/" + name + "]}\n";
}

/// @param sheet its size, cells and what holds it. @param first, second `upper` and `lower`, in the order they have in the scene.
Simulator sheetBetween(const std::string& sheet, const std::string& fixed, const std::string& sides,
                       const std::string& first, const std::string& second, const std::string& end) {
  return makeSimulator("gravity_m_per_s2: [0, 0, 0]\ntissues:\n  - name: sheet\n    sheet: {" + sheet +
                           ", thickness_m: 0.001}\n    material: {youngs_modulus_pa: 50000, poissons_ratio: 0.3, "
                           "density_kg_per_m3: 1000}\n    damping: {stiffness_s: 0.005, mass_per_s: 20}\n" +
                           fixed + "instruments:\n" + toolEntry(first) + toolEntry(second) +
                           "friction: [{instrument: upper, tissue: sheet, static: 1.0}, {instrument: lower, tissue: "
                           "sheet, static: 1.0}]\n" +
                           end,
                       {{"box", boxUrdf(sides)}});
}

/// Position of a tool that is squeezed by a share of half the thickness into its side of the sheet.
Vector2 pressed(bool upper, double x, double share) {
  const double z = kHalfBox + 0.5 * kThickness * (1.0 - share);
  return {x, upper ? z : -z};
}

void placeClear(Simulator& simulator, bool upper_first, double x) {
  for (int i = 0; i < 2; ++i) simulator.placeInstrument(i, pressed((i == 0) == upper_first, x, -0.05));
}

/// Closes in .1 s, then shifts the upper tool by `upper_m` and the lower by `lower_m` in another .1 s and holds for .1 s.
void closeAndShift(Simulator& simulator, bool upper_first, double x, double upper_m, double lower_m) {
  for (int k = 1; k <= 150; ++k) {
    const double share = -0.05 + 0.25 * std::min(k / 50.0, 1.0);
    const double moved = std::clamp((k - 50) / 50.0, 0.0, 1.0);
    const auto at = [&](bool upper) { return VectorX(pressed(upper, x + moved * (upper ? upper_m : lower_m), share)); };
    simulator.advance(kStep, {at(upper_first), at(!upper_first)});
  }
}

// Boxes over all of a free sheet, the upper one shifted by 20 um: G A d / t, .0385 N. Without a compliance in shear it read 1.35 N
// (Gauss-Seidel) and 1.03 N (Cholesky), all that friction bears: both boxes held the same nodes.
TEST(SheetShear, PlatesMeetTheShearModulusOfTheSheet) {
  constexpr double kShift = 2e-5;
  const double expected = 50000.0 / 2.6 * 1e-4 * kShift / kThickness;
  for (const char* end :
       {"solver: {iterations: 300, tolerance: 1.0e-5}\n", "solver: {relaxation: cholesky, tolerance: 1.0e-5}\n",
        "solver: {method: reference}\n", "solver: {method: cone4, tolerance: 1.0e-5}\n"}) {
    Simulator simulator = sheetBetween("size_m: [0.01, 0.01], cells: [3, 3]", "", "0.02 0.02", "upper", "lower", end);
    placeClear(simulator, true, 0.0);
    closeAndShift(simulator, true, 0.0, kShift, 0.0);
    EXPECT_NEAR(simulator.wrench(0).force.x(), -expected, 5e-3 * expected) << end;
    EXPECT_NEAR(simulator.wrench(1).force.x(), expected, 5e-3 * expected) << end;
    EXPECT_EQ(simulator.report().static_contacts, static_cast<int>(simulator.contacts().size())) << end;
  }
}

// Two equal boxes pull at a sheet that is held at its other end: each has half the pull, whatever their order. Without a compliance in shear
// the first had -.0098 and the second .0013 N (Cholesky), or -.0085 and 0 (Gauss-Seidel), exchanged with their order.
TEST(SheetShear, JawsShareThePullWhateverTheirOrder) {
  const std::string fixed = "    fixed: [{plane: {point_m: [-0.009, 0, 0], normal: [1, 0, 0]}}]\n";
  for (const char* end :
       {"solver: {iterations: 300, tolerance: 1.0e-6}\n", "solver: {relaxation: cholesky, tolerance: 1.0e-6}\n"}) {
    for (const bool upper_first : {true, false}) {
      Simulator simulator = sheetBetween("size_m: [0.02, 0.005], cells: [12, 3]", fixed, "0.004 0.01",
                                         upper_first ? "upper" : "lower", upper_first ? "lower" : "upper", end);
      placeClear(simulator, upper_first, 0.007);
      closeAndShift(simulator, upper_first, 0.007, 5e-4, 5e-4);
      const double half = 0.5 * (simulator.wrench(0).force.x() + simulator.wrench(1).force.x());
      EXPECT_LT(half, -1e-3);
      for (int i = 0; i < 2; ++i) EXPECT_NEAR(simulator.wrench(i).force.x(), half, -0.01 * half) << end << upper_first;
    }
  }
}

}  // namespace sheet_shear_test
}  // namespace tissue_contact
