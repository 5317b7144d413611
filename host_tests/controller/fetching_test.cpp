// SPDX-License-Identifier: MIT
// What `fetch` tells of a record in parts, and what it refuses.
#include "firmware/controller/fetching.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/base/crc32.hpp"
#include "core/identification.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

struct Store {
  Store() {
    record.signature = signature_of(tool::table2_robot(1), JointVector(6, 0.1), Pose{},
                                    std::span<const KnownTarget>());
  }
  [[nodiscard]] Result<void> ask(const std::string& request) {
    line.clear();
    return tell_part(*parse_request(request), fetchable, line);
  }
  Arm drawing = tool::puma560();
  SignatureRecord record;
  Fetchable fetchable{.signature = nullptr, .candidate = nullptr, .drawing = &drawing};
  Line line;
};

std::string hex_of(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += "0123456789abcdef"[byte / 16];
    text += "0123456789abcdef"[byte % 16];
  }
  return text;
}

// With the CRC-32 of what it holds now.
DrawingImage resealed(DrawingImage image) {
  const std::size_t end = image.size() - 4;
  const std::uint32_t crc = crc32(std::as_bytes(std::span(image).first(end)));
  for (std::size_t i = 0; i < 4; ++i) {
    image[end + i] = static_cast<std::uint8_t>(crc >> 8 * i);
  }
  return image;
}

TEST(Fetching, parts_together_are_the_image) {
  Store store;
  std::string all;
  for (int part = 1; part <= 3; ++part) {
    ASSERT_TRUE(store.ask("fetch what=nominal part=" + std::to_string(part)));
    const std::string told(store.line.view());
    EXPECT_TRUE(told.starts_with(" bytes=484 parts=3 hex=")) << told;
    all += told.substr(told.find("hex=") + 4);
  }
  EXPECT_EQ(all, hex_of(encode_drawing(store.drawing)));
}

TEST(Fetching, begins_with_the_first_part_where_none_is_named) {
  Store store;
  ASSERT_TRUE(store.ask("fetch what=nominal"));
  const std::string first(store.line.view());
  ASSERT_TRUE(store.ask("fetch what=nominal part=1"));
  EXPECT_EQ(store.line.view(), first);
}

TEST(Fetching, refuses_parts_that_are_not_there_and_what_it_does_not_know) {
  Store store;
  for (const char* part : {"0", "0.5", "4", "-1"}) {
    EXPECT_EQ(test::failure_of(store.ask(std::string("fetch what=nominal part=") + part)),
              Error::kOutOfRange)
        << part;
  }
  for (const char* request : {"fetch", "fetch what=ledger", "fetch what=nominal part=one",
                              "fetch what=nominal piece=1"}) {
    EXPECT_EQ(test::failure_of(store.ask(request)), Error::kUnknownRequest) << request;
  }
  (void)store.ask("fetch what=nominal part=one");
  EXPECT_EQ(store.line.view(), " why=\"part needs a number\"");
}

TEST(Fetching, tells_signature_and_candidate_apart_and_which_is_missing) {
  Store store;
  EXPECT_EQ(test::failure_of(store.ask("fetch what=signature")), Error::kNoSignature);
  EXPECT_EQ(test::failure_of(store.ask("fetch what=candidate")), Error::kNoCandidate);
  const RecordImage image = encode(store.record);
  const std::string begin = hex_of(std::span(image).first(kPartBytes));
  store.fetchable.signature = &store.record;
  ASSERT_TRUE(store.ask("fetch what=signature"));
  EXPECT_TRUE(store.line.view().ends_with("hex=" + begin));
  EXPECT_EQ(test::failure_of(store.ask("fetch what=candidate")), Error::kNoCandidate);
  store.fetchable = {.signature = nullptr, .candidate = &store.record, .drawing = &store.drawing};
  ASSERT_TRUE(store.ask("fetch what=candidate"));
  EXPECT_TRUE(store.line.view().ends_with("hex=" + begin));
  EXPECT_EQ(test::failure_of(store.ask("fetch what=signature")), Error::kNoSignature);
}

TEST(FetchedDrawing, is_the_drawing_with_its_slides_and_limits) {
  Arm drawing = tool::puma560();
  drawing.joints[2].type = JointType::kPrismatic;
  const auto decoded = decode_drawing(encode_drawing(drawing));
  ASSERT_TRUE(decoded);
  ASSERT_EQ(decoded->joints.size(), 6U);
  ASSERT_EQ(decoded->limits.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(decoded->joints[i].type, drawing.joints[i].type);
    EXPECT_EQ(decoded->joints[i].theta_rad, drawing.joints[i].theta_rad);
    EXPECT_EQ(decoded->joints[i].d_m, drawing.joints[i].d_m);
    EXPECT_EQ(decoded->joints[i].a_m, drawing.joints[i].a_m);
    EXPECT_EQ(decoded->joints[i].alpha_rad, drawing.joints[i].alpha_rad);
    EXPECT_EQ(decoded->limits[i].lower, drawing.limits[i].lower);
    EXPECT_EQ(decoded->limits[i].upper, drawing.limits[i].upper);
  }
}

TEST(FetchedDrawing, is_refused_with_any_byte_changed) {
  const DrawingImage image = encode_drawing(tool::puma560());
  ASSERT_EQ(resealed(image), image);
  for (std::size_t at = 0; at < image.size(); ++at) {
    DrawingImage damaged = image;
    damaged[at] ^= 0x10;
    EXPECT_EQ(test::failure_of(decode_drawing(damaged)), Error::kRecordCorrupt) << at;
  }
}

TEST(FetchedDrawing, of_no_joint_of_nine_or_of_what_is_no_number_is_none) {
  for (const int joints : {0, 9, 255}) {
    DrawingImage image = encode_drawing(tool::puma560());
    image[0] = static_cast<std::uint8_t>(joints);
    EXPECT_EQ(test::failure_of(decode_drawing(resealed(image))), Error::kRecordCorrupt) << joints;
  }
  Arm drawing = tool::puma560();
  drawing.joints[5].d_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(test::failure_of(decode_drawing(encode_drawing(drawing))), Error::kRecordCorrupt);
}

// Maps are of what the encoders read, everything else that is told is of the joints.
TEST(Fetching, refuses_maps_of_an_arm_whose_joints_are_coupled) {
  Store store;
  store.fetchable.signature = &store.record;
  store.drawing.couplings.push_back({.joint = 2, .from = 1, .ratio = -1});
  EXPECT_TRUE(store.ask("fetch what=signature")) << "couplings, and no maps";
  store.record.deflections.maps.resize(6);
  EXPECT_EQ(test::failure_of(store.ask("fetch what=signature")), Error::kUnsupported);
  store.drawing.couplings.clear();
  EXPECT_TRUE(store.ask("fetch what=signature")) << "maps, and no couplings";
}

}  // namespace
}  // namespace armsig::controller
