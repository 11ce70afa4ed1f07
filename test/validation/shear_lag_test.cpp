/// Form D: an elastic strip on a floor with friction, pulled at one end by F. It slips over the length F / (mu w), w its
/// weight per length; its end has moved by F^2 / (2 E A mu w); half of that is left after unloading; a cycle between
/// -F and F costs 2 F^3 / (3 E A mu w). A membrane of nu = 0; the end is fixed and the floor moves, which is the same.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "validation/text_scene.h"

namespace tissue_contact {
namespace {

constexpr double kLength = 0.3;
constexpr double kWidth = 0.02;
constexpr double kThickness = 0.002;
constexpr double kMu = 0.5;
constexpr double kYoung = 1e5;                                       // Pa
constexpr double kEA = kYoung * kWidth * kThickness;                 // 4 N
constexpr double kLoad = kMu * 1000.0 * 9.81 * kWidth * kThickness;  // mu w, 0.196 N/m
constexpr double kSlipLength = 0.2;
constexpr double kForce = kLoad * kSlipLength;                                  // 0.039 N
constexpr double kEnd = kForce * kForce / (2.0 * kEA * kLoad);                  // 0.98 mm
constexpr double kLoss = 2.0 * kForce * kForce * kForce / (3.0 * kEA * kLoad);  // per cycle, J

/// The strip's right end is fixed; the floor below it moves along x.
class Strip {
 public:
  explicit Strip(int cells) : simulator_(make(cells)) {}

  /// Moves the floor until the strip's end has been pulled by `end_m` relative to it, at most 2 mm/s, taking note of
  /// force and loss on the way: a fiftieth of the speed at which inertia and waves would show (E A / c / 50 < F / 100).
  template <typename Observer>
  void pull(double end_m, const Observer& observer) {
    const double from = end_;
    const int steps = static_cast<int>(std::ceil(std::abs(end_m - from) / (kSpeed * kStep)));
    for (int k = 1; k <= steps; ++k) {
      end_ = from + (end_m - from) * k / steps;
      simulator_.advance(kStep, {VectorX::Constant(1, -end_)});
      observer();
    }
  }
  void pull(double end_m) {
    pull(end_m, [] {});
  }

  double end() const { return end_; }
  /// What pulls: all of the friction on the floor.
  double force() const { return simulator_.wrench(0).force.x(); }

  /// How far from the pulled end the strip slides, m: the farthest sliding contact.
  double slipLength() const {
    double farthest = 0.0;
    for (const SolvedContact& one : simulator_.contacts()) {
      if (one.state != ContactState::kKinetic) continue;
      farthest = std::max(farthest, 0.5 * kLength - one.contact.p_WC.x());
    }
    return farthest;
  }

 private:
  static constexpr double kSpeed = 0.002;
  static constexpr double kStep = 0.002;

  static Simulator make(int cells) {
    std::ostringstream yaml;
    yaml << "gravity_m_per_s2: [0, 0, -9.81]\n"
         << "tissues:\n  - name: strip\n    sheet: {size_m: [" << kLength << ", " << kWidth << "], cells: [" << cells
         << ", 1], thickness_m: " << kThickness << "}\n"
         << "    material: {youngs_modulus_pa: " << kYoung
         << ", poissons_ratio: 0, density_kg_per_m3: 1000, bending_stiffness_n_m: 0}\n"
         << "    damping: {stiffness_s: 0.005}\n"
         << "    fixed: [{plane: {point_m: [" << 0.5 * kLength << ", 0, 0], normal: [-1, 0, 0]}}]\n"
         << "instruments:\n  - {name: floor, robot_description: floor, tip_link: table, contact_links: [table],"
         << " joint_state_topics: [/floor], base_pose: {position_m: [0, 0, " << -0.5 * kThickness << "]}}\n"
         << "friction:\n  - {instrument: floor, tissue: strip, static: " << kMu << "}\n"
         << "step: {max_step_s: " << kStep << "}\nsolver: {iterations: 400, tolerance: 1.0e-6}\n";
    return makeSimulator(yaml.str(), {{"floor", movingTableUrdf()}});
  }

  Simulator simulator_;
  double end_ = 0.0;
};

struct Measured {
  double force, slip_length, left;
};

Measured loadAndUnload(int cells) {
  Strip strip(cells);
  strip.pull(kEnd);
  Measured measured = {strip.force(), strip.slipLength(), 0.0};
  double end = strip.end();
  double force = strip.force();
  strip.pull(0.2 * kEnd, [&] {
    if (force > 0.0 && strip.force() <= 0.0) {
      measured.left = end + (strip.end() - end) * force / (force - strip.force());
    }
    end = strip.end();
    force = strip.force();
  });
  return measured;
}

TEST(ShearLag, SlipLengthForceAndWhatIsLeftAfterUnloading) {
  for (const int cells : {75, 150}) {
    const Measured measured = loadAndUnload(cells);
    const double cell = kLength / cells;
    std::cout << cells << " cells: force " << measured.force << " N (" << kForce << "), slip length "
              << measured.slip_length << " m (" << kSlipLength << "), left " << measured.left << " m (" << 0.5 * kEnd
              << ")\n";
    EXPECT_NEAR(measured.force, kForce, 0.02 * kForce);
    EXPECT_NEAR(measured.slip_length, kSlipLength, 2.0 * cell);
    EXPECT_NEAR(measured.left, 0.5 * kEnd, 0.02 * 0.5 * kEnd);
  }
}

TEST(ShearLag, LossOfACycle) {
  Strip strip(75);
  strip.pull(kEnd);
  double loss = 0.0;
  double end = strip.end();
  double force = strip.force();
  const auto sum = [&] {
    loss += 0.5 * (force + strip.force()) * (strip.end() - end);
    end = strip.end();
    force = strip.force();
  };
  strip.pull(-kEnd, sum);
  const double back = strip.force();
  strip.pull(kEnd, sum);
  std::cout << "force " << back << " and " << strip.force() << " N (" << kForce << "), loss " << loss << " J (" << kLoss
            << ")\n";
  EXPECT_NEAR(back, -kForce, 0.02 * kForce);
  EXPECT_NEAR(loss, kLoss, 0.03 * kLoss);
}

}  // namespace
}  // namespace tissue_contact
