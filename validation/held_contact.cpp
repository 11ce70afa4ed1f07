/// Form B, taken further: a contact that static friction holds does not creep, point by point, at the solver's default
/// settings: on an incline just below the critical angle, under an instrument that holds tissue aside, and on
/// instruments that move. At 1 kHz; 1 micrometre in a minute is the bound of all of them.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "support/text_scene.h"
#include "tissue_contact/mesh/tissue_surface.h"
#include "validation/closed_forms.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kStep = 0.001;
constexpr double kCreep = 1e-6;
constexpr const char* kNoCreep = "none: it is held";

Vector3 pointOf(const Simulator& simulator, const Contact& contact) {
  return tissue_contact::pointOf(simulator.positions(contact.key.tissue), contact.nodes, contact.weights);
}

/// The material points that static friction holds at this moment, followed by themselves: whatever contacts the
/// simulator finds or keeps later.
class HeldPoints {
 public:
  HeldPoints(const Simulator& simulator, int link) : link_(link) {
    for (const SolvedContact& one : simulator.contacts()) {
      if (one.state != ContactState::kStatic) continue;
      points_.push_back({one.contact, in(simulator, pointOf(simulator, one.contact))});
    }
  }

  int count() const { return static_cast<int>(points_.size()); }

  /// Forgets the points whose surface feature is not held, or not touched, any more.
  void keepHeld(const Simulator& simulator) {
    const auto let_go = [&](const Point& point) {
      for (const SolvedContact& one : simulator.contacts()) {
        if (one.contact.key.feature == point.contact.key.feature && one.state == ContactState::kStatic) return false;
      }
      return true;
    };
    points_.erase(std::remove_if(points_.begin(), points_.end(), let_go), points_.end());
  }

  /// How far the worst one has slipped along its contact plane in the instrument's frame since it was taken, m.
  double slip(const Simulator& simulator) const {
    double worst = 0.0;
    for (const Point& point : points_) {
      const Vector3 way = in(simulator, pointOf(simulator, point.contact)) - point.start;
      const Vector3 n = simulator.linkPoses(0)[link_].linear().transpose() * point.contact.R_WC.col(0);
      worst = std::max(worst, (way - n.dot(way) * n).norm());
    }
    return worst;
  }

 private:
  struct Point {
    Contact contact;
    Vector3 start;  ///< in the instrument's frame
  };
  Vector3 in(const Simulator& simulator, const Vector3& p_W) const {
    return simulator.linkPoses(0)[link_].inverse() * p_W;
  }

  int link_;
  std::vector<Point> points_;
};

std::string blockOnTable(double degrees, double mu) {
  const double theta = degrees * M_PI / 180.0;
  std::ostringstream yaml;
  yaml.precision(17);
  yaml
      << "gravity_m_per_s2: [" << 9.81 * std::sin(theta) << ", 0, " << -9.81 * std::cos(theta) << "]\n"
      << "tissues:\n  - name: block\n    block: {size_m: [0.06, 0.06, 0.03], cells: [4, 4, 2]}\n"
      << "    material: {model: corotational, youngs_modulus_pa: 1.0e5, poissons_ratio: 0.3, density_kg_per_m3: 1000}\n"
      << "    damping: {stiffness_s: 0.005}\n"
      << "instruments:\n  - name: table\n    robot_description: table\n    tip_link: table\n"
      << "    contact_links: [table]\n    joint_state_topics: [/joint_states]\n"
      << "friction:\n  - {instrument: table, tissue: block, static: " << mu << "}\n";
  return yaml.str();
}

