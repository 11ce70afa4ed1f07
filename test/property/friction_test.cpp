/// Every friction law through one suite: it dissipates, its limits nest, and a contact solved with it satisfies every
/// condition the law puts on it. Seeded; thousands of samples each.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <random>

#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace {

using Kind = FrictionLawDescription::Kind;
using LawPointer = std::unique_ptr<const AnisotropicFriction>;

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vector2 direction() {
    const double angle = uniform(-M_PI, M_PI);
    return {std::cos(angle), std::sin(angle)};
  }
  /// Compliance of about 1/mass with random coupling, and a velocity that closes the contact.
  Matrix3 compliance(double coupling) {
    Matrix3 B;
    for (int i = 0; i < 9; ++i) B.data()[i] = coupling * uniform(-1.0, 1.0);
    return B * B.transpose() + Matrix3::Identity();
  }
  Vector3 closing() { return {-uniform(0.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 1.0)}; }

 private:
  std::mt19937 engine_;
};

std::vector<double> coefficients(Random& random, std::size_t count, double largest) {
  std::vector<double> mu(count);
  for (double& value : mu) value = random.uniform(0.1, 1.0) * largest;
  return mu;
}

/// Positive semidefinite symmetric part, of rank 1 or 2, and a skew part: friction that pulls sideways.
std::vector<double> tensor(Random& random, double largest, bool full_rank) {
  const Vector2 along = random.direction();
  const Vector2 across(-along.y(), along.x());
  Matrix2 M = random.uniform(0.1, 1.0) * largest * along * along.transpose();
  if (full_rank) M += random.uniform(0.1, 1.0) * largest * across * across.transpose();
  const double skew = full_rank ? random.uniform(-0.5, 0.5) * largest : 0.0;
  return {M(0, 0), M(0, 1) + skew, M(1, 0) - skew, M(1, 1)};
}

struct LawCase {
  const char* name;
  Kind kind;
  bool jumps;  ///< no friction along some direction, so that it jumps there or holds nothing
  std::vector<double> (*kinetic)(Random& random, double largest);
};

void PrintTo(const LawCase& law_case, std::ostream* stream) { *stream << law_case.name; }

constexpr int kTableAngles = 7;

/// Static friction is `ratio` times kinetic friction in every direction; a tensor's also turned and mirrored, which
/// leaves the set it can hold as it is.
FrictionLawDescription describe(const LawCase& law_case, Random& random, double largest, double ratio) {
  FrictionLawDescription law;
  law.kind = law_case.kind;
  law.kinetic_coefficients = law_case.kinetic(random, largest);
  law.static_coefficients = law.kinetic_coefficients;
  if (law.kind == Kind::kTensor) {
    const std::vector<double>& m = law.kinetic_coefficients;
    law.static_coefficients = {-m[1], m[0], -m[3], m[2]};
  }
  for (double& mu : law.static_coefficients) mu *= ratio;
  if (law.kind != Kind::kTable) return law;
  law.angles_rad = {0.0};
  for (int i = 1; i < kTableAngles; ++i) {
    law.angles_rad.push_back((i + random.uniform(-0.4, 0.4)) * 2.0 * M_PI / kTableAngles);
  }
  return law;
}

CoulombLaw contactLaw(const LawPointer& anisotropic, const Vector2& axis) {
  CoulombLaw law;
  law.anisotropic = anisotropic.get();
  law.axis = axis;
  return law;
}

/// Of the terms that add up to u: what round-off is measured against.
double scaleOf(const Matrix3& W, const Vector3& q, const Vector3& r) { return q.norm() + W.norm() * r.norm(); }

class FrictionProperty : public testing::TestWithParam<LawCase> {
 protected:
  LawPointer randomLaw(double largest = 1.0, double ratio = 1.0) {
    return makeAnisotropicFriction(describe(GetParam(), random_, largest, ratio));
  }

  Random random_{11};
};

/// Laws whose friction is the point of the limit that dissipates most.
class AssociatedFriction : public FrictionProperty {};

TEST_P(FrictionProperty, ForceDissipatesAndLiesOnItsLimit) {
  for (int law_sample = 0; law_sample < 200; ++law_sample) {
    const LawPointer law = randomLaw(1.0, random_.uniform(1.0, 2.0));
    for (int sample = 0; sample < 100; ++sample) {
      const Vector2 d = random_.direction();
      const Vector2 f = law->slidingForce(d);
      ASSERT_LE(f.dot(d), 1e-16);
      ASSERT_LE(law->use(f, true), 1.0 + 1e-12);
      if (GetParam().jumps) continue;
      ASSERT_GE(law->use(f, true), 1.0 - 1e-12);
    }
  }
}

