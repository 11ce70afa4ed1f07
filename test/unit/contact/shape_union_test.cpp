// Shapes of one instrument that touch each other, as one solid: the groove between them against the closed form of a
// rolling ball, and what a tissue surface is told there.
#include "contact/shape/shape_union.h"

#include <gtest/gtest.h>

#include <cmath>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace shape_union_test {

constexpr double kR = 1.5e-3;  // two cylinders side by side along y, like a closed pair of jaws
constexpr double kRho = 0.75e-3;
constexpr double kRoom = 0.05 * kRho;

struct Jaws {
  std::unique_ptr<ShapeDistance> shape = makeCylinderDistance(kR, 0.02);
  PlacedShape left, right;

  /// @param apart free width between them, m. @param X moves both.
  explicit Jaws(double apart = 0.0, const Pose& X = Pose::Identity()) {
    Pose along_y = Pose::Identity();
    along_y.rotate(Eigen::AngleAxisd(0.5 * M_PI, Vector3::UnitX()));
    left = {shape.get(), X * at({-kR - 0.5 * apart, 0, 0}) * along_y};
    right = {shape.get(), X * at({kR + 0.5 * apart, 0, 0}) * along_y};
  }

  bool fill(const Vector3& p, SignedDistance& filled) const {
    return fillGroove(left, right, p, kRho, kRoom, distanceAt(left, p), distanceAt(right, p), filled);
  }
};

/// Height of the centre of the ball that lies on both touching cylinders.
double ballHeight() { return std::sqrt((kR + kRho) * (kR + kRho) - kR * kR); }

TEST(ShapeUnion, TheGrooveOfTouchingCylindersIsFilledAsByARollingBall) {
  const Jaws jaws;
  for (const double z : {0.2e-3, 0.5e-3, 0.9e-3}) {
    for (const double x : {-0.1e-3, 0.0, 0.15e-3}) {
      SignedDistance filled;
      const Vector3 p(x, 0.002, z);
      ASSERT_TRUE(jaws.fill(p, filled)) << x << " " << z;
      const Vector3 to_centre = Vector3(0.0, 0.002, ballHeight()) - p;
      // The ball is placed to a hundredth of its radius.
      EXPECT_NEAR(filled.distance, kRho - to_centre.norm(), 0.02 * kRho);
      EXPECT_NEAR((filled.normal - to_centre.normalized()).norm(), 0.0, 0.03);
    }
  }
}

TEST(ShapeUnion, BothShapesTellTheSameAndItTurnsWithThem) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    const Pose X = random.pose(0.05);
    const Jaws here, there(0.0, X);
    const Vector3 p(random.number(-2e-4, 2e-4), random.number(-5e-3, 5e-3), random.number(3e-4, 9e-4));
    SignedDistance a, b, turned;
    ASSERT_TRUE(here.fill(p, a));
    ASSERT_TRUE(
        fillGroove(here.right, here.left, p, kRho, kRoom, distanceAt(here.right, p), distanceAt(here.left, p), b));
    ASSERT_TRUE(there.fill(X * p, turned));
    EXPECT_NEAR(a.distance, b.distance, 1e-9);
    EXPECT_NEAR(a.distance, turned.distance, 1e-9);
    EXPECT_NEAR((X.linear() * a.normal - turned.normal).norm(), 0.0, 1e-6);
  }
}

TEST(ShapeUnion, TheOutlineStaysAwayFromTheGroove) {
  const Jaws jaws;
  SignedDistance filled;
  EXPECT_FALSE(jaws.fill({-kR, 0, kR + 1e-4}, filled));       // on top of one
  EXPECT_FALSE(jaws.fill({-2.0 * kR - 1e-4, 0, 0}, filled));  // outside
  EXPECT_FALSE(jaws.fill({0, 0, 2.5e-3}, filled));            // high above the groove
}

