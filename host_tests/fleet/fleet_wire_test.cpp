// SPDX-License-Identifier: MIT
// The bytes of every message as protoc reads them by a schema of the test's own, and what is read
// of bytes that protoc wrote or nobody did.
#include <string>

#include <gtest/gtest.h>

#include "firmware/fleet/wire/payload.hpp"
#include "firmware/fleet/wire/row_codec.hpp"
#include "host_tests/fleet/protoc.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::fleet {
namespace {

using armsig::test::failure_of;
using test::by_protoc;
using test::count;

std::string decoded(const Payload& payload) {
  return test::decoded({payload.data(), payload.size()});
}

std::span<const std::byte> bytes_of(const std::string& text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

TEST(FleetWire, DeathAsProtocReadsIt) {
  EXPECT_EQ(decoded(encode_death(1'700'000'000'123, 7)),
            "time: 1700000000123\n"
            "m {\n  name: \"bdSeq\"\n  time: 1700000000123\n  type: 4\n  l: 7\n}\n");
}

TEST(FleetWire, RowAsProtocReadsIt) {
  RowMessage row{.journal = 0xFEDCBA9876543210,
                 .number = 12,
                 .previous = 9,
                 .dropped = 1,
                 .time_ms = 1'600'000'000'000,
                 .historical = true,
                 .readings = {}};
  row.readings.push_back({Item::kVerdict, Text("drifted")});
  row.readings.push_back({Item::kResidualX, -0.125});
  row.readings.push_back({Item::kCheckPoses, std::uint64_t{16}});
  row.readings.push_back({Item::kFault, Value()});
  const auto metric = [](const std::string& alias, const std::string& type,
                         const std::string& value) {
    return "m {\n  alias: " + alias + "\n  time: 1600000000000\n  type: " + type +
           "\n  historical: true\n  " + value + "\n}\n";
  };
  EXPECT_EQ(decoded(encode_row(1'700'000'000'000, 255, row)),
            "time: 1700000000000\n" + metric("1", "8", "l: 18364758544493064720") +
                metric("2", "8", "l: 12") + metric("3", "8", "l: 9") + metric("4", "8", "l: 1") +
                metric("15", "12", "s: \"drifted\"") + metric("16", "10", "d: -0.125") +
                metric("20", "7", "i: 16") + metric("9", "12", "null: true") + "seq: 255\n");
}

TEST(FleetWire, BirthAsProtocReadsIt) {
  Readings current;
  current.push_back({Item::kMode, Text("holding")});
  current.push_back({Item::kSignatureDate, std::uint64_t{1'650'000'000'000}});
  const std::string text = decoded(encode_birth(1'700'000'000'000, 3, current));
  EXPECT_EQ(count(text, "m {\n"), kItems.size() + 2);
  EXPECT_EQ(count(text, "  name: "), kItems.size() + 2);
  EXPECT_EQ(count(text, "  alias: "), kItems.size()) << "neither bdSeq nor Rebirth has one";
  EXPECT_EQ(count(text, "  time: 1700000000000\n"), kItems.size() + 2);
  EXPECT_EQ(count(text, "null: true"), kItems.size() - 2);
  EXPECT_NE(text.find("m {\n  name: \"bdSeq\"\n  time: 1700000000000\n  type: 4\n  l: 3\n}"),
            std::string::npos);
  EXPECT_NE(text.find("m {\n  name: \"Node Control/Rebirth\"\n  time: 1700000000000\n  type: 11\n"
                      "  b: false\n}"),
            std::string::npos);
  EXPECT_NE(text.find("alias: 8\n  time: 1700000000000\n  type: 12\n  s: \"holding\""),
            std::string::npos);
  EXPECT_NE(text.find("type: 13\n  l: 1650000000000"), std::string::npos);
  EXPECT_TRUE(text.ends_with("seq: 0\n"));
}

TEST(FleetWire, CommandsAsProtocReadsThem) {
  EXPECT_EQ(
      decoded(encode_rebirth(5)),
      "time: 5\nm {\n  name: \"Node Control/Rebirth\"\n  time: 5\n  type: 11\n  b: true\n}\n");
  const std::string text = decoded(encode_acknowledgement(5, 77, 1234));
  EXPECT_NE(text.find("type: 8\n  l: 77"), std::string::npos);
  EXPECT_NE(text.find("type: 8\n  l: 1234"), std::string::npos);
}

TEST(FleetWire, WhatAnotherWroteIsRead) {
  const auto command = decode_command(bytes_of(by_protoc(
      "encode",
      "time: 9 uuid: \"x\" body: \"yz\" m { name: \"Node Control/Rebirth\" type: 11 b: true }"
      " m { name: \"Anything Else\" type: 17 y: \"123\" }")));
  ASSERT_TRUE(command);
  EXPECT_TRUE(command->rebirth);
  EXPECT_FALSE(command->acknowledged);
  const auto report = decode_report(bytes_of(
      by_protoc("encode", "time: 9 seq: 4 m { alias: 16 time: 8 d: 1.5 } m { alias: 999 l: 3 }")));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->seq, 4U);
  EXPECT_EQ(report->time_ms, 8U);
  ASSERT_EQ(report->readings.size(), 1U);
  EXPECT_EQ(*report->find(Item::kResidualX), Value(1.5));
}

TEST(FleetWire, WhatContradictsTheTableIsRefused) {
  for (const char* text : {"m { name: \"Journal/Row\" alias: 3 l: 1 }", "m { alias: 2 s: \"one\" }",
                           "m { alias: 2 l: 1 } m { alias: 2 l: 2 }"}) {
    EXPECT_EQ(failure_of(decode_report(bytes_of(by_protoc("encode", text)))), Error::kRecordCorrupt)
        << text;
  }
}

TEST(FleetWire, MoreThanThereIsRoomForIsRefused) {
  std::string many;
  for (int i = 0; i < 41; ++i) many += "m { l: 1 }";
  EXPECT_FALSE(decode_report(bytes_of(by_protoc("encode", many))));
  const std::string name(97, 'x');
  EXPECT_FALSE(decode_command(bytes_of(by_protoc("encode", "m { name: \"" + name + "\" }"))));
}

TEST(FleetWire, EveryCutOfAMessageIsReadOrRefused) {
  RowMessage row{.journal = 1,
                 .number = 2,
                 .previous = 1,
                 .dropped = 0,
                 .time_ms = 5,
                 .historical = false,
                 .readings = {}};
  row.readings.push_back({Item::kVerdict, Text("consistent")});
  const Payload payload = encode_row(9, 1, row);
  std::size_t read = 0;
  for (std::size_t size = 0; size < payload.size(); ++size) {
    const auto report = decode_report({payload.data(), size});
    if (report && report->find(Item::kVerdict) != nullptr) {
      EXPECT_EQ(*report->find(Item::kVerdict), Value(Text("consistent")));
      ++read;
    }
  }
  EXPECT_LE(read, 3U) << "only what cuts the seq behind the last metric";
}

TEST(FleetWire, RowsOfTheJournalComeBack) {
  RowBytes row;
  const std::array<Reading, 5> readings{
      Reading{Item::kMode, Text("servoing")}, Reading{Item::kAir, -3.25},
      Reading{Item::kCheckPoses, std::uint64_t{0xFFFFFFFFFFFFFFFF}}, Reading{Item::kFault, Value()},
      Reading{Item::kVerdict, Text("")}};
  for (const Reading& reading : readings) ASSERT_TRUE(add_reading(row, reading));
  const auto back = readings_of({row.data(), row.size()});
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), readings.size());
  for (std::size_t i = 0; i < readings.size(); ++i) EXPECT_EQ((*back)[i], readings[i]);
  EXPECT_FALSE(add_reading(row, {Item::kAir, Text("warm")})) << "of another type";
  for (std::size_t size = 1; size < row.size(); ++size) {
    (void)readings_of({row.data(), size});  // reads nothing beyond, the sanitizer says
  }
  row[0] = std::byte{0x7F};
  EXPECT_EQ(failure_of(readings_of({row.data(), row.size()})), Error::kRecordCorrupt);
}

TEST(FleetWire, TextIsCutBetweenCharacters) {
  EXPECT_EQ(Text(std::string(95, 'x') + "\u00e9").view(), std::string(95, 'x'));
  EXPECT_EQ(Text(std::string(94, 'x') + "\u00e9").view().size(), 96U);
}

TEST(FleetWire, HostStateIsReadAsTheSpecificationWritesIt) {
  const std::string good = R"({"online" : true, "timestamp" : 1668114759262})";
  const auto state = decode_state(bytes_of(good));
  ASSERT_TRUE(state);
  EXPECT_TRUE(state->online);
  EXPECT_EQ(state->timestamp_ms, 1668114759262U);
  for (const std::string& bad :
       {std::string(), std::string("ONLINE"), std::string(R"({"online":true})"),
        std::string(R"({"online":1,"timestamp":5})"),
        std::string(R"({"online":true,"timestamp":})"),
        std::string(R"({"online":true,"timestamp":-5})"), std::string(300, '{')}) {
    EXPECT_EQ(failure_of(decode_state(bytes_of(bad))), Error::kRecordCorrupt) << bad;
  }
}

}  // namespace
}  // namespace armsig::fleet
