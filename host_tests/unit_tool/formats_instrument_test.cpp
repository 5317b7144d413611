// SPDX-License-Identifier: MIT
// Instrument descriptions and touches: what is read, and what is refused with which words.
#include <gtest/gtest.h>

#include "firmware/formats/touches.hpp"

namespace armsig::tool {
namespace {

constexpr const char* kSockets =
    "armsig: instrument/1\nname: bars\ntool_mm: [1, 2, 150]\ninstruments:\n"
    "  - {name: ball, kind: socket}\n"
    "  - {name: encoder, kind: wire, gain_sigma: 0.002, zero_mm: 20, zero_sigma_mm: 5}\n"
    "places: {W1: encoder}\n";

std::string with(const std::string& more) { return kSockets + more; }

// The problem of a description, in one line.
std::string refusal(const std::string& text) {
  const auto read = parse_instrument(text, "i.yaml");
  return read ? "none" : render(read.error());
}

TEST(InstrumentFile, has_instruments_places_and_lengths_in_metres) {
  const auto read = parse_instrument(
      with("lengths:\n  - {from: A1, to: A2, length_mm: 300.5, sigma_mm: 0.02}\n"), "i.yaml");
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_EQ(read->tool_F, Vector3(0.001, 0.002, 0.15));
  EXPECT_EQ(read->instruments[read->instrument_of("W1")].kind, InstrumentKind::kWire);
  EXPECT_EQ(read->instruments[read->instrument_of("A1")].kind, InstrumentKind::kSocket);
  EXPECT_EQ(read->instruments[1].gain_sigma, 0.002);
  EXPECT_EQ(read->instruments[1].zero_m, 0.02);
  EXPECT_EQ(read->instruments[1].zero_sigma_m, 0.005);
  ASSERT_EQ(read->lengths.size(), 1U);
  EXPECT_EQ(read->lengths[0].length_m, 0.3005);
  EXPECT_EQ(read->lengths[0].sigma_m, 0.02e-3);
}

// A table of touches has no quotes: what could not be read back is no name.
TEST(InstrumentFile, takes_names_of_places_that_a_table_of_touches_can_hold) {
  const auto description = [](const std::string& name) {
    return std::string(kSockets) + "lengths:\n  - {from: \"" + name +
           "\", to: A2, length_mm: 300, sigma_mm: 0.02}\n";
  };
  const JointTypes types{JointType::kRevolute, JointType::kPrismatic};
  for (const char* name : {"A1", "bar 1; left", "a'b", "Ω", "\\\"x", "1e5", "-"}) {
    const auto read = parse_instrument(description(name), "i.yaml");
    ASSERT_TRUE(read) << render(read.error());
    const std::vector<Touch> touches{{.place = read->lengths[0].from, .q = {0.1, -0.02}},
                                     {.place = "W1", .q = {-0.3, 0.5}, .length_m = 0.4567}};
    const auto back = parse_touches(touches_text(touches, types, *read), "t.csv", types, *read);
    ASSERT_TRUE(back) << render(back.error());
    ASSERT_EQ(back->size(), 2U);
    EXPECT_EQ((*back)[0].place, touches[0].place);
    EXPECT_NEAR((*back)[0].q[0], 0.1, 1e-5);
    EXPECT_NEAR((*back)[0].q[1], -0.02, 1e-12);
    EXPECT_EQ((*back)[1].place, "W1");
    EXPECT_NEAR((*back)[1].length_m, 0.4567, 1e-12);
  }
  for (const char* name : {"A,1", "#A1", " A1", "A1 "}) {
    EXPECT_NE(refusal(description(name)).find("is no name of a place"), std::string::npos) << name;
  }
  std::string text = kSockets;
  text.replace(text.find("W1: encoder"), 11, "\"W,1\": encoder");
  EXPECT_NE(refusal(text).find("\"W,1\" is no name of a place"), std::string::npos);
}

TEST(InstrumentFile, refuses_what_it_does_not_understand) {
  const auto refuses = [](const std::string& text, const std::string& words) {
    EXPECT_NE(refusal(text).find(words), std::string::npos) << refusal(text);
  };
  refuses(with("lengths:\n  - {from: A1, to: A1, length_mm: 300, sigma_mm: 0.02}\n"),
          "a length from \"A1\" to itself");
  refuses(with("lengths:\n  - {from: A1, to: W1, length_mm: 300, sigma_mm: 0.02}\n"),
          "\"W1\" is no socket");
  refuses(with("lengths:\n  - {from: A1, to: A2, length_mm: 0, sigma_mm: 0.02}\n"),
          "length_mm: 0 is not positive");
  refuses(with("tool_m: [0, 0, 0]\n"), "tool_mm beside tool_m");
  std::string text = kSockets;
  refuses(text.replace(text.find("W1: encoder"), 11, "W1: dial"),
          "there is no instrument \"dial\"");
  text = kSockets;
  refuses(text.replace(text.find("kind: socket"), 12, "kind: dial"), "kind: \"dial\"");
  text = kSockets;
  refuses(text.replace(text.find("name: encoder"), 13, "name: ball"),
          "a second instrument \"ball\"");
  text = kSockets;
  refuses(text.replace(text.find("kind: socket"), 12, "kind: socket, zero_mm: 1"),
          "zero_mm of an instrument that is no wire");
  text = kSockets;
  refuses(text.replace(text.find("0.002"), 5, "-1"), "gain_sigma: -1");
}

std::string refusal_of_touches(const std::string& text) {
  const auto description = parse_instrument(kSockets, "i.yaml");
  const auto read = parse_touches(text, "t.csv", JointTypes(2, JointType::kRevolute), *description);
  return read ? "none" : render(read.error());
}

TEST(Touches, have_a_place_readings_and_of_a_wire_a_length) {
  const auto description = parse_instrument(kSockets, "i.yaml");
  const auto read = parse_touches("place,q1_deg,q2_deg,length_mm\nA1,90,0,\nW1,0,180,1200\n",
                                  "t.csv", JointTypes(2, JointType::kRevolute), *description);
  ASSERT_TRUE(read) << render(read.error());
  ASSERT_EQ(read->size(), 2U);
  EXPECT_EQ(read->at(0).place, "A1");
  EXPECT_EQ(read->at(0).line, 2U);
  EXPECT_DOUBLE_EQ(read->at(0).q[0], kPi / 2);
  EXPECT_EQ(read->at(1).length_m, 1.2);
}

TEST(Touches, are_refused_without_a_name_or_a_length_and_with_one_too_many) {
  EXPECT_NE(refusal_of_touches("place,q1_deg,q2_deg\n,1,2\n").find("a place without a name"),
            std::string::npos);
  EXPECT_NE(refusal_of_touches("place,q1_deg,q2_deg\nW1,1,2\n").find("a wire without a length"),
            std::string::npos);
  EXPECT_NE(refusal_of_touches("place,q1_deg,q2_deg,length_mm\nA1,1,2,3\n")
                .find("a place that is no wire with a length"),
            std::string::npos);
  EXPECT_NE(refusal_of_touches("place,q1_deg,q2_deg\n").find("the file ends after its header"),
            std::string::npos);
}

}  // namespace
}  // namespace armsig::tool
