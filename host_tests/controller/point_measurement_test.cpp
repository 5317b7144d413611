// SPDX-License-Identifier: MIT
// One point after another from a sensor that says what a test lets it say: which of its errors
// pass, which end the point, and which readings count.
#include "firmware/controller/point_measurement.hpp"

#include <chrono>
#include <limits>

#include <gtest/gtest.h>

#include "core/measurement/speed_of_sound.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using std::chrono::milliseconds;
using Polled = Result<std::optional<hal::RangeReading>>;
using Stepped = Result<std::optional<MeasuredPoint>>;

class Script final : public hal::RangeSensor {
 public:
  Polled next = std::optional<hal::RangeReading>();

 private:
  Polled do_poll(hal::Instant /*now*/) override { return next; }
  [[nodiscard]] std::string_view do_words(Error error) const override {
    return error == Error::kSensorPortGone ? "unplugged" : "";
  }
};

struct Point {
  Point() {
    for (const Vector3& p : configuration.sensor.receivers.p_S) {
      target += p / static_cast<double>(configuration.sensor.receivers.p_S.size());
    }
    target += Vector3(0.1, -0.05, 0) + configuration.sensor.receivers.facing_S;
  }
  // What the receivers hear of the target at `air_celsius`.
  [[nodiscard]] hal::RangeReading heard(double air_celsius = 23) {
    hal::RangeReading reading;
    const double speed = measurement::speed_of_sound(air_celsius).value_or(340);
    for (const Vector3& p : configuration.sensor.receivers.p_S) {
      reading.receivers.push_back({.valid = true, .flight_s = (target - p).norm() / speed});
    }
    reading.air_celsius = air_celsius;
    reading.at = now;
    reading.sequence = ++sequence;
    return reading;
  }
  Stepped step(const Polled& polled) {
    sensor.next = polled;
    return measurement.step(now);
  }
  Stepped step(Error error) { return step(std::unexpected(error)); }
  Stepped silence(milliseconds time) {
    now += time;
    return step(std::optional<hal::RangeReading>());
  }

  Configuration configuration = test::puma_controller();
  Script sensor;
  PointMeasurement measurement{configuration, sensor};
  hal::Instant now{milliseconds(1000)};
  Vector3 target = Vector3::Zero();
  std::uint32_t sequence = 0;
};

TEST(PointMeasurement, is_where_the_target_is_after_as_many_pings_as_configured) {
  Point point;
  point.measurement.begin(point.now);
  for (std::size_t ping = 0; ping < point.configuration.dwell.pings; ++ping) {
    ASSERT_FALSE(point.measurement.is_computing()) << ping;
    ASSERT_TRUE(point.step(point.heard()));
  }
  ASSERT_TRUE(point.measurement.is_computing());
  Stepped stepped = std::optional<MeasuredPoint>();
  for (int i = 0; i < 1000 && stepped && !*stepped; ++i) stepped = point.silence(milliseconds(1));
  ASSERT_TRUE(stepped);
  ASSERT_TRUE(*stepped);
  EXPECT_LT(((*stepped)->p_S - point.target).norm(), 1e-7);
  EXPECT_EQ((*stepped)->pings, point.configuration.dwell.pings);
  EXPECT_EQ(point.measurement.air_celsius(), 23.0);
}

TEST(PointMeasurement, passes_over_two_spoilt_answers_and_ends_by_the_third_in_a_row) {
  for (const Error error : {Error::kSensorSilent, Error::kSensorBadCrc, Error::kSensorWrongUnit,
                            Error::kSensorException, Error::kSensorMalformed}) {
    Point point;
    point.measurement.begin(point.now);
    for (int time = 0; time < 2; ++time) {
      EXPECT_TRUE(point.step(error));
      EXPECT_TRUE(point.step(error));
      EXPECT_EQ(point.measurement.trouble(), error);
      EXPECT_TRUE(point.step(point.heard())) << "after which they are counted anew";
      EXPECT_EQ(point.measurement.trouble(), std::nullopt);
    }
    EXPECT_TRUE(point.step(error));
    EXPECT_TRUE(point.step(error));
    EXPECT_EQ(test::failure_of(point.step(error)), error);
  }
}

TEST(PointMeasurement, is_ended_at_once_by_what_does_not_pass) {
  for (const Error error : {Error::kSensorStale, Error::kSensorPortGone, Error::kBusDown}) {
    Point point;
    point.measurement.begin(point.now);
    EXPECT_EQ(test::failure_of(point.step(error)), error);
  }
}

TEST(PointMeasurement, tells_trouble_while_nothing_is_measured_and_ends_nothing) {
  Point point;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(point.step(Error::kSensorPortGone));
  EXPECT_EQ(point.measurement.trouble(), Error::kSensorPortGone);
  EXPECT_EQ(point.measurement.trouble_words(), "unplugged");
  EXPECT_TRUE(point.step(point.heard()));
  EXPECT_EQ(point.measurement.trouble(), std::nullopt);
  EXPECT_EQ(point.measurement.trouble_words(), "");
}

TEST(PointMeasurement, ends_where_nothing_is_heard_for_the_time_allowed_and_blames_the_line_first) {
  const auto timeout =
      std::chrono::duration_cast<milliseconds>(test::puma_controller().sensor.reading_timeout);
  for (const Error before : {Error::kSensorBadCrc, Error::kBusDown, Error::kSensorPortGone}) {
    Point point;
    EXPECT_TRUE(point.step(before));
    point.measurement.begin(point.now);
    EXPECT_TRUE(point.silence(timeout));
    const Error told = before == Error::kSensorBadCrc ? Error::kSensorSilent : before;
    EXPECT_EQ(test::failure_of(point.silence(milliseconds(1))), told);
    EXPECT_EQ(point.measurement.trouble(), told);
  }
}

