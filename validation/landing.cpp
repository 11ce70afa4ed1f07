/// Forms G and H, landing: a sphere that arrives at 70 mm/s in steps of 20 ms, 1.4 mm each, so that all its contacts begin
/// within one step. What it moves over the tissue before it touches is no sliding: a drag from there must find what it finds
/// after a slow landing, Q / (mu P) = 0.648 +- 0.006 at d = 0.6 d1, P = 0.0613 N.
#include <cmath>
#include <string>

#include "validation/closed_forms.h"
#include "validation/press_scene.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kMu = 0.3;
constexpr double kDepth = 0.000625;
constexpr double kSlideAll = 0.2642e-3;  // d1, m
constexpr double kPress = 0.0613;        // N
constexpr double kFast = 0.07;           // m/s
constexpr double kSlowed = 2e-5;         // m: the end of a slow landing, in steps of a fifth of it
constexpr int kDragSteps = 20;

struct Landed {
  double kinetic = 0.0;  ///< share of the normal force that slides after the step that landed
  double press = 0.0;    ///< N, before the drag
  double share = 0.0;    ///< Q / (mu P) at 0.6 d1
};

class Landing {
 public:
  Landing(int cells, const std::string& solver) : simulator_(make(cells, solver)) {}
  Landing(const Landing&) = delete;
  Landing& operator=(const Landing&) = delete;

  /// The smooth sphere presses; the rough one comes down into its place, and takes it.
  Landed intoTheDimple(bool slow) {
    pressSmooth(simulator_, kDepth, 10);
    smooth_ = pressed();
    comeDown(slow ? kSlowed : 0.0);
    const double kinetic = kineticShare();
    smooth_ = away();
    simulator_.placeInstrument(0, smooth_);
    return drag(kinetic);
  }

  /// The rough sphere alone, onto the flat face; after `before` presses that end a sphere's radius above it.
  Landed ontoTheFace(int before, bool slow = false) {
    for (int press = 0; press < before; ++press) {
      comeDown(0.0);
      for (int k = 1; k <= 20; ++k) step(pressed() + Vector3(0.0, 0.0, 0.002 * k));
    }
    comeDown(slow ? kDepth : 0.0);
    return drag(kineticShare());
  }

 private:
  static Vector3 away() { return {0.0, 0.0, 0.5}; }
  static Vector3 pressed() { return {0.0, 0.0, -kDepth}; }
  static Simulator make(int cells, const std::string& solver) {
    PressScene scene;
    scene.cells = {cells, cells, cells / 2};
    scene.growth = std::pow(1.3, 10.0 / cells);
    scene.mu = kMu;
    scene.solver = solver;
    return makePress(scene);
  }

  void step(const Vector3& rough) { simulator_.advance(kPressStep, {smooth_, rough}); }

  /// At kFast to `short_of` above the depth, and slowly from there on.
  void comeDown(double short_of) {
    const Vector3 up = Vector3::UnitZ();
    const Vector3 stop = pressed() + short_of * up;
    simulator_.placeInstrument(1, stop + 3.0 * kFast * kPressStep * up);
    for (int k = 2; k >= 0; --k) step(stop + k * kFast * kPressStep * up);
    for (int k = 4; k >= 0 && short_of > 0.0; --k) step(pressed() + 0.2 * k * short_of * up);
  }

  Landed drag(double kinetic) {
    for (int k = 0; k < 5; ++k) step(pressed());
    const double press = simulator_.wrench(1).force.z();
    for (int k = 1; k <= kDragSteps; ++k) step(pressed() + Vector3(0.6 * kSlideAll * k / kDragSteps, 0.0, 0.0));
    return {kinetic, press, share()};
  }

  /// As the theory of a flat contact has it, in the contacts' own planes.
  double share() const {
    double along = 0.0;
    double normal = 0.0;
    for (const SolvedContact& one : simulator_.contacts()) {
      const Vector3 n = one.contact.R_WC.col(0);
      along += (Vector3::UnitX() - n.x() * n).normalized().dot(one.force_on_tissue_n);
      normal += n.dot(one.force_on_tissue_n);
    }
    return along / (kMu * normal);
  }

  double kineticShare() const {
    double kinetic = 0.0;
    double all = 0.0;
    for (const SolvedContact& one : simulator_.contacts()) {
      if (one.contact.key.instrument != 1) continue;
      const double force = one.contact.R_WC.col(0).dot(one.force_on_tissue_n);
      all += force;
      if (one.state == ContactState::kKinetic) kinetic += force;
    }
    return kinetic / all;  // NaN fails, if nothing touches
  }

  Simulator simulator_;
  Vector3 smooth_ = away();
};

void intoTheDimple(Report& report, const std::string& name, int cells, const std::string& solver, double cone) {
  const Landed slow = Landing(cells, solver).intoTheDimple(true);
  const Landed fast = Landing(cells, solver).intoTheDimple(false);
  // The dimple springs back between the spheres by what the solver's tolerance leaves; a cone of few sides turns friction a
  // little with the state it starts from.
  report.near(name + ": press force after a fast landing, as after a slow one", "N", slow.press, fast.press,
              1e-3 * kPress, "nothing slid");
  report.near(name + ": Q / (mu P) at 0.6 d1 after a fast landing", "", slow.share, fast.share, cone, "slow landing");
  report.atMost(name + ": share of the force that slides in the step that lands", "", 0.01, fast.kinetic,
                "nothing slid");
}

// Onto the face the spheres' contacts begin one after the other within the step, and the tissue beside the first ones moves
// before it is touched: 0.02 as for the drag after a frictionless press. Where friction acts too early the press force is larger.
void ontoTheFace(Report& report) {
  const std::string solver = PressScene().solver;
  const Landed once = Landing(20, solver).ontoTheFace(0);
  const Landed slow = Landing(20, solver).ontoTheFace(0, true);
  report.near("onto the face: press force", "N", slow.press, once.press, 2e-3 * kPress, "the same, slowly");
  report.near("onto the face: Q / (mu P) at 0.6 d1", "", 0.648, once.share, 0.02, "Cattaneo-Mindlin");
  // The tissue is at rest again, and no contact has a history.
  const Landed again = Landing(20, solver).ontoTheFace(2);
  report.near("onto the face, third landing: press force", "N", once.press, again.press, 1e-3 * kPress,
              "first landing");
  report.near("onto the face, third landing: Q / (mu P) at 0.6 d1", "", once.share, again.share, 2e-3, "first landing");
}

}  // namespace

void validateLanding(Report& report) {
  intoTheDimple(report, "gauss_seidel", 20, PressScene().solver, 2e-3);
  report.progress(0.2);
  intoTheDimple(report, "cholesky", 10, "{relaxation: cholesky, iterations: 150, tolerance: 1.0e-6}", 2e-3);
  report.progress(0.5);
  intoTheDimple(report, "reference", 10, "{method: reference, iterations: 100, tolerance: 1.0e-10}", 2e-3);
  intoTheDimple(report, "cone4", 10, "{method: cone4, iterations: 150, tolerance: 1.0e-6}", 2e-2);
  intoTheDimple(report, "polyhedral", 10, "{method: polyhedral, iterations: 150, tolerance: 1.0e-6}", 2e-2);
  // condensed_lcp is left out: two spheres on the same nodes are more than Lemke's method can pivot through.
  report.progress(0.8);
  ontoTheFace(report);
}

}  // namespace tissue_contact
