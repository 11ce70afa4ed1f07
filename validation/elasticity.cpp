/// Form J: closed forms of linear elasticity, solved statically: patch test, bar in tension, beams in bending under
/// refinement, nearly incompressible ones too. Free fall and weight: incline.cpp.
#include <algorithm>
#include <cmath>

#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/tet_elasticity.h"
#include "validation/closed_forms.h"
#include "validation/elasticity_helpers.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

/// Static answer with given displacements at some nodes. @param u in: those; out: all.
void solveLinear(const TetMesh& mesh, const std::vector<bool>& held, const MaterialDescription& material,
                 const NodalVectors& loads, NodalVectors& u) {
  std::vector<bool> prescribed;
  for (const bool node : held) prescribed.insert(prescribed.end(), 3, node);
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, std::vector<bool>(held.size(), false), material);
  solveStatic(elasticity.makeState()->stiffness, prescribed, loads, u);
}

TetMesh makeBlock(const Vector3& size, const std::array<int, 3>& cells) { return makeBlockMesh({size, cells, {}}); }

// A linear displacement field on the boundary must be reproduced inside, whatever the (here distorted) mesh.
void patchTest(Report& report) {
  TetMesh mesh = makeBlock(Vector3(0.03, 0.03, 0.03), {3, 3, 3});
  Matrix3 gradient;
  gradient << 0.010, 0.003, -0.002, 0.001, -0.004, 0.005, 0.002, 0.001, 0.006;
  std::vector<bool> boundary(mesh.positions.cols(), false);
  for (const Triangle& triangle : boundaryTriangles(mesh.tetrahedra)) {
    for (const int node : triangle) boundary[node] = true;
  }
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    const auto any = static_cast<double>(i);
    if (!boundary[i])
      mesh.positions.col(i) += 0.002 * Vector3(std::sin(7.0 * any), std::cos(5.0 * any), std::sin(3.0 * any));
  }
  NodalVectors u = gradient * mesh.positions;
  const NodalVectors exact = u;
  for (Eigen::Index i = 0; i < u.cols(); ++i) {
    if (!boundary[i]) u.col(i).setZero();
  }
  solveLinear(mesh, boundary, {ElasticModel::kLinear, 5e3, 0.45, 1000.0}, NodalVectors::Zero(3, u.cols()), u);
  // Round-off of a direct solution.
  report.atMost("patch test, distorted mesh: relative error", "", 1e-12, (u - exact).norm() / exact.norm(),
                "linear field, exact");
}

/// Nodal loads of a traction along `axis` on the face z = L, exact for tractions that are linear over each triangle.
template <typename Traction>
NodalVectors endLoads(const TetMesh& mesh, double L, int axis, const Traction& traction) {
  NodalVectors loads = NodalVectors::Zero(3, mesh.positions.cols());
  for (const Triangle& t : boundaryTriangles(mesh.tetrahedra)) {
    const auto x = [&](std::size_t k) { return Vector3(mesh.positions.col(t[k])); };
    if (std::min({x(0).z(), x(1).z(), x(2).z()}) < L - 1e-9) continue;
    const double area = 0.5 * (x(1) - x(0)).cross(x(2) - x(0)).norm();
    const double sum = traction(x(0)) + traction(x(1)) + traction(x(2));
    for (std::size_t k = 0; k < 3; ++k) loads(axis, t[k]) += area / 12.0 * (sum + traction(x(k)));
  }
  return loads;
}

std::vector<bool> lowerFace(const TetMesh& mesh) {
  std::vector<bool> held;
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) held.push_back(mesh.positions(2, i) < 1e-9);
  return held;
}

// Bar pulled by F over its end face, free to contract: elongation F L / (E A), lateral strain -nu F / (E A).
void barInTension(Report& report) {
  const double L = 0.1;
  const double width = 0.02;
  const double E = 1e4;
  const double nu = 0.3;
  const double F = 0.05;
  const TetMesh mesh = makeBlock(Vector3(width, width, L), {2, 2, 6});
  const NodalVectors loads = endLoads(mesh, L, 2, [&](const Vector3&) { return F / (width * width); });
  const double strain = F / (E * width * width);
  const std::vector<bool> held = lowerFace(mesh);
  const NodalVectors exact = Vector3(-nu * strain, -nu * strain, strain).asDiagonal() * mesh.positions;
  NodalVectors u = exact;  // the lower face gets the exact lateral contraction
  for (Eigen::Index i = 0; i < u.cols(); ++i) {
    if (!held[i]) u.col(i).setZero();
  }
  solveLinear(mesh, held, {ElasticModel::kLinear, E, nu, 1000.0}, loads, u);
  const char* const source = "F L / (E A), lateral strain -nu F / (E A)";
  // A uniform state: round-off of a direct solution is left.
  report.near("bar: elongation", "m", strain * L, u.row(2).maxCoeff(), 1e-10 * strain * L, source);
  report.atMost("bar: worst displacement error, of the elongation", "", 1e-10,
                (u - exact).cwiseAbs().maxCoeff() / (strain * L), source);
}

/// A square beam, clamped or bent, 8 times as long as deep, with n cells across its depth.
struct Beam {
  static constexpr double L = 0.08;
  static constexpr double h = 0.01;
  static constexpr double E = 1e5;

  explicit Beam(int n) : mesh(makeBlock(Vector3(h, h, L), {n, n, 8 * n})) {}

