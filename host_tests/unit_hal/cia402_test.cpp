// SPDX-License-Identifier: MIT
#include <cstdint>
#include <set>
#include <string_view>

#include <gtest/gtest.h>

#include "hal/cia402/state_machine.hpp"

namespace armsig::cia402 {
namespace {

// Statuswords of the standard's coding table, with every don't-care bit 0 and then 1.
struct Coding {
  std::uint16_t zeros;
  std::uint16_t ones;
  State state;
};
constexpr Coding kStandardCodings[] = {
    {0x0000, 0xFFB0, State::kNotReadyToSwitchOn},  {0x0040, 0xFFF0, State::kSwitchOnDisabled},
    {0x0021, 0xFFB1, State::kReadyToSwitchOn},     {0x0023, 0xFFB3, State::kSwitchedOn},
    {0x0027, 0xFFB7, State::kOperationEnabled},    {0x0007, 0xFF97, State::kQuickStopActive},
    {0x000F, 0xFFBF, State::kFaultReactionActive}, {0x0008, 0xFFB8, State::kFault},
};

TEST(Cia402, decodes_the_standards_statuswords_whatever_the_other_bits) {
  for (const Coding& coding : kStandardCodings) {
    EXPECT_EQ(decode_state(coding.zeros), coding.state) << describe(coding.state);
    EXPECT_EQ(decode_state(coding.ones), coding.state) << describe(coding.state);
  }
}

TEST(Cia402, takes_an_undefined_statusword_for_not_ready) {
  EXPECT_EQ(decode_state(0x0005), State::kNotReadyToSwitchOn);
  EXPECT_EQ(decode_state(0x0066), State::kNotReadyToSwitchOn);
}

TEST(Cia402, enables_by_transitions_2_3_4) {
  EXPECT_EQ(next_step(Goal::kEnabled, State::kSwitchOnDisabled).transition, 2);
  EXPECT_EQ(next_step(Goal::kEnabled, State::kReadyToSwitchOn).transition, 3);
  EXPECT_EQ(next_step(Goal::kEnabled, State::kSwitchedOn).transition, 4);
}

TEST(Cia402, commands_the_standards_controlwords) {
  EXPECT_EQ(control_word(next_step(Goal::kEnabled, State::kSwitchOnDisabled).command), 0x0006);
  EXPECT_EQ(control_word(next_step(Goal::kEnabled, State::kReadyToSwitchOn).command), 0x0007);
  EXPECT_EQ(control_word(next_step(Goal::kEnabled, State::kSwitchedOn).command), 0x000F);
  EXPECT_EQ(control_word(next_step(Goal::kEnabled, State::kOperationEnabled).command), 0x000F);
  EXPECT_EQ(control_word(next_step(Goal::kStopped, State::kOperationEnabled).command), 0x0002);
  EXPECT_EQ(control_word(next_step(Goal::kStopped, State::kQuickStopActive).command), 0x0002);
  EXPECT_EQ(control_word(next_step(Goal::kDisabled, State::kOperationEnabled).command), 0x0007);
  EXPECT_EQ(control_word(next_step(Goal::kDisabled, State::kSwitchedOn).command), 0x0006);
  EXPECT_EQ(control_word(next_step(Goal::kDisabled, State::kReadyToSwitchOn).command), 0x0000);
  EXPECT_EQ(control_word(next_step(Goal::kDisabled, State::kSwitchOnDisabled).command), 0x0000);
}

TEST(Cia402, disables_by_the_ramp_5_then_6_7) {
  EXPECT_EQ(next_step(Goal::kDisabled, State::kOperationEnabled).transition, 5);
  EXPECT_EQ(next_step(Goal::kDisabled, State::kSwitchedOn).transition, 6);
  EXPECT_EQ(next_step(Goal::kDisabled, State::kReadyToSwitchOn).transition, 7);
}

TEST(Cia402, stops_by_11_and_without_torque_by_10_and_7) {
  EXPECT_EQ(next_step(Goal::kStopped, State::kOperationEnabled).transition, 11);
  EXPECT_EQ(next_step(Goal::kStopped, State::kSwitchedOn).transition, 10);
  EXPECT_EQ(next_step(Goal::kStopped, State::kReadyToSwitchOn).transition, 7);
}

TEST(Cia402, leaves_a_quick_stop_by_12) {
  EXPECT_EQ(next_step(Goal::kEnabled, State::kQuickStopActive).transition, 12);
  EXPECT_EQ(next_step(Goal::kDisabled, State::kQuickStopActive).transition, 12);
}

TEST(Cia402, commands_no_transition_out_of_a_fault) {
  for (const Goal goal : {Goal::kDisabled, Goal::kEnabled, Goal::kStopped}) {
    EXPECT_EQ(next_step(goal, State::kFault).transition, 0);
    EXPECT_EQ(next_step(goal, State::kFaultReactionActive).transition, 0);
  }
}

TEST(Cia402, every_goal_is_reached_from_every_state_but_fault) {
  for (const Goal goal : {Goal::kDisabled, Goal::kEnabled, Goal::kStopped}) {
    for (const State start : {State::kSwitchOnDisabled, State::kReadyToSwitchOn, State::kSwitchedOn,
                              State::kOperationEnabled, State::kQuickStopActive}) {
      State state = start;
      for (int steps = 0; steps < 5 && !reached(goal, state); ++steps) {
        const Step step = next_step(goal, state);
        for (const Transition& transition : kTransitions) {
          if (transition.number == step.transition) state = transition.to;
        }
      }
      EXPECT_TRUE(reached(goal, state)) << describe(start);
    }
  }
}

TEST(Cia402, names_every_state) {
  EXPECT_EQ(describe(State::kQuickStopActive), "Quick stop active");
  EXPECT_EQ(describe(State::kNotReadyToSwitchOn), "Not ready to switch on");
}

TEST(Cia402, has_words_of_its_own_for_each_state) {
  std::set<std::string_view> words{describe(static_cast<State>(200))};
  for (const Coding& coding : kStandardCodings) {
    EXPECT_TRUE(words.insert(describe(coding.state)).second) << describe(coding.state);
  }
}

}  // namespace
}  // namespace armsig::cia402