TEST(ShapeUnion, OpenJawsAreNotFilled) {
  SignedDistance filled;
  const Jaws open(2.0e-3);  // the ball goes through
  for (const double x : {-0.9e-3, 0.0, 0.9e-3}) {
    for (const double z : {0.0, 0.5e-3}) EXPECT_FALSE(open.fill({x, 0, z}, filled)) << x << " " << z;
  }
  // Parallel faces do not close however near they are.
  const std::unique_ptr<ShapeDistance> plate = makeBoxDistance({0.5e-3, 5e-3, 5e-3});
  const PlacedShape left{plate.get(), at({-0.8e-3, 0, 0})}, right{plate.get(), at({0.8e-3, 0, 0})};
  const Vector3 p(0.1e-3, 0, 0);
  EXPECT_FALSE(fillGroove(left, right, p, kRho, kRoom, distanceAt(left, p), distanceAt(right, p), filled));
}

// Round walls seem to close (their normals turn towards each other) and do not: between fingers of 9 mm, 2 mm apart, a fin of 1.5 mm was squeezed with
// .12 N by what it did not touch.
TEST(ShapeUnion, RoundShapesThatStandApartAreNotFilled) {
  for (const double apart : {0.25, 0.5, 1.0, 2.0}) {  // of rho
    const Jaws open(apart * kRho);
    for (double z = 0.1e-3; z < 2.0e-3; z += 0.1e-3) {
      SignedDistance filled;
      for (const double x : {-0.4, 0.0, 0.4}) {
        EXPECT_FALSE(open.fill({x * apart * kRho, 0.002, z}, filled)) << apart << " " << x << " " << z;
      }
    }
  }
}

// Jaws that stand apart in a V meet where they turn; what is filled there is not filled where they are open.
TEST(ShapeUnion, RoundJawsThatOpenInAVAreFilledWhereTheyMeet) {
  for (const double degrees : {2.0, 5.0, 10.0}) {
    Jaws jaws;
    for (PlacedShape* jaw : {&jaws.left, &jaws.right}) {  // about the middle of their far ends, where they touch
      const double angle = (jaw == &jaws.left ? 0.5 : -0.5) * degrees * M_PI / 180.0;
      const Pose turn = at({0, -0.01, 0}) * Pose(Eigen::AngleAxisd(angle, Vector3::UnitZ())) * at({0, 0.01, 0});
      jaw->X_WS = turn * jaw->X_WS;
    }
    for (double y = -0.0095; y < 0.009; y += 0.0005) {
      const double apart = 2.0 * std::sin(0.5 * degrees * M_PI / 180.0) * (y + 0.01);
      for (double z = 0.1e-3; z < 1.4e-3; z += 0.1e-3) {
        SignedDistance filled;
        if (apart > 0.5 * kRho) {
          EXPECT_FALSE(jaws.fill({0, y, z}, filled)) << degrees << " " << y << " " << z;
        } else if (apart < kRoom && z > 0.2e-3 && z < 0.9e-3) {
          EXPECT_TRUE(jaws.fill({0, y, z}, filled)) << degrees << " " << y << " " << z;
        }
      }
    }
  }
}

/// A cylinder lies on a plate: wherever both are turned to, the same.
TEST(ShapeUnion, ACylinderOnAPlateIsFilledWhereverItIsTurned) {
  const std::unique_ptr<ShapeDistance> plate = makeBoxDistance({5e-3, 0.02, 1e-3});
  const Jaws jaws;
  Random random(5);
  int filled_points = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3 p(random.number(0.2e-3, 2.2e-3), 0.0, random.number(0.05e-3, 1.2e-3));
    std::vector<double> stands;
    for (int k = 0; k < 4; ++k) {
      const Pose X = k == 0 ? Pose::Identity() : random.pose(0.05);
      const PlacedShape cylinder{jaws.shape.get(), X * at({kR, 0, kR}) * jaws.left.X_WS};
      const PlacedShape table{plate.get(), X * at({0, 0, -1e-3})};
      SignedDistance filled;
      const bool is = fillGroove(cylinder, table, X * p, kRho, kRoom, distanceAt(cylinder, X * p),
                                 distanceAt(table, X * p), filled);
      stands.push_back(is ? filled.distance : 1.0);
    }
    filled_points += stands[0] < 1.0;
    for (const double one : stands) EXPECT_NEAR(one, stands[0], 1e-8) << p.transpose();
  }
  EXPECT_GT(filled_points, 30);
}

