// Prepared meshes on disk: found again by content, and nothing damaged or foreign is believed.
#include "contact/shape/field_cache.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "contact_test_utilities.h"
#include "support/temporary_directory.h"

namespace tissue_contact::contact_test {
namespace field_cache_test {

namespace fs = std::filesystem;

class FieldCache : public testing::Test {
 protected:
  void SetUp() override {
    preparation_.cache_directory = directory_;
    preparation_.say = [this](const std::string& line) { said_.push_back(line); };
  }

  bool fromCache() {
    said_.clear();
    prepareMeshField(mesh_, "jaw", preparation_);
    return said_.at(0).find("from the cache") != std::string::npos;
  }
  fs::path onlyFile() const {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_)) files.push_back(entry.path());
    EXPECT_EQ(files.size(), 1u);
    return files.at(0);
  }

  TemporaryDirectory temporary_;
  fs::path directory_ = temporary_.path() / "cache";
  MeshPreparation preparation_;
  std::vector<std::string> said_;
  TriangleMesh mesh_ = boxMesh({0.01, 0.002, 0.002}, 2);
};

TEST_F(FieldCache, SecondTimeTheSameBitsComeFromTheFile) {
  const auto built = prepareMeshField(mesh_, "jaw", preparation_);
  ASSERT_TRUE(fromCache());
  const auto read = prepareMeshField(mesh_, "jaw", preparation_);
  EXPECT_EQ(read->grid.samples, built->grid.samples);
  EXPECT_EQ(read->grid.size, built->grid.size);
  EXPECT_EQ(read->grid.origin, built->grid.origin);
  EXPECT_EQ(read->grid.spacing, built->grid.spacing);
  EXPECT_EQ(read->low, built->low);
  EXPECT_EQ(read->high, built->high);
  EXPECT_EQ(read->largest_deviation, built->largest_deviation);
}

TEST_F(FieldCache, AnotherMeshIsAnotherFile) {
  prepareMeshField(mesh_, "jaw", preparation_);
  mesh_.vertices(0, 0) *= 1.0 + 1e-12;
  EXPECT_FALSE(fromCache());
  EXPECT_TRUE(fromCache());
}

TEST_F(FieldCache, DamagedShortForeignAndEmptyFilesAreBuiltAnew) {
  prepareMeshField(mesh_, "jaw", preparation_);
  const fs::path file = onlyFile();
  const std::uintmax_t bytes = fs::file_size(file);
  const auto overwrite = [&](std::uintmax_t at, char value) {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    stream.seekp(static_cast<std::streamoff>(at));
    stream.put(value);
  };
  for (const std::uintmax_t at :
       {std::uintmax_t{0}, std::uintmax_t{8}, std::uintmax_t{20}, std::uintmax_t{55}, bytes / 2, bytes - 1}) {
    overwrite(at, '\x55');
    EXPECT_FALSE(fromCache()) << "byte " << at;
    EXPECT_TRUE(fromCache());
  }
  for (const std::uintmax_t size : {std::uintmax_t{0}, std::uintmax_t{100}, bytes - 4, bytes + 4}) {
    fs::resize_file(file, size);
    EXPECT_FALSE(fromCache()) << size << " bytes";
    EXPECT_TRUE(fromCache());
  }
  EXPECT_EQ(onlyFile(), file);  // no leftovers of writing
}

TEST_F(FieldCache, WithoutADirectoryItWorksAndSaysSo) {
  std::ofstream(directory_.string()) << "a file in its place";
  EXPECT_FALSE(fromCache());
  ASSERT_EQ(said_.size(), 2u);
  EXPECT_NE(said_[1].find(directory_.string()), std::string::npos) << said_[1];
  EXPECT_FALSE(fromCache());
  EXPECT_EQ(said_.size(), 1u);  // of the mesh alone
}

TEST_F(FieldCache, IsPrivateToItsOwner) {
  prepareMeshField(mesh_, "jaw", preparation_);
  EXPECT_EQ(fs::status(directory_).permissions(), fs::perms::owner_all);
}

TEST_F(FieldCache, IsNotUsedWhereEverybodyMayWrite) {
  prepareMeshField(mesh_, "jaw", preparation_);
  fs::permissions(directory_, fs::perms::all);
  EXPECT_FALSE(fromCache());
  ASSERT_EQ(said_.size(), 2u);
  EXPECT_NE(said_[1].find("chmod o-w"), std::string::npos) << said_[1];
  fs::permissions(directory_, fs::perms::owner_all);
  preparation_.cache_directory = directory_;  // given up after the first trouble
  EXPECT_TRUE(fromCache());
}

TEST_F(FieldCache, APlantedLinkIsNotFollowed) {
  prepareMeshField(mesh_, "jaw", preparation_);
  const fs::path file = onlyFile();
  fs::rename(file, directory_ / "victim");
  fs::resize_file(directory_ / "victim", 5);
  fs::create_symlink("victim", file);
  EXPECT_FALSE(fromCache());
  EXPECT_EQ(fs::file_size(directory_ / "victim"), 5u);
  EXPECT_NE(said_.back().find("symbolic link to 'victim'"), std::string::npos) << said_.back();
}

TEST_F(FieldCache, RemovesItsOwnOldFilesOnly) {
  prepareMeshField(mesh_, "jaw", preparation_);
  const std::string key(32, 'a');
  const std::vector<std::string> others = {"notes.field", "my.field.txt", key + ".field.partial", key + ".fields"};
  const std::vector<std::string> ours = {key + ".field.partial-0123456789abcdef", key + ".field"};
  for (const std::vector<std::string>& list : {others, ours}) {
    for (const std::string& name : list) {
      std::ofstream(directory_ / name) << "x";
      fs::resize_file(directory_ / name, 300u << 20);  // more than is kept; a hole takes no room on the disk
      fs::last_write_time(directory_ / name, fs::file_time_type::clock::now() - std::chrono::hours(2));
    }
  }
  mesh_.vertices(0, 0) *= 1.0 + 1e-12;
  prepareMeshField(mesh_, "jaw", preparation_);
  for (const std::string& name : others) EXPECT_TRUE(fs::exists(directory_ / name)) << name;
  for (const std::string& name : ours) EXPECT_FALSE(fs::exists(directory_ / name)) << name;
}

TEST_F(FieldCache, TwoAtOnceLeaveOneWholeFile) {
  const auto prepare = [&] {
    MeshPreparation silent;
    silent.cache_directory = directory_;
    prepareMeshField(mesh_, "jaw", silent);
  };
  std::thread other(prepare);
  prepare();
  other.join();
  EXPECT_TRUE(fromCache());
}

}  // namespace field_cache_test
}  // namespace tissue_contact::contact_test
