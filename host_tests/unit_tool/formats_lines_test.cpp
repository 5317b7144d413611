// SPDX-License-Identifier: MIT
// The lines of files in UTF-16: the same as in UTF-8, and in no more memory.
#include <malloc.h>

#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/formats/csv_lines.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::tool {
namespace {

std::string in_utf16(const std::u32string& text, bool little_endian) {
  std::string bytes;
  const auto unit = [&](std::uint32_t code) {
    const auto low = static_cast<char>(code & 0xFFU);
    const auto high = static_cast<char>(code >> 8U);
    bytes += little_endian ? low : high;
    bytes += little_endian ? high : low;
  };
  for (const char32_t code : text) {
    if (code < 0x10000) {
      unit(code);
    } else {
      unit(0xD800U + ((code - 0x10000U) >> 10U));
      unit(0xDC00U + ((code - 0x10000U) & 0x3FFU));
    }
  }
  return bytes;
}

struct File {
  explicit File(const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }
  ~File() { std::remove(path.c_str()); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  std::string path = test::temporary("lines.csv");
};

// Lines of every length from 1 on, so that every place of a character meets the end of a buffer.
TEST(Utf16Lines, are_those_of_utf8_wherever_the_buffer_ends) {
  for (const bool little_endian : {true, false}) {
    std::u32string text = U"\uFEFF";
    std::string line;
    std::vector<std::string> lines;
    for (int i = 0; i < 900; ++i) {
      line += i % 3 == 0 ? "\U0001F600" : i % 3 == 1 ? "\u20AC" : "x";
      lines.push_back("a" + line);
      text += U'a';
      for (int k = 0; k <= i; ++k)
        text += k % 3 == 0 ? U'\U0001F600' : k % 3 == 1 ? U'\u20AC' : U'x';
      text += U'\n';
    }
    const File file(in_utf16(text, little_endian));
    auto reader = LineReader::open(file.path);
    ASSERT_TRUE(reader);
    for (const std::string& expected : lines) {
      const auto more = reader->next();
      ASSERT_TRUE(more && *more);
      ASSERT_EQ(reader->line(), expected);
    }
    EXPECT_FALSE(reader->next().value());
  }
}

TEST(Utf16Lines, take_no_more_memory_the_longer_the_file) {
  const std::string line = in_utf16(U"# " + std::u32string(1020, U'-') + U"\n", true);
  std::string bytes = in_utf16(U"\uFEFFfirst\n", true);
  while (bytes.size() < (std::size_t{70} << 20U)) bytes += line;
  bytes += in_utf16(U"last", true);
  const File file(bytes);
  std::string().swap(bytes);
  const std::size_t before = ::mallinfo2().uordblks + ::mallinfo2().hblkhd;
  auto reader = LineReader::open(file.path);
  ASSERT_TRUE(reader && reader->next().value());
  EXPECT_EQ(reader->line(), "first");
  ASSERT_TRUE(reader->next().value());
  EXPECT_EQ(reader->line(), "last");
  EXPECT_LT(::mallinfo2().uordblks + ::mallinfo2().hblkhd, before + (std::size_t{1} << 20U));
}

TEST(Utf16Lines, refuse_a_file_that_breaks_off_in_mid_character) {
  const std::string whole = in_utf16(U"\uFEFFx_mm\n1\n\U0001F600", true);
  for (std::size_t less = 1; less <= 3; ++less) {
    const File file(whole.substr(0, whole.size() - less));
    auto reader = LineReader::open(file.path);
    ASSERT_TRUE(reader);
    auto more = reader->next();
    while (more && *more) more = reader->next();
    EXPECT_EQ(test::failure_of(more).what, "text in UTF-16 that breaks off in mid-character");
  }
}

}  // namespace
}  // namespace armsig::tool
