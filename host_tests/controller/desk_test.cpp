// SPDX-License-Identifier: MIT
// The operators' desk: what its table of verbs says is what the console does.
#include <set>

#include <gtest/gtest.h>

#include "firmware/controller/verbs.hpp"
#include "host_tests/support/homing_puma.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

// A puma in `mode`; empty where it does not get there.
std::unique_ptr<PumaCabinet> puma_in(Mode mode) {
  auto puma = mode == Mode::kHoming
                  ? std::make_unique<PumaCabinet>(1, test::homing_puma_controller(),
                                                  test::homing_puma_drive())
                  : std::make_unique<PumaCabinet>();
  puma->run(0.004);
  if (mode == Mode::kStarting) return puma;
  if (mode == Mode::kIdle) {
    puma->run_until(mode);
    return puma;
  }
  if (!puma->enable()) return puma;
  if (mode == Mode::kServoing) puma->ask("move q1_deg=40 pace=0.1");
  if (mode == Mode::kSweeping) puma->ask("identify");
  if (mode == Mode::kFaulted) puma->ask("stop");
  if (mode == Mode::kHoming) puma->ask("home joint=2");
  puma->run_until(mode, 1);
  return puma;
}

bool is_wrong_mode(const std::string& reply) { return reply.starts_with("error WRONG_MODE "); }

class DeskInMode : public testing::TestWithParam<Mode> {};

// Refusals for other reasons (no candidate, nothing to go back to) are another matter.
TEST_P(DeskInMode, refuses_a_verb_that_its_table_does_not_allow_there) {
  for (const Verb& verb : verbs()) {
    if (verb.modes.contains(GetParam())) continue;
    const auto puma = puma_in(GetParam());
    ASSERT_EQ(puma->mode(), GetParam());
    const std::string request = std::string(verb.name) + (verb.name == "move" ? " q1_deg=1" : "");
    EXPECT_TRUE(is_wrong_mode(puma->ask(request))) << request;
  }
}

TEST_P(DeskInMode, serves_a_verb_that_its_table_allows_there) {
  // These need something else besides: a sequence, a signature that is not used.
  const std::set<std::string_view> conditional{"pause", "resume", "acknowledge"};
  for (const Verb& verb : verbs()) {
    if (!verb.modes.contains(GetParam()) || conditional.contains(verb.name)) continue;
    const auto puma = puma_in(GetParam());
    ASSERT_EQ(puma->mode(), GetParam());
    const std::string request = std::string(verb.name) + (verb.name == "move" ? " q1_deg=1" : "");
    EXPECT_FALSE(is_wrong_mode(puma->ask(request))) << request;
  }
}

INSTANTIATE_TEST_SUITE_P(, DeskInMode, testing::ValuesIn(kAllModes),
                         [](const auto& mode) { return std::string(name(mode.param)); });

TEST(Desk, stops_in_every_mode) {
  for (const Mode mode : kAllModes) {
    const auto puma = puma_in(mode);
    EXPECT_EQ(puma->ask("stop"), "ok") << name(mode);
    EXPECT_EQ(puma->mode(), Mode::kFaulted) << name(mode);
  }
}

TEST(Desk, names_the_mode_that_refuses_and_those_that_would_not) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  const std::string refusal = "error WRONG_MODE the present mode does not allow it ";
  EXPECT_EQ(puma.ask("move q1_deg=1"), refusal + "mode=idle modes=holding");
  EXPECT_EQ(puma.ask("halt"), refusal + "mode=idle modes=holding,servoing,sweeping,homing");
  EXPECT_EQ(puma.ask("reset"), refusal + "mode=idle modes=faulted");
  EXPECT_EQ(puma.ask("pause"), refusal + "why=\"identify is not under way\"");
  EXPECT_EQ(puma.ask("acknowledge"), refusal + "why=\"nothing is to be acknowledged\"");
}

TEST(Desk, names_what_is_under_way_where_the_mode_would_do) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.bend_wrist());
  puma.console.requests.emplace_back("move dz_mm=-100 dx_mm=50");
  puma.run(0.002);
  puma.other.requests.emplace_back("move q1_deg=1");
  puma.run(0.02);
  ASSERT_EQ(puma.other.replies.size(), 1U);
  EXPECT_EQ(puma.other.replies.front(),
            "error WRONG_MODE the present mode does not allow it mode=holding modes=holding "
            "why=\"the planning of a move is under way\"");
}

TEST(Desk, begins_nothing_beside_a_sequence) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
  for (const char* request : {"identify", "move q1_deg=1", "touch-grid", "accept", "rollback"}) {
    EXPECT_TRUE(is_wrong_mode(puma.ask(puma.other, request))) << request;
  }
  EXPECT_TRUE(puma.cabinet->state().identification().is_running());
}

TEST(Desk, begins_nothing_while_a_line_is_planned) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.bend_wrist());
  puma.console.requests.emplace_back("move dz_mm=-100 dx_mm=50");
  puma.run(0.002);
  for (const char* request : {"identify", "move q1_deg=1", "touch-grid", "accept", "rollback"}) {
    puma.other.requests.emplace_back(request);
  }
  puma.run(0.02);
  ASSERT_EQ(puma.other.replies.size(), 5U);
  for (const std::string& reply : puma.other.replies) EXPECT_TRUE(is_wrong_mode(reply)) << reply;
}

TEST(Desk, tells_every_verb_and_what_each_is_for) {
  PumaCabinet puma;
  const std::string all = puma.ask("help");
  EXPECT_TRUE(all.starts_with("ok verbs=status,enable,")) << all;
  EXPECT_TRUE(all.ends_with(",log,fetch,home,help")) << all;
  for (const Verb& verb : verbs()) {
    EXPECT_NE(all.find(verb.name), std::string::npos) << verb.name;
    const std::string one = puma.ask("help " + std::string(verb.name));
    EXPECT_TRUE(one.starts_with("ok verb=" + std::string(verb.name) + " modes=")) << one;
    EXPECT_NE(one.find(verb.help), std::string::npos) << one;
  }
  EXPECT_NE(puma.ask("help enable").find(" modes=idle alone=no "), std::string::npos);
  EXPECT_NE(puma.ask("help accept").find(" modes=idle,holding alone=yes "), std::string::npos);
  EXPECT_NE(puma.ask("help stop").find("not an emergency stop"), std::string::npos);
}

TEST(Desk, refuses_words_that_a_verb_does_not_take) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  for (const char* request :
       {"enable now", "enable q1_deg=1", "help dance", "help enable disable", "help verb=enable",
        "move q1_deg", "log 1", "status x=1", "=", "move q1_deg=1 now"}) {
    EXPECT_TRUE(puma.ask(request).starts_with("error UNKNOWN_REQUEST ")) << request;
  }
  EXPECT_EQ(puma.mode(), Mode::kIdle);
}

}  // namespace
}  // namespace armsig::controller
