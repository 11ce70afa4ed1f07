#include "tissue_contact/core/resolve_path.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "support/refusal.h"
#include "support/temporary_directory.h"

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

TEST(ResolvePath, FindsWhatAUriNamesByPercent) {
  const TemporaryDirectory directory;
  const std::string base = directory.path("build%2Ffeature");  // as Jenkins names folders
  const auto package = [&](const std::string&) { return base; };
  for (const std::string name : {"a tip #2.stl", "b%.stl", "50%20.stl", "caf\xC3\xA9.stl"}) {
    directory.write("build%2Ffeature/" + name, "there");
    const std::string uri = fileUri(base + "/" + name);
    EXPECT_EQ(uri.find_first_of(" #"), std::string::npos) << uri;
    EXPECT_EQ(resolvePath(uri, "", nullptr), base + "/" + name);
    EXPECT_EQ(resolvePath("package://tools" + uri.substr(uri.rfind('/')), "", package), base + "/" + name);
    EXPECT_EQ(resolvePath("file://" + base + "/" + name, "", nullptr), base + "/" + name);  // as most write it
  }
  EXPECT_EQ(fileUri("/tmp/a tip #2%.stl"), "file:///tmp/a%20tip%20%232%25.stl");
  EXPECT_EQ(fileUri("/caf\xC3\xA9"), "file:///caf%C3%A9");
  EXPECT_EQ(resolvePath("file:///nowhere/a%20b", "", nullptr), "/nowhere/a%20b");  // as written, where there is neither
  EXPECT_EQ(resolvePath("file://" + base + "/b%00.stl", "", nullptr), base + "/b%00.stl");
  EXPECT_EQ(resolvePath(base + "/a%20tip%20%232.stl", "", nullptr), base + "/a%20tip%20%232.stl");  // a path is no URI
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
