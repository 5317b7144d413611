// SPDX-License-Identifier: MIT
// What a drive is asked and told before it is enabled, object by object, without any bus.
#include <chrono>
#include <map>
#include <optional>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "hal/cia402/factors.hpp"
#include "hal/cia402/setup.hpp"

namespace armsig::cia402 {
namespace {

constexpr hal::Duration kPeriod = std::chrono::milliseconds(2);
constexpr DriveSettings kSettings{.scaling = {.counts_per_revolution = 4000, .gear_ratio = 100},
                                  .limits = {radians(-170), radians(170)},
                                  .largest_speed = 2.0};

// The objects of a drive, read and written as they are asked for.
struct Objects {
  std::map<std::pair<std::uint16_t, std::uint8_t>, std::uint32_t> values{
      {{0x1000, 0}, 0x00020192}, {{0x6502, 0}, 0x80}, {{0x60C2, 1}, 0}, {{0x60C2, 2}, 0},
      {{0x605A, 0}, 2},          {{0x6085, 0}, 0},    {{0x607E, 0}, 0}, {{0x60B0, 0}, 77},
      {{0x6060, 0}, 0},          {{0x6061, 0}, 0},    {{0x6065, 0}, 0}, {{0x608F, 1}, 4000},
      {{0x608F, 2}, 1}};

  ObjectOutcome answer(const ObjectRequest& request) {
    const auto found = values.find({request.index, request.subindex});
    if (found == values.end()) {
      return std::unexpected(ObjectFailure{Error::kSdoAborted, kAbortNoObject});
    }
    if (request.bytes != 0) found->second = request.value;
    if (request.index == 0x6060) values[{0x6061, 0}] = request.value;
    return found->second;
  }
};

struct Outcome {
  std::optional<Error> error;
  std::uint16_t index = 0;
  DriveFactors factors;
};

Outcome set_up(Objects& objects, const DriveSettings& settings) {
  Setup setup;
  append_profile_check(setup);
  append_factor_requests(setup);
  append_motion_settings(setup, settings, *Scaling::make(settings.scaling), kPeriod);
  Outcome result;
  for (const SetupStep& step : setup) {
    const ObjectOutcome outcome = objects.answer(step.request);
    result.error = judge(step, outcome);
    result.index = step.request.index;
    if (result.error) break;
    take_factor(step.request, outcome, result.factors);
  }
  return result;
}

TEST(Cia402Setup, writes_mode_ramp_and_what_a_stop_does) {
  Objects objects;
  DriveSettings settings = kSettings;
  settings.stop_deceleration = 2 * kPi;
  settings.following_window = radians(0.36);
  const Outcome done = set_up(objects, settings);
  EXPECT_FALSE(done.error) << "at object " << done.index;
  EXPECT_EQ((objects.values[{0x6060, 0}]), 8U) << "cyclic synchronous position";
  EXPECT_EQ((objects.values[{0x605A, 0}]), 6U) << "quick stop ramp, then stay";
  EXPECT_EQ((objects.values[{0x6085, 0}]), 400000U) << "a turn a second squared, in counts";
  EXPECT_EQ((objects.values[{0x6065, 0}]), 400U);
  EXPECT_EQ((objects.values[{0x60B0, 0}]), 0U) << "position offset";
  EXPECT_FALSE(contradicting_object(done.factors, settings.scaling));
}

TEST(Cia402Setup, passes_an_optional_object_over_only_where_the_drive_says_that_it_has_none) {
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
  for (const SetupRule rule : {SetupRule::kMust, SetupRule::kMustEqual, SetupRule::kWaitsEqual}) {
    EXPECT_EQ(judge({{0x605A, 0, 2, 6}, rule, 0, 0}, no_object), Error::kSdoAborted);
  }
}

TEST(Cia402Setup, minds_of_the_polarity_that_of_positions_alone) {
  Objects objects;
  objects.values[{0x607E, 0}] = 0x7F;  // of speeds, and what is reserved
  EXPECT_FALSE(set_up(objects, kSettings).error);
}

TEST(Cia402Setup, refuses_what_is_no_drive_or_counts_otherwise) {
  Objects objects;
  objects.values[{0x1000, 0}] = 0x00020191;
  EXPECT_EQ(set_up(objects, kSettings).error, Error::kDriveWrongType);
  objects = {};
  objects.values[{0x607E, 0}] = 0x80;
  EXPECT_EQ(set_up(objects, kSettings).error, Error::kSdoUnexpectedValue);
  objects = {};
  objects.values.erase({0x6060, 0});
  EXPECT_EQ(set_up(objects, kSettings).error, Error::kSdoAborted);
  objects = {};
  objects.values[{0x608F, 1}] = 2000;
  EXPECT_EQ(contradicting_object(set_up(objects, kSettings).factors, kSettings.scaling), 0x608F);
}

}  // namespace
}  // namespace armsig::cia402