TEST_P(FrictionProperty, StaticLimitHoldsTheKineticOne) {
  for (int law_sample = 0; law_sample < 200; ++law_sample) {
    const double ratio = random_.uniform(1.0, 2.0);
    const LawPointer law = randomLaw(1.0, ratio);
    for (int sample = 0; sample < 100; ++sample) {
      const Vector2 f = random_.uniform(0.0, 1.0) * random_.direction();
      const double use = law->use(f, true);
      ASSERT_LE(law->use(f, false), use * (1.0 + 1e-12) / ratio);
      if (use > 1e3) continue;  // hardly any friction along f: a small difference of large numbers
      const double share = random_.uniform(0.0, 3.0);
      ASSERT_NEAR(law->use(share * f, true), share * use, 1e-14 * share * use);
    }
  }
}

/// Checks everything that u = W r + q has to satisfy for this law.
void expectSolved(const LawCase& law_case, const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding,
                  const ContactAnswer& answer, double tolerance) {
  const Vector3& r = answer.impulse;
  const Vector3 u = W * r + q;
  const double scale = scaleOf(W, q, r);
  const Vector2 u_t = u.tail<2>();
  const Vector2 r_t = r.tail<2>();
  ASSERT_TRUE(r.allFinite());
  if (answer.state == ContactState::kOpen) {
    ASSERT_EQ(r, Vector3::Zero());
    ASSERT_GE(u[0], 0.0);
    return;
  }
  ASSERT_GT(r[0], 0.0);
  ASSERT_LE(std::abs(u[0]), tolerance * scale);
  if (answer.state == ContactState::kStatic) {
    ASSERT_LE(u_t.norm(), tolerance * scale);
    ASSERT_LE(frictionUse(law, r_t, was_sliding), r[0]);
    return;
  }
  ASSERT_LE(r_t.dot(u_t), tolerance * scale * r.norm());
  ASSERT_LE(frictionUse(law, r_t, true), r[0] * (1.0 + 1e-12));
  if (law_case.jumps || !(u_t.norm() > 0.0)) return;
  // The direction of u_t is known to round-off / |u_t| only.
  const Vector2 expected = r[0] * kineticFriction(law, u_t.normalized());
  ASSERT_LE((r_t - expected).norm() * std::min(1.0, u_t.norm() / scale), tolerance * r.norm());
}

TEST_P(FrictionProperty, SolvedContactSatisfiesItsConditions) {
  int count[3] = {0, 0, 0};
  for (int sample = 0; sample < 10000; ++sample) {
    const LawPointer anisotropic = randomLaw(1.0, random_.uniform(1.0, 1.5));
    const Matrix3 W = random_.compliance(0.4) * std::pow(10.0, random_.uniform(-3.0, 3.0));
    Vector3 q = random_.closing() * std::pow(10.0, random_.uniform(-3.0, 3.0));
    if (sample % 50 == 0) q[0] = -q[0];
    if (sample % 3 == 0) q.tail<2>() *= 0.2;
    const CoulombLaw law = contactLaw(anisotropic, random_.direction());
    const bool was_sliding = sample % 2 == 0;
    const ContactAnswer answer = solveAnisotropicContact(W, q, law, was_sliding);
    ++count[static_cast<int>(answer.state)];
    expectSolved(GetParam(), W, q, law, was_sliding, answer, 1e-13);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(count[static_cast<int>(ContactState::kOpen)], 200);
  EXPECT_GT(count[static_cast<int>(ContactState::kKinetic)], 4000);
  if (GetParam().jumps) return;
  EXPECT_GT(count[static_cast<int>(ContactState::kStatic)], 1000);
}

/// r_t . u_t over all tangential impulses the kinetic limit allows at this normal impulse: the smallest.
double mostDissipation(const CoulombLaw& law, double normal, const Vector2& u_t) {
  constexpr int kSamples = 720;
  double most = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    const double angle = 2.0 * M_PI * i / kSamples;
    const Vector2 friction = kineticFriction(law, {std::cos(angle), std::sin(angle)});  // on the rim of the limit
    most = std::min(most, normal * friction.dot(u_t));
  }
  return most;
}

