// SPDX-License-Identifier: MIT
// When a signature may be accepted or rolled back, what becomes of the candidate, and when
// positions are kept.
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

struct Quick : PumaCabinet {
  Quick() : PumaCabinet(1, configuration()) { EXPECT_TRUE(enable()); }
  static Configuration configuration() {
    Configuration c = test::puma_controller();
    c.sweeps.points = c.sweeps.most_points = 8;
    c.sweeps.validation_poses = 3;
    return c;
  }
  bool identify() {
    return ask("identify") == "ok" && run_until(Mode::kSweeping, 1) &&
           run_until(Mode::kHolding, 3600);
  }
  void expect_error(const std::string& request, const std::string& error) {
    EXPECT_TRUE(ask(request).starts_with("error " + error + " "))
        << request << ": " << console.replies.back();
  }
};

TEST(Commit, says_why_there_is_nothing_to_accept_or_to_roll_back) {
  Quick puma;
  const std::size_t changed = puma.memory.changed;
  puma.expect_error("accept", "NO_CANDIDATE");
  puma.expect_error("rollback", "NO_SIGNATURE");
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(1);
  puma.expect_error("accept", "WRONG_MODE");
  puma.expect_error("rollback", "WRONG_MODE");
  ASSERT_EQ(puma.ask("stop"), "ok");
  puma.run(0.1);
  ASSERT_EQ(puma.mode(), Mode::kFaulted);
  puma.expect_error("accept", "WRONG_MODE");
  puma.expect_error("rollback", "WRONG_MODE");
  EXPECT_EQ(puma.memory.changed, changed);
}

// Of the second one nobody knows whether it beats the model that the rollback goes back to.
TEST(Commit, forgets_the_candidate_when_it_is_stored_or_what_it_was_compared_with_is_rolled_back) {
  Quick puma;
  ASSERT_TRUE(puma.identify());
  ASSERT_EQ(puma.ask("accept"), "ok");
  puma.expect_error("candidate", "NO_CANDIDATE");
  puma.expect_error("accept", "NO_CANDIDATE");
  ASSERT_TRUE(puma.identify());
  ASSERT_TRUE(puma.ask("candidate").starts_with("ok signature=candidate "));
  ASSERT_EQ(puma.ask("rollback"), "ok");
  EXPECT_EQ(puma.ask("signature"), "ok model=nominal");
  puma.expect_error("candidate", "NO_CANDIDATE");
}

TEST(Commit, answers_what_is_its_own_where_another_asks_meanwhile) {
  Quick puma;
  ASSERT_TRUE(puma.identify());
  const std::size_t before = puma.console.replies.size();
  puma.console.requests.emplace_back("accept");
  puma.other.requests.emplace_back("status");
  puma.run(1);
  ASSERT_EQ(puma.other.replies.size(), 1U);
  EXPECT_TRUE(puma.other.replies.back().starts_with("ok mode="));
  ASSERT_EQ(puma.console.replies.size(), before + 1);
  EXPECT_EQ(puma.console.replies.back(), "ok");
}

TEST(Commit, is_possible_without_torque) {
  Quick puma;
  ASSERT_TRUE(puma.identify());
  ASSERT_EQ(puma.ask("disable"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kIdle, 1));
  EXPECT_EQ(puma.ask("accept"), "ok");
  EXPECT_TRUE(puma.ask("signature").starts_with("ok model=signature signature=1 "));
  EXPECT_EQ(puma.ask("rollback"), "ok");
  EXPECT_EQ(puma.ask("signature"), "ok model=nominal");
}

TEST(Commit, of_a_new_signature_ends_the_trouble_with_an_old_one) {
  Quick puma;
  std::ranges::fill(puma.memory.bytes, std::uint8_t{'A'});
  puma.start(Quick::configuration(), 1);
  ASSERT_TRUE(puma.enable());
  ASSERT_NE(puma.ask("status").find(" acknowledge=needed"), std::string::npos);
  ASSERT_TRUE(puma.identify());
  ASSERT_EQ(puma.ask("accept"), "ok");
  EXPECT_EQ(puma.ask("status").find(" acknowledge="), std::string::npos);
  EXPECT_EQ(puma.ask("status").find(" store="), std::string::npos);
}

TEST(Positions, are_kept_once_more_when_an_arm_that_was_pushed_stands_still) {
  Quick puma;
  ASSERT_EQ(puma.ask("disable"), "ok");
  puma.run(2);
  const std::size_t kept = puma.memory.changed;
  EXPECT_GT(kept, 0U);
  puma.cabinet->drive(0).push(0.2 * test::kPumaCountsPerRadian);
  puma.run(0.9);
  EXPECT_NEAR(puma.now().positions[0], 0.2, 1e-3) << "it was pushed";
  EXPECT_EQ(puma.memory.changed, kept);
  puma.run(3);
  EXPECT_EQ(puma.memory.changed, kept + 256);
}

}  // namespace
}  // namespace armsig::controller
