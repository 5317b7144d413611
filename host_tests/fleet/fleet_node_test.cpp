// SPDX-License-Identifier: MIT
// What the reporter reads: its configuration, and the lines of the controller.
#include <fstream>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "firmware/controller/fetching.hpp"
#include "firmware/controller/signature_record.hpp"
#include "firmware/fleet/journal/journal.hpp"
#include "firmware/fleet/node/configuration.hpp"
#include "firmware/fleet/node/controller_lines.hpp"
#include "firmware/fleet/node/record_fetch.hpp"
#include "firmware/fleet/node/sha256.hpp"
#include "firmware/fleet/wire/row_codec.hpp"
#include "firmware/fleet/wire/signature_document.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::fleet {
namespace {

using test::failure_of;

const Value* find(const Readings& readings, Item item) {
  for (const Reading& reading : readings) {
    if (reading.item == item) return &reading.value;
  }
  return nullptr;
}

// As armsigd writes it.
constexpr std::string_view kStatus =
    "ok mode=faulted fault=DRIVE_EMERGENCY fault_joint=4 fault_code=0x2310 "
    "fault_says=\"continuous over-current\" moving=no q1_deg=10.0000 x_mm=1.000 y_mm=2.000 "
    "z_mm=3.000 model=signature sensor=SENSOR_SILENT sequence=none ticks=1000 late_mean_us=3.1 "
    "late_max_us=70.5 late_bins=10,20,470,490,5,4,1 exec_mean_us=9.0 exec_max_us=20.0 "
    "exec_bins=0,0,1000 step_max_us=55.0";

TEST(FleetNode, StatusIsRead) {
  const Readings readings = readings_of_status(kStatus);
  const auto expect = [&](Item item, const Value& value) {
    ASSERT_NE(find(readings, item), nullptr) << info(item).name;
    EXPECT_EQ(*find(readings, item), value) << info(item).name;
  };
  expect(Item::kMode, Text("faulted"));
  expect(Item::kFault, Text("DRIVE_EMERGENCY joint 4: continuous over-current"));
  expect(Item::kModel, Text("signature"));
  expect(Item::kSensor, Text("SENSOR_SILENT"));
  expect(Item::kLateness50, 4.0);
  expect(Item::kLateness99, 8.0);
  expect(Item::kLatenessMax, 70.5);
}

TEST(FleetNode, FaultThatIsGoneHasNoValue) {
  const Readings readings = readings_of_status("ok mode=idle model=nominal sensor=well");
  ASSERT_NE(find(readings, Item::kFault), nullptr);
  EXPECT_EQ(*find(readings, Item::kFault), Value());
  EXPECT_EQ(find(readings, Item::kLateness50), nullptr);
}

TEST(FleetNode, SignatureIsNamedByItsParametersAlone) {
  const std::string parameters =
      "theta1_deg=0.010000 d1_mm=1.0000 a1_mm=2.0000 alpha1_deg=-90.000000";
  const std::string head =
      "ok model=signature signature=3 predicted_tool_error_mm=0.0800 predicted_region=limits "
      "validation_rms_mm=0.1200 validation_poses=20 air_c=21.5 identified_unix_s=1790000000 ";
  const Readings readings = readings_of_signature(head + parameters);
  ASSERT_NE(find(readings, Item::kSignatureHash), nullptr);
  EXPECT_EQ(*find(readings, Item::kSignatureHash), Value(Text(sha256(parameters))));
  EXPECT_EQ(*find(readings, Item::kSignatureDate), Value(std::uint64_t{1'790'000'000'000}));
  EXPECT_EQ(*find(readings, Item::kSignatureNumber), Value(std::uint64_t{3}));
  EXPECT_EQ(*find(readings, Item::kPredicted), Value(0.08));
  EXPECT_EQ(*find(readings, Item::kPredictedRegion), Value(Text("limits")));
  EXPECT_EQ(*find(readings, Item::kValidation), Value(0.12));
  EXPECT_EQ(*find(readings, Item::kValidationPoses), Value(std::uint64_t{20}));
  EXPECT_EQ(*find(readings, Item::kAir), Value(21.5));
  RowBytes row;
  for (const Reading& reading : readings) EXPECT_TRUE(add_reading(row, reading)) << "one row";
}

// So that no figure of a former signature stays beside another, or beside the drawing.
TEST(FleetNode, SignatureIsToldWithAllItsFiguresAlsoThoseThatAreNotKnown) {
  for (const std::string line :
       {"ok model=nominal", "ok model=signature signature=3 theta1_deg=1",
        "ok model=signature signature=3 predicted_tool_error_mm=0.08 theta1_deg=1"}) {
    const Readings readings = readings_of_signature(line);
    for (const Item item : kOfSignature) {
      ASSERT_NE(find(readings, item), nullptr) << line << info(item).name;
    }
    EXPECT_EQ(*find(readings, Item::kPredicted), Value()) << "of no region: " << line;
    EXPECT_EQ(*find(readings, Item::kValidation), Value()) << line;
  }
  EXPECT_EQ(*find(readings_of_signature("ok model=nominal"), Item::kSignatureHash), Value());
}

TEST(FleetNode, DocumentOfASignatureComesInRowsOfTheJournal) {
  std::string document = "theta1_deg=0.010000";
  while (document.size() < 500) document += " d1_mm=" + std::to_string(document.size());
  EXPECT_EQ(document_of_signature("ok model=signature air_c=1 " + document), document);
  EXPECT_EQ(document_of_signature("ok model=nominal"), "");
  const std::vector<Readings> rows = readings_of_document(document);
  std::string together;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    RowBytes bytes;
    for (const Reading& reading : rows[i]) EXPECT_TRUE(add_reading(bytes, reading));
    EXPECT_LE(bytes.size(), Journal::kLongestRow);
    EXPECT_EQ(*find(rows[i], Item::kDocumentHash), Value(Text(sha256(document))));
    EXPECT_EQ(*find(rows[i], Item::kDocumentPart), Value(std::uint64_t{i + 1}));
    EXPECT_EQ(*find(rows[i], Item::kDocumentParts), Value(std::uint64_t{rows.size()}));
    together += std::get<Text>(*find(rows[i], Item::kDocumentText)).view();
  }
  EXPECT_EQ(together, document);
  EXPECT_TRUE(readings_of_document("").empty());
  const std::size_t longest = kMostDocumentParts * Text::kLongest;
  EXPECT_EQ(readings_of_document(std::string(longest, 'a')).size(), kMostDocumentParts);
  EXPECT_TRUE(readings_of_document(std::string(longest + 1, 'a')).empty());
}

