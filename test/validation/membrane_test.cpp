/// Closed forms of membranes and plates: patch test, strips in tension, a taut strip pushed aside, bending and twisting.
#include "tissue_contact/tissue/membrane.h"

#include <gtest/gtest.h>

#include <cmath>

#include "validation/elasticity_helpers.h"
#include "tissue_contact/tissue/sheet_mesh.h"

namespace tissue_contact {
namespace {

constexpr double kYoung = 1e6;
constexpr double kThickness = 1e-3;

Membrane makeMembrane(const SheetMesh& mesh, double nu, double bending) {
  return Membrane(mesh.positions, mesh.triangles, std::vector<bool>(mesh.positions.cols(), false), kThickness,
                  MaterialDescription{ElasticModel::kMembrane, kYoung, nu, 1000.0, bending});
}

/// Moves the nodes off the border within the plane by up to `size`.
void shakeInside(double size, SheetMesh& mesh) {
  const Vector3 low = mesh.positions.rowwise().minCoeff();
  const Vector3 high = mesh.positions.rowwise().maxCoeff();
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    auto x = mesh.positions.col(i);
    if (x.x() == low.x() || x.x() == high.x() || x.y() == low.y() || x.y() == high.y()) continue;
    x.head<2>() += size * Vector2(std::sin(7.0 * i), std::cos(5.0 * i));
  }
}

// A linear displacement within the plane, prescribed on the border, must be found inside a distorted mesh.
TEST(MembranePatch, LinearFieldIsExact) {
  SheetMesh mesh = makeSheetMesh({Vector2(0.04, 0.03), {4, 3}, kThickness});
  const Vector3 low = mesh.positions.rowwise().minCoeff();
  const Vector3 high = mesh.positions.rowwise().maxCoeff();
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    const auto x = mesh.positions.col(i);
    const bool border = x.x() == low.x() || x.x() == high.x() || x.y() == low.y() || x.y() == high.y();
    prescribed.insert(prescribed.end(), {border, border, true});
  }
  shakeInside(2e-3, mesh);
  Matrix3 gradient = Matrix3::Zero();
  gradient.topLeftCorner<2, 2>() << 0.010, 0.003, -0.002, 0.006;
  const NodalVectors exact = gradient * mesh.positions;
  for (const double bending : {0.0, -1.0}) {
    NodalVectors u = exact;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      if (!prescribed[i]) u.data()[i] = 0.0;
    }
    const Membrane membrane = makeMembrane(mesh, 0.3, bending);
    solveStatic(membrane.makeState()->stiffness, prescribed, NodalVectors::Zero(3, u.cols()), u);
    EXPECT_LE((u - exact).norm(), 1e-12 * exact.norm());
  }
}

constexpr double kLength = 0.06;
constexpr double kWidth = 0.02;

/// Loads that share `force` over the end x = L/2 of a strip, by length of border.
NodalVectors endLoads(const SheetMesh& mesh, const Vector3& force) {
  const double end = mesh.positions.row(0).maxCoeff();
  NodalVectors loads = NodalVectors::Zero(3, mesh.positions.cols());
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      if (mesh.positions(0, a) != end || mesh.positions(0, b) != end) continue;
      const double length = (mesh.positions.col(a) - mesh.positions.col(b)).norm();
      loads.col(a) += 0.5 * length / kWidth * force;
      loads.col(b) += 0.5 * length / kWidth * force;
    }
  }
  return loads;
}

// With nu = 0: F L / (E h b), and, the strain being the stretch less one, at any stretch.
TEST(Strip, StretchesByForceTimesLengthOverStiffness) {
  SheetMesh mesh = makeSheetMesh({Vector2(kLength, kWidth), {6, 2}, kThickness});
  shakeInside(2e-3, mesh);
  const Membrane membrane = makeMembrane(mesh, 0.0, 0.0);
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    const bool held = mesh.positions(0, i) == -0.5 * kLength;
    prescribed.insert(prescribed.end(), {held, held, true});
  }
  for (const double strain : {1e-3, 0.5}) {
    const double F = strain * kYoung * kThickness * kWidth;
    NodalVectors u = NodalVectors::Zero(3, mesh.positions.cols());
    const NodalVectors loads = endLoads(mesh, F * Vector3::UnitX());
    solveStatic(membrane.makeState()->stiffness, prescribed, loads, u);
    NodalVectors x = mesh.positions;
    const double residual = solveEquilibrium(membrane, prescribed, loads, 20, x);
    EXPECT_LE(residual, 1e-11 * F);
    for (Eigen::Index i = 0; i < u.cols(); ++i) {
      const double expected = strain * (mesh.positions(0, i) + 0.5 * kLength);
      ASSERT_NEAR(u(0, i), expected, 1e-10 * strain * kLength);
      ASSERT_NEAR(x(0, i) - mesh.positions(0, i), expected, 1e-10 * strain * kLength);
    }
  }
}

