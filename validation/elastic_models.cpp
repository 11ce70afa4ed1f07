/// Form J: closed forms of the models beyond linear elasticity of one material: neo-Hookean bars at finite strain, mass-spring
/// volumes under uniform strain, layered bars, Kelvin-Voigt creep, stress that relaxes.
#include <algorithm>
#include <cmath>
#include <complex>
#include <sstream>

#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "tissue_contact/tissue/tissue.h"
#include "validation/closed_forms.h"
#include "validation/elasticity_helpers.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kYoung = 1e4;

/// Like .3, for names of checks.
std::string text(double value) {
  std::ostringstream stream;
  stream << value;
  return stream.str();
}

TissueDescription bar(ElasticModel model, double nu, const Vector3& size, const std::array<int, 3>& cells) {
  TissueDescription description;
  description.name = "bar";
  description.geometry = BlockDescription{size, cells, {}};
  description.material = {model, kYoung, nu, 1000.0, -1.0, Dilatation::kElement};
  return description;
}

/// Coordinates held so that a bar can be pulled along z and contract freely: z at both ends, x and y in the planes of
/// symmetry (which must hold nodes).
std::vector<bool> pulledBar(const NodalVectors& rest, double length) {
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    prescribed.push_back(rest(0, i) == 0.0);
    prescribed.push_back(rest(1, i) == 0.0);
    prescribed.push_back(rest(2, i) == 0.0 || rest(2, i) == length);
  }
  return prescribed;
}

struct Pull {
  double tension_n = 0.0;
  double lateral = 0.0;   ///< stretch
  double residual = 0.0;  ///< largest force that is not in balance, over the tension
};

/// A bar stretched to `stretch`.
Pull pull(const Tissue& tissue, double length, double stretch) {
  const NodalVectors& rest = tissue.restPositions();
  const double guess = 1.0 / std::sqrt(stretch);  // of the lateral stretch: near enough for Newton
  NodalVectors x = Vector3(guess, guess, stretch).asDiagonal() * rest;
  const double residual =
      solveEquilibrium(tissue.elasticity(), pulledBar(rest, length), NodalVectors::Zero(3, rest.cols()), 60, x);
  const NodalVectors f = elasticForces(tissue.elasticity(), x);
  Pull result;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    if (rest(2, i) == length) result.tension_n -= f(2, i);
  }
  result.residual = residual / std::abs(result.tension_n);
  result.lateral = x.row(0).maxCoeff() / rest.row(0).maxCoeff();
  return result;
}

/// Lateral stretch and tension per area of psi under uniaxial stretch s: two equations, P_lateral = 0 and P_axial.
void uniaxial(double nu, double s, double& lateral, double& stress) {
  const double mu_lame = kYoung / (2.0 * (1.0 + nu));
  const double lambda_lame = kYoung * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const double mu = 4.0 / 3.0 * mu_lame;
  const double lambda = lambda_lame + 5.0 / 6.0 * mu_lame;
  const double alpha = 1.0 + 0.75 * mu / lambda;
  const auto P = [&](double axis, double cofactor) {
    const double I = 2.0 * lateral * lateral + s * s;
    return mu * (1.0 - 1.0 / (I + 1.0)) * axis + lambda * (lateral * lateral * s - alpha) * cofactor;
  };
  double low = 0.1;  // P_lateral / lateral grows with the lateral stretch
  double high = 5.0;
  for (int i = 0; i < 200; ++i) {
    lateral = 0.5 * (low + high);
    (P(lateral, lateral * s) > 0.0 ? high : low) = lateral;
  }
  stress = P(s, lateral * lateral);
}

// A uniform state: linear tetrahedra hold it exactly, so only Newton's residual is left.
void neoHookeanBar(Report& report) {
  for (const double nu : {0.0, 0.3, 0.45, 0.49}) {
    const Tissue tissue(bar(ElasticModel::kNeoHookean, nu, {0.02, 0.02, 0.04}, {2, 2, 3}), Pose::Identity());
    double stress_error = 0.0;
    double lateral_error = 0.0;
    double residual = 0.0;
    for (const double stretch : {0.6, 0.9, 1.2, 1.8}) {
      double lateral = 1.0;
      double stress = 0.0;
      uniaxial(nu, stretch, lateral, stress);
      const Pull got = pull(tissue, 0.04, stretch);
      stress_error = std::max(stress_error, std::abs(got.tension_n / 4e-4 / stress - 1.0));
      lateral_error = std::max(lateral_error, std::abs(got.lateral - lateral));
      residual = std::max(residual, got.residual);
    }
    const std::string name = "neo-Hookean bar, nu " + text(nu) + ": ";
    const char* const source = "uniaxial stress of the energy, stretch .6 to 1.8";
    report.atMost(name + "stress error", "", 1e-8, stress_error, source);
    report.atMost(name + "lateral error", "", 1e-8, lateral_error, source);
    report.atMost(name + "imbalance", "", 1e-9, residual, "equilibrium");
  }
}