// A slide and a map, as a controller has them.
controller::SignatureRecord bent_record() {
  controller::SignatureRecord record;
  Signature& signature = record.signature;
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
    signature.types.push_back(type);
    signature.configuration.push_back(type == JointType::kPrismatic ? 0.25 : -0.5);
    record.deflections.maps.push_back({.domain = {.origin = -3, .per_length = 19}, .step = 1e-8});
    record.machine.drives.push_back({});
  }
  for (int i = 0; i < 3; ++i) signature.X_SL.push_back({});
  record.deflections.maps[0].steps[7] = -77;
  record.deflections.gravity.push_back({.joint = 0, .origin = 2, .coefficient = 1e-4});
  return record;
}

std::vector<std::string> fetched(const controller::RecordImage& image) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < image.size(); at += controller::kPartBytes) {
    std::string line = "ok bytes=3956 parts=21 hex=";
    for (std::size_t i = at; i < std::min(at + controller::kPartBytes, image.size()); ++i) {
      line += fmt::format("{:02x}", image[i]);
    }
    lines.push_back(line);
  }
  return lines;
}

std::string document_by(const std::vector<std::string>& lines) {
  RecordFetch fetch;
  fetch.begin("theta1_deg=0", 0);
  for (const std::string& line : lines) {
    if (fetch.state() != RecordFetch::State::kAsks) break;
    EXPECT_TRUE(fetch.take(line)) << line;
  }
  EXPECT_EQ(fetch.state(), RecordFetch::State::kWhole);
  return fetch.document();
}

TEST(FleetNode, DocumentHasWhatTheRecordOfTheControllerAddsToTheRows) {
  const controller::SignatureRecord record = bent_record();
  static_assert(RecordFetch::kRecordBytes == controller::kRecordBytes);
  static_assert(RecordFetch::kPartBytes == controller::kPartBytes);
  const auto lines = fetched(encode(record));
  ASSERT_EQ(lines.size(), 21U);
  const std::string document = document_by(lines);
  EXPECT_EQ(document, signature_document("theta1_deg=0", record.signature.types, record.deflections,
                                         record.signature.configuration));
  EXPECT_TRUE(document.starts_with(
      "theta1_deg=0 type2=prismatic zero1_rad=0 rest1_rad=-0.5 map1_from_rad=-3 "));
  EXPECT_TRUE(document.contains(" zero2_m=0 rest2_m=0.25 map2_from_m=-3 "));
  EXPECT_TRUE(document.contains("map1=0,0,0,0,0,0,0,-77,0"));
  EXPECT_TRUE(document.ends_with(" gravity=1,2,0.0001"));
}

// Another was accepted between the rows and the record: they are no document together.
TEST(FleetNode, RowsOfOneSignatureAndTheRecordOfAnotherAreNoDocument) {
  controller::SignatureRecord record = bent_record();
  record.sequence = 4;
  for (const std::uint64_t number : {3U, 4U}) {
    RecordFetch fetch;
    fetch.begin("theta1_deg=0", number);
    for (const std::string& line : fetched(encode(record))) EXPECT_TRUE(fetch.take(line));
    EXPECT_EQ(fetch.state(), number == 4 ? RecordFetch::State::kWhole : RecordFetch::State::kOther);
  }
}

