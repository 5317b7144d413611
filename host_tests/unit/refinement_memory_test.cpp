// SPDX-License-Identifier: MIT
// What a refinement needs beside its log: the estimate that it fills, and its stack.
#include <pthread.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "core/refinement/refinement.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig {
namespace {

constexpr std::size_t kBudget = 64 * 1024;
constexpr std::size_t kStack = 512 * 1024;
constexpr std::uint64_t kPaint = 0xA5A5A5A5A5A5A5A5;

struct Job {
  Signature start;
  test::Log log;
  std::vector<refinement::RowOutcome> outcomes;
  std::unique_ptr<refinement::Refined> refined = std::make_unique<refinement::Refined>();
  bool done = false;
};

void* idle(void* /*unused*/) { return nullptr; }
void* run(void* argument) {
  Job& job = *static_cast<Job*>(argument);
  job.done = refinement::refine(job.start, job.log, {}, job.outcomes, *job.refined).has_value();
  return nullptr;
}

// Bytes of a painted stack that a thread has overwritten.
std::size_t stack_used(void* (*body)(void*), void* argument) {
  std::vector<std::uint64_t> stack(kStack / sizeof(std::uint64_t) + 512, kPaint);
  void* bottom = stack.data();
  std::size_t space = stack.size() * sizeof(std::uint64_t);
  std::align(4096, kStack, bottom, space);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  EXPECT_EQ(pthread_attr_setstack(&attributes, bottom, kStack), 0);
  pthread_t thread{};
  EXPECT_EQ(pthread_create(&thread, &attributes, body, argument), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  const auto touched =
      std::ranges::find_if(stack, [](std::uint64_t word) { return word != kPaint; });
  const auto top = reinterpret_cast<std::uintptr_t>(bottom) + kStack;
  return top - reinterpret_cast<std::uintptr_t>(&*touched);
}

TEST(RefinementMemory, of_six_joints_and_250_measurements_is_at_most_64_kib_beside_the_log) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer enlarges every stack frame";
#endif
  test::Random random(13);
  const test::Cell cell = test::puma_cell(random);
  const JointVector held = test::puma_configuration();
  Job job;
  job.start = test::disturbed(test::signature_of(cell, held), 2e-3, 2e-3, random);
  test::add_sweeps(cell, held, kPi, 36, 2e-4, random, job.log);
  test::add_poses(cell, 34, 2e-4, random, job.log);
  ASSERT_EQ(job.log.size(), 250U);
  job.outcomes.resize(job.log.size());
  const std::size_t of_any_thread = stack_used(idle, nullptr);
  const std::size_t stack = stack_used(run, &job) - of_any_thread;
  ASSERT_TRUE(job.done);
  RecordProperty("stack", std::to_string(stack));
  EXPECT_LE(sizeof(refinement::Refined) + stack, kBudget)
      << sizeof(refinement::Refined) << " bytes of estimate, " << stack << " of stack";
}

}  // namespace
}  // namespace armsig
