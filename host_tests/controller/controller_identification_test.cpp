// SPDX-License-Identifier: MIT
// The whole story in virtual time: power up, identify, accept, touch the grid, restart.
#include <chrono>

#include <gtest/gtest.h>

#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

using test::identify_and_accept;

TEST(Identification, reaches_the_indices_of_table_3_on_robot_1_and_survives_a_restart) {
  const auto began = std::chrono::steady_clock::now();
  const Configuration configuration = test::puma_with_grid();
  ASSERT_TRUE(check(configuration));
  PumaCabinet puma(1, configuration);
  const auto factors = test::table_3_run(puma, configuration);
  const double wall_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const double speed = hal::seconds(puma.now().now.time_since_epoch()) / wall_s;
  RecordProperty("times_real_time", std::to_string(speed));
  const auto printed = tool::table3(1);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_GE(factors[k], printed[k]) << "index " << k + 1;
    RecordProperty("index_" + std::to_string(k + 1), std::to_string(factors[k]));
    std::printf("index %zu: %.1f (paper %.1f)\n", k + 1, factors[k], printed[k]);
  }
  std::printf("%.0f s of virtual time at %.0f times real time\n",
              hal::seconds(puma.now().now.time_since_epoch()), speed);

  ASSERT_TRUE(puma.cabinet->state().active());
  const auto image = encode(*puma.cabinet->state().active());
  puma.start(configuration, 2);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  ASSERT_TRUE(puma.cabinet->state().active());
  EXPECT_EQ(encode(*puma.cabinet->state().active()), image);
}

TEST(Identification, gives_the_same_signature_bit_by_bit_for_the_same_seed) {
  std::array<std::vector<std::uint8_t>, 2> memories;
  for (auto& memory : memories) {
    PumaCabinet puma(7);
    ASSERT_TRUE(identify_and_accept(puma));
    memory = puma.memory.bytes;
  }
  EXPECT_EQ(memories[0], memories[1]);
}

TEST(Identification, accepts_and_rolls_back_without_a_jump_of_the_joints) {
  PumaCabinet puma;
  ASSERT_TRUE(identify_and_accept(puma));
  const JointVector before = puma.now().commanded;
  ASSERT_EQ(puma.ask("rollback"), "ok");
  puma.run(0.1);
  EXPECT_FALSE(puma.cabinet->state().active());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(puma.now().commanded[i], before[i]);
  EXPECT_TRUE(puma.ask("rollback").starts_with("error"));
}

TEST(Identification, pauses_for_trouble_of_the_sensor_and_goes_on) {
  for (const Error error : {Error::kSensorSilent, Error::kSensorStale, Error::kSensorBadCrc,
                            Error::kSensorWrongUnit, Error::kSensorException, Error::kBusDown}) {
    PumaCabinet puma;
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("identify"), "ok");
    puma.run(10);
    const IdentificationSequence& sequence = puma.cabinet->state().identification();
    puma.cabinet->sensor().set_error(error);
    puma.run(5);
    ASSERT_TRUE(sequence.is_paused()) << describe(error);
    EXPECT_EQ(sequence.pause_reason(), error);
    EXPECT_EQ(puma.memory.stored, 0U);
    const std::size_t points = sequence.points_done();
    puma.cabinet->sensor().set_error({});
    ASSERT_EQ(puma.ask("resume"), "ok");
    puma.run(10);
    EXPECT_FALSE(sequence.is_paused());
    EXPECT_GT(sequence.points_done(), points);
  }
}

TEST(Identification, that_is_begun_again_has_no_reason_to_pause) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(10);
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  puma.cabinet->sensor().set_error(Error::kSensorSilent);
  puma.run(5);
  ASSERT_EQ(sequence.pause_reason(), Error::kSensorSilent);
  puma.cabinet->sensor().set_error({});
  ASSERT_EQ(puma.ask("stop"), "ok");
  ASSERT_EQ(puma.ask("reset"), "ok");
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  EXPECT_FALSE(sequence.is_paused());
  EXPECT_EQ(sequence.pause_reason(), std::nullopt);
}

// Of the first move of a sequence.
double first_move_s(PumaCabinet& puma, const std::string& request) {
  EXPECT_EQ(puma.ask(request), "ok") << request;
  for (int i = 0; i < 5000 && !puma.now().moving; ++i) puma.cabinet->step();
  return puma.now().left_s;
}

TEST(Identification, moves_at_the_pace_that_is_asked_for_and_the_next_sequence_at_its_own) {
  const auto begin_anew = [](PumaCabinet& puma) {
    EXPECT_EQ(puma.ask("stop"), "ok");
    EXPECT_EQ(puma.ask("reset"), "ok");
    EXPECT_TRUE(puma.enable());
    EXPECT_EQ(puma.ask("move q1_deg=0 q2_deg=-90 q3_deg=90 q4_deg=30 q5_deg=0 q6_deg=0"), "ok");
    puma.run(20);
    EXPECT_EQ(puma.mode(), Mode::kHolding);
  };
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  const double full_s = first_move_s(puma, "identify");
  begin_anew(puma);
  EXPECT_NEAR(first_move_s(puma, "identify pace=0.1"), 10 * full_s, 0.05 * full_s);
  begin_anew(puma);
  EXPECT_NEAR(first_move_s(puma, "identify"), full_s, 0.05 * full_s);
}

TEST(Identification, refuses_a_pace_that_is_none) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  for (const char* pace : {"0", "1.01", "-0.1"}) {
    EXPECT_TRUE(puma.ask(std::string("identify pace=") + pace).starts_with("error OUT_OF_RANGE"));
  }
  EXPECT_TRUE(puma.ask("identify pace=slow").starts_with("error UNKNOWN_REQUEST"));
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Identification, tells_how_far_a_sweep_is_with_every_tenth_point) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  for (int i = 0; i < 3000 && sequence.points_done() < 25; ++i) puma.run(0.1);
  ASSERT_EQ(sequence.points_done(), 25U);
  std::vector<std::string> progress;
  for (const std::string& line : puma.console.told) {
    if (line.starts_with("# identify sweep joint=1 ")) progress.push_back(line);
  }
  ASSERT_EQ(progress.size(), 2U);
  EXPECT_TRUE(progress[0].contains(" points=10 ")) << progress[0];
  EXPECT_TRUE(progress[1].contains(" points=20 ")) << progress[1];
}

TEST(Identification, pauses_where_the_air_temperature_is_implausible) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(10);
  puma.cabinet->sensor().field().air_celsius = 85;
  puma.run(5);
  EXPECT_TRUE(puma.cabinet->state().identification().is_paused());
  EXPECT_EQ(puma.cabinet->state().identification().pause_reason(), Error::kTemperatureImplausible);
}

TEST(Identification, lives_with_30_percent_of_drop_outs) {
  PumaCabinet puma;
  puma.cabinet->sensor().field().dropout_probability = 0.3;
  EXPECT_TRUE(identify_and_accept(puma));
}

TEST(Identification, has_nothing_to_accept_before_it_is_done) {
  PumaCabinet puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_TRUE(puma.ask("accept").starts_with("error"));
  EXPECT_TRUE(puma.ask("candidate").starts_with("error"));
  EXPECT_TRUE(puma.ask("rollback").starts_with("error"));
  EXPECT_EQ(puma.memory.stored, 0U);
}

}  // namespace
}  // namespace armsig::controller
