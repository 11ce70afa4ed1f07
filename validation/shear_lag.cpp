/// Form D: an elastic strip on a floor with friction, pulled at one end by F. It slips over the length F / (mu w), w
/// its weight per length; its end has moved by F^2 / (2 E A mu w); half of that is left after unloading; a cycle
/// between -F and F costs 2 F^3 / (3 E A mu w). A membrane of nu = 0; the end is fixed and the floor moves, which is
/// the same. With both relaxations: a taut membrane is where the lagged Cholesky one once diverged.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "support/text_scene.h"
#include "validation/closed_forms.h"
#include "validation/report.h"

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

/// How fast the strip is pulled. Its end stretches at the rate speed / kSlipLength, which the damping adds to its
/// force: E A damping speed / kSlipLength.
struct Pace {
  double speed;    ///< m/s
  double step;     ///< s
  double damping;  ///< of the stiffness, s

  double dampingForce() const { return kEA * damping * speed / kSlipLength; }
};

// Slow: the wave that the floor sends off at the start, E A speed / (10 m/s) = 0.5 % of F, dies on the way; damping is
// 0.03 % of F. Brisk: 2 % and 0.5 %, with the step and the damping at which Cholesky once diverged.
constexpr Pace kSlow = {0.0005, 0.008, 0.001};
constexpr Pace kBrisk = {0.002, 0.002, 0.005};

/// The strip's right end is fixed; the floor below it moves along x.
class Strip {
 public:
  Strip(int cells, const char* relaxation, const Pace& pace)
      : pace_(pace), cell_(kLength / cells), simulator_(make(cells, relaxation, pace)) {}

  /// Moves the floor until the strip's end has been pulled by `end_m` relative to it, observing every step.
  template <typename Observer>
  void pull(double end_m, const Observer& observer) {
    const double from = end_;
    const int steps = static_cast<int>(std::ceil(std::abs(end_m - from) / (pace_.speed * pace_.step)));
    direction_ = end_m > from ? 1.0 : -1.0;
    for (int k = 1; k <= steps; ++k) {
      end_ = from + (end_m - from) * k / steps;
      simulator_.advance(pace_.step, {VectorX::Constant(1, -end_)});
      observer();
    }
  }
  void pull(double end_m) {
    pull(end_m, [] {});
  }

  double end() const { return end_; }
  double cell() const { return cell_; }

  /// All of the friction on the floor, N.
  double friction() const { return simulator_.wrench(0).force.x(); }
  /// What pulls, N. The fixed end carries the weight of half a cell, which the floor therefore lacks: its friction is
  /// added.
  double force() const { return friction() + direction_ * kLoad * 0.5 * cell_; }

  /// How far from the pulled end the strip slides, in its unstretched length, m: the farthest sliding contact.
  double slipLength() const {
    const NodalVectors& rest = simulator_.tissues()[0].restPositions();
    double farthest = 0.0;
    for (const SolvedContact& one : simulator_.contacts()) {
      if (one.state != ContactState::kKinetic) continue;
      double x = 0.0;
      for (int i = 0; i < 3; ++i) x += one.contact.weights[i] * rest(0, one.contact.nodes[i]);
      farthest = std::max(farthest, 0.5 * kLength - x);
    }
    return farthest;
  }

 private:
  static Simulator make(int cells, const std::string& relaxation, const Pace& pace) {
    std::ostringstream yaml;
    yaml << "gravity_m_per_s2: [0, 0, -9.81]\n"
         << "tissues:\n  - name: strip\n    sheet: {size_m: [" << kLength << ", " << kWidth << "], cells: [" << cells
         << ", 1], thickness_m: " << kThickness << "}\n"
         << "    material: {youngs_modulus_pa: " << kYoung
         << ", poissons_ratio: 0, density_kg_per_m3: 1000, bending_stiffness_n_m: 0}\n"
         << "    damping: {stiffness_s: " << pace.damping << "}\n"
         << "    fixed: [{plane: {point_m: [" << 0.5 * kLength << ", 0, 0], normal: [-1, 0, 0]}}]\n"
         << "instruments:\n  - {name: floor, robot_description: floor, tip_link: table, contact_links: [table],"
         << " joint_state_topics: [/floor], base_pose: {position_m: [0, 0, " << -0.5 * kThickness << "]}}\n"
         << "friction:\n  - {instrument: floor, tissue: strip, static: " << kMu << "}\n"
         << "step: {max_step_s: " << pace.step << "}\nsolver: {relaxation: " << relaxation
         << ", iterations: 400, tolerance: 1.0e-6}\n";
    return makeSimulator(yaml.str(), {{"floor", movingTableUrdf()}});
  }

