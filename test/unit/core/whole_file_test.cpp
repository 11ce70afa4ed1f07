/// Results that are whole or absent: both kinds of unfinished file, and what they refuse to replace.
#include "tissue_contact/core/whole_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/part_file.h"
#include "support/temporary_directory.h"

namespace tissue_contact {
namespace whole_file_test {

namespace fs = std::filesystem;

class WholeFileTest : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return temporary_.path(name); }
  void write(const std::string& name, const std::string& text) const { temporary_.write(name, text); }
  std::string read(const std::string& name) const { return temporary_.read(name); }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_)) {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }
  mode_t mode(const std::string& name) const {
    struct stat status {};
    EXPECT_EQ(stat(path(name).c_str(), &status), 0);
    return status.st_mode & 07777u;
  }

  TemporaryDirectory temporary_;
  fs::path directory_ = temporary_.path();
};

template <typename Function>
std::string messageOf(const Function& function) {
  try {
    function();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

class PartFileTest : public WholeFileTest, public testing::WithParamInterface<PartFile::Kind> {
 protected:
  void fill(PartFile& file, const std::string& text) const {
    std::ostream stream(&file);
    stream.exceptions(std::ios::badbit);
    stream << text;
  }
};

TEST_P(PartFileTest, TakesThePlaceWhenComplete) {
  write("out", "old");
  write("out.part", "somebody's");
  const std::string text(200000, 'x');  // more than the buffer holds
  {
    PartFile file(path("out"), GetParam());
    fill(file, text);
    file.finish();
    EXPECT_EQ(read("out"), "old");
    file.place();
    EXPECT_EQ(read("out"), text);
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"out", "out.part"}));
  EXPECT_EQ(read("out.part"), "somebody's");
}

TEST_P(PartFileTest, LeavesNothingWhenGivenUp) {
  write("out", "old");
  {
    PartFile file(path("out"), GetParam());
    fill(file, "new");
  }
  EXPECT_EQ(read("out"), "old");
  EXPECT_EQ(names(), (std::vector<std::string>{"out"}));
}

TEST_P(PartFileTest, KeepsPermissionsAndIsNeverMoreReadable) {
  const mode_t before = umask(022);
  write("private", "old");
  ASSERT_EQ(chmod(path("private").c_str(), 0600), 0);
  for (const char* const name : {"private", "new"}) {
    PartFile file(path(name), GetParam());
    for (const fs::directory_entry& entry : fs::directory_iterator(directory_)) {
      if (entry.path().filename().string().rfind("private.partial", 0) == 0) {
        EXPECT_EQ(mode(entry.path().filename().string()), 0600u);
      }
    }
    file.place();
  }
  umask(before);
  EXPECT_EQ(mode("private"), 0600u);
  EXPECT_EQ(mode("new"), 0644u);
}

TEST_P(PartFileTest, TwoWritersBothWriteWholeFilesAndTheLastWins) {
  PartFile first(path("out"), GetParam());
  PartFile second(path("out"), GetParam());
  fill(first, std::string(100000, 'a'));
  fill(second, std::string(90000, 'b'));
  second.place();
  EXPECT_EQ(read("out"), std::string(90000, 'b'));
  first.place();
  EXPECT_EQ(read("out"), std::string(100000, 'a'));
}

TEST_P(PartFileTest, AFolderThatIsRenamedMeanwhileTakesItAlong) {
  fs::create_directory(directory_ / "a");
  PartFile file(path("a/out"), GetParam());
  fill(file, "text");
  fs::rename(directory_ / "a", directory_ / "b");
  file.place();
  EXPECT_EQ(read("b/out"), "text");
}

TEST_P(PartFileTest, WhatTookTheNameMeanwhileIsNotDestroyed) {
  write("victim", "old");
  PartFile file(path("out"), GetParam());
  fs::create_symlink("victim", directory_ / "out");
  EXPECT_NE(messageOf([&] { file.place(); }).find("symbolic link to 'victim'"), std::string::npos);
  EXPECT_EQ(read("victim"), "old");
  EXPECT_TRUE(fs::is_symlink(directory_ / "out"));
}

TEST_P(PartFileTest, LongNamesFit) {
  const std::string name(255, 'n');
  PartFile file(path(name), GetParam());
  file.place();
  EXPECT_EQ(names(), (std::vector<std::string>{name}));
}

INSTANTIATE_TEST_SUITE_P(BothKinds, PartFileTest,
                         testing::Values(PartFile::Kind::kUnnamedIfPossible, PartFile::Kind::kNamed));

/// As a library does that opens files by name.
TEST_P(PartFileTest, IsWrittenByItsPath) {
  write("result", "before");
  PartFile part(path("result"), GetParam());
  std::ofstream(part.path()) << "by another";
  EXPECT_EQ(read("result"), "before");
  part.place();
  EXPECT_EQ(read("result"), "by another");
  EXPECT_EQ(names(), std::vector<std::string>{"result"});
}

TEST_P(PartFileTest, APartialResultTakesAPlaceBeside) {
  write("result", "before");
  for (const std::string text : {"half", "three quarters"}) {
    PartFile part(path("result"), GetParam());
    std::ostream(&part) << text;
    part.placeBeside(WholeFile::kPartialEnding);
    EXPECT_EQ(read("result"), "before");
    EXPECT_EQ(read("result.partial"), text);
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"result", "result.partial"}));
  write("victim", "whole");
  fs::remove(path("result.partial"));
  fs::create_symlink("victim", path("result.partial"));
  PartFile part(path("result"), GetParam());
  EXPECT_THROW(part.placeBeside(WholeFile::kPartialEnding), std::runtime_error);
  EXPECT_EQ(read("victim"), "whole");
}

