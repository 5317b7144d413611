// SPDX-License-Identifier: MIT
// What a drive is asked and told before it is enabled, object by object, without any bus.
#include <chrono>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "hal/cia402/setup_run.hpp"

namespace armsig::cia402 {
namespace {

constexpr hal::Duration kPeriod = std::chrono::milliseconds(2);
constexpr DriveSettings kSettings{.scaling = {.counts_per_revolution = 4000, .gear_ratio = 100},
                                  .limits = {radians(-170), radians(170)},
                                  .largest_speed = 2.0};

using Key = std::pair<std::uint16_t, std::uint8_t>;

// The objects of a drive, read and written as they are asked for.
struct Objects {
  std::map<Key, std::uint32_t> values{
      {{0x1000, 0}, 0x00020192}, {{0x6502, 0}, 0x80}, {{0x60C2, 1}, 0}, {{0x60C2, 2}, 0},
      {{0x605A, 0}, 2},          {{0x6085, 0}, 0},    {{0x607E, 0}, 0}, {{0x60B0, 0}, 77},
      {{0x6060, 0}, 0},          {{0x6061, 0}, 0},    {{0x6065, 0}, 0}, {{0x608F, 1}, 4000},
      {{0x608F, 2}, 1},          {{0x6007, 0}, 1},    {{0x605B, 0}, 1}, {{0x605C, 0}, 1},
      {{0x605E, 0}, 2}};
  std::set<Key> read_only;
  std::set<Key> pretending;  // that acknowledge a value and keep their own
  unsigned written = 0;

  ObjectOutcome answer(const ObjectRequest& request) {
    const Key key{request.index, request.subindex};
    const auto found = values.find(key);
    if (found == values.end()) {
      return std::unexpected(ObjectFailure{Error::kSdoAborted, kAbortNoObject});
    }
    if (request.bytes == 0) return found->second;
    if (read_only.contains(key)) {
      return std::unexpected(ObjectFailure{Error::kSdoAborted, 0x06010002});
    }
    ++written;
    if (!pretending.contains(key)) found->second = request.value;
    if (request.index == 0x6060) values[{0x6061, 0}] = request.value;
    return request.value;
  }
};

struct Outcome {
  std::optional<SetupRefusal> refusal;
  SetupReport report;