void neoHookeanAtSmallStrain(Report& report) {
  Matrix3 strain;
  strain << 1.0, 0.3, -0.2, 0.3, -0.5, 0.1, -0.2, 0.1, 0.4;
  for (const double nu : {-0.3, 0.0, 0.3, 0.49, 0.499}) {
    const Tissue hyperelastic(bar(ElasticModel::kNeoHookean, nu, {0.02, 0.03, 0.04}, {2, 3, 3}), Pose::Identity());
    const Tissue linear(bar(ElasticModel::kLinear, nu, {0.02, 0.03, 0.04}, {2, 3, 3}), Pose::Identity());
    const Eigen::MatrixXd K = dense(linear.elasticity().makeState()->stiffness);
    const Eigen::MatrixXd difference = dense(hyperelastic.elasticity().makeState()->stiffness) - K;
    double worst = 0.0;  // difference of forces over strain
    for (const double size : {1e-4, 1e-5}) {
      const NodalVectors x = (Matrix3::Identity() + size * strain) * linear.restPositions();
      const NodalVectors f = elasticForces(linear.elasticity(), x);
      worst = std::max(worst, (elasticForces(hyperelastic.elasticity(), x) - f).norm() / (size * f.norm()));
    }
    const std::string name = "neo-Hookean at small strain, nu " + text(nu) + ": ";
    report.atMost(name + "stiffness error", "", 1e-12, difference.cwiseAbs().maxCoeff() / K.cwiseAbs().maxCoeff(),
                  "linear elasticity");
    report.atMost(name + "error / strain", "", 20.0, worst, "linear elasticity, of 2nd order");
  }
}

// Under uniform strain the springs of a mesh hold the energy of an isotropic body of modulus E and Poisson's ratio 1/4.
void massSpringEnergy(Report& report) {
  TissueDescription description = bar(ElasticModel::kMassSpring, 0.25, Vector3(0.03, 0.03, 0.03), {3, 3, 3});
  const Tissue even(description, Pose::Identity());
  auto& block = std::get<BlockDescription>(description.geometry);
  block.cells = {4, 4, 4};
  for (AxisGrading& axis : block.grading) axis.growth = 1.2;
  const Tissue graded(description, Pose::Identity());
  Matrix3 strain;
  strain << 1.0, 0.3, -0.2, 0.3, -0.5, 0.1, -0.2, 0.1, 0.4;
  for (const Tissue* tissue : {&even, &graded}) {
    const Eigen::MatrixXd K = dense(tissue->elasticity().makeState()->stiffness);
    double error = 0.0;
    for (const Matrix3& e : {strain, Matrix3(Matrix3::Identity()), Matrix3(Vector3(0.0, 0.0, 1.0).asDiagonal()),
                             Matrix3(Vector3(1.0, -1.0, 0.0).asDiagonal())}) {
      const NodalVectors u = e * tissue->restPositions();
      const Eigen::Map<const VectorX> all(u.data(), u.size());
      const double lame = 0.4 * kYoung;
      const double expected = 2.7e-5 * (lame * e.squaredNorm() + 0.5 * lame * e.trace() * e.trace());
      error = std::max(error, std::abs(0.5 * all.dot(K * all) / expected - 1.0));
    }
    report.atMost(std::string("mass-spring, ") + (tissue == &even ? "even" : "graded") + " mesh: worst energy error",
                  "", 1e-9, error, "isotropic body, nu 1/4, uniform strain");
  }
}

