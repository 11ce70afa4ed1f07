// Tables of joint positions are read strictly: a cell that is no number must not shift the others.
#include "validation/joint_path.h"

#include <gtest/gtest.h>

#include <string>

#include "support/refusal.h"
#include "support/temporary_directory.h"

namespace tissue_contact {
namespace {

class JointPathTest : public testing::Test {
 protected:
  std::string write(const std::string& text) { return directory_.write("path.csv", text); }

  TemporaryDirectory directory_;
};

TEST_F(JointPathTest, ReadsWhatItsFirstLineNames) {
  const JointPath path = loadJointPath(write("time_s,insertion,jaw\n0,0.1,-1e-3\n0.5,+0.2,2\n"));
  EXPECT_EQ(path.joints, (std::vector<std::string>{"insertion", "jaw"}));
  EXPECT_EQ(path.rows, (std::vector<std::vector<double>>{{0.0, 0.1, -1e-3}, {0.5, 0.2, 2.0}}));
}

TEST_F(JointPathTest, RefusesARowThatIsNotOneNumberPerColumn) {
  const std::string good = "time_s,insertion,jaw\n0,1,2\n";
  EXPECT_NO_THROW(loadJointPath(write(good + "1,2,3\n")));
  for (const std::string bad :
       {"1,2,3,abc", "1,2", "1,2,3,4", "1,2 3", "1,,3", "", "abc,1,2,3", "1,2,3,", "1,nan,3", "0,1,2"}) {
    SCOPED_TRACE(bad);
    expectRefusal([&] { loadJointPath(write(good + bad + "\n1,2,3\n")); }, {"path.csv:3: ", "each of the 3 columns"});
  }
}

}  // namespace
}  // namespace tissue_contact
