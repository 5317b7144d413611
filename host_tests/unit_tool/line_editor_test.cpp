// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/line_editor.hpp"

#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

constexpr std::string_view kUp = "\033[A";
constexpr std::string_view kDown = "\033[B";
constexpr std::string_view kLeft = "\033[D";

// The last line that the keys gave; "(none)" if they gave none.
std::string type(LineEditor& editor, std::string_view keys) {
  std::string line = "(none)";
  for (const char key : keys) {
    if (const auto given = editor.key(key)) line = *given;
  }
  return line;
}

TEST(LineEditor, gives_a_line_at_return_and_starts_anew) {
  LineEditor editor;
  EXPECT_EQ(type(editor, "status"), "(none)");
  EXPECT_EQ(editor.text(), "status");
  EXPECT_EQ(type(editor, "\r"), "status");
  EXPECT_EQ(editor.text(), "");
  EXPECT_EQ(editor.cursor(), 0U);
}

TEST(LineEditor, inserts_and_deletes_at_the_cursor) {
  LineEditor editor;
  type(editor, "enble");
  type(editor, kLeft);
  type(editor, kLeft);
  type(editor, kLeft);
  EXPECT_EQ(type(editor, "a\r"), "enable");
  type(editor, "movee q1");
  for (int i = 0; i < 3; ++i) type(editor, kLeft);
  EXPECT_EQ(type(editor, "\x7F\r"), "move q1");
  EXPECT_EQ(type(editor, "xstatus\x01\033[3~\r"), "status");
}

TEST(LineEditor, recalls_earlier_lines_and_keeps_the_unfinished_one) {
  LineEditor editor;
  type(editor, "first\rsecond\rsecond\runfin");
  type(editor, kUp);
  EXPECT_EQ(editor.text(), "second");
  type(editor, kUp);
  EXPECT_EQ(editor.text(), "first");  // equal neighbours are kept once
  type(editor, kUp);
  EXPECT_EQ(editor.text(), "first");
  type(editor, kDown);
  type(editor, kDown);
  type(editor, kDown);
  EXPECT_EQ(editor.text(), "unfin");
}

TEST(LineEditor, knows_the_keys_of_a_shell) {
  LineEditor editor;
  EXPECT_EQ(type(editor, "one two\x17three\r"), "one three");
  EXPECT_EQ(type(editor, "one\x15two\r"), "two");
  EXPECT_EQ(type(editor, "one\x01\x0Btwo\r"), "two");
  EXPECT_EQ(type(editor, "one\x03two\r"), "two");
  EXPECT_EQ(type(editor, "one\033[Hzero \033[F two\r"), "zero one two");
}

TEST(LineEditor, ignores_unknown_keys_and_bytes_that_are_no_text) {
  LineEditor editor;
  EXPECT_EQ(type(editor,
                 "a\033[5~b\033[Zc\xC3\xA4\x02"
                 "d\r"),
            "abcd");
}

TEST(LineEditor, stops_at_the_longest_line_that_a_console_takes) {
  LineEditor editor;
  type(editor, std::string(1000, 'x'));
  EXPECT_EQ(editor.text().size(), LineEditor::kLongestLine);
}

}  // namespace
}  // namespace armsig::tool