// Plane stress with nu > 0, free to contract: F L / (E h b) again, and lateral strain -nu F / (E h b).
TEST(Strip, ContractsByPoissonsRatio) {
  SheetMesh mesh = makeSheetMesh({Vector2(kLength, kWidth), {6, 2}, kThickness});
  const double nu = 0.4;
  const double strain = 1e-3;
  const Membrane membrane = makeMembrane(mesh, nu, 0.0);
  std::vector<bool> prescribed;
  NodalVectors u = NodalVectors::Zero(3, mesh.positions.cols());
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    prescribed.insert(prescribed.end(), {mesh.positions(0, i) == -0.5 * kLength, mesh.positions(1, i) == 0.0, true});
  }
  solveStatic(membrane.makeState()->stiffness, prescribed,
              endLoads(mesh, strain * kYoung * kThickness * kWidth * Vector3::UnitX()), u);
  for (Eigen::Index i = 0; i < u.cols(); ++i) {
    ASSERT_NEAR(u(0, i), strain * (mesh.positions(0, i) + 0.5 * kLength), 1e-10 * strain * kLength);
    ASSERT_NEAR(u(1, i), -nu * strain * mesh.positions(1, i), 1e-10 * strain * kLength);
  }
}

// A strip without bending stiffness, stretched between its ends and pushed aside across its middle: a string of tension
// T, deflection F l / (4 T), l its stretched length. Small, so that the tangent alone must give it.
TEST(Strip, TautItResistsLikeAString) {
  const SheetMesh mesh = makeSheetMesh({Vector2(kLength, kWidth), {6, 2}, kThickness});
  const Membrane membrane = makeMembrane(mesh, 0.0, 0.0);
  const double strain = 0.02;
  const NodalVectors x = Vector3(1.0 + strain, 1.0, 1.0).asDiagonal() * mesh.positions;
  const auto state = membrane.makeState();
  NodalVectors f(3, x.cols());
  membrane.update(x, *state, f);
  const double T = strain * kYoung * kThickness * kWidth;
  const double F = 1e-3 * T;
  std::vector<bool> prescribed;
  NodalVectors loads = NodalVectors::Zero(3, x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const bool end = std::abs(mesh.positions(0, i)) == 0.5 * kLength;
    prescribed.insert(prescribed.end(), {true, true, end});
    if (mesh.positions(0, i) == 0.0) loads(2, i) = mesh.positions(1, i) == 0.0 ? 0.5 * F : 0.25 * F;
  }
  NodalVectors u = NodalVectors::Zero(3, x.cols());
  solveStatic(state->stiffness, prescribed, loads, u);
  const double expected = F * kLength * (1.0 + strain) / (4.0 * T);
  EXPECT_NEAR(u.row(2).maxCoeff(), expected, 1e-9 * expected);
}

/// Tip deflection under an end load of a cantilever with n cells across and 3 n along, over that of a beam of bending
/// stiffness B b. Clamped by two rows of nodes, and therefore as long as from half way between them.
/// @param sag curvature at rest across the strip, 1/m: 0 takes the quadratic form of bending, else that of angles
double cantileverRatio(int n, double nu, double shake, double sag) {
  const double cell = kLength / (3 * n);
  SheetMesh mesh = makeSheetMesh({Vector2(kLength + cell, kWidth), {3 * n + 1, n}, kThickness});
  shakeInside(shake * cell, mesh);
  mesh.positions.row(2) = sag * mesh.positions.row(1).array().square();
  const double D = 1e-3;
  const Membrane membrane = makeMembrane(mesh, nu, D);
  const double low = mesh.positions.row(0).minCoeff();
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    prescribed.insert(prescribed.end(), 3, mesh.positions(0, i) < low + 1.5 * cell);
  }
  NodalVectors u = NodalVectors::Zero(3, mesh.positions.cols());
  const NodalVectors loads = endLoads(mesh, 1e-6 * Vector3::UnitZ());
  solveStatic(membrane.makeState()->stiffness, prescribed, loads, u);
  double tip = 0.0;
  for (Eigen::Index i = 0; i < u.cols(); ++i) tip += u(2, i) * loads(2, i) / 1e-6;
  const double length = kLength + 0.5 * cell;
  return tip / (1e-6 * length * length * length / (3.0 * D * (1.0 - nu * nu) * kWidth));
}

