// SPDX-License-Identifier: MIT
// An arm that a tracker measures, by the interface and by lines on a TCP connection, and one that
// nothing measures.
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

#include "hal/linux/line_server.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/point_client.hpp"
#include "host_tests/support/sent_signature.hpp"
#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

Configuration tracked() {
  Configuration c = test::puma_controller();
  c.sensor.measures = Measures::kPoints;
  c.sensor.receivers = {};
  c.sensor.point_sigma_m = 0.02e-3;
  return c;
}

Configuration unmeasured() {
  Configuration c = tracked();
  c.sensor.measures = Measures::kNothing;
  return c;
}

// What a bridge says of the target where it is now.
std::string line_of(PumaCabinet& puma) {
  const Vector3 p_mm = 1e3 * puma.cabinet->sensor().target(puma.now().now);
  std::array<char, 160> line{};
  std::snprintf(line.data(), line.size(), "point x_mm=%.5f y_mm=%.5f z_mm=%.5f sigma_mm=0.02\n",
                p_mm.x(), p_mm.y(), p_mm.z());
  return line.data();
}

// A cabinet whose points come from this process by TCP.
struct Connected {
  Connected() {
    puma.points = &server;
    puma.start(tracked(), 1);
    puma.cabinet->step();
    client.emplace(server.port());
  }
  // Says where the target is every 20 ms.
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
      if (client && i % 10 == 0) EXPECT_TRUE(client->say(line_of(puma)));
      puma.cabinet->step();
    }
  }
  bool identify() {
    if (!puma.enable() || puma.ask("identify") != "ok") return false;
    for (int i = 0; i < 600 && puma.mode() != Mode::kHolding; ++i) run(1);
    return puma.mode() == Mode::kHolding;
  }
  [[nodiscard]] const IdentificationSequence& sequence() const {
    return puma.cabinet->state().identification();
  }

  linux_hal::PointServer server{{}};
  PumaCabinet puma;
  std::optional<test::PointClient> client;
};

TEST(Tracker, identifies_is_accepted_and_checks) {
  ASSERT_TRUE(check(tracked()));
  PumaCabinet puma(1, tracked());
  ASSERT_TRUE(test::identify_and_accept(puma)) << puma.console.told.back();
  const auto& active = puma.cabinet->state().active();
  ASSERT_TRUE(active);
  // Better than the sensor of the demo, whose ranges are ten times as coarse.
  EXPECT_LT(active->accuracy.validated->rms_m, 0.05e-3);
  EXPECT_TRUE(puma.ask("status").contains(" sensor=well")) << puma.ask("status");
  ASSERT_EQ(puma.ask("check"), "ok");
  puma.run_until(Mode::kSweeping, 1);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  EXPECT_EQ(puma.cabinet->state().check().last()->verdict, CheckVerdict::kAsAccepted);
}

TEST(Tracker, that_sends_lines_identifies_and_is_accepted) {
  Connected connected;
  ASSERT_TRUE(connected.identify()) << connected.puma.console.told.back();
  ASSERT_EQ(connected.puma.ask("accept"), "ok");
  const auto& active = connected.puma.cabinet->state().active();
  ASSERT_TRUE(active);
  EXPECT_LT(active->accuracy.validated->rms_m, 0.05e-3);
}

// Four wires from known anchors, as good as a draw-wire encoder is.
TEST(Wires, identify_and_are_accepted_and_checked) {
  Configuration c = test::puma_controller();
  c.sensor.measures = Measures::kPoints;
  c.sensor.point_sigma_m = c.sensor.receivers.range_sigma_m = 0.1e-3;
  c.sensor.receivers.p_S.resize(5);
  ASSERT_TRUE(check(c));
  PumaCabinet puma;
  puma.length_offsets_m = {0.0355, 0, -0.002, 0, 0.4};
  puma.start(c, 1);
  ASSERT_TRUE(test::identify_and_accept(puma)) << puma.console.told.back();
  const auto& active = puma.cabinet->state().active();
  ASSERT_TRUE(active);
  EXPECT_LT(active->accuracy.validated->rms_m, 0.3e-3);
  EXPECT_TRUE(puma.ask("status").contains(" sensor=well")) << puma.ask("status");
  ASSERT_EQ(puma.ask("check"), "ok");
  puma.run_until(Mode::kSweeping, 1);
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  EXPECT_EQ(puma.cabinet->state().check().last()->verdict, CheckVerdict::kAsAccepted);
}

