// SPDX-License-Identifier: MIT
#include "hal/serial_console.hpp"

#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"

namespace armsig::hal {
namespace {

// A line with two ends: what the operator types, and what the console writes.
class TypedLine final : public ByteStream {
 public:
  std::string typed;
  std::string written;
  std::size_t room = 10'000;
  bool overrun = false;

 private:
  Result<void> do_write(std::span<const std::uint8_t> bytes) override {
    if (bytes.size() > room) return std::unexpected(Error::kBusBusy);
    room -= bytes.size();
    written.append(bytes.begin(), bytes.end());
    return {};
  }
  Result<std::size_t> do_read(std::span<std::uint8_t> into) override {
    if (overrun) {
      overrun = false;
      return std::unexpected(Error::kCharactersLost);
    }
    const std::size_t count = std::min(into.size(), typed.size());
    std::copy_n(typed.begin(), count, into.begin());
    typed.erase(0, count);
    return count;
  }
};

struct Serial {
  TypedLine line;
  SerialConsole console{line};

  std::string read(const std::string& typed) {
    line.typed += typed;
    for (int i = 0; i < 20; ++i) {
      if (const auto whole = console.read_line()) {
        return whole->error ? std::string(describe(*whole->error)) : std::string(whole->text());
      }
    }
    return "";
  }
};

TEST(SerialConsole, ends_a_line_with_either_or_both_line_ends) {
  Serial serial;
  EXPECT_EQ(serial.read("status\n"), "status");
  EXPECT_EQ(serial.read("enable\r\n"), "enable");
  EXPECT_EQ(serial.read("\n\r\nlog\r"), "log");
}

TEST(SerialConsole, keeps_the_begin_of_a_line_until_its_end_comes) {
  Serial serial;
  EXPECT_EQ(serial.read("sta"), "");
  EXPECT_EQ(serial.read("tus\n"), "status");
}

TEST(SerialConsole, hands_out_two_lines_that_came_together_one_after_the_other) {
  Serial serial;
  EXPECT_EQ(serial.read("one\ntwo\n"), "one");
  EXPECT_EQ(serial.read(""), "two");
}

TEST(SerialConsole, throws_away_a_line_that_is_too_long_or_no_text) {
  Serial serial;
  EXPECT_EQ(serial.read(std::string(kMaxConsoleLine + 1, 'a').append("\n")),
            describe(Error::kLineTooLong));
  EXPECT_EQ(serial.read("sta\x01tus\n"), describe(Error::kNotText));
  EXPECT_EQ(serial.read("status\n"), "status");
}

TEST(SerialConsole, takes_a_line_of_the_full_length) {
  Serial serial;
  const std::string longest(kMaxConsoleLine, 'a');
  EXPECT_EQ(serial.read(longest + "\n"), longest);
}

TEST(SerialConsole, throws_away_a_line_that_characters_were_lost_from) {
  Serial serial;
  EXPECT_EQ(serial.read("sta"), "");
  serial.line.overrun = true;
  EXPECT_EQ(serial.read("tus\nenable\n"), describe(Error::kCharactersLost));
  EXPECT_EQ(serial.read(""), "enable");
}

TEST(SerialConsole, writes_whole_lines_or_none) {
  Serial serial;
  serial.line.room = 10;
  EXPECT_TRUE(serial.console.write_line(SerialConsole::kClient, "ok"));
  EXPECT_EQ(serial.line.written, "ok\r\n");
  const auto refused = serial.console.write_line(SerialConsole::kClient, "a longer one");
  ASSERT_FALSE(refused);
  EXPECT_EQ(test::failure_of(refused), Error::kConsoleGone);
  serial.console.broadcast("# not this one either");
  EXPECT_EQ(serial.line.written, "ok\r\n");
}

TEST(SerialConsole, cuts_what_it_writes_after_1024_characters) {
  for (const std::size_t length : {1023U, 1024U, 1025U, 5000U}) {
    Serial serial;
    serial.line.room = 10'000;
    EXPECT_TRUE(serial.console.write_line(SerialConsole::kClient, std::string(length, 'a')));
    EXPECT_EQ(serial.line.written, std::string(std::min<std::size_t>(length, 1024), 'a') + "\r\n");
  }
}

TEST(SerialConsole, takes_a_tab_for_text_and_a_deletion_not) {
  Serial serial;
  EXPECT_EQ(serial.read("a\tb\n"), "a\tb");
  EXPECT_EQ(serial.read("a\x7F"
                        "b\n"),
            describe(Error::kNotText));
}

TEST(SerialConsole, says_of_a_line_that_is_wrong_twice_what_came_first) {
  Serial serial;
  EXPECT_EQ(serial.read("\x01" + std::string(kMaxConsoleLine + 1, 'a') + "\n"),
            describe(Error::kNotText));
  EXPECT_EQ(serial.read(std::string(kMaxConsoleLine + 1, 'a') + "\x01\n"),
            describe(Error::kLineTooLong));
  EXPECT_EQ(serial.read(std::string(kMaxConsoleLine, 'a') + "\x01\n"), describe(Error::kNotText));
}

}  // namespace
}  // namespace armsig::hal
