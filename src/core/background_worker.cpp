#include "core/background_worker.h"

#include <unistd.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace tissue_contact {

BackgroundWorker::BackgroundWorker() : process_(getpid()), shared_(std::make_unique<Shared>()) {
  shared_->thread = std::thread([shared = shared_.get()] { work(*shared); });
}

BackgroundWorker::~BackgroundWorker() {
  if (getpid() != process_) {
    // No thread to wait for. What it held or waited for at the fork would hang whoever destroys it, and its handle may be another's now.
    static_cast<void>(shared_.release());
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->ends = true;
  }
  shared_->given.notify_one();
  shared_->thread.join();
}

void BackgroundWorker::requireThread() const {
  if (getpid() == process_) return;
  throw std::runtime_error("this simulation has a second thread, which stayed in process " + std::to_string(process_) +
                           " when that was forked: make the simulator in this process, and load the saved state");
}

BackgroundWorker::Ticket BackgroundWorker::start(std::function<void()> job) {
  requireThread();
  Ticket ticket = 0;
  {
    const std::lock_guard<std::mutex> lock(shared_->mutex);
    shared_->jobs.push_back(std::move(job));
    ticket = ++shared_->jobs_given;
  }
  shared_->given.notify_one();
  return ticket;
}

bool BackgroundWorker::wait(Ticket job) {
  requireThread();
  std::unique_lock<std::mutex> lock(shared_->mutex);
  const bool is_early = shared_->jobs_done < job;
  shared_->done.wait(lock, [&] { return shared_->jobs_done >= job; });
  return is_early;
}

void BackgroundWorker::work(Shared& shared) {
  std::unique_lock<std::mutex> lock(shared.mutex);
  for (;;) {
    shared.given.wait(lock, [&] { return shared.ends || !shared.jobs.empty(); });
    if (shared.ends) return;
    const std::function<void()> job = std::move(shared.jobs.front());
    shared.jobs.pop_front();
    lock.unlock();
    job();
    lock.lock();
    ++shared.jobs_done;
    shared.done.notify_all();
  }
}

}  // namespace tissue_contact
