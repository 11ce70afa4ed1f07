/// @file
/// Two fingers close on a fin of tissue. They are what they touch, whether one instrument has both or two have one each: shapes of one instrument act as one
/// solid only where they meet (shape_union.h).
#include <gtest/gtest.h>

#include <string>

#include "support/text_scene.h"

namespace tissue_contact {
namespace round_fingers_test {

constexpr double kRadius = 0.009;  // m

/// Spheres that slide along x away from the middle, `fingers` of a and b.
std::string fingersUrdf(const std::string& fingers) {
  std::string urdf = "<robot name='hand'><link name='base'/>";
  for (const char finger : fingers) {
    const std::string name(1, finger), sign = finger == 'a' ? "1" : "-1";
    urdf += "<link name='" + name + "'><collision><geometry><sphere radius='" + std::to_string(kRadius) +
            "'/></geometry></collision></link><joint name='" + name +
            "_x' type='prismatic'><parent link='base'/><child link='" + name + "'/><axis xyz='" + sign +
            " 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>";
  }
  return urdf + "</robot>";
}

/// A fin of 20 kPa hangs from its upper edge at z = 0; the fingers stand 9 mm below.
Simulator fin(double thickness_m, bool one_instrument) {
  const auto hand = [](const std::string& fingers) {
    std::string links = fingers.substr(0, 1);
    if (fingers.size() > 1) links += ", " + fingers.substr(1);
    return "  - {name: " + fingers + ", robot_description: " + fingers + ", tip_link: base, contact_links: [" + links +
           "], joint_state_topics: [/" + fingers +
           "], base_pose: {position_m: [0, 0, -0.009]}, initial_joint_positions: {" + fingers.substr(0, 1) +
           "_x: 0.013" + (fingers.size() > 1 ? ", b_x: 0.013" : "") + "}}\n";
  };
  const auto friction = [](const std::string& fingers) {
    return "  - {instrument: " + fingers + ", tissue: fin, static: 0.6, kinetic: 0.5}\n";
  };
  return makeSimulator("tissues:\n  - name: fin\n    block: {size_m: [" + std::to_string(thickness_m) +
                           ", 0.03, 0.03], cells: [2, 12, 12]}\n    pose: {position_m: [0, 0, -0.03]}\n    fixed: "
                           "[{plane: {point_m: [0, 0, 0], normal: [0, 0, "
                           "1]}}]\n    material: {model: neo_hookean, youngs_modulus_pa: 20000, poissons_ratio: 0.4, "
                           "density_kg_per_m3: 1000}\n    damping: "
                           "{stiffness_s: 0.003, mass_per_s: 20}\ninstruments:\n" +
                           (one_instrument ? hand("ab") : hand("a") + hand("b")) + "friction:\n" +
                           (one_instrument ? friction("ab") : friction("a") + friction("b")) +
                           "step: {max_step_s: 0.005}\n",
                       {{"ab", fingersUrdf("ab")}, {"a", fingersUrdf("a")}, {"b", fingersUrdf("b")}});
}

/// Force along x on finger a, N, once the fingers stand `apart_m` from each other.
double squeeze(Simulator simulator, double apart_m) {
  const double open = 0.013, closed = kRadius + 0.5 * apart_m;
  for (int k = 1; k <= 60; ++k) {
    const double x = k < 40 ? open + k / 40.0 * (closed - open) : closed;
    std::vector<VectorX> positions;
    for (const Instrument& instrument : simulator.instruments()) {
      positions.push_back(VectorX::Constant(static_cast<Eigen::Index>(instrument.model().joints().size()), x));
    }
    simulator.advance(0.01, positions);
    EXPECT_FALSE(simulator.report().implausible_load.found);
  }
  double force = 0.0;
  for (const SolvedContact& contact : simulator.contacts()) {
    if (contact.force_on_tissue_n.x() < 0.0) force -= contact.force_on_tissue_n.x();
  }
  return force;
}

// Filled as if they met, they squeezed a fin that they do not touch with .12 N.
TEST(RoundFingers, AFinThatStandsClearFeelsNothing) { EXPECT_EQ(squeeze(fin(0.0015, true), 0.002), 0.0); }

// And one of 2 mm, closed to 1.2 mm, with .26 N in place of .1.
TEST(RoundFingers, OneInstrumentSqueezesAsTwoDo) {
  for (const double apart_m : {0.0016, 0.0012}) {
    const double one = squeeze(fin(0.002, true), apart_m), two = squeeze(fin(0.002, false), apart_m);
    EXPECT_GT(two, 0.02);
    EXPECT_NEAR(one, two, 0.01 * two);  // the solver's tolerance
  }
}

}  // namespace round_fingers_test
}  // namespace tissue_contact