  [[nodiscard]] std::optional<Error> reason() const {
    return refusal ? std::optional(refusal->error) : std::nullopt;
  }
  [[nodiscard]] std::uint16_t index() const { return refusal ? refusal->object.index : 0; }
};

Outcome set_up(Objects& objects, const DriveSettings& settings) {
  Setup setup;
  append_profile_check(setup, {});
  append_factor_requests(setup);
  append_motion_settings(setup, settings, *Scaling::make(settings.scaling), kPeriod);
  SetupRun run;
  run.begin(setup, settings);
  Outcome result;
  while (const auto request = run.request()) {
    result.refusal = run.take(objects.answer(*request));
    if (result.refusal) break;
  }
  result.report = run.report();
  return result;
}

hal::DeviceObject gap(std::uint16_t index, std::optional<std::uint32_t> found,
                      std::uint32_t wanted) {
  return {.index = index, .subindex = 0, .found = found, .wanted = wanted};
}

TEST(Cia402Setup, writes_mode_ramp_and_what_a_stop_does) {
  Objects objects;
  DriveSettings settings = kSettings;
  settings.stop_deceleration = 2 * kPi;
  settings.following_window = radians(0.36);
  const Outcome done = set_up(objects, settings);
  EXPECT_FALSE(done.refusal) << "at object " << done.index();
  EXPECT_EQ((objects.values[{0x6060, 0}]), 8U) << "cyclic synchronous position";
  EXPECT_EQ((objects.values[{0x605A, 0}]), 6U) << "quick stop ramp, then stay";
  EXPECT_EQ((objects.values[{0x6085, 0}]), 400000U) << "a turn a second squared, in counts";
  EXPECT_EQ((objects.values[{0x6065, 0}]), 400U);
  EXPECT_EQ((objects.values[{0x60B0, 0}]), 0U) << "position offset";
  EXPECT_TRUE(done.report.gaps.empty());
}

TEST(Cia402Setup, writes_the_ramp_in_the_drives_own_unit) {
  Objects objects;
  objects.values[{0x60AA, 0}] = 0x00C00300;
  DriveSettings settings = kSettings;
  settings.stop_deceleration = 2 * kPi;
  EXPECT_FALSE(set_up(objects, settings).refusal);
  EXPECT_EQ((objects.values[{0x6085, 0}]), 6000U) << "revolutions of the motor a minute and second";
  objects.values[{0x60AA, 0}] = 0xFD015700;
  const Outcome unknown = set_up(objects, settings);
  EXPECT_EQ(unknown.reason(), Error::kScaleInvalid);
  EXPECT_EQ(unknown.index(), 0x6085);
  EXPECT_FALSE(set_up(objects, kSettings).refusal) << "where no ramp is configured";
}

TEST(Cia402Setup, writes_no_option_that_is_right_already) {
  Objects objects;
  EXPECT_FALSE(set_up(objects, kSettings).refusal);
  objects.written = 0;
  EXPECT_FALSE(set_up(objects, kSettings).refusal);
  EXPECT_EQ(objects.written, 1U) << "the mode";
}

TEST(Cia402Setup, passes_an_option_that_is_absent_or_read_only_and_safe_and_tells_it) {
  Objects objects;
  objects.values.erase({0x605E, 0});
  objects.values[{0x605B, 0}] = 0;
  objects.read_only = {{0x605A, 0}, {0x605B, 0}, {0x605C, 0}};
  const Outcome done = set_up(objects, kSettings);
  ASSERT_FALSE(done.refusal) << "at object " << done.index();
  ASSERT_EQ(done.report.gaps.size(), 3U);
  EXPECT_EQ(done.report.gaps[0], gap(0x605A, 2, 6)) << "a ramp, and disabled after it";
  EXPECT_EQ(done.report.gaps[1], gap(0x605B, 0, 1)) << "never commanded under torque";
  EXPECT_EQ(done.report.gaps[2], gap(0x605E, std::nullopt, 2));
}

TEST(Cia402Setup, refuses_an_option_that_stays_unsafe) {
  for (const std::uint16_t index : {std::uint16_t{0x605A}, std::uint16_t{0x605E}}) {
    Objects objects;
    objects.values[{index, 0}] = 0;  // coasts
    objects.read_only = {{index, 0}};
    const Outcome done = set_up(objects, kSettings);
    ASSERT_TRUE(done.refusal) << index;
    EXPECT_EQ(done.refusal->error, Error::kSdoAborted);
    EXPECT_EQ(done.refusal->code, 0x06010002U);
    EXPECT_EQ(done.refusal->object, gap(index, 0, index == 0x605A ? 6 : 2));
    objects.pretending.swap(objects.read_only);
    EXPECT_EQ(set_up(objects, kSettings).reason(), Error::kSdoUnexpectedValue)
        << "acknowledged and not taken";
  }
}

TEST(Cia402Setup, needs_what_is_configured) {
  Objects objects;
  objects.values.erase({0x6085, 0});
  DriveSettings settings = kSettings;
  settings.stop_deceleration = 2 * kPi;
  const Outcome done = set_up(objects, settings);
  EXPECT_EQ(done.reason(), Error::kSdoAborted);
  EXPECT_EQ(done.index(), 0x6085);
}

TEST(Cia402Setup, tries_a_drive_that_does_not_tell_its_modes) {
  Objects objects;
  objects.values.erase({0x6502, 0});
  EXPECT_FALSE(set_up(objects, kSettings).refusal);
}

TEST(Cia402Setup, leaves_the_mode_to_be_seen_later_where_it_is_not_shown_yet) {
  Objects objects;
  EXPECT_FALSE(set_up(objects, kSettings).report.hides_mode);
  cia402::Setup setup;
  expect(setup, 0x6061, SetupRule::kTold, 0xFF, 8);
  SetupRun run;
  run.begin(setup, kSettings);
  EXPECT_FALSE(run.take(ObjectOutcome(0U)));
  EXPECT_TRUE(run.report().hides_mode);
}

TEST(Cia402Setup, is_told_whether_a_drive_stops_without_its_master) {
  for (std::uint32_t option = 0; option <= 4; ++option) {
    Objects objects;
    objects.values[{0x6007, 0}] = option;
    objects.read_only = {{0x6007, 0}};
    const Outcome done = set_up(objects, kSettings);
    ASSERT_FALSE(done.refusal);
    EXPECT_EQ(done.report.stops, option >= 1 && option <= 3) << option;
    EXPECT_FALSE(done.report.is_supervised()) << "it does not watch it";
  }
}

TEST(Cia402Setup, passes_a_read_over_only_where_the_drive_says_that_it_has_none) {
  const ObjectOutcome no_object =
      std::unexpected(ObjectFailure{Error::kSdoAborted, kAbortNoObject});
  const ObjectOutcome no_subindex =
      std::unexpected(ObjectFailure{Error::kSdoAborted, kAbortNoSubindex});
  const ObjectOutcome not_now = std::unexpected(ObjectFailure{Error::kSdoAborted, 0x08000022});
  const ObjectOutcome silent = std::unexpected(ObjectFailure{Error::kSdoTimeout, kAbortNoObject});
  for (const SetupRule rule : {SetupRule::kIfPresent, SetupRule::kEqualIfPresent}) {
    const SetupStep step{{0x605A, 0, 2, 6}, rule, 0, 0};
    EXPECT_FALSE(judge(step, no_object));
    EXPECT_FALSE(judge(step, no_subindex));
    EXPECT_EQ(judge(step, not_now), Error::kSdoAborted);
    EXPECT_EQ(judge(step, silent), Error::kSdoTimeout);
  }
  for (const SetupRule rule : {SetupRule::kMust, SetupRule::kMustEqual, SetupRule::kTold}) {
    EXPECT_EQ(judge({{0x605A, 0, 2, 6}, rule, 0, 0}, no_object), Error::kSdoAborted);
  }
}

TEST(Cia402Setup, minds_of_the_polarity_that_of_positions_alone) {
  Objects objects;
  objects.values[{0x607E, 0}] = 0x7F;  // of speeds, and what is reserved
  EXPECT_FALSE(set_up(objects, kSettings).refusal);
}

TEST(Cia402Setup, refuses_what_is_no_drive_or_counts_otherwise_before_it_writes) {
  const auto refused = [](Key key, std::uint32_t value) {
    Objects objects;
    objects.values[key] = value;
    const Outcome done = set_up(objects, kSettings);
    EXPECT_EQ(objects.written, 0U) << key.first;
    EXPECT_EQ(done.index(), key.first);
    return done.reason();
  };
  EXPECT_EQ(refused({0x1000, 0}, 0x00020191), Error::kDriveWrongType);
  EXPECT_EQ(refused({0x6502, 0}, 0x43), Error::kDriveWrongType);
  EXPECT_EQ(refused({0x607E, 0}, 0x80), Error::kSdoUnexpectedValue);
  EXPECT_EQ(refused({0x608F, 1}, 2000), Error::kScaleInvalid);
  Objects objects;
  objects.values.erase({0x6060, 0});
  EXPECT_EQ(set_up(objects, kSettings).reason(), Error::kSdoAborted);
}

}  // namespace
}  // namespace armsig::cia402