// Second order in the cells, from below. A grid without shaking is exact for bending along it but for the end load's
// last half cell.
TEST(Cantilever, SheetBendsAsAPlateStrip) {
  const double coarse = cantileverRatio(2, 0.0, 0.0, 0.0);
  const double fine = cantileverRatio(4, 0.0, 0.0, 0.0);
  RecordProperty("ratio_nu_0", std::to_string(coarse) + " " + std::to_string(fine));
  EXPECT_NEAR(coarse, 1.0, 0.01);
  EXPECT_NEAR(fine, 1.0, 0.003);
  EXPECT_NEAR((1.0 - coarse) / (1.0 - fine), 4.0, 0.5);
}

// With Poisson's ratio the beam's free contraction is held at the clamp, which makes the strip 2 to 4 % stiffer. What
// matters here: distorted and even meshes go to the same answer.
TEST(Cantilever, DistortedSheetsAgree) {
  const double even = cantileverRatio(8, 0.3, 0.0, 0.0);
  const double distorted = cantileverRatio(8, 0.3, 0.2, 0.0);
  RecordProperty("ratio_nu_0.3", std::to_string(even) + " " + std::to_string(distorted));
  EXPECT_NEAR(distorted, even, 0.005);
  EXPECT_GT(even, 0.94);
  EXPECT_LT(even, 1.0);
}

// A sag of 1e-6 of the width takes the bending by angles, which must be the same plate.
TEST(Cantilever, BendingByAnglesIsTheSamePlate) {
  for (const double nu : {0.0, 0.3}) {
    const double flat = cantileverRatio(3, nu, 0.1, 0.0);
    const double curved = cantileverRatio(3, nu, 0.1, 1e-4);
    EXPECT_NEAR(curved, flat, 1e-4);
    EXPECT_NE(curved, flat);  // else it did not
  }
}

// A square plate with forces +P, -P at alternate corners: pure twist, w = P x y / (2 D (1 - nu)) (Timoshenko).
TEST(Plate, TwistsByItsShearStiffness) {
  const auto ratio = [](int n, double shake) {
    SheetMesh mesh = makeSheetMesh({Vector2(kWidth, kWidth), {n, n}, kThickness});
    shakeInside(shake * kWidth / n, mesh);
    const double D = 1e-3;
    const double nu = 0.3;
    const double P = 1e-6;
    const Membrane membrane = makeMembrane(mesh, nu, D);
    std::vector<bool> prescribed(3 * mesh.positions.cols(), true);
    NodalVectors loads = NodalVectors::Zero(3, mesh.positions.cols());
    NodalVectors u = NodalVectors::Zero(3, mesh.positions.cols());
    const double w = P * 0.25 * kWidth * kWidth / (2.0 * D * (1.0 - nu));
    int corners = 0;
    double work = 0.0;
    for (Eigen::Index i = 0; i < u.cols(); ++i) {
      const double x = mesh.positions(0, i);
      const double y = mesh.positions(1, i);
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
  };
  const double coarse = ratio(4, 0.0);
  const double fine = ratio(8, 0.0);
  const double distorted = ratio(8, 0.2);
  RecordProperty("ratio", std::to_string(coarse) + " " + std::to_string(fine) + " " + std::to_string(distorted));
  EXPECT_NEAR(coarse, 1.0, 1e-9);  // constant curvature: exact on even meshes, whichever way the diagonals run
  EXPECT_NEAR(fine, 1.0, 1e-9);
  EXPECT_NEAR(distorted, 1.0, 0.02);
}

}  // namespace
}  // namespace tissue_contact
