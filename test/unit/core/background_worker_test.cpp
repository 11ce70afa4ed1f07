/// @file
/// BackgroundWorker: jobs in their order, what they leave is there once waited for, and an end that drops what has not begun.
#include "core/background_worker.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <future>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <thread>
#include <vector>

namespace tissue_contact {
namespace background_worker_test {

void takeTime() { std::this_thread::sleep_for(std::chrono::milliseconds(50)); }

TEST(BackgroundWorker, DoesJobsInTheirOrderBesideTheCaller) {
  std::vector<int> done;
  std::thread::id by;
  BackgroundWorker worker;
  BackgroundWorker::Ticket last = 0;
  for (int i = 0; i < 100; ++i) {
    last = worker.start([&done, &by, i] {
      done.push_back(i);
      by = std::this_thread::get_id();
    });
  }
  worker.wait(last);
  std::vector<int> expected(100);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(done, expected);
  EXPECT_NE(by, std::this_thread::get_id());
}

TEST(BackgroundWorker, WaitsForTheJobAskedFor) {
  int first = 0;
  int second = 0;
  BackgroundWorker worker;
  const auto quick = worker.start([&] { first = 1; });
  const auto slow = worker.start([&] {
    takeTime();
    second = 2;
  });
  worker.wait(quick);
  EXPECT_EQ(first, 1);
  EXPECT_TRUE(worker.wait(slow)) << "it was not done yet";
  EXPECT_EQ(second, 2);
  EXPECT_FALSE(worker.wait(slow));
  EXPECT_FALSE(worker.wait(quick));
}

TEST(BackgroundWorker, EndsOnceTheJobItIsAtIsDone) {
  bool ended = false;
  {
    std::promise<void> begun;
    BackgroundWorker worker;
    worker.start([&] {
      begun.set_value();
      takeTime();
      ended = true;
    });
    begun.get_future().wait();
  }
  EXPECT_TRUE(ended);
}

// As Python's multiprocessing forks: a thread that is not there must be waited for by nobody.
TEST(BackgroundWorker, RefusesInAForkedProcess) {
  auto worker = std::make_unique<BackgroundWorker>();
  worker->wait(worker->start([] {}));
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);  // what hangs ends by a signal
    int refused = 0;
    try {
      worker->start([] {});
    } catch (const std::runtime_error&) {
      ++refused;
    }
    try {
      worker->wait(1);
    } catch (const std::runtime_error&) {
      ++refused;
    }
    auto own = std::make_unique<BackgroundWorker>();
    worker.reset();
    int done = 0;
    own->wait(own->start([&] { done = 1; }));
    own.reset();
    _exit(refused + done);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 3);
}

TEST(BackgroundWorker, EndsWithoutAnyJob) { const BackgroundWorker worker; }

}  // namespace background_worker_test
}  // namespace tissue_contact