TEST_P(AssociatedFriction, DissipatesMost) {
  int slid = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    const LawPointer anisotropic = randomLaw();
    const Matrix3 W = random_.compliance(0.4);
    const Vector3 q = random_.closing();
    const CoulombLaw law = contactLaw(anisotropic, random_.direction());
    const ContactAnswer answer = solveAnisotropicContact(W, q, law, false);
    if (answer.state != ContactState::kKinetic) continue;
    ++slid;
    const Vector2 u_t = (W * answer.impulse + q).tail<2>();
    const double dissipation = answer.impulse.tail<2>().dot(u_t);
    ASSERT_LE(dissipation, mostDissipation(law, answer.impulse[0], u_t) + 1e-13 * scaleOf(W, q, answer.impulse));
  }
  EXPECT_GT(slid, 1000);
}

// Loads between the kinetic and the static limit: held if the contact was at rest, sliding on if it was sliding.
TEST_P(FrictionProperty, HysteresisBetweenTheLimits) {
  for (int sample = 0; sample < 3000; ++sample) {
    constexpr double kRatio = 1.5;
    const LawPointer anisotropic = randomLaw(1.0, kRatio);
    const CoulombLaw law = contactLaw(anisotropic, random_.direction());
    const Vector2 rim = kineticFriction(law, random_.direction());
    if (!(frictionUse(law, rim, true) > 0.5)) continue;  // where friction jumps, forces can lie inside
    const double share = random_.uniform(1.01, kRatio - 0.01) / frictionUse(law, rim, true);
    const Matrix3 W = random_.compliance(0.4);
    const Vector3 q = -W * Vector3(1.0, share * rim.x(), share * rim.y());
    ASSERT_EQ(solveAnisotropicContact(W, q, law, false).state,
              q[0] < 0.0 ? ContactState::kStatic : ContactState::kOpen);
    ASSERT_EQ(solveAnisotropicContact(W, q, law, true).state,
              q[0] < 0.0 ? ContactState::kKinetic : ContactState::kOpen);
  }
}

TEST_P(FrictionProperty, TurningTheAxisTurnsTheAnswer) {
  for (int sample = 0; sample < 3000; ++sample) {
    const LawPointer anisotropic = randomLaw();
    const Matrix3 W = random_.compliance(0.4);
    const Vector3 q = random_.closing();
    const Vector2 axis = random_.direction();
    const Eigen::Rotation2Dd turn(random_.uniform(-M_PI, M_PI));
    Matrix3 R = Matrix3::Identity();
    R.bottomRightCorner<2, 2>() = turn.toRotationMatrix();
    const ContactAnswer answer = solveAnisotropicContact(W, q, contactLaw(anisotropic, axis), false);
    const ContactAnswer turned =
        solveAnisotropicContact(R * W * R.transpose(), R * q, contactLaw(anisotropic, turn * axis), false);
    ASSERT_EQ(turned.state, answer.state);
    ASSERT_LE((turned.impulse - R * answer.impulse).norm(), 1e-12 * answer.impulse.norm());
  }
}

// No absolute thresholds: powers of 2 scale without round-off, so that the answers are equal to the last bit.
TEST_P(FrictionProperty, UnitsDoNotMatter) {
  for (int sample = 0; sample < 2000; ++sample) {
    const LawPointer anisotropic = randomLaw();
    const CoulombLaw law = contactLaw(anisotropic, random_.direction());
    const Matrix3 W = random_.compliance(0.4);
    const Vector3 q = random_.closing();
    const ContactAnswer answer = solveAnisotropicContact(W, q, law, false);
    const ContactAnswer scaled = solveAnisotropicContact(std::ldexp(1.0, 30) * W, std::ldexp(1.0, -20) * q, law, false);
    ASSERT_EQ(scaled.state, answer.state);
    ASSERT_EQ(std::ldexp(1.0, 50) * scaled.impulse, answer.impulse);
  }
}

/// A contact whose law has these factors against one whose coefficients were multiplied by them.
void expectFactorsMultiply(const FrictionLawDescription& description, double fixed, double kinetic, bool was_sliding,
                           Random& random) {
  const LawPointer plain = makeAnisotropicFriction(description);
  CoulombLaw law = contactLaw(plain, random.direction());
  law.static_factor = fixed;
  law.kinetic_factor = kinetic;
  FrictionLawDescription multiplied = description;
  for (double& mu : multiplied.static_coefficients) mu *= fixed;
  for (double& mu : multiplied.kinetic_coefficients) mu *= kinetic;
  const LawPointer scaled = makeAnisotropicFriction(multiplied);
  const Matrix3 W = random.compliance(0.4);
  const Vector3 q = random.closing();
  const ContactAnswer answer = solveAnisotropicContact(W, q, law, was_sliding);
  const ContactAnswer expected = solveAnisotropicContact(W, q, contactLaw(scaled, law.axis), was_sliding);
  ASSERT_EQ(answer.state, expected.state);
  ASSERT_LE((answer.impulse - expected.impulse).norm(), (fixed == 1.0 ? 1e-12 : 1e-10) * expected.impulse.norm());
}

