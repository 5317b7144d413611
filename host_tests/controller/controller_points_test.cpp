// SPDX-License-Identifier: MIT
// An identification point by point: what it visits, what is lost and skipped, what it tells of its
// progress, and how each end of it is told.
#include <chrono>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

struct Measured : PumaCabinet {
  explicit Measured(const Configuration& c = configuration()) : PumaCabinet(1, c) {
    EXPECT_TRUE(enable());
    EXPECT_EQ(ask("identify"), "ok");
    run_until(Mode::kSweeping, 1);
  }
  static Configuration configuration() {
    Configuration c = test::puma_controller();
    c.sweeps.points = c.sweeps.most_points = 8;
    c.sweeps.validation_poses = 3;
    return c;
  }
  const IdentificationSequence& sequence() { return cabinet->state().identification(); }
  // Until `points` are measured.
  void measure(std::size_t points) {
    for (int i = 0; i < 200'000 && sequence().points_done() < points; ++i) cabinet->step();
    ASSERT_EQ(sequence().points_done(), points);
  }
  [[nodiscard]] std::size_t told(const std::string& beginning) const {
    std::size_t count = 0;
    for (const std::string& line : console.told) count += line.starts_with(beginning) ? 1 : 0;
    return count;
  }
  [[nodiscard]] std::string last(const std::string& beginning) const {
    std::string found;
    for (const std::string& line : console.told) {
      if (line.starts_with(beginning)) found = line;
    }
    return found;
  }
};

TEST(Identify, visits_each_joints_arc_and_the_poses_held_out_and_returns) {
  Measured puma;
  EXPECT_EQ(puma.sequence().points_planned(), 6 * 8 + 3U);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
  const MeasurementLog& log = puma.sequence().log();
  ASSERT_EQ(log.size(), puma.sequence().points_done());
  ASSERT_GT(log.size(), 6 * 6 + 3U);
  const JointVector centre = test::puma_configuration();
  const Configuration c = Measured::configuration();
  for (std::size_t i = 0; i < log.size(); ++i) {
    const std::size_t sweep = log[i].sweep();
    EXPECT_EQ(sweep == 0, i + 3 >= log.size()) << i;
    const std::size_t before = i == 0 ? 1 : log[i - 1].sweep();
    EXPECT_TRUE(sweep == 0 || sweep == before || sweep == before + 1) << i;
    EXPECT_EQ(log[i].pings(), 5U) << i;
    for (std::size_t joint = 0; joint < 6; ++joint) {
      const double off = std::abs(log[i].readings()[joint] - centre[joint]);
      if (sweep == 0) {
        const auto [lower, upper] = c.drawing.limits[joint];
        EXPECT_GE(log[i].readings()[joint], centre[joint] + 0.5 * (lower - centre[joint]) - 1e-3);
        EXPECT_LE(log[i].readings()[joint], centre[joint] + 0.5 * (upper - centre[joint]) + 1e-3);
      } else if (joint + 1 != sweep) {
        EXPECT_LT(off, 1e-3) << i << ": only the joint of the sweep moves";
      }
    }
  }
  EXPECT_EQ(puma.told("# identify swept joint="), 6U);
  EXPECT_EQ(puma.told("# candidate signature=candidate "), 1U);
  const std::string held_out = puma.last("# candidate signature=candidate ");
  const std::size_t active = held_out.find(" active_rms_mm=");
  const std::size_t candidate = held_out.find(" validation_rms_mm=");
  ASSERT_NE(active, std::string::npos) << held_out;
  EXPECT_NEAR(std::stod(held_out.substr(candidate + 19)),
              1e3 * puma.sequence().report().candidate_rms_m, 0.51e-4);
  EXPECT_NEAR(std::stod(held_out.substr(active + 15)), 1e3 * puma.sequence().report().active_rms_m,
              0.51e-4);
  EXPECT_EQ(held_out.find(' ', active + 1) - held_out.find('.', active), 5U)
      << "four decimals: " << held_out;
  EXPECT_EQ(puma.told("# identify done"), 1U);
  puma.run(0.1);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_NEAR(puma.now().positions[joint], centre[joint], 1e-3) << "back where it began";
  }
}

