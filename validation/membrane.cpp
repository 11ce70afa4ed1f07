/// Form J: closed forms of membranes and plates: patch test, strips in tension, a taut strip pushed aside, bending and twisting.
#include "tissue/membrane.h"

#include <algorithm>
#include <cmath>

#include "tissue_contact/mesh/triangle_mesh.h"
#include "validation/closed_forms.h"
#include "validation/elasticity_helpers.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kYoung = 1e6;
constexpr double kThickness = 1e-3;

Membrane makeMembrane(const TriangleMesh& mesh, double nu, double bending) {
  return Membrane(mesh.vertices, mesh.triangles, std::vector<bool>(mesh.vertices.cols(), false), kThickness,
                  MaterialDescription{ElasticModel::kMembrane, kYoung, nu, 1000.0, bending});
}

/// Moves the nodes off the border within the plane by up to `size`.
void shakeInside(double size, TriangleMesh& mesh) {
  const Vector3 low = mesh.vertices.rowwise().minCoeff();
  const Vector3 high = mesh.vertices.rowwise().maxCoeff();
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    auto x = mesh.vertices.col(i);
    if (x.x() == low.x() || x.x() == high.x() || x.y() == low.y() || x.y() == high.y()) continue;
    const auto any = static_cast<double>(i);
    x.head<2>() += size * Vector2(std::sin(7.0 * any), std::cos(5.0 * any));
  }
}

// A linear displacement within the plane, prescribed on the border, must be found inside a distorted mesh.
void patchTest(Report& report) {
  TriangleMesh mesh = makeSheetMesh({Vector2(0.04, 0.03), {4, 3}, kThickness});
  const Vector3 low = mesh.vertices.rowwise().minCoeff();
  const Vector3 high = mesh.vertices.rowwise().maxCoeff();
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const auto x = mesh.vertices.col(i);
    const bool border = x.x() == low.x() || x.x() == high.x() || x.y() == low.y() || x.y() == high.y();
    prescribed.insert(prescribed.end(), {border, border, true});
  }
  shakeInside(2e-3, mesh);
  Matrix3 gradient = Matrix3::Zero();
  gradient.topLeftCorner<2, 2>() << 0.010, 0.003, -0.002, 0.006;
  const NodalVectors exact = gradient * mesh.vertices;
  for (const double bending : {0.0, -1.0}) {
    NodalVectors u = exact;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (!prescribed[i]) u.data()[i] = 0.0;
    }
    const Membrane membrane = makeMembrane(mesh, 0.3, bending);
    solveStatic(membrane.makeState()->stiffness, prescribed, NodalVectors::Zero(3, u.cols()), u);
    // Round-off of a direct solution.
    report.atMost(std::string("patch test, ") + (bending < 0.0 ? "with" : "without") + " bending: relative error", "",
                  1e-12, (u - exact).norm() / exact.norm(), "linear field, exact");
  }
}

constexpr double kLength = 0.06;
constexpr double kWidth = 0.02;

/// Loads that share `force` over the end x = L/2 of a strip, by length of border.
NodalVectors endLoads(const TriangleMesh& mesh, const Vector3& force) {
  const double end = mesh.vertices.row(0).maxCoeff();
  NodalVectors loads = NodalVectors::Zero(3, mesh.vertices.cols());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      if (mesh.vertices(0, a) != end || mesh.vertices(0, b) != end) continue;
      const double length = (mesh.vertices.col(a) - mesh.vertices.col(b)).norm();
      loads.col(a) += 0.5 * length / kWidth * force;
      loads.col(b) += 0.5 * length / kWidth * force;
    }
  }
  return loads;
}

constexpr const char* kInTension = "F L / (E h b)";

// With nu = 0: F L / (E h b), and, the strain being the stretch less one, at any stretch.
void stripInTension(Report& report) {
  TriangleMesh mesh = makeSheetMesh({Vector2(kLength, kWidth), {6, 2}, kThickness});
  shakeInside(2e-3, mesh);
  const Membrane membrane = makeMembrane(mesh, 0.0, 0.0);
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const bool held = mesh.vertices(0, i) == -0.5 * kLength;
    prescribed.insert(prescribed.end(), {held, held, true});
  }
  for (const double strain : {1e-3, 0.5}) {
    const double F = strain * kYoung * kThickness * kWidth;
    NodalVectors u = NodalVectors::Zero(3, mesh.vertices.cols());
    const NodalVectors loads = endLoads(mesh, F * Vector3::UnitX());
    solveStatic(membrane.makeState()->stiffness, prescribed, loads, u);
    NodalVectors x = mesh.vertices;
    const double residual = solveEquilibrium(membrane, prescribed, loads, 20, x);
    const Eigen::RowVectorXd expected = strain * (mesh.vertices.row(0).array() + 0.5 * kLength);
    const std::string name = strain < 0.1 ? "strip stretched by .1 %: " : "strip stretched by 50 %: ";
    report.near(name + "elongation", "m", strain * kLength, x.row(0).maxCoeff() - 0.5 * kLength,
                1e-10 * strain * kLength, kInTension);
    // Round-off of direct solutions.
    report.atMost(name + "worst error of the tangent", "", 1e-10,
                  (u.row(0) - expected).cwiseAbs().maxCoeff() / (strain * kLength), kInTension);
    report.atMost(name + "worst error of the equilibrium", "", 1e-10,
                  (x.row(0) - mesh.vertices.row(0) - expected).cwiseAbs().maxCoeff() / (strain * kLength), kInTension);
    report.atMost(name + "imbalance over F", "", 1e-11, residual / F, "equilibrium");
  }
}

