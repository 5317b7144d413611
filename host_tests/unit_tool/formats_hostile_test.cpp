// SPDX-License-Identifier: MIT
// Bounds of the readers: characters, sizes, depth, and memory per byte of input.
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/yaml_tree.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/peak_memory.hpp"

namespace armsig::tool {
namespace {

std::string repeated(const std::string& piece, std::size_t times) {
  std::string text;
  text.reserve(piece.size() * times);
  for (std::size_t k = 0; k < times; ++k) text += piece;
  return text;
}

TEST(Characters, that_a_terminal_or_a_reader_could_obey_are_not_printable) {
  for (const std::uint32_t code :
       {0x00U,   0x09U,   0x0AU,   0x0DU,   0x1BU,   0x1FU,   0x7FU,
        0x80U,   0x85U,   0x9FU,   0x2028U, 0x2029U, 0x202AU, 0x202EU,
        0x2066U, 0x2069U, 0xFEFFU, 0xFDD0U, 0xFFFEU, 0xFFFFU, 0x1FFFEU}) {
    EXPECT_FALSE(is_printable(code)) << std::hex << code;
  }
  for (const std::uint32_t code : {0x20U, 0x7EU, 0xA0U, 0xDFU, 0x5D0U, 0x2027U, 0x202FU, 0x2065U,
                                   0x206AU, 0xFEFEU, 0xFFFDU, 0x1F9BEU, 0x10FFFDU}) {
    EXPECT_TRUE(is_printable(code)) << std::hex << code;
  }
}

TEST(Characters, are_decoded_strictly) {
  EXPECT_EQ(first_character("\xF0\x9F\xA6\xBE").code, 0x1F9BEU);
  EXPECT_EQ(first_character("\xC3\x9F").length, 2U);
  for (const char* bad : {"\x80", "\xC0\x80", "\xC1\xBF", "\xE0\x80\x80", "\xED\xA0\x80",
                          "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xE2\x80", "\xC3(", ""}) {
    EXPECT_EQ(first_character(bad).length, 0U) << shown(bad);
  }
}

TEST(Characters, are_shown_escaped_one_by_one) {
  EXPECT_EQ(shown("a\x1b\xC2\x9B\xE2\x80\xAE\x80z"), "a\\x1B\\x9B\\u202E\\x80z");
  EXPECT_EQ(shown_lines("a\nb\rc"), "a\nb\\x0Dc");
}

// Also of a file's name, and of what a person wrote on the command line.
TEST(Characters, that_drive_a_terminal_are_escaped_in_a_problem) {
  EXPECT_EQ(render({"a\x1B]0;x\x07", 1, 2, "b\r", "c\n"}),
            "a\\x1B]0;x\\x07:1:2: b\\x0D; expected c\\x0A");
}

TEST(Yaml, refuses_characters_that_its_escapes_make) {
  const auto root = parse_yaml("a: 1\nb: \"x\\ry\"\n");
  ASSERT_FALSE(root);
  EXPECT_EQ(render(test::failure_of(root)),
            ":2:4: the character \"\\x0D\" in \"x\\x0Dy\"; expected printable text on one line");
}

TEST(Yaml, refuses_what_turns_the_direction_of_writing_in_a_comment_too) {
  const auto root = parse_yaml("a: 1  # \xE2\x80\xAE\n");
  ASSERT_FALSE(root);
  EXPECT_EQ(test::failure_of(root).what, "the character \"\\u202E\"");
}

TEST(Yaml, stops_at_depth) {
  EXPECT_TRUE(parse_yaml(repeated("[", 16) + repeated("]", 16)));
  const auto root = parse_yaml(repeated("[", 17) + repeated("]", 17));
  ASSERT_FALSE(root);
  EXPECT_EQ(test::failure_of(root).what, "nested too deeply");
  EXPECT_EQ(test::failure_of(root).column, 17);
}

TEST(Yaml, stops_at_the_first_anchor) {
  const auto root = parse_yaml("a: &x [1]\nb: [*x, *x]\nc: \"not closed");
  ASSERT_FALSE(root);
  EXPECT_EQ(test::failure_of(root).what, "a YAML anchor or alias");
}

TEST(Yaml, is_refused_by_its_marks_before_it_is_parsed) {
  EXPECT_TRUE(parse_yaml("[" + repeated("1,", 249'997) + "1]"));
  const auto root = parse_yaml("[" + repeated("1,", 249'999) + "1]");
  ASSERT_FALSE(root);
  EXPECT_EQ(test::failure_of(root).what, "too much in one file");
}

TEST(Names, are_at_most_two_hundred_bytes_long) {
  const auto arm = [](std::size_t length) {
    return parse_arm("armsig: arm/1\nname: " + std::string(length, 'a') +
                         "\njoints:\n  - {type: revolute, theta_deg: 0, d_mm: 0, a_mm: 0, "
                         "alpha_deg: 0}\n",
                     "A");
  };
  EXPECT_TRUE(arm(200));
  const auto refused = arm(201);
  ASSERT_FALSE(refused);
  EXPECT_EQ(render(test::failure_of(refused)),
            "A:2:7: name: 201 bytes; expected printable UTF-8 text of at most 200 bytes");
}

// Of every kind of file that costs yaml-cpp most: the bound that docs/formats.md states.
TEST(Memory, of_a_yaml_file_is_bounded) {
  constexpr double kMost = 128 << 20U;
  constexpr std::size_t kBytes = std::size_t{4} << 20U;
  for (const char* piece : {"1,", "[", "{a: ", "- ", "a: b\n", "- a\n", "? ", "a", "&a ", "*a, ",
                            "\"", "#\n", ", ", "!!a "}) {
    for (const char* start : {"", "["}) {
      const std::string text = start + repeated(piece, kBytes / std::string(piece).size());
      EXPECT_LT(test::cost_of(text, [](const std::string& t) { (void)parse_yaml(t); }), kMost)
          << piece;
    }
  }
}

TEST(Memory, of_measurements_does_not_grow_with_their_number) {
  const JointTypes types{JointType::kRevolute};
  const auto read = [&](const std::string& text) {
    auto reader = MeasurementReader::over(text, "M", types);
    for (MeasurementRow row; reader;) {
      const auto more = reader->next(row);
      if (!more || !*more) break;
    }
  };
  const std::string header = "sweep,target,q1_deg,x_mm,y_mm,z_mm\n";
  const double copy_and_buffers = 4 << 20U;
  for (const char* rows : {"1,1,1,2,3,4\n", "\n", "#\n", ",,,,,\n"}) {
    const std::string text = header + repeated(rows, 400'000 / std::string(rows).size());
    EXPECT_LT(test::cost_of(text, read), copy_and_buffers) << rows;
  }
}

}  // namespace
}  // namespace armsig::tool
