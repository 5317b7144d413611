// SPDX-License-Identifier: MIT
#include "hal/mailbox.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace armsig::hal {
namespace {

TEST(Mailbox, keeps_the_order) {
  Mailbox<int, 4> box;
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(box.post(i));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(box.take(), i);
}

TEST(Mailbox, is_empty_at_first_and_full_at_its_capacity) {
  Mailbox<int, 2> box;
  EXPECT_FALSE(box.take());
  EXPECT_TRUE(box.post(1));
  EXPECT_TRUE(box.post(2));
  EXPECT_FALSE(box.post(3));
  EXPECT_EQ(box.take(), 1);
  EXPECT_TRUE(box.post(3));
}

TEST(Mailbox, loses_and_doubles_nothing_between_two_threads) {
  Mailbox<int, 8> box;
  constexpr int kCount = 20000;
  std::thread producer([&] {
    for (int i = 0; i < kCount;) {
      if (box.post(i)) {
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  for (int expected = 0; expected < kCount;) {
    if (const auto value = box.take()) {
      EXPECT_EQ(*value, expected++);
    } else {
      std::this_thread::yield();
    }
  }
  producer.join();
}

}  // namespace
}  // namespace armsig::hal