// Plane stress with nu > 0, free to contract: F L / (E h b) again, and lateral strain -nu F / (E h b).
void stripContracts(Report& report) {
  TriangleMesh mesh = makeSheetMesh({Vector2(kLength, kWidth), {6, 2}, kThickness});
  const double nu = 0.4;
  const double strain = 1e-3;
  const Membrane membrane = makeMembrane(mesh, nu, 0.0);
  std::vector<bool> prescribed;
  NodalVectors u = NodalVectors::Zero(3, mesh.vertices.cols());
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    prescribed.insert(prescribed.end(), {mesh.vertices(0, i) == -0.5 * kLength, mesh.vertices(1, i) == 0.0, true});
  }
  solveStatic(membrane.makeState()->stiffness, prescribed,
              endLoads(mesh, strain * kYoung * kThickness * kWidth * Vector3::UnitX()), u);
  const Eigen::RowVectorXd along = strain * (mesh.vertices.row(0).array() + 0.5 * kLength);
  report.atMost("strip, nu .4: worst error along, of the elongation", "", 1e-10,
                (u.row(0) - along).cwiseAbs().maxCoeff() / (strain * kLength), kInTension);
  report.atMost("strip, nu .4: worst error across, of the elongation", "", 1e-10,
                (u.row(1) + nu * strain * mesh.vertices.row(1)).cwiseAbs().maxCoeff() / (strain * kLength),
                "lateral strain -nu F / (E h b)");
}

// A strip without bending stiffness, stretched between its ends and pushed aside across its middle: a string of tension
// T, deflection F l / (4 T), l its stretched length. Small, so that the tangent alone must give it.
void tautStrip(Report& report) {
  const TriangleMesh mesh = makeSheetMesh({Vector2(kLength, kWidth), {6, 2}, kThickness});
  const Membrane membrane = makeMembrane(mesh, 0.0, 0.0);
  const double strain = 0.02;
  const NodalVectors x = Vector3(1.0 + strain, 1.0, 1.0).asDiagonal() * mesh.vertices;
  const auto state = membrane.makeState();
  NodalVectors f(3, x.cols());
  membrane.update(x, *state, f);
  const double T = strain * kYoung * kThickness * kWidth;
  const double F = 1e-3 * T;
  std::vector<bool> prescribed;
  NodalVectors loads = NodalVectors::Zero(3, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const bool end = std::abs(mesh.vertices(0, i)) == 0.5 * kLength;
    prescribed.insert(prescribed.end(), {true, true, end});
    if (mesh.vertices(0, i) == 0.0) loads(2, i) = mesh.vertices(1, i) == 0.0 ? 0.5 * F : 0.25 * F;
  }
  NodalVectors u = NodalVectors::Zero(3, x.cols());
  solveStatic(state->stiffness, prescribed, loads, u);
  const double expected = F * kLength * (1.0 + strain) / (4.0 * T);
  report.near("taut strip pushed aside: deflection", "m", expected, u.row(2).maxCoeff(), 1e-9 * expected,
              "string, F l / (4 T)");
}

/// Tip deflection under an end load of a cantilever with n cells across and 3 n along, over that of a beam of bending
/// stiffness B b. Clamped by two rows of nodes, and therefore as long as from half way between them.
/// @param sag curvature at rest across the strip, 1/m: 0 takes the quadratic form of bending, else that of angles
double cantileverRatio(int n, double nu, double shake, double sag) {
  const double cell = kLength / (3 * n);
  TriangleMesh mesh = makeSheetMesh({Vector2(kLength + cell, kWidth), {3 * n + 1, n}, kThickness});
  shakeInside(shake * cell, mesh);
  mesh.vertices.row(2) = sag * mesh.vertices.row(1).array().square();
  const double D = 1e-3;
  const Membrane membrane = makeMembrane(mesh, nu, D);
  const double low = mesh.vertices.row(0).minCoeff();
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    prescribed.insert(prescribed.end(), 3, mesh.vertices(0, i) < low + 1.5 * cell);
  }
  NodalVectors u = NodalVectors::Zero(3, mesh.vertices.cols());
  const NodalVectors loads = endLoads(mesh, 1e-6 * Vector3::UnitZ());
  solveStatic(membrane.makeState()->stiffness, prescribed, loads, u);
  double tip = 0.0;
  for (Eigen::Index i = 0; i < u.cols(); ++i) tip += u(2, i) * loads(2, i) / 1e-6;
  const double length = kLength + 0.5 * cell;
  return tip / (1e-6 * length * length * length / (3.0 * D * (1.0 - nu * nu) * kWidth));
}

