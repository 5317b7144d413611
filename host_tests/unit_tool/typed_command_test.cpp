// SPDX-License-Identifier: MIT
// What a person is told to type is read back by the shell as it was meant.
#include "firmware/command_line/typed_command.hpp"

#include <array>
#include <cstdio>
#include <string>

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

// The words that bash makes of `line`, each ended by a zero byte.
std::string words_by_bash(const std::string& line) {
  std::FILE* file = std::fopen("typed_command_test.sh", "wb");
  if (file == nullptr) return "no file";
  std::fputs(("printf '%s\\0' " + line + "\n").c_str(), file);
  std::fclose(file);
  std::FILE* pipe = ::popen("bash typed_command_test.sh", "r");
  std::string words;
  std::array<char, 4096> bytes{};
  while (const std::size_t size = std::fread(bytes.data(), 1, bytes.size(), pipe)) {
    words.append(bytes.data(), size);
  }
  ::pclose(pipe);
  std::remove("typed_command_test.sh");
  return words;
}

TEST(ShellQuoted, comes_back_from_bash_byte_for_byte) {
  std::string every;
  for (int byte = 1; byte < 256; ++byte) every += static_cast<char>(byte);
  for (const std::string& word :
       {std::string(), std::string("m.csv"), std::string("it's"), std::string("a b\tc\nd"),
        std::string("$HOME `id` $(id) \"x\" \\ ! # ~ * ? [a] {a,b} <x >y |z &"), std::string("\n"),
        std::string("a\n7"), std::string("\xE2\x80\xAEmoc.evil"),
        std::string("Pr\xC3\xBC"
                    "fling"),
        std::string("\xFF"), std::string("~"), std::string("--out=x"), every}) {
    EXPECT_EQ(words_by_bash(shell_quoted(word)), word + '\0') << shell_quoted(word);
    EXPECT_EQ(shell_quoted(word).find('\n'), std::string::npos) << "one line";
  }
}

TEST(ShellQuoted, leaves_plain_words_plain) {
  EXPECT_EQ(shell_quoted("/tmp/m-1_2.csv"), "/tmp/m-1_2.csv");
  EXPECT_EQ(shell_quoted("a b"), "'a b'");
  EXPECT_EQ(shell_quoted("it's"), R"('it'\''s')");
}

TEST(TypedCommand, lets_no_word_look_like_an_option) {
  TypedCommand command("report");
  command.file_option("--signature", "-s.yaml").option("--columns", "-x").option("--sensor", "");
  EXPECT_EQ(command.file("-m.csv").word("wait").text(),
            "armsig report --signature ./-s.yaml --columns=-x ./-m.csv wait");
  EXPECT_EQ(TypedCommand::of_program("check_urdf").file("a b.urdf").text(),
            "check_urdf 'a b.urdf'");
}

}  // namespace
}  // namespace armsig::tool
