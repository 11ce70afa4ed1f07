/// @file
/// Room `ros`, private: what other threads ask of the one that steps, done between two moments. No ROS inside.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <string>

namespace tissue_contact {

/// To whoever asked.
struct Answer {
  bool success = false;
  std::string message;  ///< what was done, or why not and what to do
};

/// Thread-safe. Whoever asks waits; the thread that answers never does, unless it wants to.
class RequestQueue {
 public:
  /// @param on_request called, by whoever asks, when there is one.
  explicit RequestQueue(std::function<void()> on_request) : on_request_(std::move(on_request)) {}

  /// Waits until `work` has been done by the thread that answers. If that has not begun after `patience_s`, it never will.
  /// An exception of it becomes its answer.
  Answer ask(std::function<Answer()> work, double patience_s);

  /// Does what was asked for, oldest first.
  void answer();

  /// Returns once there is a request, and after that long in any case.
  void wait(double most_s);

  /// What waits and what comes is refused.
  void close();

 private:
  struct Request {
    std::function<Answer()> work;
    bool begun = false;
    bool done = false;
    Answer answer;
  };

  std::function<void()> on_request_;
  std::mutex mutex_;  ///< guards all below, not while work is done
  std::condition_variable changed_;
  std::deque<std::shared_ptr<Request>> waiting_;
  bool closed_ = false;
};

}  // namespace tissue_contact