// Whatever the controller answers, the rows are told.
TEST(FleetNode, RowsAreTheDocumentWhereNoRecordComes) {
  auto lines = fetched(encode(bent_record()));
  lines[4][60] = lines[4][60] == '0' ? '1' : '0';
  EXPECT_EQ(document_by(lines), "theta1_deg=0") << "a wrong CRC";
  for (const char* line :
       {"error UNKNOWN_REQUEST no such request", "error UNSUPPORTED x",
        "ok bytes=", "ok bytes=12 parts=1 hex=00", "ok bytes=3956 parts=21 hex=0"}) {
    EXPECT_EQ(document_by({line}), "theta1_deg=0") << line;
  }
  lines = fetched(encode(bent_record()));
  lines[20].back() = 'x';
  EXPECT_EQ(document_by(lines), "theta1_deg=0") << "no digit";
  RecordFetch fetch;
  EXPECT_FALSE(fetch.take("ok bytes=3956 parts=21 hex=00")) << "nothing is asked for";
  fetch.begin("theta1_deg=0", 0);
  EXPECT_FALSE(fetch.take("# mode holding"));
  EXPECT_FALSE(fetch.take("ok mode=idle"));
}

TEST(FleetNode, CheckIsReadWithItsResidual) {
  const Readings readings = readings_of_check(
      "# check verdict=consistent signature=3 dx_mm=0.01 dy_mm=-0.02 dz_mm=0.03 sigma_mm=0.025 "
      "poses=16");
  ASSERT_NE(find(readings, Item::kResidualY), nullptr);
  EXPECT_EQ(*find(readings, Item::kVerdict), Value(Text("consistent")));
  EXPECT_EQ(*find(readings, Item::kResidualY), Value(-0.02));
  EXPECT_EQ(*find(readings, Item::kCheckPoses), Value(std::uint64_t{16}));
}

TEST(FleetNode, OtherLinesAndNumbersThatAreNoneSayNothing) {
  for (const char* line : {"", "ok", "ok model=", "error UNKNOWN_REQUEST", "# mode holding"}) {
    EXPECT_TRUE(readings_of_status(line).empty()) << line;
    EXPECT_TRUE(readings_of_check(line).empty()) << line;
  }
  const Readings readings =
      readings_of_status("ok mode=idle late_max_us=nan late_bins=1,x,3 late_bins=");
  EXPECT_EQ(find(readings, Item::kLatenessMax), nullptr);
  EXPECT_EQ(find(readings, Item::kLateness50), nullptr);
}

// Of the examples to FIPS 180-4.
TEST(FleetNode, Sha256IsTheStandards) {
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256(std::string(1'000'000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

std::string example() {
  std::ifstream file(ARMSIG_EXAMPLE);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string with(const std::string& old_part, const std::string& new_part) {
  std::string text = example();
  const std::size_t at = text.find(old_part);
  EXPECT_NE(at, std::string::npos) << old_part;
  return text.replace(at, old_part.size(), new_part);
}

TEST(FleetNode, ExampleConfigurationIsGood) {
  const auto read = parse_node_configuration(example(), "node.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->edge.group, "plant-1");
  EXPECT_EQ(read->edge.node, "arm-1");
  EXPECT_EQ(read->slots, (16U * 1024 * 1024 - 4096) / 256);
  EXPECT_EQ(read->period_ms, 10'000U);
  EXPECT_EQ(read->broker.port, 8883);
  EXPECT_EQ(read->serial, "C400-17");
}

TEST(FleetNode, WrongConfigurationIsRefusedWithItsPlace) {
  const std::vector<std::pair<std::string, std::string>> wrong{
      {with("node/1", "node/2"), "node/1"},
      {with("node: arm-1", "node: arm/1"), "arm/1"},
      {with("group: plant-1", "group: \"+\""), "letters"},
      {with("group: plant-1 ", "grupp: plant-1 "), "grupp"},
      {with("journal_mib: 16", "journal_mib: 0"), "journal_mib"},
      {with("period_s: 10", "period_s: 0.1"), "period"},
      {with("period_s: 10", "period: 10"), "period"},
      {with("  key: /etc", "  kay: /etc"), "kay"},
      {with("  key: /etc/armsig/fleet/arm-1.key", ""), "key"},
      {with("port: 8883", "port: 70000"), "port"},
  };
  for (const auto& [text, part] : wrong) {
    const std::string said = tool::render(failure_of(parse_node_configuration(text, "node.yaml")));
    EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_TRUE(said.starts_with("node.yaml:")) << said;
  }
}

TEST(FleetNode, BrokerWithoutTlsIsForTheLoopbackAlone) {
  const std::string head =
      "armsig: node/1\nconsole: /c\njournal: /j\ngroup: g\nnode: n\nhost: h\nbroker:\n";
  EXPECT_TRUE(parse_node_configuration(head + "  address: localhost\n", "x"));
  EXPECT_FALSE(parse_node_configuration(head + "  address: broker.example\n", "x"));
}

}  // namespace
}  // namespace armsig::fleet
