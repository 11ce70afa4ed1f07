#include "mesh/reader/isolated.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <stdexcept>
#include <system_error>

namespace tissue_contact {
namespace {

// First byte of what the child sends, and last byte: a host that ignores SIGCHLD gets no exit status, only the bytes.
constexpr char kResult = '+';
constexpr char kRefusal = '-';
constexpr char kWholeMark = '.';

/// Limits of the calling (child) process. Its address space now is the base, because sanitizers reserve terabytes.
void limitSelf(unsigned seconds, std::size_t bytes) {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const std::size_t now = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  const rlimit memory{now + bytes, now + bytes};
  const rlimit no_core_file{0, 0};
  if (pages > 0) setrlimit(RLIMIT_AS, &memory);
  setrlimit(RLIMIT_CORE, &no_core_file);
  // The host's handlers (ROS has some) must not run here: a crash ends the child, and so does the alarm.
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGINT, SIGTERM, SIGPIPE}) {
    std::signal(number, SIG_DFL);
  }
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  alarm(seconds);
}

std::string answerOf(const std::function<std::string()>& work) {
  try {
    return kResult + work() + kWholeMark;
  } catch (const std::bad_alloc&) {
    return kRefusal + std::string("it needs too much memory") + kWholeMark;
  } catch (const std::exception& error) {
    return kRefusal + std::string(error.what()) + kWholeMark;
  }
}

[[noreturn]] void runChild(const std::function<std::string()>& work, int pipe, unsigned seconds, std::size_t bytes) {
  limitSelf(seconds, bytes);
  const std::string answer = answerOf(work);
  std::size_t sent = 0;
  while (sent < answer.size()) {
    const ssize_t count = write(pipe, answer.data() + sent, answer.size() - sent);
    if (count < 0 && errno != EINTR) _exit(1);
    if (count > 0) sent += static_cast<std::size_t>(count);
  }
  _exit(0);  // no destructors, no flushing: the buffers belong to the parent
}

std::string receiveAnswer(int pipe) {
  std::string answer;
  char buffer[1 << 16];
  while (true) {
    const ssize_t count = read(pipe, buffer, sizeof buffer);
    if (count > 0) answer.append(buffer, static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR)) return answer;
  }
}

/// Why a child ended without a complete answer.
std::string describeEnd(int status, unsigned seconds) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    return "it takes longer than " + std::to_string(seconds) + " s";
  if (WIFSIGNALED(status)) {
    return "the library that reads it crashes (" + std::string(strsignal(WTERMSIG(status))) + "); it is malformed";
  }
  return "the library that reads it ends without an answer; it is malformed";
}

}  // namespace

std::string runIsolated(const std::function<std::string()>& work, unsigned seconds, std::size_t bytes) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "no pipe to a child process");
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    runChild(work, ends[1], seconds, bytes);
  }
  const int fork_error = errno;
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw std::system_error(fork_error, std::generic_category(), "no child process");
  }
  std::string answer = receiveAnswer(ends[0]);
  close(ends[0]);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0 || answer.size() < 2 || answer.back() != kWholeMark) {
    throw std::invalid_argument(describeEnd(status, seconds));
  }
  answer.pop_back();
  const char kind = answer.front();
  answer.erase(0, 1);
  if (kind != kResult) throw std::invalid_argument(answer);
  return answer;
}

}  // namespace tissue_contact
