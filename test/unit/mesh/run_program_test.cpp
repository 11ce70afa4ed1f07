#include "mesh/fill/run_program.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "support/temporary_directory.h"

namespace tissue_contact {
namespace run_program_test {

TEST(RunProgram, EndsWhatTakesTooLongAndTellsWhatIsMissing) {
  const TemporaryDirectory directory;
  const ProgramLimits limits = {1, std::size_t{1} << 30U};
  EXPECT_TRUE(runProgram({"sleep", "1000"}, directory.path().string(), limits).timed_out);
  EXPECT_FALSE(runProgram({"no-such-program"}, directory.path().string(), limits).found);
  const ProgramEnd end = runProgram({"pwd"}, directory.path().string(), limits);
  EXPECT_TRUE(end.well);
  EXPECT_EQ(end.output, std::filesystem::canonical(directory.path()).string() + "\n");
  EXPECT_FALSE(runProgram({"false"}, directory.path().string(), limits).well);
}

}  // namespace run_program_test
}  // namespace tissue_contact
