#include "tissue_contact/core/resolve_path.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

#include "support/refusal.h"

namespace tissue_contact {
namespace resolve_path_test {

std::string packageDirectory(const std::string& package) { return package == "known" ? "/opt/known" : ""; }

TEST(ResolvePath, FollowsEachKindOfPath) {
  EXPECT_EQ(resolvePath("package://known/urdf/a.urdf", "/base", packageDirectory), "/opt/known/urdf/a.urdf");
  EXPECT_EQ(resolvePath("package://known//urdf/a.urdf", "/base", packageDirectory), "/opt/known/urdf/a.urdf");
  EXPECT_EQ(resolvePath("file:///tmp/a b.stl", "/base", packageDirectory), "/tmp/a b.stl");
  EXPECT_EQ(resolvePath("/tmp/a.stl", "/base", packageDirectory), "/tmp/a.stl");
  EXPECT_EQ(resolvePath("meshes/a.stl", "/base/dir", packageDirectory), "/base/dir/meshes/a.stl");
  EXPECT_EQ(resolvePath("../a.stl", "/base/dir", packageDirectory), "/base/dir/../a.stl");
}

TEST(ResolvePath, MakesRelativeBasesAbsolute) {
  const std::string here = std::filesystem::current_path().string();
  EXPECT_EQ(resolvePath("a.stl", "", nullptr), (std::filesystem::path(here) / "a.stl").string());
  EXPECT_EQ(resolvePath("a.stl", "dir", nullptr), (std::filesystem::path(here) / "dir/a.stl").string());
}

TEST(ResolvePath, RefusesAndNamesTheUri) {
  for (const char* uri : {"package://unknown/a.urdf", "package://known", "package://known/", "package:///a",
                          "package://", "file://a.stl", "file://", "http://host/a.stl", "://a", ""}) {
    expectRefusal([&] { resolvePath(uri, "/base", packageDirectory); }, {"\"" + std::string(uri) + "\""});
  }
  EXPECT_THROW(resolvePath(std::string("a\0b", 3), "/base", packageDirectory), std::invalid_argument);
}

TEST(ResolvePath, NeedsAPackageLookUpOnlyForPackages) {
  EXPECT_THROW(resolvePath("package://known/a", "/base", nullptr), std::invalid_argument);
  EXPECT_EQ(resolvePath("a", "/base", nullptr), "/base/a");
}

}  // namespace resolve_path_test
}  // namespace tissue_contact
