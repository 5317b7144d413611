// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/conversation.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

constexpr std::size_t kWidth = 80;

Conversation with_verbs() {
  Conversation conversation;
  conversation.learn_verbs("ok verbs=status,stop,move,confirm,help");
  conversation.learn_verb("ok verb=status modes=idle,holding alone=no does=\"mode, fault\"");
  conversation.learn_verb("ok verb=stop modes=idle,holding alone=no does=\"quick stop\"");
  conversation.learn_verb(
      "ok verb=move modes=holding alone=yes does=\"q1_deg=10 q3_mm=5 moves joints, dq1_deg=1 by so "
      "much; x_mm= y_mm= moves the tool; pace=0.5\"");
  conversation.learn_verb(
      "ok verb=confirm modes=idle,holding alone=no does=\"q1_deg=10 q3_mm=5: a person sees them\"");
  conversation.learn_joints("ok mode=idle q1_deg=0.0000 q2_deg=90.0000 q3_mm=5.0000 ticks=7");
  return conversation;
}

using Words = std::vector<std::string>;

TEST(Conversation, sends_a_request_as_it_was_typed_without_blanks_about_it) {
  Conversation conversation = with_verbs();
  const auto step = conversation.take("  move q1_deg=10  pace=0.5 ", kWidth);
  EXPECT_EQ(step.send, "move q1_deg=10  pace=0.5");
  EXPECT_EQ(step.say, "");
  EXPECT_FALSE(step.leaves);
}

TEST(Conversation, sends_nothing_for_a_word_that_is_no_verb_and_names_the_nearest) {
  Conversation conversation = with_verbs();
  const auto step = conversation.take("mvoe q1_deg=10", kWidth);
  EXPECT_EQ(step.send, "");
  EXPECT_EQ(step.say, "There is no request `mvoe`; did you mean `move`? Nothing was sent.\n");
  EXPECT_EQ(conversation.take("frobnicate", kWidth).say,
            "There is no request `frobnicate`; `help` lists them. Nothing was sent.\n");
}

TEST(Conversation, sends_everything_while_the_verbs_are_not_known) {
  Conversation conversation;
  EXPECT_EQ(conversation.take("mvoe q1_deg=10", kWidth).send, "mvoe q1_deg=10");
  EXPECT_EQ(conversation.take("help", kWidth).send, "help");
}

TEST(Conversation, leaves_at_quit_and_exit_alone) {
  Conversation conversation = with_verbs();
  EXPECT_TRUE(conversation.take(" quit ", kWidth).leaves);
  EXPECT_TRUE(conversation.take("exit", kWidth).leaves);
  EXPECT_FALSE(conversation.take("", kWidth).leaves);
  EXPECT_FALSE(conversation.take("stop", kWidth).leaves);
}

TEST(Conversation, tells_a_verb_a_line) {
  Conversation conversation = with_verbs();
  const std::string all = conversation.take("help", kWidth).say;
  EXPECT_NE(all.find("\n  stop          quick stop\n"), std::string::npos) << all;
  EXPECT_NE(all.find("\n  quit          leaves the console"), std::string::npos) << all;
  EXPECT_EQ(conversation.take("help stop", kWidth).say,
            "  stop          quick stop\n  modes         idle, holding\n");
  EXPECT_NE(conversation.take("help move", kWidth).say.find("only while nothing else"),
            std::string::npos);
  EXPECT_EQ(conversation.take("help stpo", kWidth).say,
            "There is no request `stpo`; did you mean `stop`? Nothing was sent.\n");
}

TEST(Conversation, refuses_a_line_that_no_console_takes) {
  Conversation conversation = with_verbs();
  const std::string longest = "move " + std::string(Conversation::kLongestLine - 5, 'x');
  EXPECT_EQ(conversation.take(longest, kWidth).send, longest);
  const auto step = conversation.take(longest + "x", kWidth);
  EXPECT_EQ(step.send, "");
  EXPECT_EQ(step.say, "A request has 512 characters at most. Nothing was sent.\n");
}

TEST(Conversation, completes_verbs_and_those_that_help_takes) {
  const Conversation conversation = with_verbs();
  EXPECT_EQ(conversation.completions("st"), (Words{"status", "stop"}));
  EXPECT_EQ(conversation.completions("  mo"), (Words{"move"}));
  EXPECT_EQ(conversation.completions("help co"), (Words{"confirm"}));
  EXPECT_EQ(conversation.completions("raw sta"), (Words{"status"}));
  EXPECT_EQ(conversation.completions("x"), Words{});
}

TEST(Conversation, completes_the_keys_of_a_verb_for_the_joints_that_there_are) {
  const Conversation conversation = with_verbs();
  EXPECT_EQ(conversation.completions("move d"), (Words{"dq1_deg=", "dq2_deg=", "dq3_mm="}));
  EXPECT_EQ(conversation.completions("move q1_deg=3 q"), (Words{"q2_deg=", "q3_mm="}));
  EXPECT_EQ(conversation.completions("confirm "), (Words{"q1_deg=", "q2_deg=", "q3_mm="}));
  EXPECT_EQ(conversation.completions("raw confirm q1"), (Words{"q1_deg="}));
  EXPECT_EQ(conversation.completions("raw confirm "), (Words{"q1_deg=", "q2_deg=", "q3_mm="}));
  EXPECT_EQ(conversation.completions("stop "), Words{});
}

TEST(Conversation, says_a_status_in_words_and_by_raw_as_the_controller_wrote_it) {
  const std::string reply = "ok mode=idle moving=no sequence=none ticks=7";
  Conversation conversation = with_verbs();
  EXPECT_EQ(conversation.take("status", kWidth).send, "status");
  EXPECT_EQ(conversation.take("raw status", kWidth).send, "status");
  EXPECT_NE(conversation.hear(reply, kWidth).find("idle          no torque"), std::string::npos);
  EXPECT_EQ(conversation.hear("# half way", kWidth), "# half way\n");
  EXPECT_EQ(conversation.hear(reply, kWidth), reply + "\n");
}

TEST(Conversation, gives_no_terminal_a_command_of_the_controller) {
  Conversation conversation = with_verbs();
  EXPECT_EQ(conversation.hear("# \x1B[2J", kWidth), "# \\x1B[2J\n");
  (void)conversation.take("status", kWidth);
  const std::string told =
      conversation.hear("ok mode=\x1B[2J ticks=1 fault=\x1B]0 what=\x1B[1m", kWidth);
  EXPECT_EQ(told.find('\x1B'), std::string::npos);
}

}  // namespace
}  // namespace armsig::tool
