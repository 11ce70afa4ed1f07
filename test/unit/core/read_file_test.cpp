/// Files to read: regular, of a bounded size, and named in every refusal.
#include "tissue_contact/core/read_file.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "support/refusal.h"
#include "support/temporary_directory.h"

namespace tissue_contact {
namespace read_file_test {

namespace fs = std::filesystem;

class ReadFile : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return temporary_.path(name); }
  std::string write(const std::string& name, const std::string& text) const { return temporary_.write(name, text); }
  static std::string refusal(const std::string& file) {
    return tissue_contact::refusal([&] { readFile(file, "test file", 100); });
  }

  TemporaryDirectory temporary_;
  fs::path directory_ = temporary_.path();
};

TEST_F(ReadFile, GivesAllBytes) {
  const std::string bytes("a\0b\r\n\xff", 6);
  EXPECT_EQ(readFile(write("a", bytes), "test file", 6), bytes);
  fs::create_symlink("a", directory_ / "link");
  EXPECT_EQ(readFile(path("link"), "test file", 6), bytes);
}

TEST_F(ReadFile, SizeLimitIsTold) {
  EXPECT_EQ(readFile(write("a", std::string(100, 'x')), "test file", 100).size(), 100u);
  EXPECT_EQ(refusal(write("b", std::string(101, 'x'))),
            "test file '" + path("b") + "' has 101 bytes; at most 100 are read");
  // Terabytes that take no room on the disk, and none in memory.
  write("hole", "x");
  fs::resize_file(path("hole"), std::uintmax_t{1} << 40u);
  EXPECT_NE(refusal(path("hole")).find("1099511627776 bytes"), std::string::npos);
  EXPECT_EQ(refusal(write("c", "")), "test file '" + path("c") + "' is empty");
}

TEST_F(ReadFile, NothingButRegularFilesIsOpened) {
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  const int listener = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(path("socket").size(), sizeof address.sun_path);
  std::strcpy(address.sun_path, path("socket").c_str());
  ASSERT_EQ(bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  close(listener);
  const std::pair<std::string, std::string> cases[] = {
      {path("fifo"), "is not a regular file but a FIFO (named pipe)"},
      {path("socket"), "is not a regular file but a socket"},
      {directory_.string(), "is not a regular file but a directory"},
      {"/dev/zero", "is not a regular file but a device"},
      {path("none"), "does not exist"},
      {path("fifo/none"), "does not exist"},
      {"", "does not exist"},
  };
  for (const auto& [file, what] : cases) {
    EXPECT_EQ(refusal(file).rfind("test file '" + file + "' " + what, 0), 0u) << refusal(file);
    EXPECT_THROW(requireRegularFile(file, "test file"), std::invalid_argument);
  }
  fs::create_symlink(path("fifo"), directory_ / "link");
  EXPECT_NE(refusal(path("link")).find("FIFO"), std::string::npos);
  fs::create_symlink("round", directory_ / "round");
  EXPECT_NE(refusal(path("round")).find("Too many levels of symbolic links"), std::string::npos);
}

TEST_F(ReadFile, TellsWhereARelativePathWasLookedFor) {
  EXPECT_EQ(refusal("no_such_folder/none"), "test file 'no_such_folder/none' does not exist in '" +
                                                fs::current_path().string() + "'; correct the path");
}

TEST_F(ReadFile, TellsOfAFileWhoseNameDiffersInCapitalsAlone) {
  write("tool.stl", "x");
  EXPECT_EQ(refusal(path("tool.STL")),
            "test file '" + path("tool.STL") + "' does not exist; correct the path ('tool.stl' lies there)");
  fs::create_symlink("nowhere", directory_ / "dangling");
  EXPECT_EQ(refusal(path("dangling")), "test file '" + path("dangling") + "' does not exist; correct the path");
}

TEST_F(ReadFile, StandInsAreCalledThat) {
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 1\n";
  EXPECT_NE(refusal(write("a", pointer)).find("git lfs pull"), std::string::npos);
}

TEST_F(ReadFile, UnreadableFilesGiveTheReason) {
  if (geteuid() == 0) GTEST_SKIP() << "root reads everything";
  write("secret", "x");
  ASSERT_EQ(chmod(path("secret").c_str(), 0), 0);
  EXPECT_NE(refusal(path("secret")).find("Permission denied"), std::string::npos);
}

}  // namespace read_file_test
}  // namespace tissue_contact