TEST(Identify, tells_how_much_is_left_by_what_was_done) {
  Measured puma;
  EXPECT_FALSE(puma.sequence().left_s()) << "nothing is known before the first point";
  EXPECT_EQ(puma.ask("status").find(" left_s="), std::string::npos);
  const hal::Instant began = puma.now().now;
  puma.measure(10);
  const double a_point_s = hal::seconds(puma.now().now - began) / 10;
  EXPECT_NEAR(puma.sequence().left_s().value_or(0), 41 * a_point_s, 0.05 * 41 * a_point_s);
  EXPECT_EQ(puma.told("# identify swept joint=1 points=8 planned=51 axis_sigma_deg=0."), 1U);
  const std::string swept = puma.last("# identify swept joint=1 ");
  EXPECT_LT(swept.rfind('.'), swept.find(" left_s=")) << "whole seconds: " << swept;
}

// Ranges that do not meet in a point are the place's fault, until they are so three times in a row.
TEST(Identify, skips_points_without_a_position_and_pauses_at_the_third_in_a_row) {
  Measured puma;
  puma.measure(4);
  puma.cabinet->sensor().field().multipath_probability = 0.9;
  puma.cabinet->sensor().field().longest_detour_m = 3;
  for (int i = 0; i < 100'000 && puma.told("# identify point lost") < 1; ++i) puma.cabinet->step();
  EXPECT_NE(puma.last("# identify point lost").find(" error=RANGES_INCONSISTENT "),
            std::string::npos)
      << puma.last("# identify point lost");
  EXPECT_FALSE(puma.sequence().is_paused());
  for (int i = 0; i < 100'000 && !puma.sequence().is_paused(); ++i) puma.cabinet->step();
  EXPECT_EQ(puma.told("# identify point lost"), 3U);
  EXPECT_EQ(puma.sequence().pause_reason(), Error::kRangesInconsistent);
  puma.run(5);
  EXPECT_EQ(puma.sequence().points_done(), 4U);
  puma.cabinet->sensor().field().multipath_probability = 0;
  ASSERT_EQ(puma.ask("resume"), "ok");
  EXPECT_FALSE(puma.sequence().pause_reason());
  puma.measure(6);
}

// A sensor that is gone is not the place's fault: nothing is skipped.
TEST(Identify, pauses_at_once_for_the_sensor) {
  Measured puma;
  puma.measure(2);
  puma.cabinet->sensor().set_error(Error::kSensorPortGone);
  for (int i = 0; i < 10'000 && !puma.sequence().is_paused(); ++i) puma.cabinet->step();
  EXPECT_EQ(puma.sequence().pause_reason(), Error::kSensorPortGone);
  EXPECT_EQ(puma.told("# identify point lost"), 0U);
  EXPECT_EQ(puma.told("# identify paused error=SENSOR_PORT_GONE "), 1U);
}

TEST(Identify, ends_where_the_arm_is_moved_at_every_try) {
  Measured puma;
  puma.measure(2);
  for (int i = 0; i < 50'000 && puma.sequence().is_running(); ++i) {
    // Out of the tolerance and back, between the first ping of a point and its last.
    if (puma.now().settled == std::chrono::milliseconds(250)) {
      puma.cabinet->drive(4).push(5e-4 * test::kPumaCountsPerRadian);
    }
    puma.cabinet->step();
  }
  EXPECT_EQ(puma.told("# identify point refused error=ARM_MOVED "), 2U);
  EXPECT_TRUE(puma.last("# identify point refused").ends_with(" joint=5"))
      << puma.last("# identify point refused");
  EXPECT_EQ(puma.told("# identify ended error=ARM_MOVED "), 1U);
  EXPECT_TRUE(puma.last("# identify ended").ends_with(" joint=5"));
}

TEST(Identify, counts_the_tries_of_each_point_alone) {
  Measured puma;
  puma.measure(2);
  int tries = 0;
  for (int i = 0; i < 50'000 && puma.sequence().points_done() < 4; ++i) {
    if (puma.now().settled == std::chrono::milliseconds(250) && tries++ % 3 < 2) {
      puma.cabinet->drive(4).push(5e-4 * test::kPumaCountsPerRadian);
    }
    puma.cabinet->step();
  }
  EXPECT_EQ(puma.sequence().points_done(), 4U);
  EXPECT_EQ(puma.told("# identify point refused error=ARM_MOVED "), 4U);
  EXPECT_TRUE(puma.sequence().is_running());
}

// The one before ended while a point was to be measured for the third time: nothing is left of it.
TEST(Identify, begun_anew_begins_at_its_first_place_and_with_its_first_try) {
  Measured puma;
  const auto disturb = [&puma](std::size_t refused) {
    for (int i = 0; i < 50'000 && puma.told("# identify point refused") < refused; ++i) {
      if (puma.now().settled == std::chrono::milliseconds(250)) {
        puma.cabinet->drive(4).push(5e-4 * test::kPumaCountsPerRadian);
      }
      puma.cabinet->step();
    }
    EXPECT_EQ(puma.told("# identify point refused"), refused);
  };
  puma.measure(2);
  disturb(2);
  ASSERT_EQ(puma.ask("halt"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kHolding));
  ASSERT_EQ(puma.ask("identify"), "ok");
  disturb(4);
  ASSERT_TRUE(puma.sequence().is_running());
  puma.measure(1);
  EXPECT_NEAR(puma.sequence().log()[0].readings()[0],
              planned_arc(Measured::configuration(), 0).lower, 1e-3);
}

TEST(Identify, tells_what_it_found_to_a_tenth_of_a_micrometre) {
  Measured puma;
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 3600));
  const auto decimals = [](const std::string& line, const std::string& key) {
    const std::size_t point = line.find('.', line.find(key));
    return std::min(line.find(' ', point), line.size()) - point - 1;
  };
  const std::string candidate = puma.ask("candidate");
  EXPECT_EQ(decimals(candidate, " validation_rms_mm="), 4U) << candidate;
  EXPECT_EQ(decimals(candidate, " active_rms_mm="), 4U);
  ASSERT_EQ(puma.ask("accept"), "ok");
  const std::string signature = puma.ask("signature");
  EXPECT_EQ(decimals(signature, " validation_rms_mm="), 4U) << signature;
  EXPECT_EQ(decimals(signature, " predicted_tool_error_mm="), 4U);
}

TEST(Identify, ends_by_a_halt_and_by_a_fault_with_its_joint) {
  Measured halted;
  halted.measure(1);
  ASSERT_EQ(halted.ask("halt"), "ok");
  halted.run(1);
  EXPECT_EQ(halted.told("# identify ended error=SEQUENCE_STOPPED "), 1U);
  EXPECT_EQ(halted.mode(), Mode::kHolding);
  EXPECT_GT(halted.sequence().log().size(), 0U);
  ASSERT_EQ(halted.ask("identify"), "ok");
  EXPECT_EQ(halted.sequence().log().size(), 0U) << "the next one has a log of its own";
  Measured faulted;
  faulted.measure(1);
  faulted.cabinet->drive(2).inject(simulated::DriveFault::kEmergency, 0x2310);
  faulted.run(1);
  EXPECT_EQ(faulted.told("# identify ended error=DRIVE_EMERGENCY "), 1U)
      << faulted.last("# identify ended") << faulted.last("# mode");
  EXPECT_TRUE(faulted.last("# identify ended").ends_with(" joint=3"));
  EXPECT_EQ(faulted.told("# mode faulted error=DRIVE_EMERGENCY "), 1U);
}

// By that the thread of the background goes on at once, not with the next tick.
TEST(Identify, says_that_there_is_more_to_do_while_it_computes) {
  Measured puma;
  std::size_t computing = 0;
  for (int i = 0; i < 2'000'000 && puma.mode() != Mode::kHolding; ++i) {
    puma.cabinet->step();
    const bool more = puma.cabinet->controller().background();
    if (!puma.sequence().is_computing()) continue;
    EXPECT_TRUE(more) << i;
    ++computing;
  }
  EXPECT_GT(computing, puma.sequence().points_done());
  puma.run(1);
  EXPECT_FALSE(puma.cabinet->controller().background()) << "nothing is under way";
}

TEST(Identify, pauses_on_request_and_stays_where_it_is) {
  Measured puma;
  puma.measure(3);
  ASSERT_EQ(puma.ask("pause"), "ok");
  puma.run(5);
  const std::size_t done = puma.sequence().points_done();
  EXPECT_LE(done, 4U);
  puma.run(10);
  EXPECT_EQ(puma.sequence().points_done(), done);
  EXPECT_EQ(puma.mode(), Mode::kSweeping);
  EXPECT_FALSE(puma.sequence().is_computing());
  ASSERT_EQ(puma.ask("resume"), "ok");
  puma.measure(done + 2);
}

}  // namespace
}  // namespace armsig::controller
