// SPDX-License-Identifier: MIT
// What a signature record of the store must be, once its CRC-32 is right.
#include <algorithm>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "core/identification.hpp"
#include "firmware/controller/signature_record.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

SignatureRecord good() {
  SignatureRecord record;
  const KnownTarget known{1, 6, Vector3(0.15, 0, 0.05)};
  record.signature = signature_of(tool::table2_robot(1), JointVector(6, 0.1), Pose{}, {&known, 1});
  return record;
}

// The error of the record's image after `change`, with the CRC-32 of what it then holds.
Error refusal_of(const std::function<void(RecordImage&)>& change) {
  RecordImage image = encode(good());
  change(image);
  const std::size_t end = image.size() - 4;
  const std::uint32_t crc = crc32(std::as_bytes(std::span(image).first(end)));
  for (std::size_t i = 0; i < 4; ++i) image[end + i] = static_cast<std::uint8_t>(crc >> 8 * i);
  // An image of no record's length is whole in no way.
  const bool of_its_length =
      std::equal(image.begin() + 8, image.begin() + 12, encode(good()).begin() + 8);
  EXPECT_EQ(is_whole(image), of_its_length);
  SignatureRecord record;
  return test::failure_of(decode(image, tool::puma560(), record));
}

TEST(RecordDecoding, takes_what_was_encoded_with_its_hand_target_or_without_one) {
  for (const bool has_target : {true, false}) {
    SignatureRecord record = good();
    record.sequence = 7;
    if (!has_target) record.signature.targets.clear();
    SignatureRecord decoded;
    ASSERT_TRUE(decode(encode(record), tool::puma560(), decoded));
    EXPECT_EQ(decoded.sequence, 7U);
    ASSERT_EQ(decoded.signature.targets.size(), has_target ? 1U : 0U);
    if (!has_target) continue;
    EXPECT_EQ(decoded.signature.targets[0].number, 1);
    EXPECT_EQ(decoded.signature.targets[0].link, 6U);
    EXPECT_EQ(decoded.signature.targets[0].p_S, record.signature.targets[0].p_S);
  }
}

// So that a record is the same bytes whatever was in the memory, of a reader of another maker too.
TEST(RecordEncoding, leaves_zeros_where_an_arm_has_no_joint_no_target_and_no_map) {
  SignatureRecord record = good();
  record.signature.targets.clear();
  const RecordImage image = encode(record);
  constexpr std::size_t kReadings = 24;
  constexpr std::size_t kTarget = kReadings + 8 * 8 + 9 * 12 * 8;
  constexpr std::size_t kMaps = 1416;
  const auto zeros = [&image](std::size_t begin, std::size_t end) {
    return std::all_of(image.begin() + begin, image.begin() + end,
                       [](std::uint8_t byte) { return byte == 0; });
  };
  EXPECT_FALSE(zeros(kReadings + 5 * 8, kReadings + 6 * 8));
  EXPECT_TRUE(zeros(kReadings + 6 * 8, kReadings + 8 * 8));
  EXPECT_TRUE(zeros(kTarget, kTarget + 8 + 3 * 8));
  EXPECT_TRUE(zeros(kMaps, kRecordBytes - 4));
}

TEST(RecordDecoding, refuses_another_magic_version_or_length_and_no_joint_or_nine) {
  for (const std::size_t at : {0U, 1U, 2U, 3U, 4U, 5U, 8U, 9U, 10U, 11U}) {
    EXPECT_EQ(refusal_of([at](RecordImage& image) { image[at] ^= 1; }), Error::kRecordCorrupt)
        << at;
  }
  for (const int joints : {0, 9, 255}) {
    EXPECT_EQ(
        refusal_of([joints](RecordImage& image) { image[6] = static_cast<std::uint8_t>(joints); }),
        Error::kRecordCorrupt)
        << joints;
  }
}

TEST(RecordDecoding, refuses_what_is_no_number_and_no_rotation) {
  const auto refusal = [](const std::function<void(SignatureRecord&)>& change) {
    SignatureRecord record = good();
    change(record);
    SignatureRecord decoded;
    return test::failure_of(decode(encode(record), tool::puma560(), decoded));
  };
  EXPECT_EQ(
      refusal([](SignatureRecord& r) { r.air_celsius = std::numeric_limits<double>::quiet_NaN(); }),
      Error::kRecordCorrupt);
  for (const std::size_t frame : {0U, 3U, 6U}) {
    EXPECT_EQ(refusal([frame](SignatureRecord& r) { r.signature.X_SL[frame].R(0, 0) += 1e-6; }),
              Error::kRecordCorrupt);
    EXPECT_EQ(refusal([frame](SignatureRecord& r) { r.signature.X_SL[frame].R.col(1) *= -1; }),
              Error::kRecordCorrupt)
        << "a mirror is none";
  }
}

TEST(RecordDecoding, of_other_joints_than_the_drawings_is_unsuitable) {
  const RecordImage image = encode(good());
  SignatureRecord decoded;
  Arm fewer = tool::puma560();
  fewer.joints.resize(5);
  fewer.limits.resize(5);
  EXPECT_EQ(test::failure_of(decode(image, fewer, decoded)), Error::kRecordUnsuitable);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    Arm other = tool::puma560();
    other.joints[joint].type = JointType::kPrismatic;
    EXPECT_EQ(test::failure_of(decode(image, other, decoded)), Error::kRecordUnsuitable) << joint;
  }
}

TEST(RecordDecoding, finds_no_checksum_in_an_image_of_no_records_length) {
  RecordImage image{};
  EXPECT_EQ(crc_of(image), 0U);
  EXPECT_FALSE(is_whole(image));
  image = encode(good());
  EXPECT_NE(crc_of(image), 0U);
  EXPECT_TRUE(is_whole(image));
}

}  // namespace
}  // namespace armsig::controller
