#include "mesh/fill/run_program.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace tissue_contact {
namespace {

constexpr std::size_t kMostOutput = std::size_t{1} << 16U;
constexpr rlim_t kMostFile = rlim_t{1} << 30U;  // bytes
constexpr int kNotFound = 127;                  // as shells have it

[[noreturn]] void refuse(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

/// This process's environment without what would change the answer.
std::vector<std::string> environmentFor(const std::string& folder) {
  std::vector<std::string> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string text = *variable;
    const std::string name = text.substr(0, text.find('='));
    if (name != "HOME" && name != "GMSH_HOME" && name != "LANG" && name.rfind("LC_", 0) != 0 &&
        name.rfind("OMP_", 0) != 0) {
      variables.push_back(text);
    }
  }
  variables.insert(variables.end(), {"HOME=" + folder, "LC_ALL=C", "OMP_NUM_THREADS=1"});
  return variables;
}

std::vector<char*> pointersTo(const std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  pointers.reserve(texts.size() + 1);
  for (const std::string& text : texts) pointers.push_back(const_cast<char*>(text.c_str()));
  pointers.push_back(nullptr);
  return pointers;
}

/// What the child does between fork and exec: nothing that takes a lock or memory.
[[noreturn]] void become(char* const* arguments, char* const* environment, const char* folder, int output,
                         const ProgramLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit memory{limits.bytes, limits.bytes};
  const rlimit no_core_file{0, 0};
  const rlimit files{kMostFile, kMostFile};
  setrlimit(RLIMIT_AS, &memory);
  setrlimit(RLIMIT_CORE, &no_core_file);
  setrlimit(RLIMIT_FSIZE, &files);
  for (const int number : {SIGALRM, SIGINT, SIGTERM, SIGPIPE, SIGCHLD}) std::signal(number, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(output, STDOUT_FILENO) < 0 ||
      dup2(output, STDERR_FILENO) < 0 || chdir(folder) != 0) {
    _exit(1);
  }
  alarm(limits.seconds);  // outlives exec
  execvpe(arguments[0], arguments, environment);
  _exit(errno == ENOENT || errno == EACCES || errno == ENOTDIR ? kNotFound : 1);
}

constexpr rlim_t kMostFiles = 1U << 16U;           // that are looked for
const int kEndings[] = {SIGINT, SIGTERM, SIGHUP};  // what a group or a machine is told to end by

/// What a child does for a ScratchFolder: leaves behind a process, of no terminal and nobody's to wait for, that removes the folder once the
/// other end of the pipe is closed: Ctrl-C and SIGKILL run no destructor. It keeps no directory and no file of ours in use, and
/// nothing here takes a lock or memory.
[[noreturn]] void removeOnceAlone(const int* ends, const char* folder) {
  for (const int number : kEndings) std::signal(number, SIG_IGN);  // `rm` ignores them too
  close(ends[1]);
  setsid();
  if (fork() != 0) _exit(0);
  constexpr int kPipe = STDERR_FILENO + 1;
  if (dup2(ends[0], kPipe) < 0) _exit(1);
  const int nothing = open("/dev/null", O_RDWR);
  for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, standard);
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) _exit(1);
  const int end = static_cast<int>(std::min<rlim_t>(files.rlim_cur, kMostFiles));
  for (int file = kPipe + 1; file < end; ++file) close(file);  // close_range() is newer than Debian 11
  if (chdir("/") != 0) _exit(1);
  char none = 0;
  ssize_t count = 0;  // of what a stranger writes: a host without standard files has given the other end to its stderr
  while ((count = read(kPipe, &none, 1)) != 0) {
    if (count < 0 && errno != EINTR) _exit(1);
  }
  execlp("rm", "rm", "-rf", "--", folder, nullptr);
  _exit(1);
}

/// Reads on where nothing is kept any more, so that the program never waits for us.
std::string receive(int pipe) {
  std::string output;
  char buffer[1U << 12U];
  while (true) {
    const ssize_t count = read(pipe, buffer, sizeof buffer);
    if (count > 0 && output.size() < kMostOutput) output.append(buffer, static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR)) return output;
  }
}

}  // namespace

ProgramEnd runProgram(const std::vector<std::string>& arguments, const std::string& folder,
                      const ProgramLimits& limits) {
  const std::vector<std::string> variables = environmentFor(folder);
  const std::vector<char*> argument_pointers = pointersTo(arguments);
  const std::vector<char*> variable_pointers = pointersTo(variables);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) refuse("no pipe to another program");
  const pid_t child = fork();
  if (child == 0) become(argument_pointers.data(), variable_pointers.data(), folder.c_str(), ends[1], limits);
  const int fork_error = errno;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    errno = fork_error;
    refuse("no process for another program");
  }
  ProgramEnd end;
  end.output = receive(ends[0]);
  close(ends[0]);
  int status = -1;
  pid_t waited = 0;
  while ((waited = waitpid(child, &status, 0)) < 0 && errno == EINTR) {
  }
  const bool unknown = waited < 0;  // a host that ignores SIGCHLD gets no status: what the program wrote must tell
  end.found = unknown || !WIFEXITED(status) || WEXITSTATUS(status) != kNotFound;
  end.timed_out = !unknown && WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  end.well = unknown || (WIFEXITED(status) && WEXITSTATUS(status) == 0);
  return end;
}

ScratchFolder::ScratchFolder() {
  const std::filesystem::path place = std::filesystem::absolute(std::filesystem::temp_directory_path());
  std::string pattern = (place / "tissue_contact_XXXXXX").string();
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) refuse("no pipe to another program");
  lives_ = ends[1];
  sigset_t endings;  // wait until the child ignores them: they would leave the folder and nobody to remove it
  sigset_t before;
  sigemptyset(&endings);
  for (const int number : kEndings) sigaddset(&endings, number);
  pthread_sigmask(SIG_BLOCK, &endings, &before);
  if (mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  const int error = errno;
  const pid_t child = path_.empty() ? -1 : fork();
  if (child == 0) removeOnceAlone(ends, path_.c_str());
  close(ends[0]);
  while (child > 0 && waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (!path_.empty()) return;
  close(lives_);
  errno = error;
  refuse("no folder for temporary files");
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  close(lives_);
}

}  // namespace tissue_contact
