// SPDX-License-Identifier: MIT
// What checks have shown, kept over a restart: as if there had been none, or learnt anew.
#include "firmware/controller/check_image.hpp"

#include <cmath>
#include <limits>
#include <span>

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "hal/simulated/random.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

constexpr std::uint32_t kSequence = 7;
constexpr std::int64_t kIdentified_s = 1'700'000'000;
constexpr CheckSubject kSubject{.record_crc = 0x12345678, .poses_crc = 0x9ABCDEF0};
constexpr double kTrackerSigma_m = 0.1e-3;

// Check `number` of an arm whose second axis grows from check 30 on.
MeasuredCheck check_of(int number) {
  simulated::Random random(static_cast<std::uint64_t>(number) + 1);
  MeasuredCheck check{.poses = {}, .places = {}, .sigma_m = kTrackerSigma_m};
  const double grown_m = number < 30 ? 0 : 2e-5 * (number - 29);
  for (std::uint8_t i = 0; i < kMostCheckPoses; ++i) {
    const double turn = 0.15 * i;
    const Vector3 noise_m(random.normal(), random.normal(), random.normal());
    check.poses.push_back({.p_R = {std::cos(7.0 * i), std::sin(5.0 * i), 0.02 * i * i},
                           .residual_m = kTrackerSigma_m * noise_m +
                                         grown_m * Vector3(std::cos(turn), std::sin(turn), 0.3)});
    check.places.push_back(i);
  }
  return check;
}

CheckReport take(CheckHistory& history, int number) {
  MeasuredCheck check = check_of(number);
  const auto report = history.take(check, 0.2e-3);
  EXPECT_TRUE(report);
  return report.value_or(CheckReport{});
}

CheckHistory after(int checks) {
  CheckHistory history;
  history.begin(kSequence, kIdentified_s);
  for (int i = 0; i < checks; ++i) take(history, i);
  return history;
}

CheckHistory begun(std::uint32_t sequence = kSequence, std::int64_t at_s = kIdentified_s) {
  CheckHistory history;
  history.begin(sequence, at_s);
  return history;
}

// With the right CRC, whatever was changed.
CheckImage sealed(CheckImage image) {
  const std::uint32_t crc = crc32(std::as_bytes(std::span(image).first(kCheckImageBytes - 4)));
  for (std::size_t i = 0; i < 4; ++i) {
    image[kCheckImageBytes - 4 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  }
  return image;
}

CheckImage with(CheckImage image, std::size_t at, std::initializer_list<std::uint8_t> bytes) {
  std::ranges::copy(bytes, image.begin() + static_cast<std::ptrdiff_t>(at));
  return sealed(image);
}

TEST(CheckImage, restart_after_every_check_changes_no_verdict) {
  CheckHistory whole = after(0);
  CheckHistory broken = after(0);
  CheckVerdict last = CheckVerdict::kAsAccepted;
  for (int i = 0; i < 60; ++i) {
    const CheckReport expected = take(whole, i);
    const CheckReport got = take(broken, i);
    EXPECT_EQ(got.verdict, expected.verdict) << i;
    EXPECT_EQ(got.sum, expected.sum) << i;
    EXPECT_EQ(got.learnt, expected.learnt) << i;
    last = got.verdict;
    const CheckImage image = encode(kSubject, broken.state());
    broken = begun();
    const auto recalled = decode(image, kSubject, broken.state());
    ASSERT_TRUE(recalled) << i;
    ASSERT_EQ(*recalled, Recalled::kEverything) << i;
    ASSERT_EQ(encode(kSubject, broken.state()), image) << i;
  }
  EXPECT_EQ(last, CheckVerdict::kDrifting);  // else nothing was shown of the sum
}

TEST(CheckImage, any_byte_changed_is_refused) {
  const CheckImage image = encode(kSubject, after(35).state());
  for (std::size_t i = 0; i < image.size(); ++i) {
    CheckImage changed = image;
    changed[i] ^= 0x10;
    CheckHistory history = begun();
    EXPECT_EQ(test::failure_of(decode(changed, kSubject, history.state())), Error::kRecordCorrupt)
        << i;
    EXPECT_EQ(history.state().learnt, 0);
  }
}

TEST(CheckImage, of_another_signature_or_of_other_poses_is_not_used) {
  const CheckImage image = encode(kSubject, after(3).state());
  const auto recalled = [&](const CheckSubject& subject, CheckHistory history) {
    const auto found = decode(image, subject, history.state());
    EXPECT_TRUE(found);
    EXPECT_EQ(history.state().learnt == 3, found && *found == Recalled::kEverything);
    return found.value_or(Recalled::kNothing);
  };
  EXPECT_EQ(recalled(kSubject, begun()), Recalled::kEverything);
  EXPECT_EQ(recalled({.record_crc = 1, .poses_crc = kSubject.poses_crc}, begun()),
            Recalled::kOtherSignature);
  EXPECT_EQ(recalled(kSubject, begun(kSequence + 1)), Recalled::kOtherSignature);
  EXPECT_EQ(recalled(kSubject, begun(kSequence, kIdentified_s + 1)), Recalled::kOtherSignature);
  EXPECT_EQ(recalled({.record_crc = kSubject.record_crc, .poses_crc = 1}, begun()),
            Recalled::kOtherPoses);
}

TEST(CheckImage, what_no_checks_leave_is_refused_though_its_crc_is_right) {
  const CheckImage learning = encode(kSubject, after(5).state());
  const CheckImage summing = encode(kSubject, after(35).state());
  const struct {
    const char* what;
    CheckImage image;
  } cases[] = {
      {"magic", with(learning, 0, {'B'})},
      {"another version", with(learning, 4, {2, 0})},
      {"another length", with(learning, 6, {0x3D})},
      {"21 checks learnt", with(summing, 28, {21, 0, 0, 0})},
      {"poses of checks that were none", with(learning, 28, {0, 0, 0, 0})},
      {"fewer checks than a pose has", with(learning, 28, {4, 0, 0, 0})},
      {"a sum that is no number", with(summing, 32, {0, 0, 0, 0, 0, 0, 0xF8, 0x7F})},
      {"a sum beyond all", with(summing, 32, {0, 0, 0, 0, 0, 0, 0xF0, 0x7E})},
      {"a sum before the reference is whole", with(learning, 56, {1, 0, 0, 0})},
      {"more checks since than ever", with(summing, 60, {16, 0, 0, 0})},
      {"neither named nor not", with(summing, 64, {2})},
      {"a reference that is no number", with(learning, 68, {0, 0, 0xC0, 0x7F})},
      {"a pose never measured that has a place", with(learning, 80, {0, 0})},
      {"padding", with(learning, 82, {1})},
      {"means of other checks", with(summing, 580, {14})},
      {"more means than there is room", with(summing, 580, {21})},
      {"a mean that is infinite", with(summing, 584, {0, 0, 0x80, 0x7F})},
  };
  for (const auto& [what, image] : cases) {
    CheckHistory history = begun();
    EXPECT_EQ(test::failure_of(decode(image, kSubject, history.state())), Error::kRecordCorrupt)
        << what;
    EXPECT_EQ(history.state().learnt, 0) << what;
  }
}

}  // namespace
}  // namespace armsig::controller
