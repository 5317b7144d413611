// SPDX-License-Identifier: MIT
// Golden frames are written by hand from CiA 301, 7.2.4.3.3 to 7.2.4.3.6.
#include "hal/canopen/sdo_client.hpp"

#include <chrono>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::canopen {
namespace {

using std::chrono::milliseconds;
using test::frame;
using test::text;

constexpr SdoRequest kReadDeviceType{0x1000, 0, 0, 0};
constexpr SdoRequest kWriteMode{0x6060, 0, 1, 8};

SdoTransfer read_device_type() { return {5, kReadDeviceType, milliseconds(100), 3}; }

TEST(Sdo, encodes_a_download_of_each_size) {
  EXPECT_EQ(text(encode_sdo(5, {0x6060, 0, 1, 8})), "605#2F60600008000000");
  EXPECT_EQ(text(encode_sdo(5, {0x1017, 0, 2, 500})), "605#2B171000F4010000");
  EXPECT_EQ(text(encode_sdo(1, {0x1400, 1, 4, 0x80000201})), "601#2300140101020080");
}

TEST(Sdo, encodes_an_upload) {
  EXPECT_EQ(text(encode_sdo(5, kReadDeviceType)), "605#4000100000000000");
}

TEST(Sdo, decodes_an_upload_of_each_size_without_the_bytes_unused) {
  EXPECT_EQ(decode_sdo(frame("585#4300100092010200"), kReadDeviceType), SdoOutcome(0x00020192));
  EXPECT_EQ(decode_sdo(frame("585#4B001000AABBCCDD"), kReadDeviceType), SdoOutcome(0xBBAA));
  EXPECT_EQ(decode_sdo(frame("585#4F001000AABBCCDD"), kReadDeviceType), SdoOutcome(0xAA));
  EXPECT_EQ(decode_sdo(frame("585#42001000AABBCCDD"), kReadDeviceType), SdoOutcome(0xDDCCBBAA));
}

TEST(Sdo, decodes_a_download_response) {
  EXPECT_EQ(decode_sdo(frame("585#6060600000000000"), kWriteMode), SdoOutcome(8));
}

TEST(Sdo, decodes_an_abort) {
  const auto outcome = decode_sdo(frame("585#8000100000000206"), kReadDeviceType);
  ASSERT_TRUE(outcome && !*outcome);
  EXPECT_EQ(test::failure_of(*outcome).error, Error::kSdoAborted);
  EXPECT_EQ(test::failure_of(*outcome).abort_code, 0x06020000U);
  EXPECT_EQ(describe_sdo_abort(test::failure_of(*outcome).abort_code), "object does not exist");
}

TEST(Sdo, refuses_a_segmented_upload) {
  const auto outcome = decode_sdo(frame("585#4100100010000000"), kReadDeviceType);
  ASSERT_TRUE(outcome && !*outcome);
  EXPECT_EQ(test::failure_of(*outcome).error, Error::kSdoAborted);
}

TEST(Sdo, ignores_answers_to_other_requests) {
  EXPECT_FALSE(decode_sdo(frame("585#4301100092010200"), kReadDeviceType));  // other index
  EXPECT_FALSE(decode_sdo(frame("585#4300100192010200"), kReadDeviceType));  // other sub-index
  EXPECT_FALSE(decode_sdo(frame("585#6000100000000000"), kReadDeviceType));  // download response
  EXPECT_FALSE(decode_sdo(frame("585#4360600008000000"), kWriteMode));       // upload response
  EXPECT_FALSE(decode_sdo(frame("585#43001000920102"), kReadDeviceType));    // seven bytes
  EXPECT_FALSE(decode_sdo(frame("585#C300100092010200"), kReadDeviceType));  // unknown specifier
}

TEST(SdoTransfer, sends_once_and_ends_with_the_answer) {
  SdoTransfer transfer = read_device_type();
  EXPECT_TRUE(transfer.poll(hal::Instant(milliseconds(0))));
  EXPECT_FALSE(transfer.poll(hal::Instant(milliseconds(99))));
  transfer.take(frame("585#4300100092010200"));
  ASSERT_TRUE(transfer.outcome());
  EXPECT_EQ(*transfer.outcome(), SdoOutcome(0x00020192));
}

TEST(SdoTransfer, repeats_a_lost_request) {
  SdoTransfer transfer = read_device_type();
  EXPECT_TRUE(transfer.poll(hal::Instant(milliseconds(0))));
  const auto repeated = transfer.poll(hal::Instant(milliseconds(100)));
  ASSERT_TRUE(repeated);
  EXPECT_EQ(text(*repeated), "605#4000100000000000");
  EXPECT_FALSE(transfer.outcome());
}

TEST(SdoTransfer, gives_up_after_its_attempts) {
  SdoTransfer transfer = read_device_type();
  for (int attempt = 0; attempt < 3; ++attempt) {
    EXPECT_TRUE(transfer.poll(hal::Instant(milliseconds(100 * attempt))));
  }
  EXPECT_FALSE(transfer.poll(hal::Instant(milliseconds(300))));
  ASSERT_TRUE(transfer.outcome() && !*transfer.outcome());
  EXPECT_EQ(test::failure_of(*transfer.outcome()).error, Error::kSdoTimeout);
}

TEST(SdoTransfer, ignores_an_answer_before_the_request) {
  SdoTransfer transfer = read_device_type();
  transfer.take(frame("585#4300100092010200"));
  EXPECT_FALSE(transfer.outcome());
}

TEST(Sdo, has_words_for_codes_it_does_not_know) {
  EXPECT_EQ(describe_sdo_abort(0x12345678), "unknown abort code");
}

TEST(SdoTransfer, is_over_once) {
  SdoTransfer transfer = read_device_type();
  EXPECT_TRUE(transfer.poll(hal::Instant(milliseconds(0))));
  transfer.take(frame("585#4300100092010200"));
  transfer.take(frame("585#4300100011111111"));
  EXPECT_EQ(transfer.outcome(), SdoOutcome(0x00020192));
  EXPECT_FALSE(transfer.poll(hal::Instant(milliseconds(500))));
}

}  // namespace
}  // namespace armsig::canopen