TEST_F(WholeFileTest, AnUnfinishedNamedFileSaysSo) {
  const PartFile file(path("out"), PartFile::Kind::kNamed);
  ASSERT_EQ(names().size(), 1u);
  EXPECT_EQ(names()[0].rfind("out.partial-", 0), 0u) << names()[0];
}

TEST_F(WholeFileTest, AFailingWriteNamesFileAndReason) {
  // As a full disk: a limit on the size of files, in a child, since it cannot be raised again.
  write("out", "old");
  const auto writeTooMuch = [this] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    if (setrlimit(RLIMIT_FSIZE, &limit) != 0) std::_Exit(2);
    const std::string expected = "cannot write '" + path("out") + "': File too large";
    // A write that fills the buffer, one that commit() hands over, and numbers, which another function writes.
    const std::string at_once = messageOf([this] { WholeFile(path("out")).stream() << std::string(300000, 'x'); });
    const std::string at_end = messageOf([this] {
      WholeFile file(path("out"));
      file.stream() << std::string(3000, 'x');
      file.commit();
    });
    const std::string of_numbers = messageOf([this] {
      WholeFile file(path("out"));
      for (int i = 0; i < 100000; ++i) file.stream() << 0.1 << ',' << i << '\n';
    });
    std::_Exit(at_once == expected && at_end == expected && of_numbers == expected ? 0 : 1);
  };
  EXPECT_EXIT(writeTooMuch(), testing::ExitedWithCode(0), "");
  EXPECT_EQ(read("out"), "old");
  EXPECT_EQ(names(), (std::vector<std::string>{"out"}));
}

TEST_F(WholeFileTest, RefusesWhatIsNoPlaceForAResult) {
  write("victim", "old");
  fs::create_symlink("victim", directory_ / "link");
  fs::create_symlink("nowhere", directory_ / "dangling");
  fs::create_directory(directory_ / "folder");
  ASSERT_EQ(mkfifo(path("fifo").c_str(), 0600), 0);
  const std::vector<std::pair<std::string, std::string>> cases = {
      {path("link"), "symbolic link to 'victim'"},
      {path("dangling"), "symbolic link to 'nowhere'"},
      {path("folder"), "directory"},
      {path("folder/"), "directory"},
      {path("folder/.."), "directory"},
      {path("fifo"), "FIFO"},
      {"/dev/null", "device"},
      {path("none/out"), "No such file or directory"},
      {path("victim/out"), "Not a directory"},
      {path(std::string(256, 'n')), "File name too long"},
      {"", "directory"},
      {"-", "standard output"},
  };
  for (const auto& [file, reason] : cases) {
    const std::string message = messageOf([path = file] { const WholeFile whole(path); });
    EXPECT_EQ(message.rfind("cannot write '" + file + "'", 0), 0u) << message;
    EXPECT_NE(message.find(reason), std::string::npos) << message;
  }
  EXPECT_EQ(read("victim"), "old");
  EXPECT_TRUE(fs::is_symlink(path("link")) && fs::is_symlink(path("dangling")) && fs::is_fifo(path("fifo")));
}

TEST_F(WholeFileTest, AWriteProtectedResultStays) {
  if (geteuid() == 0) GTEST_SKIP() << "nothing is write-protected for root";
  write("out", "old");
  ASSERT_EQ(chmod(path("out").c_str(), 0444), 0);
  EXPECT_NE(messageOf([this] { const WholeFile whole(path("out")); }).find("write-protected"), std::string::npos);
}

TEST_F(WholeFileTest, OutputsAreNoInputsAndNotEachOther) {
  write("in", "old");
  fs::create_symlink("in", directory_ / "soft");
  fs::create_hard_link(directory_ / "in", directory_ / "hard");
  fs::create_directory(directory_ / "a");
  const auto refusal = [](const std::vector<NamedFile>& outputs, const std::vector<NamedFile>& inputs) {
    return messageOf([&] { requireFreeOutputs(outputs, inputs); });
  };
  for (const char* const name : {"in", "soft", "hard", "a/../in"}) {
    EXPECT_EQ(refusal({{"--out", path(name)}}, {{"--in", path("in")}}),
              "--out '" + path(name) + "' is the same file as --in '" + path("in") + "'; give another name");
    EXPECT_NE(refusal({{"--out", path("in")}}, {{"--in", path(name)}}), "");
  }
  EXPECT_EQ(refusal({{"--a", path("x")}, {"--b", path("a/../x")}}, {}),
            "--b '" + path("a/../x") + "' is the same file as --a '" + path("x") + "'; give another name");
  EXPECT_NE(refusal({{"--a", path("in")}, {"--b", path("hard")}}, {}), "");
  EXPECT_EQ(refusal({{"--a", path("x")}, {"--b", path("a/x")}, {"--c", ""}}, {{"--in", ""}, {"--on", path("none")}}),
            "");
  EXPECT_EQ(names(), (std::vector<std::string>{"a", "hard", "in", "soft"}));
}

}  // namespace whole_file_test
}  // namespace tissue_contact
