/// Another program's folder: there as long as it is used, and gone afterwards, however the process ends.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <thread>

#include "mesh/fill/run_program.h"

namespace tissue_contact {
namespace scratch_folder_test {

namespace fs = std::filesystem;

bool isGoneWithin(const std::string& folder, std::chrono::seconds time) {
  const auto end = std::chrono::steady_clock::now() + time;
  while (fs::exists(folder) && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return !fs::exists(folder);
}

/// Makes a folder with a file in it, tells its path, and dies of the signal, alone or with its group.
[[noreturn]] void dieWithAFolder(int tell, int signal, bool group) {
  if (group) setpgid(0, 0);
  const ScratchFolder folder;
  std::ofstream(folder.path("surface.msh")) << "something";
  const std::string& path = folder.path();
  if (write(tell, path.data(), path.size()) < 0) _exit(1);
  close(tell);
  std::signal(signal, SIG_DFL);
  kill(group ? 0 : getpid(), signal);
  _exit(1);
}

/// Processes of this program in other sessions: those that wait to remove a folder.
std::set<pid_t> processesNamedAsThis() {
  std::set<pid_t> found;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
    const pid_t process = std::atoi(entry.path().filename().c_str());
    std::error_code gone;
    if (process > 0 && fs::read_symlink(entry.path() / "exe", gone) == fs::read_symlink("/proc/self/exe") &&
        getsid(process) != getsid(0)) {
      found.insert(process);
    }
  }
  return found;
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

/// Of a process that dies of the signal while it uses it.
std::string folderOfTheDead(int signal, bool group) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) dieWithAFolder(ends[1], signal, group);
  close(ends[1]);
  std::string path;
  char some[1024];
  // Ends when everybody has closed the pipe, so the one who removes the folder keeps nothing of ours open.
  for (ssize_t got = 0; (got = read(ends[0], some, sizeof some)) > 0;) path.append(some, static_cast<std::size_t>(got));
  close(ends[0]);
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == signal);
  return path;
}

TEST(ScratchFolder, GoesWithItsProcess) {
  for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
    SCOPED_TRACE(signal);
    const std::string path = folderOfTheDead(signal, false);
    ASSERT_FALSE(path.empty());
    EXPECT_TRUE(isGoneWithin(path, std::chrono::seconds(60))) << path;
  }
}

TEST(ScratchFolder, GoesWhenItsGroupIsEnded) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGKILL}) {
    SCOPED_TRACE(signal);
    const std::string path = folderOfTheDead(signal, true);
    ASSERT_FALSE(path.empty());
    EXPECT_TRUE(isGoneWithin(path, std::chrono::seconds(60))) << path;
  }
}

/// A process of this program that was not there before and has gone to "/", as the one does that waits to remove the folder: 0 if
/// there is none.
pid_t cleanerAfter(const std::set<pid_t>& before) {
  for (const pid_t process : processesNamedAsThis()) {
    std::error_code gone;
    const fs::path at = fs::read_symlink("/proc/" + std::to_string(process) + "/cwd", gone);
    if (before.count(process) == 0 && !gone && at == "/") return process;
  }
  return 0;
}

// A machine that goes down, or a service manager, signals every process, whatever its group.
TEST(ScratchFolder, GoesWhereEveryProcessIsToldToEnd) {
  const std::set<pid_t> before = processesNamedAsThis();
  auto folder = std::make_unique<ScratchFolder>();
  const std::string path = folder->path();
  pid_t cleaner = 0;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while ((cleaner = cleanerAfter(before)) == 0 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_NE(cleaner, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) EXPECT_EQ(kill(cleaner, signal), 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(kill(cleaner, 0), 0) << "it has died";
  for (const char* standard : {"0", "1", "2"}) {
    EXPECT_EQ(fs::read_symlink("/proc/" + std::to_string(cleaner) + "/fd/" + standard), "/dev/null");
  }
  folder.reset();
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace scratch_folder_test
}  // namespace tissue_contact
