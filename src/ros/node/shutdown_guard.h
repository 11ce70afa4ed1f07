/// @file
/// Room `ros`, private: SIGINT and SIGTERM end the process within a second, whatever it is doing. No ROS inside.
#pragma once

#include <functional>
#include <mutex>
#include <thread>

namespace tissue_contact {

/// While it lives both signals only ask the program to end. If it has not ended by itself (this object destroyed) half a
/// second later, the last words are said and the process is left with exit code 0, without any clean-up.
/// One at a time.
class ShutdownGuard {
 public:
  /// @throws std::runtime_error when there is already one, or the system refuses.
  ShutdownGuard();
  ~ShutdownGuard();
  ShutdownGuard(const ShutdownGuard&) = delete;
  ShutdownGuard& operator=(const ShutdownGuard&) = delete;

  bool asked() const;  ///< by a signal or ask()
  void ask();          ///< as if a signal had come: starts the half second

  /// What to do when the time is up: at most a third of a second, from a thread of its own, while all others run on.
  void setLastWords(std::function<void()> last_words);

 private:
  void watch();
  void leave();

  std::mutex mutex_;  ///< guards last_words_
  std::function<void()> last_words_;
  std::thread watcher_;
};

}  // namespace tissue_contact