constexpr const char* kPlateStrip = "plate strip, F L^3 / (3 B b)";

// Second order in the cells, from below. A grid without shaking is exact for bending along it but for the end load's
// last half cell.
void plateStrip(Report& report) {
  ConvergenceStudy study{"sheet as cantilever: deflection over the plate strip's", "", "cell (m)", {}, 1.0};
  for (const int n : {2, 4, 8}) study.levels.push_back({kLength / (3 * n), cantileverRatio(n, 0.0, 0.0, 0.0)});
  report.near("cantilever, 2 cells across: deflection", "", 1.0, study.levels[0].value, 0.01, kPlateStrip);
  report.near("cantilever, 4 cells across: deflection", "", 1.0, study.levels[1].value, 0.003, kPlateStrip);
  report.near("cantilever: order of convergence", "", 2.0, study.observedOrder(), 0.2, "second order in the cells");
  report.convergence(study);
}

// With Poisson's ratio the beam's free contraction is held at the clamp, which makes the strip 2 to 4 % stiffer. What
// matters here: distorted and even meshes go to the same answer.
void distortedSheet(Report& report) {
  const double even = cantileverRatio(8, 0.3, 0.0, 0.0);
  const double distorted = cantileverRatio(8, 0.3, 0.2, 0.0);
  report.near("cantilever, nu .3, distorted mesh: deflection", "", even, distorted, 0.005, "that of the even mesh");
  report.atLeast("cantilever, nu .3: deflection", "", 0.94, even, "plate strip, 2 to 4 % stiffer by its clamp");
  report.atMost("cantilever, nu .3: deflection", "", 1.0, even, kPlateStrip);
}

// A sag of 1e-6 of the width takes the bending by angles, which must be the same plate.
void bendingByAngles(Report& report) {
  for (const double nu : {0.0, 0.3}) {
    const double flat = cantileverRatio(3, nu, 0.1, 0.0);
    const double curved = cantileverRatio(3, nu, 0.1, 1e-4);
    const std::string name = std::string("cantilever, nu ") + (nu == 0.0 ? "0" : ".3");
    report.near(name + ", sagging: deflection", "", flat, curved, 1e-4, "that of the flat sheet");
    report.require(name + ": another form of bending was taken", curved != flat, "bending by angles");
  }
}

// A square plate with forces +P, -P at alternate corners: pure twist, w = P x y / (2 D (1 - nu)) (Timoshenko).
double twistRatio(int n, double shake) {
  TriangleMesh mesh = makeSheetMesh({Vector2(kWidth, kWidth), {n, n}, kThickness});
  shakeInside(shake * kWidth / n, mesh);
  const double D = 1e-3;
  const double nu = 0.3;
  const double P = 1e-6;
  const Membrane membrane = makeMembrane(mesh, nu, D);
  std::vector<bool> prescribed(3 * mesh.vertices.cols(), true);
  NodalVectors loads = NodalVectors::Zero(3, mesh.vertices.cols());
  NodalVectors u = NodalVectors::Zero(3, mesh.vertices.cols());
  const double w = P * 0.25 * kWidth * kWidth / (2.0 * D * (1.0 - nu));
  int corners = 0;
  double work = 0.0;
  for (Eigen::Index i = 0; i < u.cols(); ++i) {
    const double x = mesh.vertices(0, i);
    const double y = mesh.vertices(1, i);
    prescribed[3 * i + 2] = false;
    if (std::abs(x) < 0.5 * kWidth || std::abs(y) < 0.5 * kWidth) continue;
    loads(2, i) = x * y > 0.0 ? P : -P;
    if (corners++ < 3) {  // statically determinate: without reaction
      prescribed[3 * i + 2] = true;
      u(2, i) = x * y > 0.0 ? w : -w;
    }
  }
  solveStatic(membrane.makeState()->stiffness, prescribed, loads, u);
  for (Eigen::Index i = 0; i < u.cols(); ++i) work += loads(2, i) * u(2, i);
  // Prescribed corners move as the closed form says; the fourth tells the stiffness: 3 w + its own.
  return work / P / w - 3.0;
}

// Constant curvature: exact on even meshes, whichever way the diagonals run.
void twistedPlate(Report& report) {
  const char* const source = "pure twist (Timoshenko)";
  report.near("twisted plate, 4 x 4 cells: deflection", "", 1.0, twistRatio(4, 0.0), 1e-9, source);
  report.near("twisted plate, 8 x 8 cells: deflection", "", 1.0, twistRatio(8, 0.0), 1e-9, source);
  report.near("twisted plate, distorted mesh: deflection", "", 1.0, twistRatio(8, 0.2), 0.02, source);
}

}  // namespace

void validateMembrane(Report& report) {
  patchTest(report);
  stripInTension(report);
  stripContracts(report);
  tautStrip(report);
  plateStrip(report);
  distortedSheet(report);
  bendingByAngles(report);
  twistedPlate(report);
}

}  // namespace tissue_contact