// The critical angle of 0.3 is 16.699 degrees, so 99.4 % of the friction there is are in use.
void blockOnAnInclineStaysForAMinute(Report& report) {
  Simulator simulator = makeSimulator(blockOnTable(16.6, 0.3), {{"table", movingTableUrdf()}});
  const std::vector<VectorX> still = {VectorX::Zero(1)};
  for (int k = 0; k < 1000; ++k) simulator.advance(kStep, still);
  const HeldPoints held(simulator, 1);
  report.atLeast("16.6 deg, mu .3: points held", "", 25, held.count(), "every node of the face");
  for (int k = 0; k < 60000; ++k) {
    simulator.advance(kStep, still);
    if (k % 1000 == 0) report.progress(0.2 * k / 60000);
  }
  report.atMost("16.6 deg, mu .3: slip of the worst point in 60 s", "m", kCreep, held.slip(simulator), kNoCreep);
  report.atMost("16.6 deg, mu .3: kinetic contacts", "", 0.0, simulator.report().kinetic_contacts, "it holds");
}

// Shaken at 1 Hz and 5 mm, which takes 0.2 of the 0.5 m/s^2 per m/s^2 there is: the block goes with the tray.
void blockGoesWithAShakenTray(Report& report) {
  Simulator simulator = makeSimulator(blockOnTable(0.0, 0.5), {{"table", movingTableUrdf()}});
  const auto tray = [](int k) { return VectorX::Constant(1, 0.005 * (1.0 - std::cos(2.0 * M_PI * k * kStep))); };
  for (int k = 1; k <= 1000; ++k) simulator.advance(kStep, {tray(k)});
  const HeldPoints held(simulator, 1);
  report.atLeast("shaken tray: points held", "", 25, held.count(), "every node of the face");
  double worst = 0.0;
  for (int k = 1; k <= 20000; ++k) {
    simulator.advance(kStep, {tray(k)});
    worst = std::max(worst, held.slip(simulator));
    if (k % 1000 == 0) report.progress(0.2 + 0.2 * k / 20000);
  }
  report.atMost("shaken tray: slip of the worst point in 20 s", "m", kCreep, worst, kNoCreep);
}

std::string probeOnPad(double mu) {
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: pad\n    block:\n      size_m: [0.03, 0.03, 0.015]\n      cells: [8, 8, 4]\n"
       << "      grading: {x: {growth: 1.3}, y: {growth: 1.3}, z: {growth: 1.3, fine_at: maximum}}\n"
       << "    material: {youngs_modulus_pa: 1.0e4, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n"
       << "    damping: {stiffness_s: 0.005}\n"
       << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
       << "instruments:\n  - name: probe\n    robot_description: probe\n    tip_link: tip\n"
       << "    joint_state_topics: [/joint_states]\n    base_pose: {position_m: [0, 0, 0.0201]}\n"
       << "    contact_links: [tip]\n"
       << "friction:\n  - {instrument: probe, tissue: pad, static: " << mu << "}\n";
  return yaml.str();
}

/// Presses the 5 mm sphere 2 mm deep in 0.2 s, then moves it aside in another 0.2 s.
void pressAndPull(Simulator& simulator, double aside_m) {
  for (int k = 1; k <= 200; ++k) simulator.advance(kStep, {Vector3(0.0, 0.0, -0.0021 * k / 200)});
  for (int k = 1; k <= 200; ++k) simulator.advance(kStep, {Vector3(aside_m * k / 200, 0.0, -0.0021)});
}

