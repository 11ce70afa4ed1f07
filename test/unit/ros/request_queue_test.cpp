#include "ros/node/request_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

namespace tissue_contact {
namespace request_queue_test {

constexpr double kLong_s = 60.0;

TEST(RequestQueue, TheOtherThreadDoesIt) {
  std::atomic<int> requests{0};
  RequestQueue queue([&] { ++requests; });
  std::thread worker([&] {
    queue.wait(kLong_s);
    queue.answer();
  });
  std::thread::id doer;
  const Answer answer = queue.ask(
      [&] {
        doer = std::this_thread::get_id();
        return Answer{true, "done"};
      },
      kLong_s);
  EXPECT_EQ(doer, worker.get_id());
  worker.join();
  EXPECT_TRUE(answer.success);
  EXPECT_EQ(answer.message, "done");
  EXPECT_EQ(requests, 1);
}

TEST(RequestQueue, AnExceptionIsAnAnswer) {
  RequestQueue queue([&queue] { queue.answer(); });  // by whoever asks, to be alone
  const Answer answer = queue.ask([]() -> Answer { throw std::invalid_argument("no such file"); }, kLong_s);
  EXPECT_FALSE(answer.success);
  EXPECT_EQ(answer.message, "no such file");
}

TEST(RequestQueue, WhatHasNotBegunInTimeIsNeverDone) {
  RequestQueue queue([] {});
  bool done = false;
  const Answer answer = queue.ask([&] { return done = true, Answer{true, ""}; }, 0.01);
  EXPECT_FALSE(answer.success);
  queue.answer();
  EXPECT_FALSE(done);
}

TEST(RequestQueue, OnceClosedEverythingIsRefused) {
  RequestQueue queue([] {});
  std::thread closer([&] { queue.close(); });
  EXPECT_FALSE(queue.ask([] { return Answer{true, ""}; }, kLong_s).success);
  closer.join();
  EXPECT_FALSE(queue.ask([] { return Answer{true, ""}; }, kLong_s).success);
}

}  // namespace request_queue_test
}  // namespace tissue_contact
