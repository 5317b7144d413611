// SPDX-License-Identifier: MIT
// Rows are known again whatever the file that holds them looks like, and no others are.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/calibration/reading_hash.hpp"
#include "firmware/formats/origin.hpp"
#include "firmware/formats/signature_file.hpp"
#include "host_tests/support/random_signature.hpp"

namespace armsig::tool {
namespace {

const JointTypes kTurnAndSlide{JointType::kRevolute, JointType::kPrismatic};

// The hashes of the rows of a file, in its order.
std::vector<std::uint64_t> hashes_of(const std::string& text) {
  std::vector<std::uint64_t> hashes;
  auto reader = MeasurementReader::over(text, "m.csv", kTurnAndSlide);
  EXPECT_TRUE(reader);
  for (MeasurementRow row; reader;) {
    const auto more = reader->next(row);
    EXPECT_TRUE(more);
    if (!more || !*more) break;
    if (const auto hash = row_hash(row, kTurnAndSlide)) hashes.push_back(*hash);
  }
  return hashes;
}

TEST(RowHash, is_the_same_in_other_units_columns_and_words_beside_it) {
  const auto plain = hashes_of(
      "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm\n"
      "1,1,-12.345,100.5,412.3125,-77.0187,903.5532\n"
      "2,2,178.001,0.0,-0.0,1.0005,2\n");
  const auto other = hashes_of(
      "z_m,y_m,x_m,q2_m,q1_rad,target,sweep,sigma_mm,air_c\n"
      "0.9035532,-0.0770187,0.4123125,0.1005,-0.21546089615869998,7,0,0.1,21\n"
      "0.002,0.0010005,0,0,3.1067035218424266,8,0,0.2,22\n");
  ASSERT_EQ(plain.size(), 2U);
  EXPECT_EQ(plain, other);
}

TEST(RowHash, differs_where_anything_measured_does) {
  const std::string header = "sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm\n";
  auto all = hashes_of(header +
                       "1,1,10,20,1,2,3\n"
                       "1,1,10.00000001,20,1,2,3\n"
                       "1,1,10,20.00001,1,2,3\n"
                       "1,1,10,20,1.00001,2,3\n"
                       "1,1,10,20,1,2.00001,3\n"
                       "1,1,10,20,1,2,3.00001\n"
                       "1,1,20,10,1,2,3\n"
                       "1,1,10,20,2,1,3\n");
  make_set(all);
  EXPECT_EQ(all.size(), 8U);
}

TEST(RowHash, is_of_ranges_too_and_of_nothing_where_nothing_was_seen) {
  const auto ranges = hashes_of(
      "sweep,target,q1_deg,q2_mm,r1_mm,r2_mm,r3_mm\n"
      "1,1,10,20,100,,300\n"
      "1,1,10,20,100,300,\n"
      "1,1,10,20,,,\n");
  ASSERT_EQ(ranges.size(), 2U);
  EXPECT_NE(ranges[0], ranges[1]);
  EXPECT_TRUE(hashes_of("sweep,target,q1_deg,q2_mm,x_mm,y_mm,z_mm\n1,1,10,20,,,\n").empty());
}

TEST(RowSet, has_no_order_and_no_copies) {
  std::vector<std::uint64_t> one{5, 3, 9, 3};
  std::vector<std::uint64_t> other{9, 9, 5, 3};
  make_set(one);
  make_set(other);
  EXPECT_EQ(one, other);
  EXPECT_EQ(set_crc32(one), set_crc32(other));
  // python3: zlib.crc32(struct.pack("<3Q", 3, 5, 9))
  EXPECT_EQ(set_crc32(one), 0x9EC9A535U);
  other.push_back(10);
  EXPECT_NE(set_crc32(one), set_crc32(other));
}

Origin an_origin() {
  Origin origin;
  origin.arm = "arm.yaml";
  origin.measurements = "it's \"$here\"/m 1.csv";
  origin.columns = "auto,x_mm=East";
  origin.sensor = "sensor.yaml";
  origin.options = "--method refined";
  origin.sensor_crc32 = 0x0BADF00D;
  origin.rows = 3;
  origin.rows_crc32 = 0x12345678;
  origin.fitted = {1, 0x10E5, 0xFFFFFFFFFFFFFFFF};
  return origin;
}

std::string signature_with(const Origin& origin) {
  SignatureRecord record = test::RandomRecord(1).make(3);
  record.origin = origin;
  const auto text = signature_text(record);
  EXPECT_TRUE(text) << render(text.error());
  return text.value_or("");
}

TEST(Origin, comes_back_from_a_signature_as_it_was) {
  const Origin origin = an_origin();
  const auto read = parse_signature(signature_with(origin), "s.yaml");
  ASSERT_TRUE(read && read->origin);
  EXPECT_EQ(read->origin->arm, origin.arm);
  EXPECT_EQ(read->origin->measurements, origin.measurements);
  EXPECT_EQ(read->origin->columns, origin.columns);
  EXPECT_EQ(read->origin->sensor, origin.sensor);
  EXPECT_EQ(read->origin->options, origin.options);
  EXPECT_EQ(read->origin->sensor_crc32, origin.sensor_crc32);
  EXPECT_EQ(read->origin->rows, origin.rows);
  EXPECT_EQ(read->origin->rows_crc32, origin.rows_crc32);
  EXPECT_EQ(read->origin->fitted, origin.fitted);
  SignatureRecord without = test::RandomRecord(1).make(3);
  without.origin.reset();
  const auto text = signature_text(without);
  ASSERT_TRUE(text);
  EXPECT_FALSE(parse_signature(*text, "s.yaml")->origin);
}

TEST(Origin, is_refused_where_it_is_none) {
  const auto said = [](const std::string& section) {
    const auto document = parse_yaml(section);
    EXPECT_TRUE(document);
    const auto map = YamlMap::open(*document, "the signature", {"origin"});
    EXPECT_TRUE(map);
    const auto origin = read_origin_section(*map);
    return origin ? "read" : render(origin.error());
  };
  const std::string head = "origin:\n  measurements: m.csv\n  rows: 2\n";
  EXPECT_EQ(said(head + "  rows_crc32: 0x00000001\n  fitted: []\n"), "read");
  EXPECT_NE(said(head + "  rows_crc32: 0x1\n  fitted: []\n").find("0x and 8 hexadecimal digits"),
            std::string::npos);
  EXPECT_NE(said(head + "  rows_crc32: 0x0000000G\n  fitted: []\n").find("rows_crc32"),
            std::string::npos);
  EXPECT_NE(said(head + "  rows_crc32: 0x00000001\n  fitted: [0x0000000000000002, "
                        "0x0000000000000002]\n")
                .find("in ascending order"),
            std::string::npos);
  EXPECT_NE(said(head + "  fitted: []\n").find("rows_crc32"), std::string::npos);
}

// Of a set that is larger than what a file keeps, rows beyond the largest hash kept are not known.
TEST(Origin, tells_of_a_sample_of_many_rows) {
  Origin origin = an_origin();
  origin.fitted.clear();
  for (std::uint64_t k = 0; k < kMostRowHashes; ++k) origin.fitted.push_back(2 * k);
  const auto read = parse_signature(signature_with(origin), "s.yaml");
  ASSERT_TRUE(read && read->origin);
  EXPECT_EQ(read->origin->fitted, origin.fitted);
  EXPECT_TRUE(origin.has_fitted(4));
  EXPECT_FALSE(origin.has_fitted(5));
  EXPECT_TRUE(origin.tells_of(5));
  EXPECT_FALSE(origin.tells_of(2 * kMostRowHashes));
  origin.fitted.pop_back();  // all that there are
  EXPECT_TRUE(origin.tells_of(2 * kMostRowHashes));
}

}  // namespace
}  // namespace armsig::tool
