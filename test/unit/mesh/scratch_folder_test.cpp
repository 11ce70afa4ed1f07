/// Another program's folder: there as long as it is used, and gone afterwards, however the process ends.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "mesh/fill/run_program.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

bool isGoneWithin(const std::string& folder, std::chrono::seconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (fs::exists(folder) && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return !fs::exists(folder);
}

/// Makes a folder with a file in it, tells its path, and dies of the signal.
[[noreturn]] void dieWithAFolder(int tell, int signal) {
  const ScratchFolder folder;
  std::ofstream(folder.path("surface.msh")) << "something";
  const std::string& path = folder.path();
  if (write(tell, path.data(), path.size()) < 0) _exit(1);
  close(tell);
  std::signal(signal, SIG_DFL);
  std::raise(signal);
  _exit(1);
}

TEST(ScratchFolder, GoesWithItsObject) {
  std::string path;
  {
    const ScratchFolder folder;
    path = folder.path();
    std::ofstream(folder.path("surface.msh")) << "something";
    EXPECT_TRUE(fs::exists(path));
    EXPECT_EQ(fs::status(path).permissions() & fs::perms::mask, fs::perms::owner_all);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(ScratchFolder, GoesWithItsProcess) {
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    SCOPED_TRACE(signal);
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) dieWithAFolder(ends[1], signal);
    close(ends[1]);
    char path[1024] = {};
    const ssize_t length = read(ends[0], path, sizeof path - 1);
    close(ends[0]);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
    ASSERT_GT(length, 0);
    EXPECT_TRUE(isGoneWithin(path, std::chrono::seconds(60))) << path;
  }
}

}  // namespace
}  // namespace tissue_contact
