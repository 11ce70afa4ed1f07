/// Files of tests and validation cases: private, not to be foreseen, gone afterwards.
#include "support/temporary_directory.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "support/refusal.h"

namespace tissue_contact {
namespace temporary_directory_test {

namespace fs = std::filesystem;

TEST(TemporaryDirectory, IsPrivateAndGoneAfterwards) {
  std::string path;
  {
    const TemporaryDirectory directory;
    path = directory.write("below/cone.stl", "solid");
    struct stat status {};
    ASSERT_EQ(stat(directory.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 07777u, 0700u);
    EXPECT_EQ(directory.read("below/cone.stl"), "solid");
  }
  EXPECT_FALSE(fs::exists(fs::path(path).parent_path().parent_path()));
}

TEST(TemporaryDirectory, TwoOfOneNameAreTwoFiles) {
  const TemporaryDirectory one;
  const TemporaryDirectory two;
  EXPECT_NE(one.write("cone.stl", "1"), two.write("cone.stl", "2"));
}

TEST(TemporaryDirectory, WhatCannotBeWrittenIsNamed) {
  const TemporaryDirectory directory;
  fs::create_directory(directory.path() / "cone.stl");
  expectRefusal<std::runtime_error>([&] { directory.write("cone.stl", ""); }, {"cone.stl"});
}

}  // namespace temporary_directory_test
}  // namespace tissue_contact
