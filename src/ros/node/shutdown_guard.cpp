#include "ros/node/shutdown_guard.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <utility>

namespace tissue_contact {
namespace {

constexpr std::chrono::milliseconds kGrace(500);      ///< for the program to end by itself
constexpr std::chrono::milliseconds kLastWords(330);  ///< for the last words; the rest of the second is the machine's

constexpr char kAsked = 'a';
constexpr char kDone = 'd';

// A signal handler reaches nothing but what is global.
std::atomic<bool> g_asked{false};
std::array<int, 2> g_pipe = {-1, -1};

void tell(char what) {
  const int saved = errno;
  // A full pipe holds an earlier word, which does as well.
  if (write(g_pipe[1], &what, 1) < 0) errno = 0;
  errno = saved;
}

extern "C" void onSignal(int /*signal*/) {
  g_asked = true;
  tell(kAsked);
}

using Clock = std::chrono::steady_clock;

/// The next word, waiting for ever; or 0 when none has come by the deadline.
char nextWord(const std::optional<Clock::time_point>& deadline) {
  pollfd waiting = {g_pipe[0], POLLIN, 0};
  for (;;) {
    using Milliseconds = std::chrono::milliseconds;
    const auto left = deadline ? std::chrono::duration_cast<Milliseconds>(*deadline - Clock::now()) : Milliseconds(-1);
    if (deadline && left.count() <= 0) return 0;
    char word = 0;
    if (poll(&waiting, 1, static_cast<int>(left.count())) > 0 && read(g_pipe[0], &word, 1) == 1) return word;
  }
}

bool isDoneWithin(std::chrono::milliseconds time) {
  const Clock::time_point deadline = Clock::now() + time;
  for (char word = nextWord(deadline); word != 0; word = nextWord(deadline)) {  // signals may be repeated
    if (word == kDone) return true;
  }
  return false;
}

}  // namespace

ShutdownGuard::ShutdownGuard() {
  if (g_pipe[0] >= 0) throw std::runtime_error("only one ShutdownGuard at a time");
  if (pipe2(g_pipe.data(), O_CLOEXEC | O_NONBLOCK) != 0) throw std::runtime_error("no pipe for signals");
  g_asked = false;
  watcher_ = std::thread([this] { watch(); });
  struct sigaction action = {};
  action.sa_handler = onSignal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

ShutdownGuard::~ShutdownGuard() {
  tell(kDone);
  watcher_.join();
  // A signal from now on finds the program on its way out.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  for (int& end : g_pipe) close(std::exchange(end, -1));
}

bool ShutdownGuard::asked() const { return g_asked; }

void ShutdownGuard::ask() { onSignal(0); }

void ShutdownGuard::setLastWords(std::function<void()> last_words) {
  const std::lock_guard<std::mutex> lock(mutex_);
  last_words_ = std::move(last_words);
}

void ShutdownGuard::watch() {
  if (nextWord(std::nullopt) != kDone && !isDoneWithin(kGrace)) leave();
}

void ShutdownGuard::leave() {
  std::thread([this] {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (last_words_) last_words_();
    tell(kDone);
  }).detach();
  isDoneWithin(kLastWords);
  std::fflush(stdout);
  std::_Exit(0);
}

}  // namespace tissue_contact
