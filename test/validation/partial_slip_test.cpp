/// Form G on the block of form H: a sphere pressed without friction, then dragged by d with mu = 0.3. An annulus slides
/// while the centre holds: Q / (mu P) = 0.648 at d = 0.6 d1, all slides at 1.5 d1 (0.9998) after 2.65 microjoules of
/// friction; P = 0.0613 N, d1 = 0.2642 mm; the part that holds has the radius a (1 - Q / (mu P))^(1/3).
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "validation/press_scene.h"

namespace tissue_contact {
namespace {

constexpr double kMu = 0.3;
constexpr double kDepth = 0.000625;
constexpr double kSlideAll = 0.2642e-3;  // d1, m
constexpr double kContactRadius = 0.005;
constexpr double kPress = 0.0613;  // N
constexpr double kLoss = 2.65e-6;  // J, up to 1.5 d1

/// Of the contacts between two radii, weighted by their normal force.
struct Ring {
  double held = 0.0;  ///< share of the force that static contacts carry
  double slip = 0.0;  ///< mean sliding speed over that of the sphere
};

class Drag {
 public:
  Drag(int cells, double growth) : simulator_(make(cells, growth)) {
    // The loss: what friction takes from sliding contacts, step by step.
    simulator_.setStepObserver([this] {
      const ContactProblem& problem = simulator_.lastProblem();
      const ContactSolution& solution = simulator_.lastSolution();
      for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
        if (solution.states[c] != ContactState::kKinetic) continue;
        const Vector2 slip = relativeVelocity(problem.contacts[c], solution.v).tail<2>();
        loss_ -= slip.dot(solution.impulses[c].tail<2>());
      }
    });
    pressSmooth(simulator_, kDepth, 10);
    // Frictionless press: the rough sphere takes the smooth one's place.
    simulator_.placeInstrument(0, away());
    simulator_.placeInstrument(1, Vector3(0.0, 0.0, -kDepth));
    for (int k = 0; k < 5; ++k) step(0.0);
    loss_ = 0.0;
  }
  Drag(const Drag&) = delete;
  Drag& operator=(const Drag&) = delete;

  void step(double d) { simulator_.advance(kPressStep, {away(), Vector3(d, 0.0, -kDepth)}); }

  double normalForce() const { return simulator_.wrench(1).force.z(); }
  double share() const { return -simulator_.wrench(1).force.x() / (kMu * normalForce()); }  ///< Q / (mu P)
  double loss() const { return loss_; }

  /// @param speed of the sphere in the last step, m/s.
  Ring ring(double inner, double outer, double speed) const {
    const Vector3 axis = simulator_.linkPoses(1).back().translation();
    Ring ring;
    double all = 0.0;
    for (std::size_t c = 0; c < simulator_.contacts().size(); ++c) {
      const SolvedContact& one = simulator_.contacts()[c];
      const double radius = (one.contact.p_WC - axis).head<2>().norm();
      if (radius < inner || radius >= outer) continue;
      const double force = one.contact.R_WC.col(0).dot(one.force_on_tissue_n);
      const Vector3 u = relativeVelocity(simulator_.lastProblem().contacts[c], simulator_.lastSolution().v);
      all += force;
      if (one.state == ContactState::kStatic) ring.held += force;
      ring.slip += force * u.tail<2>().norm() / speed;
    }
    EXPECT_GT(all, 0.0);
    return {ring.held / all, ring.slip / all};
  }

 private:
  static Vector3 away() { return {0.0, 0.0, 0.5}; }
  static Simulator make(int cells, double growth) {
    PressScene scene;
    scene.cells = {cells, cells, cells / 2};
    scene.growth = growth;
    scene.mu = kMu;
    return makePress(scene);
  }

  double loss_ = 0.0;
  Simulator simulator_;
};

constexpr double kDragStep = 1.5 * kSlideAll / 50;  // m: 1.5 d1 in a second

// The mesh makes the normal force 16 % too large at 1.6 mm cells and 7 % at 1 mm (see indentation_test.cpp), and with it
// d1 and the loss, which go with it; the shares of mu P do not. 1 % is what the closed form's own 0.006 and steps of the
// mesh leave. At 1.5 d1, 0.7 % more than mu P: a faceted surface that is dragged under a sphere ploughs.
TEST(PartialSlip, DragForceAndLoss) {
  for (const auto& [cells, growth] : {std::pair(16, 1.23), std::pair(24, 1.15)}) {
    Drag drag(cells, growth);
    for (int k = 1; k <= 20; ++k) drag.step(k * kDragStep);  // 0.6 d1
    const double press = drag.normalForce();
    const double partly = drag.share();
    for (int k = 21; k <= 50; ++k) drag.step(k * kDragStep);
    const double loss = drag.loss() / press * kPress;
    std::cout << cells << " cells across: P " << press << " N (" << kPress << "), Q/(mu P) " << partly
              << " at 0.6 d1 (0.648), " << drag.share() << " at 1.5 d1 (0.9998), loss " << drag.loss() << " J, " << loss
              << " J at the right P (" << kLoss << ")\n";
    EXPECT_NEAR(partly, 0.648, 0.01);
    EXPECT_NEAR(drag.share(), 0.9998, 0.01);
    EXPECT_NEAR(loss, kLoss, 0.03 * kLoss);
    const Ring all = drag.ring(0.0, 1.0, kDragStep / kPressStep);
    EXPECT_LE(all.held, 0.02);
    EXPECT_GE(all.slip, 0.9);
  }
}

// At 0.6 d1 c = 3.5 mm of a = 5 mm. Inside, nothing slips; there are more contact points than the nodes below them could
// hold one by one, so some are called kinetic all the same and give way by a few per cent of the sphere's motion. Outside,
// everything slips, by 1 - 2/pi asin(c/r) of that motion: 0.37 at 1.2 c, 0.5 at the rim. Cells of 1 mm spread c by half of
// theirs, which leaves 0.2 to 0.35.
TEST(PartialSlip, AnnulusSlidesWhileTheCentreHolds) {
  Drag drag(24, 1.15);
  for (int k = 1; k <= 20; ++k) drag.step(k * kDragStep);
  const double held_radius = kContactRadius * std::cbrt(1.0 - drag.share());
  const Ring inside = drag.ring(0.0, 0.8 * held_radius, kDragStep / kPressStep);
  const Ring outside = drag.ring(1.2 * held_radius, 1.0, kDragStep / kPressStep);
  std::cout << "c " << held_radius << " m (0.00353); within 0.8 c " << inside.held << " of the force is held, slip "
            << inside.slip << " of the sphere's speed; beyond 1.2 c " << outside.held << ", " << outside.slip << "\n";
  EXPECT_NEAR(held_radius, kContactRadius * std::cbrt(1.0 - 0.648), 0.01 * kContactRadius);
  EXPECT_GE(inside.held, 0.5);
  EXPECT_LE(inside.slip, 0.02);
  EXPECT_EQ(outside.held, 0.0);
  EXPECT_GE(outside.slip, 0.15);
}

}  // namespace
}  // namespace tissue_contact
