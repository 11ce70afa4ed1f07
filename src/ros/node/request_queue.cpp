#include "ros/node/request_queue.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <utility>

namespace tissue_contact {

Answer RequestQueue::ask(std::function<Answer()> work, double patience_s) {
  const auto request = std::make_shared<Request>();
  request->work = std::move(work);
  std::unique_lock<std::mutex> lock(mutex_);
  if (closed_) return {false, "the node is ending"};
  waiting_.push_back(request);
  lock.unlock();
  changed_.notify_all();
  on_request_();
  lock.lock();
  const auto settled = [&] { return request->done || (closed_ && !request->begun); };
  if (!changed_.wait_for(lock, std::chrono::duration<double>(patience_s), settled) && request->begun) {
    changed_.wait(lock, settled);
  }
  if (request->done) return request->answer;
  waiting_.erase(std::remove(waiting_.begin(), waiting_.end(), request), waiting_.end());
  if (closed_) return {false, "the node is ending"};
  return {false, "a step takes longer than " + std::to_string(static_cast<int>(patience_s)) +
                     " s: nothing was done; ask again"};
}

void RequestQueue::answer() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!waiting_.empty()) {
    const std::shared_ptr<Request> request = waiting_.front();
    waiting_.pop_front();
    request->begun = true;
    lock.unlock();
    Answer answer;
    try {
      answer = request->work();
    } catch (const std::exception& error) {
      answer = {false, error.what()};
    }
    lock.lock();
    request->answer = std::move(answer);
    request->done = true;
    changed_.notify_all();
  }
}

void RequestQueue::wait(double most_s) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait_for(lock, std::chrono::duration<double>(most_s), [this] { return closed_ || !waiting_.empty(); });
}

void RequestQueue::close() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

}  // namespace tissue_contact