void instrumentHoldsTissueAsideForAMinute(Report& report) {
  Simulator simulator = makeSimulator(probeOnPad(1.0), {{"probe", probeUrdf(0.005)}});
  pressAndPull(simulator, 0.0005);
  const std::vector<VectorX> still = {Vector3(0.0005, 0.0, -0.0021)};
  for (int k = 0; k < 1000; ++k) simulator.advance(kStep, still);
  const HeldPoints held(simulator, 3);
  int barycentric = 0;
  for (const SolvedContact& one : simulator.contacts()) {
    barycentric += one.state == ContactState::kStatic && one.contact.weights.maxCoeff() < 0.9;
  }
  // A sphere rests on vertices where there are any near, and on faces between: 4 and 4 here, so that both kinds are
  // held.
  report.atLeast("held aside: contacts inside faces", "", 2, barycentric, "both kinds are to be held");
  report.atLeast("held aside: contacts at vertices", "", 2, held.count() - barycentric, "both kinds are to be held");
  const Vector3 force = simulator.wrench(0).force;
  report.atLeast("held aside: friction over normal force", "", 0.1, std::abs(force.x()) / force.z(),
                 "by choice of the case");
  for (int k = 0; k < 60000; ++k) {
    simulator.advance(kStep, still);
    if (k % 1000 == 0) report.progress(0.4 + 0.4 * k / 60000);
  }
  report.atMost("held aside: slip of the worst point in 60 s", "m", kCreep, held.slip(simulator), kNoCreep);
  // A micrometre of half a millimetre is what creep could take of the force.
  report.atMost("held aside: change of force in 60 s", "N", 2e-3 * force.norm(),
                (simulator.wrench(0).force - force).norm(), "none: it is held");
}

/// Moves the sphere for `seconds` along target(t) and returns the points that were held all the time.
template <typename Target>
HeldPoints moveHolding(Simulator& simulator, int seconds, const Target& target) {
  for (int k = 1; k <= 1000; ++k) simulator.advance(kStep, {target(k * kStep)});
  HeldPoints held(simulator, 3);
  for (int k = 1; k <= 1000 * seconds; ++k) {
    simulator.advance(kStep, {target(k * kStep)});
    held.keepHeld(simulator);
  }
  return held;
}

// Back and forth by 0.05 mm once a second (twice that lets most of the eight points of this coarse contact slide in turn). Inside the contact nothing slips, and nothing adds up: the face that carries
// a point rocks and stretches a little, which takes points beside it some 50 nm to and fro.
void tissueGoesBackAndForthWithAnInstrument(Report& report) {
  Simulator simulator = makeSimulator(probeOnPad(1.0), {{"probe", probeUrdf(0.005)}});
  pressAndPull(simulator, 0.0005);
  const HeldPoints held = moveHolding(
      simulator, 20, [](double t) { return Vector3(0.000475 + 2.5e-5 * std::cos(2.0 * M_PI * t), 0.0, -0.0021); });
  report.atLeast("to and fro: points held throughout", "", 5, held.count(), "the inside of the contact");
  report.atMost("to and fro: slip of the worst after 20 times", "m", kCreep, held.slip(simulator), kNoCreep);
  report.progress(0.95);
}

// Round on a circle of 0.1 mm across. The one contact point of a face wanders on it as the face rocks, and the face
// stretches meanwhile: round a loop that leaves a little, about 0.1 micrometre each turn whatever the friction, the
// time step and the solver's tolerance: of the mesh, not creep. The bound says how little: a thousandth of the way.
void tissueGoesRoundWithAnInstrumentButForAThousandth(Report& report) {
  constexpr int kTurns = 5;
  constexpr double kRadius = 5e-5;
  Simulator simulator = makeSimulator(probeOnPad(2.0), {{"probe", probeUrdf(0.005)}});
  pressAndPull(simulator, 0.0005);
  const HeldPoints held = moveHolding(simulator, kTurns, [](double t) {
    const double angle = 2.0 * M_PI * t;
    return Vector3(0.0005 - kRadius + kRadius * std::cos(angle), kRadius * std::sin(angle), -0.0021);
  });
  report.atLeast("round a circle: points held throughout", "", 3, held.count(), "the inside of the contact");
  report.atMost("round a circle: slip of the worst after 5 turns", "m", 1e-3 * kTurns * 2.0 * M_PI * kRadius,
                held.slip(simulator), "a thousandth of the way");
}

}  // namespace

void validateHeldContact(Report& report) {
  blockOnAnInclineStaysForAMinute(report);
  blockGoesWithAShakenTray(report);
  instrumentHoldsTissueAsideForAMinute(report);
  tissueGoesBackAndForthWithAnInstrument(report);
  tissueGoesRoundWithAnInstrumentButForAThousandth(report);
}

}  // namespace tissue_contact