// As they close the filling comes by and by: how far it stands from a point at a time.
TEST(ShapeUnion, TheFillingGrowsAsShapesClose) {
  double before = 0.0;
  for (int k = 0; k <= 100; ++k) {
    SignedDistance filled;
    const Jaws jaws((0.25 - 0.0025 * k) * kRho);
    const double free = distanceAt(jaws.left, {0, 0.002, 0.5e-3}).distance;
    const double stands = jaws.fill({0, 0.002, 0.5e-3}, filled) ? free - filled.distance : 0.0;
    EXPECT_GE(stands, before - 0.02 * kRho) << k;  // the ball is placed to a hundredth of its radius
    EXPECT_LE(stands, before + 0.06 * kRho) << k;
    before = stands;
  }
  EXPECT_GT(before, 0.2 * kRho);
}

/// One instrument of two spheres over one triangle.
struct TwoSpheres {
  std::vector<Instrument> instruments;
  std::vector<std::vector<Pose>> X_WL{{Pose::Identity(), Pose::Identity()}};

  explicit TwoSpheres(double apart) {
    const double x = kR + 0.5 * apart;
    instruments.push_back(
        makeInstrument("tool", {{SphereGeometry{kR}, at({-x, 0, 0})}, {SphereGeometry{kR}, at({x, 0, 0})}}));
  }
};

/// Contacts of a small tent of tissue whose ridge is a point at `tip`; its faces fall away from the tool above.
std::vector<Contact> contactsOfTip(const TwoSpheres& tool, const Vector3& tip, int& pinched) {
  NodalVectors x(3, 4);
  x << tip.x(), 4e-3, -4e-3, 0.0, tip.y(), -4e-3, -4e-3, 5e-3, tip.z(), -8e-3, -8e-3, -8e-3;
  TissueSurface surface;
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  surface.fixed.assign(4, false);
  ContactDetector detector(tool.instruments, shareSurfaces({surface}, {x}));
  std::vector<Contact> contacts;
  detector.detect({x}, tool.X_WL, 2e-4, contacts);
  pinched = detector.pinchedContacts();
  return contacts;
}

TEST(ShapeUnion, ATipInTheGrooveIsPressedOutOfItNotIntoIt) {
  int pinched = 0;
  const std::vector<Contact> contacts = contactsOfTip(TwoSpheres(0.0), {0, 0, -0.6e-3}, pinched);
  ASSERT_FALSE(contacts.empty());
  EXPECT_EQ(pinched, 0);
  int at_tip = 0;
  for (const Contact& contact : contacts) {
    if (contact.key.feature[1] >= 0) continue;  // the tip itself
    ++at_tip;
    EXPECT_LT(contact.R_WC.col(0).z(), -0.99);  // without the other sphere: the slope of one, -.37
    EXPECT_NEAR(contact.gap_m, kRho - (ballHeight() - 0.6e-3), 0.02 * kRho);
  }
  EXPECT_EQ(at_tip, 2);  // one for each sphere
}

TEST(ShapeUnion, ATipWithoutRoomIsLetGoAndCounted) {
  int pinched = 0;
  for (const Contact& contact : contactsOfTip(TwoSpheres(0.0), {0, 0, 0}, pinched)) {
    EXPECT_GE(contact.key.feature[1], 0) << "the tip is where the spheres touch";
  }
  EXPECT_GT(pinched, 0);
  // With room it is held from both sides, as tissue in a grip is.
  const std::vector<Contact> held = contactsOfTip(TwoSpheres(0.2e-3), {0, 0, 0}, pinched);
  EXPECT_EQ(pinched, 0);
  std::vector<double> normals;
  for (const Contact& contact : held) {
    if (contact.key.feature[1] < 0) normals.push_back(contact.R_WC(0, 0));
  }
  ASSERT_EQ(normals.size(), 2U);
  EXPECT_LT(normals[0] * normals[1], -0.9);
}

}  // namespace shape_union_test
}  // namespace tissue_contact::contact_test
