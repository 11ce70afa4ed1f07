/// @file
/// Room `core`, private: one thread beside the caller's that does jobs in the order they were given. What they leave behind may be read
/// once wait() has returned: when it was ready is nobody's business, so that results do not depend on how fast it was.
#pragma once

#include <sys/types.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace tissue_contact {

class BackgroundWorker {
 public:
  /// Of a job: how many had been given with it.
  using Ticket = std::uint64_t;

  BackgroundWorker();
  /// Ends the thread once the job that it is at is done; those that wait are dropped.
  ~BackgroundWorker();
  BackgroundWorker(const BackgroundWorker&) = delete;
  BackgroundWorker& operator=(const BackgroundWorker&) = delete;

  /// @param job must not throw, and what it refers to must stay until it is done.
  /// @throws std::runtime_error in a process that fork() made of the one with the thread, as wait() does.
  Ticket start(std::function<void()> job);

  /// Returns once that job, and so all before it, are done. @return whether they were not yet: for figures alone.
  bool wait(Ticket job);

 private:
  struct Shared {  ///< with the thread
    std::mutex mutex;
    std::condition_variable given;
    std::condition_variable done;
    std::deque<std::function<void()>> jobs;
    Ticket jobs_given = 0;
    Ticket jobs_done = 0;
    bool ends = false;
    std::thread thread;  ///< last: it uses all of the above
  };

  static void work(Shared& shared);
  void requireThread() const;

  pid_t process_;  ///< that has the thread
  std::unique_ptr<Shared> shared_;
};

}  // namespace tissue_contact
