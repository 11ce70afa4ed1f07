/// @file
/// Reading and writing contact problem files: what comes back is what went in, and nothing a file says does harm.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <sstream>

#include "support/refusal.h"
#include "support/temporary_directory.h"
#include "tissue_contact/baselines/delassus.h"
#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace contact_problem_file_test {

class ContactProblemFile : public ::testing::Test {
 protected:
  DelassusProblem read(const std::string& text) { return readContactProblem(directory_.write("problem.txt", text)); }

  TemporaryDirectory directory_;
  std::string file_ = directory_.path("problem.txt");
};

const char* const kOneContact = "FC3D 1\nn 1\nW dense\n1 0 0  0 2 0  0 0 3\nq -1 2 3\nmu 0.5\n";

TEST_F(ContactProblemFile, ReadsDenseWithComments) {
  const DelassusProblem problem = read("# a\nFC3D 1 # b\nn 1 W dense 1 0 0 0 2 0.5 0 0 3 q -1 2e0 3 mu 0.5 # end");
  EXPECT_EQ(problem.contacts(), 1);
  EXPECT_EQ(problem.W(1, 2), 0.5);
  EXPECT_EQ(problem.W(2, 1), 0.0);
  EXPECT_EQ(problem.q, Vector3(-1.0, 2.0, 3.0));
  EXPECT_EQ(problem.laws[0].mu_static, 0.5);
  EXPECT_EQ(problem.laws[0].mu_kinetic, 0.5);
  EXPECT_FALSE(problem.was_sliding[0]);
}

TEST_F(ContactProblemFile, SparseEntriesThatOccurTwiceAdd) {
  const DelassusProblem problem = read("FC3D 1 n 1 W sparse 4  0 0 1  0 0 0.5  1 1 2  2 2 2  q 0 0 0 mu 0");
  EXPECT_EQ(problem.W(0, 0), 1.5);
  EXPECT_EQ(problem.W.sum(), 5.5);
}

TEST_F(ContactProblemFile, RoundTripIsExact) {
  std::mt19937_64 random(1);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 1 + trial % 5;
    const bool sparse = trial % 2 == 0;
    const auto anyDouble = [&random] {  // any bits that are a finite number, tiny and huge ones included
      double value = 0.0;
      do {
        const std::uint64_t bits = random();
        std::memcpy(&value, &bits, sizeof value);
      } while (!std::isfinite(value));
      return value;
    };
    DelassusProblem problem;
    problem.W.setZero(3 * n, 3 * n);
    for (int i = 0; i < problem.W.size(); ++i) {
      if (!sparse || i % 7 == 0) problem.W(i) = anyDouble();
    }
    problem.q.resize(3 * n);
    for (Eigen::Index i = 0; i < problem.q.size(); ++i) problem.q[i] = anyDouble();
    problem.laws.resize(n);
    for (CoulombLaw& law : problem.laws) law.mu_static = law.mu_kinetic = std::abs(anyDouble());
    problem.was_sliding.assign(n, false);
    std::ostringstream text;
    writeContactProblem(text, problem, std::vector<ContactState>(n));
    const DelassusProblem again = read(text.str());
    EXPECT_EQ(again.W, problem.W);
    EXPECT_EQ(again.q, problem.q);
    for (int c = 0; c < n; ++c) EXPECT_EQ(again.laws[c].mu_static, problem.laws[c].mu_static);
  }
}

TEST_F(ContactProblemFile, WritesTheCoefficientThatApplies) {
  DelassusProblem problem = read(kOneContact);
  problem.laws[0].mu_static = 0.6;
  problem.laws[0].mu_kinetic = 0.3;
  const auto written = [&](ContactState state) {
    std::ostringstream text;
    writeContactProblem(text, problem, {state});
    return read(text.str()).laws[0].mu_static;
  };
  EXPECT_EQ(written(ContactState::kStatic), 0.6);
  EXPECT_EQ(written(ContactState::kOpen), 0.6);
  EXPECT_EQ(written(ContactState::kKinetic), 0.3);
  problem.was_sliding[0] = true;
  EXPECT_EQ(written(ContactState::kStatic), 0.3);
  FrictionLawDescription orthotropic;
  orthotropic.kind = FrictionLawDescription::Kind::kOrthotropic;
  orthotropic.static_coefficients = {0.5, 0.2};
  orthotropic.kinetic_coefficients = {0.4, 0.1};
  const auto law = makeAnisotropicFriction(orthotropic);
  problem.laws[0].anisotropic = law.get();
  EXPECT_DOUBLE_EQ(written(ContactState::kStatic), 0.4);
}