// A real bar's surface springs are not in balance with that: the error is of the order of a cell over the width.
void massSpringBar(Report& report) {
  ConvergenceStudy study{"mass-spring bar: modulus over the given one", "", "cell (m)", {}, 1.0};
  double residual = 0.0;
  for (const int n : {2, 4, 6}) {
    const Tissue tissue(bar(ElasticModel::kMassSpring, 0.25, {0.02, 0.02, 0.04}, {n, n, 2 * n}), Pose::Identity());
    const Pull got = pull(tissue, 0.04, 1.0001);
    residual = std::max(residual, got.residual);
    study.levels.push_back({0.02 / n, got.tension_n / (1e-4 * kYoung * 4e-4)});
  }
  report.near("mass-spring bar, 2 cells across: modulus", "", 1.0, study.levels[0].value, 0.05, "modulus given");
  report.near("mass-spring bar, 6 cells across: modulus", "", 1.0, study.levels[2].value, 0.02, "modulus given");
  report.require("mass-spring bar: nearer with each refinement",
                 study.error(study.levels[2]) < study.error(study.levels[1]) &&
                     study.error(study.levels[1]) < study.error(study.levels[0]),
                 "a surface layer of one cell");
  report.atMost("mass-spring bar: imbalance", "", 1e-9, residual, "equilibrium");
  report.convergence(study);
}

TissueDescription layeredBar(ElasticModel model) {
  TissueDescription description = bar(model, 0.0, {0.02, 0.02, 0.05}, {2, 2, 5});
  TissueRegion region;
  region.name = "soft";
  region.where = {BoxRegion{Vector3(-1.0, -1.0, 0.02), Vector3(1.0, 1.0, 0.05)}};
  region.material = description.material;
  region.material.youngs_modulus_pa = 0.2 * kYoung;
  description.regions = {region};
  return description;
}

/// All coordinates of the nodes at z = 0.
std::vector<bool> lowerEnd(const Tissue& tissue) {
  std::vector<bool> prescribed;
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    prescribed.insert(prescribed.end(), 3, tissue.restPositions()(2, i) == 0.0);
  }
  return prescribed;
}

/// Consistent nodal loads of a total force along z over the face at z = length.
NodalVectors endLoads(const Tissue& tissue, double length, double force) {
  NodalVectors loads = NodalVectors::Zero(3, tissue.nodeCount());
  double area = 0.0;
  for (const Triangle& t : tissue.surface()) {
    const auto x = [&](std::size_t i) { return Vector3(tissue.restPositions().col(t[i])); };
    if (x(0).z() != length || x(1).z() != length || x(2).z() != length) continue;
    const double third = (x(1) - x(0)).cross(x(2) - x(0)).norm() / 6.0;
    for (const int node : t) loads(2, node) += third;
    area += 3.0 * third;
  }
  return loads * (force / area);
}

// Two springs in series: F L1 / (E1 A) + F L2 / (E2 A). With nu = 0 there is no lateral strain to disturb it.
void layeredBarInTension(Report& report) {
  const char* const names[] = {"linear", "corotational", "neo-Hookean"};
  for (const ElasticModel model : {ElasticModel::kLinear, ElasticModel::kCorotational, ElasticModel::kNeoHookean}) {
    const Tissue tissue(layeredBar(model), Pose::Identity());
    const double F = 1e-3;
    NodalVectors u = NodalVectors::Zero(3, tissue.nodeCount());
    solveStatic(tissue.elasticity().makeState()->stiffness, lowerEnd(tissue), endLoads(tissue, 0.05, F), u);
    const double unit = F / (kYoung * 4e-4);
    double error = 0.0;
    for (int i = 0; i < tissue.nodeCount(); ++i) {
      const double z = tissue.restPositions()(2, i);
      error = std::max(error, std::abs(u(2, i) - unit * (std::min(z, 0.02) + 5.0 * std::max(0.0, z - 0.02))));
    }
    const std::string name = std::string("layered bar, ") + names[static_cast<int>(model)];
    const char* const source = "two springs in series";
    report.near(name + ": elongation", "m", unit * 0.17, u.row(2).maxCoeff(), 1e-10 * unit * 0.17, source);
    report.atMost(name + ": worst error, of it", "", 1e-10, error / (unit * 0.17), source);
  }
}

