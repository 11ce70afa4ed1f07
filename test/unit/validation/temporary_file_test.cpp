/// The validator's mesh files: private, not to be foreseen, gone afterwards.
#include "validation/temporary_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

TEST(TemporaryFile, IsPrivateAndGoneAfterwards) {
  std::string path;
  {
    const TemporaryFile file("cone.stl", "solid");
    path = file.path();
    struct stat status {};
    ASSERT_EQ(stat(path.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777u, 0600u);
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    EXPECT_EQ(text.str(), "solid");
    EXPECT_EQ(fs::path(path).extension(), ".stl");
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(TemporaryFile, TwoOfOneNameAreTwoFiles) {
  const TemporaryFile one("cone.stl", "1");
  const TemporaryFile two("cone.stl", "2");
  EXPECT_NE(one.path(), two.path());
}

TEST(TemporaryFile, ReasonIsTold) {
  try {
    const TemporaryFile file("none/cone.stl", "");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("No such file or directory"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace tissue_contact