// Stribeck: a factor on kinetic friction alone; contact pressure: one factor on both.
TEST_P(FrictionProperty, FactorsMultiplyCoefficients) {
  for (int sample = 0; sample < 2000; ++sample) {
    const double by_speed = random_.uniform(0.1, 1.0);
    expectFactorsMultiply(describe(GetParam(), random_, 1.0, 1.2), 1.0, by_speed, sample % 2 == 0, random_);
    const double by_pressure = random_.uniform(0.1, 2.0);
    expectFactorsMultiply(describe(GetParam(), random_, 1.0, 1.2), by_pressure, by_pressure, sample % 2 == 0, random_);
    if (HasFatalFailure()) return;
  }
}

// Far beyond what is physical: coefficients to 100, compliances of condition 1e6, hardly any closing velocity. The
// answer stays finite and dissipates, so that its impulse is bounded: r'W r + r'q <= 0.
TEST_P(FrictionProperty, ExtremeContactsStayBounded) {
  for (int sample = 0; sample < 20000; ++sample) {
    const LawPointer anisotropic = randomLaw(std::pow(10.0, random_.uniform(-8.0, 2.0)));
    const CoulombLaw law = contactLaw(anisotropic, random_.direction());
    const Matrix3 W = random_.compliance(std::pow(10.0, random_.uniform(-1.0, 3.0)));
    Vector3 q = random_.closing();
    q[0] *= std::pow(10.0, random_.uniform(-6.0, 0.0));
    const ContactAnswer answer = solveAnisotropicContact(W, q, law, sample % 2 == 0);
    const Vector3& r = answer.impulse;
    ASSERT_TRUE(r.allFinite());
    const Vector3 u = W * r + q;
    const double scale = scaleOf(W, q, r);
    ASSERT_LE(std::abs(u[0]), 1e-14 * scale);
    // Where friction nearly jams the contact, r_n is -q_n over a small difference of compliances.
    const double jammed_scale = W.norm() * q.norm() * r.norm() / -q[0];
    ASSERT_LE(r.dot(u), 1e-14 * jammed_scale * r.norm());
    ASSERT_LE(r.norm(), (1.0 + 1e-6) * q.norm() / Eigen::SelfAdjointEigenSolver<Matrix3>(W).eigenvalues()[0]);
    if (answer.state != ContactState::kKinetic) continue;
    ASSERT_LE(frictionUse(law, r.tail<2>(), true), r[0] * (1.0 + 1e-9));
  }
}

std::string nameOf(const testing::TestParamInfo<LawCase>& law) { return law.param.name; }

std::vector<LawCase> associatedLaws() {
  return {{"Orthotropic", Kind::kOrthotropic, false,
           [](Random& random, double largest) { return coefficients(random, 2, largest); }},
          {"Asymmetric", Kind::kAsymmetric, false,
           [](Random& random, double largest) { return coefficients(random, 3, largest); }},
          {"Blade", Kind::kOrthotropic, true,
           [](Random& random, double largest) {
             return std::vector<double>{0.0, random.uniform(0.1, 1.0) * largest};
           }},
          {"FreeForward", Kind::kAsymmetric, true,
           [](Random& random, double largest) {
             std::vector<double> mu = coefficients(random, 3, largest);
             mu[0] = 0.0;
             return mu;
           }},
          {"FreeSideways", Kind::kAsymmetric, true, [](Random& random, double largest) {
             std::vector<double> mu = coefficients(random, 3, largest);
             mu[2] = 0.0;
             return mu;
           }}};
}

std::vector<LawCase> otherLaws() {
  return {
      {"Table", Kind::kTable, false,
       [](Random& random, double largest) { return coefficients(random, kTableAngles, largest); }},
      {"Tensor", Kind::kTensor, false, [](Random& random, double largest) { return tensor(random, largest, true); }},
      {"SingularTensor", Kind::kTensor, true,
       [](Random& random, double largest) { return tensor(random, largest, false); }}};
}

INSTANTIATE_TEST_SUITE_P(Elliptic, FrictionProperty, testing::ValuesIn(associatedLaws()), nameOf);
INSTANTIATE_TEST_SUITE_P(Elliptic, AssociatedFriction, testing::ValuesIn(associatedLaws()), nameOf);
INSTANTIATE_TEST_SUITE_P(Other, FrictionProperty, testing::ValuesIn(otherLaws()), nameOf);

}  // namespace
}  // namespace tissue_contact
