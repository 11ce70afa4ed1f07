/// Forms G and H, drag: a sphere pressed without friction into the block of form H, then dragged by d with mu = 0.3. An
/// annulus slides while the centre holds: Q / (mu P) = 0.648 +- 0.006 at d = 0.6 d1, 0.9998 at 1.5 d1 after 2.65
/// microjoules of friction; P = 0.0613 N, d1 = 0.2642 mm; what holds has the radius a (1 - Q / (mu P))^(1/3).
/// Cattaneo 1938, Mindlin 1949, on this block by refined finite elements.
#include <cmath>
#include <utility>

#include "validation/closed_forms.h"
#include "validation/press_scene.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kMu = 0.3;
constexpr double kDepth = 0.000625;
constexpr double kSlideAll = 0.2642e-3;  // d1, m
constexpr double kContactRadius = 0.005;
constexpr double kPress = 0.0613;  // N
constexpr double kLoss = 2.65e-6;  // J, up to 1.5 d1
constexpr int kSteps = 50;
constexpr double kDragStep = 1.5 * kSlideAll / kSteps;  // m: 1.5 d1 in a second

/// Of the contacts between two radii, weighted by their normal force.
struct Ring {
  double held = 0.0;  ///< share of the force that static contacts carry
  double slip = 0.0;  ///< mean sliding speed over that of the sphere
};

class Drag {
 public:
  Drag() : simulator_(make()) {
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
  double loss() const { return loss_; }

  /// Q / (mu P) with both in the contacts' own planes, as the theory of a flat contact has them: friction along the drag
  /// over mu times the normal force. Their normals lean by up to a / R = 0.125.
  double share() const {
    double along = 0.0;
    double normal = 0.0;
    for (const SolvedContact& one : simulator_.contacts()) {
      const Vector3 n = one.contact.R_WC.col(0);
      const Vector3 direction = (Vector3::UnitX() - n.x() * n).normalized();
      along += direction.dot(one.force_on_tissue_n);
      normal += n.dot(one.force_on_tissue_n);
    }
    return along / (kMu * normal);
  }

  /// The same of the published wrench. The drag tilts the surface under the sphere a little, and the normal force with it.
  double worldShare() const { return -simulator_.wrench(1).force.x() / (kMu * normalForce()); }

  Ring ring(double inner, double outer) const {
    const Vector3 axis = simulator_.linkPoses(1).back().translation();
    const double speed = kDragStep / kPressStep;
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
    return {ring.held / all, ring.slip / all};  // NaN fails, if nothing touches there
  }

 private:
  static Vector3 away() { return {0.0, 0.0, 0.5}; }
  /// 1 mm cells, 4.8 per contact radius.
  static Simulator make() {
    PressScene scene;
    scene.mu = kMu;
    return makePress(scene);
  }

  double loss_ = 0.0;
  Simulator simulator_;
};

}  // namespace

void validatePartialSlip(Report& report) {
  constexpr const char* kTheory = "Cattaneo-Mindlin";
  Drag drag;
  const double press = drag.normalForce();
  report.near("press force", "N", 0.06166, press, 0.01 * press, "as in benchmark-block");
  for (int k = 1; k <= kSteps * 2 / 5; ++k) {
    drag.step(k * kDragStep);
    report.progress(static_cast<double>(k) / kSteps);
  }
  const double partly = drag.share();
  report.near("Q / (mu P) at 0.6 d1", "", 0.648, partly, 0.02, kTheory);
  const double held_radius = kContactRadius * std::cbrt(1.0 - partly);
  report.near("radius of what holds, at 0.6 d1", "m", kContactRadius * std::cbrt(1.0 - 0.648), held_radius,
              0.02 * kContactRadius, kTheory);
  // Cells of 1 mm spread the edge of what holds by half of theirs, hence 0.8 and 1.2 of it. Outside everything slips, by
  // 1 - 2/pi asin(c / r) of the sphere's motion: 0.37 at 1.2 c, 0.5 at the rim; half of that is left to the mesh.
  const Ring inside = drag.ring(0.0, 0.8 * held_radius);
  const Ring outside = drag.ring(1.2 * held_radius, 1.0);
  report.atLeast("share of the force held within 0.8 of that radius", "", 0.99, inside.held, kTheory);
  report.atMost("slip within 0.8 of that radius, of the sphere's speed", "", 0.01, inside.slip, kTheory);
  report.atMost("share of the force held beyond 1.2 of it", "", 0.0, outside.held, kTheory);
  report.atLeast("slip beyond 1.2 of it, least, of the sphere's speed", "", 0.2, outside.slip, kTheory);
  report.atMost("slip beyond 1.2 of it, most, of the sphere's speed", "", 0.6, outside.slip, kTheory);
  for (int k = kSteps * 2 / 5 + 1; k <= kSteps; ++k) {
    drag.step(k * kDragStep);
    report.progress(static_cast<double>(k) / kSteps);
  }
  report.near("Q / (mu P) at 1.5 d1", "", 0.9998, drag.share(), 0.001, kTheory);
  report.near("friction loss up to 1.5 d1, at the right P", "J", kLoss, drag.loss() / press * kPress, 0.03 * kLoss,
              "refined finite elements");
  report.note("Q / (mu P) of the published wrench at 1.5 d1, where the tilted surface turns the normal force: " +
              std::to_string(drag.worldShare()));
}

}  // namespace tissue_contact