TEST_F(ContactProblemFile, RefusesWhatIsWrongAndSaysWhere) {
  const struct {
    const char* text;
    const char* message;
  } cases[] = {
      {"FC3D 2 n 1", "found '2', expected '1'"},
      {"fc3d 1", "found 'fc3d', expected 'FC3D'"},
      {"FC3D 1\nn 0", "line 2: found '0', expected an integer from 1 to 3000"},
      {"FC3D 1 n -1", "found '-1'"},
      {"FC3D 1 n 1.5", "found '1.5'"},
      {"FC3D 1 n 99999999999999", "found '99999999999999'"},
      {"FC3D 1 n 3000 W sparse 0 q", "a file long enough to hold q and mu"},
      {"FC3D 1 n 1 W full", "found 'full', expected 'dense' or 'sparse'"},
      {"FC3D 1 n 1 W dense 1 2", "a file long enough to hold W dense"},
      {"FC3D 1 n 1 W sparse 2000000000 0 0 1", "a file long enough to hold W sparse"},
      {"FC3D 1 n 1 W sparse 1 3 0 1 q 0 0 0 mu 1", "found '3', expected an integer from 0 to 2 for a row of W"},
      {"FC3D 1 n 1 W sparse 1 0 -1 1 q 0 0 0 mu 1", "found '-1', expected an integer from 0 to 2 for a column of W"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 nan q 0 0 0 mu 1", "found 'nan', expected a finite number"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 1e999 q 0 0 0 mu 1", "found '1e999', expected a finite number"},
      {"FC3D 1 n 1 W sparse 2 0 0 1e308 0 0 1e308 q 0 0 0 mu 1", "sums are finite"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 1x q 0 0 0 mu 1", "found '1x'"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 1 q 0 0 inf mu 1", "found 'inf'"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 1 q 0 0 0 mu -0.1", "found '-0.1', expected a coefficient"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 1 q 0 0 0 mu nan", "found 'nan'"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 1 q 0 0 0\n\n", "line 3: found the end of the file, expected 'mu'"},
      {"FC3D 1 n 1 W dense 1 0 0 0 1 0 0 0 1 q 0 0 0 mu 1 2", "found '2', expected the end of the file"},
      {" ", "line 1: found the end of the file, expected 'FC3D'"},
      {"", "is empty"},
  };
  for (const auto& bad : cases) {
    SCOPED_TRACE(bad.text);
    expectRefusal([&] { read(bad.text); }, {bad.message, file_});
  }
}

TEST_F(ContactProblemFile, RefusesWhatIsNoFile) {
  EXPECT_THROW(readContactProblem(file_ + ".absent"), std::invalid_argument);
  EXPECT_THROW(readContactProblem(directory_.path().string()), std::invalid_argument);
  EXPECT_THROW(readContactProblem("/dev/zero"), std::invalid_argument);
}

TEST_F(ContactProblemFile, RefusesAFileTooLargeBeforeItIsRead) {
  std::ofstream(file_, std::ios::binary) << kOneContact;
  std::filesystem::resize_file(file_, std::uintmax_t{3} << 30U);  // a hole: it takes no room on the disk
  expectRefusal([&] { readContactProblem(file_); }, {"has 3221225472 bytes; at most 2147483648 are read", file_});
}

TEST_F(ContactProblemFile, GarbledFilesAreReadOrRefusedButNothingElse) {
  std::mt19937 random(2);
  const std::string good = "FC3D 1\nn 2\nW sparse 6 0 0 1 1 1 1 2 2 1 3 3 1 4 4 1 5 5 1\nq -1 0 0 1 0 0\nmu 0.3 0.4\n";
  ASSERT_NO_THROW(read(good));
  const std::string alphabet = std::string("0123456789.-+e# \nnqmuWFCDx\t") + '\0';
  int refused = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    std::string text = good;
    for (int edit = 0; edit < 1 + trial % 3; ++edit) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.insert(at, 1, alphabet[random() % alphabet.size()]);
          break;
        default:
          text.erase(at, 1 + random() % 20);
          if (text.empty()) text = " ";
      }
    }
    try {
      const DelassusProblem problem = read(text);
      ASSERT_EQ(problem.W.rows(), 3 * problem.contacts());
      ASSERT_EQ(problem.q.size(), 3 * problem.contacts());
      ASSERT_TRUE(problem.W.allFinite() && problem.q.allFinite());
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 300);
  EXPECT_LT(refused, 1000);
}

}  // namespace contact_problem_file_test
}  // namespace tissue_contact
