// SPDX-License-Identifier: MIT
// What `system` tells: each key of it, with the figure that belongs to it.
#include "firmware/linux/process_watch.hpp"

#include <cerrno>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace armsig::daemon {
namespace {

std::string told(const ProcessWatch& watch) {
  controller::Line line;
  watch.tell(line);
  return std::string(line.view());
}

// From ` can=` on.
std::string told_of_the_bus(const ProcessWatch& watch) {
  const std::string line = told(watch);
  const std::size_t at = line.find(" can=");
  return at == std::string::npos ? "" : line.substr(at);
}

TEST(ProcessWatch, tells_of_the_process_alone_where_there_is_no_bus) {
  ProcessWatch watch;
  watch.begin({}, 80);
  watch.look({}, nullptr);
  const std::string line = told(watch);
  EXPECT_TRUE(line.starts_with(" memory_locked=yes real_time=yes heap_calls=")) << line;
  EXPECT_NE(line.find(" page_faults="), std::string::npos);
  EXPECT_NE(line.find(" servo_page_faults="), std::string::npos);
  EXPECT_EQ(told_of_the_bus(watch), "");
}

TEST(ProcessWatch, tells_what_the_process_was_not_granted) {
  ProcessWatch watch;
  watch.begin({.memory_not_locked = EPERM, .priority_not_given = EPERM}, 80);
  EXPECT_TRUE(told(watch).starts_with(" memory_locked=no real_time=no "));
  ProcessWatch ordinary;
  ordinary.begin({}, 0);
  EXPECT_TRUE(told(ordinary).starts_with(" memory_locked=yes real_time=no "));
}

TEST(ProcessWatch, tells_every_counter_of_the_bus_and_of_its_master) {
  ProcessWatch watch;
  watch.begin({}, 80);
  watch.look_at(0,
                hal::CanStatus{.state = hal::CanState::kPassive,
                               .lost = 2,
                               .error_frames = 1,
                               .bus_offs = 3,
                               .restarts = 4},
                0);
  watch.look_at(0, canopen::MasterCounters{.malformed = 5,
                                           .foreign = 6,
                                           .unknown = 7,
                                           .unsent = 8,
                                           .unanswered = 9,
                                           .late_heartbeats = 10,
                                           .emergencies = 11,
                                           .repeated = 12});
  EXPECT_EQ(told_of_the_bus(watch),
            " can=passive can_error_frames=1 can_lost=2 can_bus_offs=3 can_restarts=4"
            " can_malformed=5 can_foreign=6 can_unknown=7 can_unsent=8 can_unanswered=9"
            " can_late_heartbeats=10 can_emergencies=11 can_repeated=12");
}

TEST(ProcessWatch, tells_a_second_bus_by_keys_of_its_own) {
  ProcessWatch watch;
  watch.look_at(0, hal::CanStatus{.state = hal::CanState::kActive}, 0);
  watch.look_at(1, hal::CanStatus{.state = hal::CanState::kBusOff, .bus_offs = 2}, ENETDOWN);
  watch.look_at(1, canopen::MasterCounters{.emergencies = 3});
  const std::string line = told_of_the_bus(watch);
  EXPECT_NE(line.find(" can_emergencies=0 "), std::string::npos) << line;
  EXPECT_NE(line.find(" can2=bus-off "), std::string::npos) << line;
  EXPECT_NE(line.find(" can2_bus_offs=2 "), std::string::npos) << line;
  EXPECT_NE(line.find(" can2_emergencies=3 "), std::string::npos) << line;
  EXPECT_TRUE(line.ends_with(" can2_says=\"Network is down\"")) << line;
}

TEST(ProcessWatch, names_each_state_of_the_interface) {
  using enum hal::CanState;
  for (const auto& [state, name] :
       {std::pair{kActive, "active"}, std::pair{kWarning, "warning"},
        std::pair{kPassive, "passive"}, std::pair{kBusOff, "bus-off"}, std::pair{kDown, "down"}}) {
    ProcessWatch watch;
    watch.look_at(0, hal::CanStatus{.state = state}, 0);
    EXPECT_TRUE(told_of_the_bus(watch).starts_with(std::string(" can=") + name + " ")) << name;
  }
}

TEST(ProcessWatch, says_the_last_refusal_of_the_system_in_words) {
  ProcessWatch watch;
  watch.look_at(0, hal::CanStatus{}, ENETDOWN);
  EXPECT_TRUE(told_of_the_bus(watch).ends_with(" can_says=\"Network is down\""));
}

}  // namespace
}  // namespace armsig::daemon
