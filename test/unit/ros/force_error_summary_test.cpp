/// The line about likely errors at the end of a replay.
#include "ros/replay/force_error_summary.h"

#include <gtest/gtest.h>

namespace tissue_contact {
namespace force_error_summary_test {

ForceErrorEstimate estimate(double mesh_n, double step_n, double solver_n, bool knows_mesh = true) {
  ForceErrorEstimate error;
  error.knows_mesh = knows_mesh;
  error.mesh_n = mesh_n;
  error.step_n = step_n;
  error.solver_n = solver_n;
  return error;
}

TEST(ForceErrorSummary, SaysNothingOfNoForce) {
  ForceErrorSummary summary;
  EXPECT_EQ(summary.text(), "");
  summary.add(0.0, estimate(0.0, 0.0, 0.0));
  EXPECT_EQ(summary.text(), "");
}

TEST(ForceErrorSummary, ComparesRootsOfSumsOfSquares) {
  ForceErrorSummary summary;
  summary.add(3.0, estimate(0.03, 0.04, 0.0));
  summary.add(4.0, estimate(0.0, 0.0, 0.0));
  EXPECT_EQ(summary.text(), "likely wrong by 1 % (RMS; mesh 0.6 %, step 0.8 %, solver 0 %)");
}

TEST(ForceErrorSummary, NamesTheKeyThatLowersTheLargestPart) {
  const auto text = [](const ForceErrorEstimate& error) {
    ForceErrorSummary summary;
    summary.add(1.0, error);
    return summary.text();
  };
  EXPECT_NE(text(estimate(0.5, 0.1, 0.1)).find("tissues[].refinement"), std::string::npos);
  EXPECT_NE(text(estimate(0.1, 0.5, 0.1)).find("step.max_step_s"), std::string::npos);
  EXPECT_NE(text(estimate(0.1, 0.1, 0.5)).find("solver.tolerance"), std::string::npos);
  EXPECT_NE(text(estimate(1.64, 0.1, 0.1)).find("wrong by 160 % (RMS; mesh 160 %,"), std::string::npos);
  EXPECT_NE(text(estimate(0.0, 0.1, 0.1, false)).find("the mesh's part is not known, step 10 %"), std::string::npos);
}

// An organ on a stalk: what it errs by hangs on where it has swung to.
TEST(ForceErrorSummary, SaysThatSwingingTissueErrsByMore) {
  const auto text = [](double inertia_n) {
    ForceErrorSummary summary;
    ForceErrorEstimate error = estimate(inertia_n > 0.6 ? 0.2 : 0.02, 0.0, 0.0);
    error.inertia_n = inertia_n;
    summary.add(1.0, error);
    return summary.text();
  };
  EXPECT_NE(text(0.7).find("cells; for less take smaller cells where it touches"), std::string::npos);
  EXPECT_EQ(text(0.3), "likely wrong by 2 % (RMS; mesh 2 %, step 0 %, solver 0 %)");
  EXPECT_NE(text(0.54).find("; and by what went wrong in earlier steps, since the tissue swings: its inertia is 54 %"),
            std::string::npos);
}

// Of the mesh of one sample nothing is known: what is known of the others is no advice.
TEST(ForceErrorSummary, AdvisesNothingAboutAMeshThatIsNotKnown) {
  ForceErrorSummary summary;
  summary.add(1.0, estimate(0.9, 0.1, 0.0));
  summary.add(1.0, estimate(0.0, 0.1, 0.0, false));
  EXPECT_NE(summary.text().find("not known, step 10 %, solver 0 %); for less take shorter steps"), std::string::npos);
}

}  // namespace force_error_summary_test
}  // namespace tissue_contact