/// End displacement after `time` of a bar under a constant end load, by implicit Euler steps of the room's matrices:
/// (M + dt D + dt^2 K) v = M v0 + dt f(x0) + dt load, D = stiffness_s K or State::damping.
double creep(const Tissue& tissue, const std::vector<bool>& prescribed, double length, double force, double time,
             int steps) {
  const double dt = time / steps;
  const NodalVectors loads = endLoads(tissue, length, force);
  const auto state = tissue.elasticity().makeState();
  NodalVectors x = tissue.restPositions();
  NodalVectors v = NodalVectors::Zero(3, x.cols());
  NodalVectors f(3, x.cols());
  for (int step = 0; step < steps; ++step) {
    state->step_s = dt;
    tissue.elasticity().update(x, *state, f);
    state->elapsed_s = dt;
    BlockMatrix A = state->stiffness;
    const double scale = dt * (dt + tissue.damping().stiffness_s);
    const bool damps = state->damping.rows() > 0;
    A.setSum(scale, state->stiffness, damps ? dt : 0.0, damps ? state->damping : state->stiffness);
    for (std::size_t i = 0; i < A.diagonal.size(); ++i) {
      A.diagonal[i].diagonal().array() += tissue.nodeMasses()[static_cast<Eigen::Index>(i)];
    }
    const NodalVectors b = v * tissue.nodeMasses().asDiagonal() + dt * (f + loads);
    NodalVectors next = NodalVectors::Zero(3, x.cols());
    solveStatic(A, prescribed, b, next);
    v = next;
    x += dt * v;
  }
  return x.row(2).maxCoeff() - length;
}

/// Displacement over the expected one with 20, 40 and 80 steps. Implicit Euler is of first order.
void creepStudy(const std::string& name, const Tissue& tissue, const std::vector<bool>& prescribed, double force,
                double expected, const char* source, Report& report) {
  ConvergenceStudy study{name + ": displacement over the expected one", "", "step (s)", {}, 1.0};
  for (const int steps : {20, 40, 80}) {
    study.levels.push_back({0.15 / steps, creep(tissue, prescribed, 0.05, force, 0.15, steps) / expected});
    report.near(name + ", " + std::to_string(steps) + " steps: displacement", "", 1.0, study.levels.back().value,
                0.4 / steps, source);
  }
  report.near(name + ": order of convergence", "", 1.0, study.observedOrder(), 0.07, "implicit Euler");
  report.convergence(study);
}

// tau = stiffness_s: the mass is so small that waves cross in 1e-6 tau.
void kelvinVoigt(Report& report) {
  TissueDescription description = bar(ElasticModel::kLinear, 0.0, {0.02, 0.02, 0.05}, {2, 2, 5});
  description.material.density_kg_per_m3 = 1e-6;
  description.damping.stiffness_s = 0.2;
  const double F = 1e-3;
  const char* const source = "u = F L / (E A) (1 - exp(-t / tau)) per layer";
  const Tissue plain(description, Pose::Identity());
  creepStudy("Kelvin-Voigt bar", plain, lowerEnd(plain), F, F * 0.05 / (kYoung * 4e-4) * (1.0 - std::exp(-0.15 / 0.2)),
             source, report);

  TissueDescription layers = layeredBar(ElasticModel::kCorotational);
  layers.material.density_kg_per_m3 = layers.regions[0].material.density_kg_per_m3 = 1e-6;
  layers.damping.stiffness_s = 0.1;
  layers.regions[0].damping_stiffness_s = 0.4;
  const Tissue layered(layers, Pose::Identity());
  creepStudy(
      "Kelvin-Voigt layers", layered, lowerEnd(layered), 0.1 * F,
      0.1 * F / (kYoung * 4e-4) * (0.02 * (1.0 - std::exp(-0.15 / 0.1)) + 5.0 * 0.03 * (1.0 - std::exp(-0.15 / 0.4))),
      source, report);
}

constexpr double kRelaxedPoisson = 0.45;
const std::vector<PronyTerm> kTerms = {{0.5, 0.05}, {1.5, 2.0}};

TissueDescription viscoelasticBar(ElasticModel model) {
  TissueDescription description = bar(model, kRelaxedPoisson, {0.02, 0.02, 0.02}, {2, 2, 2});
  description.material.density_kg_per_m3 = 1e-6;  // waves cross in no time
  description.material.prony_series = kTerms;
  return description;
}

