#include "core/background_worker.h"

#include <utility>

namespace tissue_contact {

BackgroundWorker::BackgroundWorker() : thread_([this] { work(); }) {}

BackgroundWorker::~BackgroundWorker() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ends_ = true;
  }
  given_.notify_one();
  thread_.join();
}

BackgroundWorker::Ticket BackgroundWorker::start(std::function<void()> job) {
  Ticket ticket = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    jobs_.push_back(std::move(job));
    ticket = ++jobs_given_;
  }
  given_.notify_one();
  return ticket;
}

bool BackgroundWorker::wait(Ticket job) {
  std::unique_lock<std::mutex> lock(mutex_);
  const bool is_early = jobs_done_ < job;
  done_.wait(lock, [&] { return jobs_done_ >= job; });
  return is_early;
}

void BackgroundWorker::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  for (;;) {
    given_.wait(lock, [this] { return ends_ || !jobs_.empty(); });
    if (ends_) return;
    const std::function<void()> job = std::move(jobs_.front());
    jobs_.pop_front();
    lock.unlock();
    job();
    lock.lock();
    ++jobs_done_;
    done_.notify_all();
  }
}

}  // namespace tissue_contact
