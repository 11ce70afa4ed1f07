/// What a tissue makes of its attachments and its pressure: how stiffness is shared out, which forces act, what is refused.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/tissue/tissue.h"
#include "validation/elasticity_helpers.h"

namespace tissue_contact {
namespace attachment_test {

constexpr double kPressure = 1600.0;

TissueDescription blockDescription() {
  TissueDescription description;
  description.name = "block";
  description.geometry = BlockDescription{Vector3(0.04, 0.03, 0.02), {4, 3, 2}, {}};
  description.material = {ElasticModel::kCorotational, 5e3, 0.45, 1050.0};
  return description;
}

/// The nodes and triangles of the lowest face, and nothing else.
Region base() { return PlaneRegion{}; }

Tissue withAttachments(const std::vector<Attachment>& attachments, const std::vector<Region>& fixed = {}) {
  TissueDescription description = blockDescription();
  description.attachments = attachments;
  description.fixed = fixed;
  return {description, Pose::Identity()};
}

/// Forces that a shift gives a body which resists no shift itself.
NodalVectors pullsOf(const Tissue& tissue, const Vector3& shift) {
  return elasticForces(tissue.elasticity(), tissue.restPositions().colwise() + shift);
}

TEST(Attachment, SharesStiffnessPerAreaByTheAreaAroundEachNode) {
  const Tissue tissue = withAttachments({{{base()}, 1e5, 0.0}});
  EXPECT_NEAR(tissue.attachmentStiffness(), 1e5 * 0.04 * 0.03, 1e-9);
  const Vector3 shift(1e-3, -2e-3, 3e-3);
  const NodalVectors pulls = pullsOf(tissue, shift);
  EXPECT_LE((pulls.rowwise().sum() + 120.0 * shift).norm(), 1e-9);
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    const bool attached = tissue.restPositions()(2, i) < 1e-9;
    EXPECT_EQ(pulls.col(i).norm() > 1e-6, attached) << i;
  }
}

TEST(Attachment, GivesEachNodeItsStiffnessAndAddsUpWhereSeveralHoldIt) {
  const Region corner = BoxRegion{Vector3(0.015, 0.01, -1.0), Vector3(1.0, 1.0, 0.005)};  // one node
  const Tissue tissue = withAttachments({{{base()}, 0.0, 10.0}, {{corner}, 0.0, 5.0}});
  EXPECT_NEAR(tissue.attachmentStiffness(), 20 * 10.0 + 5.0, 1e-12);
  const NodalVectors pulls = pullsOf(tissue, Vector3(0.0, 0.0, 1e-3));
  EXPECT_NEAR(pulls.row(2).minCoeff(), -0.015, 1e-9);
}

TEST(Attachment, PlacesOfOneEntryDoNotAddUp) {
  const Tissue tissue = withAttachments({{{base(), base()}, 0.0, 10.0}});
  EXPECT_NEAR(tissue.attachmentStiffness(), 200.0, 1e-12);
}

TEST(Attachment, PullsToTheRestPositionInTheWorld) {
  TissueDescription description = blockDescription();
  description.attachments = {{{base()}, 0.0, 10.0}};
  Pose X_WT = Pose::Identity();
  X_WT.translation() = Vector3(1.0, 2.0, 3.0);
  X_WT.linear() = Eigen::AngleAxisd(1.0, Vector3::UnitY()).toRotationMatrix();
  const Tissue tissue(description, X_WT);
  EXPECT_LE(pullsOf(tissue, Vector3::Zero()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LE((pullsOf(tissue, Vector3(1e-3, 0.0, 0.0)).rowwise().sum() - Vector3(-0.2, 0.0, 0.0)).norm(), 1e-10);
}

TEST(Attachment, FixedNodesNeedNoSpring) {
  const Region half = BoxRegion{Vector3(-1.0, -1.0, -1.0), Vector3(-0.005, 1.0, 1.0)};  // 8 nodes of the base
  EXPECT_NEAR(withAttachments({{{base()}, 0.0, 10.0}}, {half}).attachmentStiffness(), 120.0, 1e-12);
  EXPECT_EQ(withAttachments({}).attachmentStiffness(), 0.0);
}

void expectRefused(const TissueDescription& description, const std::string& entry, const std::string& problem) {
  try {
    const Tissue tissue(description, Pose::Identity());
    FAIL() << "accepted; expected: " << problem;
  } catch (const EntryError& error) {
    EXPECT_EQ(error.entry(), entry) << error.what();
    EXPECT_NE(std::string(error.what()).find(problem), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("tissue 'block'"), std::string::npos) << error.what();
  }
}

TEST(Attachment, RefusesWhatHoldsNothing) {
  TissueDescription description = blockDescription();
  const auto refuse = [&](const Attachment& attachment, const std::string& entry, const std::string& problem) {
    description.attachments = {{{base()}, 0.0, 1.0}, attachment};
    expectRefused(description, entry, problem);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Region far = SphereRegion{Vector3(1.0, 0.0, 0.0), 0.01};
  const Region point = SphereRegion{Vector3(-0.02, -0.015, 0.0), 1e-4};  // one node and no centroid
  refuse({{base()}, 0.0, 0.0}, "attachments[1]", "has no stiffness; give exactly one of");
  refuse({{base()}, 1.0, 1.0}, "attachments[1]", "has two stiffnesses; give exactly one of");
  refuse({{base()}, -1.0, 0.0}, "attachments[1]", "stiffness_pa_per_m is -1 Pa/m; it must be finite and > 0");
  refuse({{base()}, 0.0, nan}, "attachments[1]", "stiffness_n_per_m is nan N/m; it must be finite and > 0");
  refuse({{}, 0.0, 1.0}, "attachments[1].where", "has no region");
  refuse({{base(), far}, 0.0, 1.0}, "attachments[1].where[1]", "holds no node; all lie within");
  refuse({{point}, 1.0, 0.0}, "attachments[1].where[0]", "holds no centroid of a surface triangle");
  description.fixed = {base()};
  description.attachments = {{{base()}, 0.0, 1.0}};
  expectRefused(description, "attachments[0].where", "are fixed already; remove it, or enlarge its region");
}

NodalVectors shaken(const NodalVectors& rest, double size) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-size, size);
  NodalVectors x = rest;
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += uniform(random);
  return x;
}

NodalVectors pressureForces(const Tissue& tissue, const NodalVectors& x) {
  NodalVectors forces = NodalVectors::Zero(3, x.cols());
  tissue.addPressure(x, forces);
  return forces;
}

Vector3 moment(const NodalVectors& x, const NodalVectors& forces) {
  Vector3 sum = Vector3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) sum += Vector3(x.col(i)).cross(Vector3(forces.col(i)));
  return sum;
}

TEST(Pressure, OnAClosedSurfaceHasNeitherResultantNorMoment) {
  TissueDescription description = blockDescription();
  description.pressure_pa = kPressure;
  const Tissue tissue(description, Pose::Identity());
  for (const double size : {0.0, 3e-3}) {
    const NodalVectors x = shaken(tissue.restPositions(), size);
    const NodalVectors forces = pressureForces(tissue, x);
    EXPECT_GT(forces.cwiseAbs().sum(), 1.0);
    EXPECT_LE(forces.rowwise().sum().norm(), 1e-14 * forces.cwiseAbs().sum());
    EXPECT_LE(moment(x, forces).norm(), 1e-15 * forces.cwiseAbs().sum());
  }
}

// Of a closed surface it is the gradient of p times the enclosed volume, which sums of signed tetrahedra know.
TEST(Pressure, DoesTheWorkOfTheVolumeItTakes) {
  TissueDescription description = blockDescription();
  description.pressure_pa = kPressure;
  const Tissue tissue(description, Pose::Identity());
  const auto volume = [&](const NodalVectors& x) {
    double sum = 0.0;
    for (const Triangle& t : tissue.surface()) {
      sum += Vector3(x.col(t[0])).dot(Vector3(x.col(t[1])).cross(Vector3(x.col(t[2])))) / 6.0;
    }
    return sum;
  };
  NodalVectors x = shaken(tissue.restPositions(), 3e-3);
  const NodalVectors forces = pressureForces(tissue, x);
  const double h = 1e-6;  // the volume is linear in each coordinate: only round-off errs
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double before = x.data()[i];
    x.data()[i] = before + h;
    const double above = volume(x);
    x.data()[i] = before - h;
    const double below = volume(x);
    x.data()[i] = before;
    ASSERT_NEAR(forces.data()[i], -kPressure * (above - below) / (2.0 * h), 1e-8 * forces.cwiseAbs().maxCoeff());
  }
}