TEST(Tracker, that_is_disconnected_pauses_and_goes_on_where_another_connects) {
  Connected connected;
  PumaCabinet& puma = connected.puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  connected.run(10);
  connected.client.reset();
  connected.run(5);
  ASSERT_TRUE(connected.sequence().is_paused());
  EXPECT_EQ(connected.sequence().pause_reason(), Error::kSensorPortGone);
  EXPECT_TRUE(puma.ask("status").contains("sensor_says=\"nobody is connected to 127.0.0.1"))
      << puma.ask("status");
  const std::size_t points = connected.sequence().points_done();
  connected.client.emplace(connected.server.port());
  ASSERT_EQ(puma.ask("resume"), "ok");
  connected.run(10);
  EXPECT_FALSE(connected.sequence().is_paused());
  EXPECT_GT(connected.sequence().points_done(), points);
}

TEST(Tracker, that_is_silent_or_sends_no_points_pauses_by_name) {
  for (const auto& [line, error] : {std::pair("", Error::kSensorSilent),
                                    {"point 1 2 3\n", Error::kSensorMalformed},
                                    {"point x_mm=1 y_mm=2 z_mm=3 seq=4\n", Error::kSensorStale}}) {
    Connected connected;
    PumaCabinet& puma = connected.puma;
    ASSERT_TRUE(puma.enable());
    ASSERT_EQ(puma.ask("identify"), "ok");
    connected.run(4);
    for (int i = 0; i < 40 && !connected.sequence().is_paused(); ++i) {
      ASSERT_TRUE(connected.client->say(line));
      puma.run(0.1);
    }
    ASSERT_TRUE(connected.sequence().is_paused()) << line;
    EXPECT_EQ(connected.sequence().pause_reason(), error) << line;
    const bool counted = puma.ask("status").contains(" sensor_malformed=");
    EXPECT_EQ(counted, error == Error::kSensorMalformed) << puma.ask("status");
  }
}

TEST(Tracker, whose_points_differ_by_more_than_it_says_pauses_by_name) {
  PumaCabinet puma(1, tracked());
  puma.cabinet->sensor().field().range_sigma_m = 2e-3;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(30);
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  ASSERT_TRUE(sequence.is_paused());
  EXPECT_EQ(sequence.pause_reason(), Error::kPointsDiffer);
}

TEST(Tracker, configuration_of_it_is_refused_where_its_sigma_cannot_be) {
  Configuration c = tracked();
  c.sensor.point_sigma_m = 0.02;
  EXPECT_TRUE(check(c));
  c.sensor.point_sigma_m = 20;
  ASSERT_FALSE(check(c));
  EXPECT_EQ(test::failure_of(check(c)).setting, "sensor.point_sigma");
}

TEST(NoSensor, refuses_by_name_what_measures_and_nothing_else) {
  ASSERT_TRUE(check(unmeasured()));
  PumaCabinet puma(1, unmeasured());
  ASSERT_TRUE(puma.enable());
  for (const char* verb : {"identify", "check", "compare"}) {
    EXPECT_EQ(puma.ask(verb), "error NO_SENSOR no sensor is configured") << verb;
  }
  EXPECT_TRUE(puma.ask("status").contains(" sensor=none")) << puma.ask("status");
  EXPECT_EQ(puma.ask("move q1_deg=5"), "ok");
}

TEST(NoSensor, servoes_by_a_signature_that_was_accepted_before) {
  PumaCabinet puma(1, tracked());
  ASSERT_TRUE(test::identify_and_accept(puma));
  const auto image = encode(*puma.cabinet->state().active());
  ASSERT_EQ(puma.ask("disable"), "ok");
  puma.run(5);
  puma.start(unmeasured(), 1);
  ASSERT_TRUE(puma.enable());
  ASSERT_TRUE(puma.cabinet->state().active());
  EXPECT_EQ(encode(*puma.cabinet->state().active()), image);
  EXPECT_TRUE(puma.ask("status").contains(" model=signature"));
}

TEST(NoSensor, leaves_no_check_to_a_schedule) {
  Configuration c = unmeasured();
  c.check.every = std::chrono::hours(24);
  ASSERT_FALSE(check(c));
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kNoSensor);
}

}  // namespace
}  // namespace armsig::controller