/// Shear stress over relaxed modulus of a cube sheared uniformly by angle(t) at every dt; the last `count` of `steps`.
template <typename Angle>
std::vector<double> shearStresses(const Tissue& tissue, double dt, int steps, int count, const Angle& angle) {
  const auto state = tissue.elasticity().makeState();
  NodalVectors f(3, tissue.nodeCount());
  std::vector<double> stresses;
  for (int step = 0; step <= steps; ++step) {
    Matrix3 F = Matrix3::Identity();
    F(0, 2) = angle(step * dt);
    tissue.elasticity().update(F * tissue.restPositions(), *state, f);
    state->elapsed_s = dt;
    if (step <= steps - count) continue;
    double force = 0.0;
    for (int i = 0; i < tissue.nodeCount(); ++i) force -= tissue.restPositions()(2, i) == 0.02 ? f(0, i) : 0.0;
    stresses.push_back(force / 4e-4 * 2.0 * (1.0 + kRelaxedPoisson) / kYoung);
  }
  return stresses;
}

// Held: G(t)/G = 1 + sum g exp(-t/tau). Swinging: G(w)/G = 1 + sum g i w tau / (1 + i w tau), in phase and a quarter ahead.
void relaxingShear(const std::string& name, const Tissue& tissue, Report& report) {
  constexpr double kAngle = 1e-6;  // the models differ by its square
  const double held = shearStresses(tissue, 0.01, 100, 1, [](double) { return kAngle; })[0] / kAngle;
  double expected = 1.0;
  std::complex<double> modulus = 1.0;
  const double omega = 3.0;
  for (const PronyTerm& term : kTerms) {
    expected += term.modulus_ratio * std::exp(-1.0 / term.time_s);
    const std::complex<double> turned(0.0, omega * term.time_s);
    modulus += term.modulus_ratio * turned / (1.0 + turned);
  }
  report.near(name + ": held shear after 1 s", "", expected, held, 1e-5 * expected, "G(t) of the series");
  constexpr int kPerCycle = 400;
  const double dt = 2.0 * M_PI / omega / kPerCycle;
  const std::vector<double> stresses =
      shearStresses(tissue, dt, 20 * kPerCycle, kPerCycle, [&](double t) { return kAngle * std::sin(omega * t); });
  std::complex<double> got;
  for (int i = 0; i < kPerCycle; ++i) {
    const double phase = 2.0 * M_PI * (i + 1) / kPerCycle;
    got += 2.0 / kPerCycle / kAngle * stresses[i] * std::complex<double>(std::sin(phase), std::cos(phase));
  }
  report.near(name + ": storage modulus at 3 rad/s", "", modulus.real(), got.real(), 1e-4 * modulus.real(), "series");
  report.near(name + ": loss modulus at 3 rad/s", "", modulus.imag(), got.imag(), 2e-4 * modulus.imag(), "series");
}

void relaxation(Report& report) {
  const std::pair<const char*, ElasticModel> models[] = {{"linear", ElasticModel::kLinear},
                                                         {"corotational", ElasticModel::kCorotational},
                                                         {"neo-Hookean", ElasticModel::kNeoHookean}};
  for (const auto& [name, model] : models) {
    relaxingShear(std::string("Prony series, ") + name, Tissue(viscoelasticBar(model), Pose::Identity()), report);
  }
  // One term, uniaxial creep under a constant load: 1/E(t) = 1/(9 K) + J(t)/3, J = (1 - g/(1+g) exp(-t/(tau (1+g)))) / G.
  TissueDescription description = viscoelasticBar(ElasticModel::kLinear);
  std::get<BlockDescription>(description.geometry).size_m.z() = 0.05;
  description.material.prony_series = {{1.5, 0.1}};
  const Tissue tissue(description, Pose::Identity());
  std::vector<bool> prescribed;
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    for (int axis = 0; axis < 3; ++axis) prescribed.push_back(tissue.restPositions()(axis, i) == 0.0);
  }
  const double shear = kYoung / (2.0 * (1.0 + kRelaxedPoisson));
  const double bulk = kYoung / (3.0 * (1.0 - 2.0 * kRelaxedPoisson));
  const double compliance = 1.0 / (9.0 * bulk) + (1.0 - 0.6 * std::exp(-0.15 / 0.25)) / (3.0 * shear);
  const double F = 1e-3;
  creepStudy("Prony bar", tissue, prescribed, F, F * 0.05 / 4e-4 * compliance,
             "u = F L / A (1/(9 K) + J(t)/3), one term", report);
}

}  // namespace

void validateElasticModels(Report& report) {
  neoHookeanBar(report);
  neoHookeanAtSmallStrain(report);
  massSpringEnergy(report);
  report.progress(0.3);
  massSpringBar(report);
  report.progress(0.6);
  layeredBarInTension(report);
  kelvinVoigt(report);
  relaxation(report);
}

}  // namespace tissue_contact