  Pace pace_;
  double cell_;
  Simulator simulator_;
  double end_ = 0.0;
  double direction_ = 1.0;
};

struct Measured {
  double friction, force, slip_length, left;
};

Measured loadAndUnload(Strip& strip) {
  strip.pull(kEnd);
  Measured measured = {strip.friction(), strip.force(), strip.slipLength(), 0.0};
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

// Linear elements are exact at the nodes of a strip under loads at its nodes, so that only damping is left: d = 0.03 %
// of the force. On the way back to zero force half the length slips, stretching twice as fast: 2 d of F are held by
// damping, 4 d of what is left. Tolerances are twice these.
void checkStrip(Report& report, const std::string& name, const Strip& strip, const Measured& measured) {
  const double damping = kSlow.dampingForce() / kForce;
  report.near(name + ": force", "N", kForce, measured.force, 2.0 * damping * kForce,
              "end displacement F^2 / (2 E A mu w)");
  // The last node that slides is the last but one: that at the closed form's slip length is just about to.
  report.near(name + ": slip length", "m", kSlipLength, measured.slip_length, 1.001 * strip.cell(), "F / (mu w)");
  report.near(name + ": left after unloading", "m", 0.5 * kEnd, measured.left, 8.0 * damping * 0.5 * kEnd,
              "half the end's displacement");
}

void convergesInTheMesh(Report& report) {
  ConvergenceStudy friction = {"friction on the floor alone", "N", "cell (m)", {}, kForce + kSlow.dampingForce()};
  ConvergenceStudy slip = {"slip length", "m", "cell (m)", {}, kSlipLength};
  for (const int cells : {15, 30, 60}) {
    Strip strip(cells, "cholesky", kSlow);
    const Measured measured = loadAndUnload(strip);
    checkStrip(report, std::to_string(cells) + " cells", strip, measured);
    friction.levels.push_back({strip.cell(), measured.friction});
    slip.levels.push_back({strip.cell(), measured.slip_length});
    report.progress(0.4 * cells / 60.0);
  }
  // Half a cell's friction exactly, less what the solver leaves: 1e-6 of the loads in each of some hundred steps.
  report.near("friction on the floor: observed order in the cell", "", 1.0, friction.observedOrder(), 0.02,
              "half a cell rests on the fixed end");
  report.convergence(friction);
  report.convergence(slip);
}

void sameWithGaussSeidel(Report& report) {
  Strip strip(30, "gauss_seidel", kSlow);
  checkStrip(report, "30 cells, Gauss-Seidel", strip, loadAndUnload(strip));
  report.progress(0.5);
}

void lossOfACycle(Report& report) {
  Strip strip(30, "cholesky", kSlow);
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
  const double damping = kSlow.dampingForce() / kForce;
  report.near("cycle: force at the far end", "N", -kForce, strip.force(), 2.0 * damping * kForce, "-F");
  strip.pull(kEnd, sum);
  // Damping costs 4 damping speed F: the rate speed / s over the slipping length s, summed over both ways. Loads at
  // nodes sum the slip's parabola by trapezoids: 1 / (2 n^2) of the loss for n cells that slip. Twice both.
  const double slipping = kSlipLength / strip.cell();
  const double tolerance = 8.0 * kSlow.damping * kSlow.speed * kForce + kLoss / (slipping * slipping);
  report.near("cycle: loss", "J", kLoss, loss, tolerance, "2 F^3 / (3 E A mu w)");
  report.progress(0.7);
}

// 75 cells: with Cholesky each relaxation once left 0.7 of the defect, and the contact passes on old compliances
// brought back more, until in step 147 the strip flew apart.
void tautStripWithCholesky(Report& report) {
  Strip strip(75, "cholesky", kBrisk);
  strip.pull(kEnd);
  report.near("75 cells, brisk, Cholesky: force", "N", kForce + kBrisk.dampingForce(), strip.force(), 1e-3 * kForce,
              "as above, with the damping's share");
}

}  // namespace

void validateShearLag(Report& report) {
  convergesInTheMesh(report);
  sameWithGaussSeidel(report);
  lossOfACycle(report);
  tautStripWithCholesky(report);
}

}  // namespace tissue_contact