TEST(Pressure, OnAPartPushesInwardsByPressureTimesDeformedArea) {
  TissueDescription description = blockDescription();
  description.pressure_pa = kPressure;
  description.pressure_where = {PlaneRegion{Vector3(0.0, 0.0, 0.02), Vector3(0.0, 0.0, -1.0)}};
  const Tissue tissue(description, Pose::Identity());
  const NodalVectors wide = Vector3(2.0, 1.5, 1.0).asDiagonal() * tissue.restPositions();
  const Vector3 total = pressureForces(tissue, wide).rowwise().sum();
  EXPECT_LE((total - Vector3(0.0, 0.0, -kPressure * 3.0 * 0.04 * 0.03)).norm(), 1e-12);
  const Matrix3 R = Eigen::AngleAxisd(0.7, Vector3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  EXPECT_LE((pressureForces(tissue, R * wide).rowwise().sum() - R * total).norm(), 1e-12) << "it follows the surface";
}

TEST(Pressure, OnASheetActsAgainstItsNormal) {
  TissueDescription description;
  description.name = "sheet";
  description.geometry = SheetDescription{Vector2(0.04, 0.02), {4, 2}, 1e-3};
  description.material = {ElasticModel::kMembrane, 2e4, 0.4, 1000.0};
  description.pressure_pa = kPressure;
  const Tissue tissue(description, Pose::Identity());
  const Vector3 total = pressureForces(tissue, tissue.restPositions()).rowwise().sum();
  EXPECT_LE((total - Vector3(0.0, 0.0, -kPressure * 0.04 * 0.02)).norm(), 1e-12);
}

TEST(Pressure, WithoutOneNothingIsAdded) {
  const Tissue tissue(blockDescription(), Pose::Identity());
  EXPECT_TRUE(pressureForces(tissue, tissue.restPositions()).isZero(0.0));
}

TEST(Pressure, RefusesWhatActsNowhere) {
  TissueDescription description = blockDescription();
  description.pressure_where = {base()};
  expectRefused(description, "pressure_where", "pressure_pa is 0 or missing");
  description.pressure_pa = std::numeric_limits<double>::infinity();
  expectRefused(description, "pressure_pa", "it must be finite");
  description.pressure_pa = kPressure;
  description.pressure_where = {base(), SphereRegion{Vector3(1.0, 0.0, 0.0), 0.01}};
  expectRefused(description, "pressure_where[1]", "holds no centroid of a surface triangle");
}

TEST(Pressure, OfTwiceTheShearModulusIsForNeoHookeanTissue) {
  TissueDescription description = blockDescription();
  description.fixed = {base()};
  for (const ElasticModel model : {ElasticModel::kLinear, ElasticModel::kCorotational, ElasticModel::kNeoHookean}) {
    description.material.model = model;
    const double limit = description.material.youngs_modulus_pa / (1.0 + description.material.poissons_ratio);
    description.pressure_pa = 0.99 * limit;
    EXPECT_NO_THROW(checkTissue(description));
    description.pressure_pa = 1.01 * limit;
    if (model == ElasticModel::kNeoHookean) {
      EXPECT_NO_THROW(checkTissue(description));
    } else {
      EXPECT_THROW(checkTissue(description), EntryError);
    }
  }
}

TEST(Pressure, OnAFreeLinearBodyIsRefused) {
  TissueDescription description = blockDescription();
  description.material.model = ElasticModel::kLinear;
  description.pressure_pa = 100.0;
  EXPECT_THROW(checkTissue(description), EntryError);
  description.attachments = {{{base()}, 1e5, 0.0}};
  EXPECT_NO_THROW(checkTissue(description));
}

}  // namespace attachment_test
}  // namespace tissue_contact