TEST(PointMeasurement, of_a_sensor_that_stays_silent_ends_by_the_time_allowed) {
  const auto timeout =
      std::chrono::duration_cast<milliseconds>(test::puma_controller().sensor.reading_timeout);
  Point point;
  point.measurement.begin(point.now);
  EXPECT_TRUE(point.step(Error::kSensorSilent));
  point.now += timeout - milliseconds(2);
  EXPECT_TRUE(point.step(Error::kSensorSilent));
  EXPECT_EQ(test::failure_of(point.silence(milliseconds(3))), Error::kSensorSilent);
}

TEST(PointMeasurement, takes_no_air_that_cannot_be_and_none_that_changed_at_a_stroke) {
  const Sensor& sensor = test::puma_controller().sensor;
  for (const double air : {sensor.lowest_air_celsius, sensor.highest_air_celsius}) {
    Point point;
    point.measurement.begin(point.now);
    EXPECT_TRUE(point.step(point.heard(air)));
  }
  for (const double air : {sensor.lowest_air_celsius - 0.1, sensor.highest_air_celsius + 0.1,
                           std::numeric_limits<double>::quiet_NaN()}) {
    Point point;
    point.measurement.begin(point.now);
    EXPECT_EQ(test::failure_of(point.step(point.heard(air))), Error::kTemperatureImplausible);
  }
  for (const double way : {-1.0, 1.0}) {
    Point point;
    point.measurement.begin(point.now);
    EXPECT_TRUE(point.step(point.heard(20)));
    const double near = 20 + way * 0.9 * sensor.largest_air_step_kelvin;
    EXPECT_TRUE(point.step(point.heard(near)));
    const double far = near + way * 1.1 * sensor.largest_air_step_kelvin;
    EXPECT_EQ(test::failure_of(point.step(point.heard(far))), Error::kAirChanged);
    point.measurement.begin(point.now);
    EXPECT_TRUE(point.step(point.heard(far))) << "from there it is measured again";
  }
}

TEST(PointMeasurement, counts_no_reading_from_before_the_arm_stood) {
  Point point;
  const hal::RangeReading early = point.heard();
  point.now += milliseconds(1);
  point.measurement.begin(point.now);
  for (std::size_t i = 0; i < 2 * point.configuration.dwell.pings; ++i) {
    EXPECT_TRUE(point.step(early));
  }
  EXPECT_FALSE(point.measurement.is_computing());
}

// Such a sensor goes on talking, so that no silence ends the point.
TEST(PointMeasurement, of_other_receivers_than_configured_is_malformed_and_ends_like_it) {
  for (const bool fewer : {true, false}) {
    Point point;
    point.measurement.begin(point.now);
    hal::RangeReading other = point.heard();
    other.receivers.resize(fewer ? other.receivers.size() - 1 : other.receivers.size() + 1);
    EXPECT_TRUE(point.step(other));
    EXPECT_EQ(point.measurement.trouble(), Error::kSensorMalformed);
    EXPECT_TRUE(point.step(other));
    EXPECT_FALSE(point.measurement.is_computing());
    EXPECT_EQ(test::failure_of(point.step(other)), Error::kSensorMalformed);
  }
}

TEST(PointMeasurement, gives_up_with_the_reason_when_the_pings_allowed_are_used_up) {
  Point point;
  point.measurement.begin(point.now);
  Stepped stepped = std::optional<MeasuredPoint>();
  int pings = 0;
  while (stepped && pings < 100) {
    if (!point.measurement.is_computing()) ++pings;
    hal::RangeReading reading = point.heard();
    for (std::size_t i = 2; i < reading.receivers.size(); ++i) reading.receivers[i].valid = false;
    stepped = point.step(reading);
    ASSERT_TRUE(!stepped || !*stepped);
  }
  EXPECT_EQ(test::failure_of(stepped), Error::kTooFewReceivers);
  EXPECT_EQ(pings, static_cast<int>(point.configuration.dwell.most_pings));
}

TEST(PointMeasurement, begun_anew_while_it_is_worked_out_begins_with_the_next_ping) {
  Point point;
  point.measurement.begin(point.now);
  for (std::size_t i = 0; i < point.configuration.dwell.pings; ++i) {
    ASSERT_TRUE(point.step(point.heard()));
  }
  ASSERT_TRUE(point.measurement.is_computing());
  point.measurement.begin(point.now);
  EXPECT_FALSE(point.measurement.is_computing());
}

// A slow processor works longer than a sensor may be silent.
TEST(PointMeasurement, blames_no_sensor_for_the_time_in_which_it_does_not_listen) {
  const auto timeout =
      std::chrono::duration_cast<milliseconds>(test::puma_controller().sensor.reading_timeout);
  for (const bool located : {true, false}) {
    Point point;
    point.measurement.begin(point.now);
    for (std::size_t i = 0; i < point.configuration.dwell.pings; ++i) {
      hal::RangeReading reading = point.heard();
      for (std::size_t k = 2; k < reading.receivers.size() && !located; ++k) {
        reading.receivers[k].valid = false;
      }
      ASSERT_TRUE(point.step(reading));
    }
    for (int i = 0; i < 1000 && point.measurement.is_computing(); ++i) {
      EXPECT_TRUE(point.silence(timeout));
    }
    EXPECT_TRUE(point.silence(timeout)) << "pings are waited for as long as before";
    const Stepped later = point.silence(milliseconds(1));
    if (located) {
      EXPECT_TRUE(later) << "nothing is waited for where the point is found";
    } else {
      EXPECT_EQ(test::failure_of(later), Error::kSensorSilent);
    }
  }
}

}  // namespace
}  // namespace armsig::controller