  /// Mean of u_x over the nodes of the end face, m.
  double tipDeflection(const NodalVectors& u) const {
    double sum = 0.0;
    double count = 0.0;
    for (Eigen::Index i = 0; i < u.cols(); ++i) {
      if (mesh.positions(2, i) < L - 1e-9) continue;
      sum += u(0, i);
      count += 1.0;
    }
    return sum / count;
  }

  TetMesh mesh;
};

/// Tip deflection of a cantilever under an end load over that of Timoshenko's beam.
double cantileverRatio(int n, double nu) {
  const Beam beam(n);
  const double F = 1e-3;
  NodalVectors u = NodalVectors::Zero(3, beam.mesh.positions.cols());
  const NodalVectors loads = endLoads(beam.mesh, Beam::L, 0, [&](const Vector3&) { return F / (Beam::h * Beam::h); });
  solveLinear(beam.mesh, lowerFace(beam.mesh), {ElasticModel::kLinear, Beam::E, nu, 1000.0}, loads, u);
  const double inertia = std::pow(Beam::h, 4) / 12.0;
  const double shear_modulus = Beam::E / (2.0 * (1.0 + nu));
  const double timoshenko = F * std::pow(Beam::L, 3) / (3.0 * Beam::E * inertia) +
                            F * Beam::L / (5.0 / 6.0 * shear_modulus * Beam::h * Beam::h);
  return beam.tipDeflection(u) / timoshenko;
}

// Linear tetrahedra are too stiff in bending and approach the beam from below as the mesh is refined. The clamped end
// (no lateral contraction) makes the solid about 1 % stiffer than the beam, so 1 is not reached.
void cantilever(Report& report) {
  const char* const source = "Timoshenko's beam";
  const double coarse = cantileverRatio(1, 0.3);
  const double medium = cantileverRatio(2, 0.3);
  const double fine = cantileverRatio(4, 0.3);
  report.require("cantilever: softer with each refinement", coarse < medium && medium < fine, source);
  report.atLeast("cantilever, 4 cells deep: deflection over the beam's", "", 0.85, fine, source);
  report.atMost("cantilever, 4 cells deep: deflection over the beam's", "", 1.0, fine, source);
  // Second order in the element size: each halving leaves about a quarter of the error.
  report.atMost("cantilever: error with 4 cells over that with 2", "", 0.4, (1.0 - fine) / (1.0 - medium), source);
  // Nearly incompressible: linear tetrahedra lock. This states how much, so that a better element shows.
  const double locked = cantileverRatio(4, 0.49);
  report.atMost("cantilever, nu .49: deflection over that with .3", "", 1.0, locked / fine, "linear tetrahedra lock");
  report.atLeast("cantilever, nu .49: deflection over the beam's", "", 0.4, locked, source);
}

/// Stiffness of a beam bent by end moments over the exact one. The lower face has the exact displacements
/// u = kappa ((z^2 + nu (x^2 - y^2)) / 2, nu x y, -x z), the upper one the exact traction -E kappa x along z.
double bendingStiffness(int n, double nu) {
  const Beam beam(n);
  const double kappa = 1.0;
  NodalVectors exact(3, beam.mesh.positions.cols());
  for (Eigen::Index i = 0; i < exact.cols(); ++i) {
    const Vector3 p = beam.mesh.positions.col(i);
    exact.col(i) << 0.5 * (p.z() * p.z() + nu * (p.x() * p.x() - p.y() * p.y())), nu * p.x() * p.y(), -p.x() * p.z();
  }
  exact *= kappa;
  const std::vector<bool> held = lowerFace(beam.mesh);
  NodalVectors u = exact;
  for (Eigen::Index i = 0; i < u.cols(); ++i) {
    if (!held[i]) u.col(i).setZero();
  }
  const NodalVectors loads =
      endLoads(beam.mesh, Beam::L, 2, [&](const Vector3& p) { return -Beam::E * kappa * p.x(); });
  solveLinear(beam.mesh, held, {ElasticModel::kLinear, Beam::E, nu, 1000.0}, loads, u);
  return beam.tipDeflection(exact) / beam.tipDeflection(u);
}

// Without a clamp the solid has an exact answer for every Poisson's ratio, so that the order can be seen. It is the
// energy at a given bending, and so the stiffness, whose error is of second order from coarse meshes on.
void bentBeam(Report& report) {
  for (const double nu : {0.3, 0.49}) {
    const std::string name = nu == 0.3 ? "bent beam, nu .3" : "bent beam, nu .49";
    ConvergenceStudy study{name + ": stiffness over the exact one", "", "cell (m)", {}, 1.0};
    for (const int n : {2, 4, 8}) {
      study.levels.push_back({Beam::h / n, bendingStiffness(n, nu)});
      report.progress(nu == 0.3 ? 0.3 + 0.04 * n : 0.65 + 0.04 * n);
    }
    report.atLeast(name + ", 8 cells deep: stiffness", "", 1.0, study.levels[2].value,
                   "compatible elements: too stiff");
    report.near(name + ": order of convergence", "", 2.0, study.observedOrder(), 0.1, "2 for linear elements");
    report.convergence(study);
  }
}

}  // namespace

void validateElasticity(Report& report) {
  patchTest(report);
  barInTension(report);
  cantilever(report);
  bentBeam(report);
}

}  // namespace tissue_contact
