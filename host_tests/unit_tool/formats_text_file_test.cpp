// SPDX-License-Identifier: MIT
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::tool {
namespace {

namespace fs = std::filesystem;

// An empty folder for one test.
fs::path empty_folder(const std::string& name) {
  const fs::path folder = test::temporary(name);
  fs::remove_all(folder);
  fs::create_directory(folder);
  return folder;
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, appears_only_when_committed) {
  const fs::path folder = empty_folder("commit");
  const fs::path path = folder / "a.txt";
  auto file = AtomicFile::create(path);
  ASSERT_TRUE(file) << render(file.error());
  file->write("hello");
  EXPECT_FALSE(fs::exists(path));
  ASSERT_TRUE(file->commit());
  EXPECT_EQ(read_text_file(path).value_or(""), "hello");
  EXPECT_EQ(files_in(folder), 1U);
  fs::remove_all(folder);
}

TEST(AtomicFile, leaves_the_old_content_when_it_is_not_committed) {
  const fs::path folder = empty_folder("abandon");
  const fs::path path = folder / "a.txt";
  ASSERT_TRUE(write_text_file(path, "old"));
  {
    auto file = AtomicFile::create(path);
    ASSERT_TRUE(file);
    file->write(std::string(200000, 'x'));
  }
  EXPECT_EQ(read_text_file(path).value_or(""), "old");
  EXPECT_EQ(files_in(folder), 1U);
  fs::remove_all(folder);
}

TEST(AtomicFile, keeps_the_permissions_of_the_file_it_replaces) {
  const fs::path folder = empty_folder("mode");
  const fs::path path = folder / "a.txt";
  ASSERT_TRUE(write_text_file(path, "old"));
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(write_text_file(path, "new"));
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  fs::remove_all(folder);
}

TEST(AtomicFile, replaces_what_a_symbolic_link_points_to) {
  const fs::path folder = empty_folder("link");
  ASSERT_TRUE(write_text_file(folder / "real.txt", "old"));
  fs::create_symlink("real.txt", folder / "link.txt");
  ASSERT_TRUE(write_text_file(folder / "link.txt", "new"));
  EXPECT_TRUE(fs::is_symlink(folder / "link.txt"));
  EXPECT_EQ(read_text_file(folder / "real.txt").value_or(""), "new");
  fs::remove_all(folder);
}

TEST(AtomicFile, writes_directly_to_what_is_no_regular_file) {
  EXPECT_TRUE(write_text_file("/dev/null", "gone"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(AtomicFile, reports_a_full_disk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "/dev/full is absent";
  const auto written = write_text_file("/dev/full", "text");
  ASSERT_FALSE(written);
  EXPECT_EQ(render(test::failure_of(written)),
            "/dev/full: can't be written: No space left on device");
}

TEST(AtomicFile, says_why_it_cannot_be_written) {
  EXPECT_EQ(render(test::failure_of(write_text_file("/nonexistent/a.txt", ""))),
            "/nonexistent/a.txt: can't be written: No such file or directory");
  EXPECT_EQ(render(test::failure_of(write_text_file("/", ""))),
            "/: can't be written: Is a directory");
}

TEST(ReadTextFile, refuses_a_huge_file) {
  const fs::path folder = empty_folder("huge");
  std::ofstream(folder / "huge.yaml") << std::string((16U << 20U) + 1, '#');
  const auto text = read_text_file(folder / "huge.yaml");
  ASSERT_FALSE(text);
  EXPECT_EQ(test::failure_of(text).what, "the file is too large");
  fs::remove_all(folder);
}

TEST(Nearest, finds_a_misspelt_word) {
  const std::vector<std::string> words{"theta_deg", "theta_rad", "alpha_deg", "d_mm"};
  EXPECT_EQ(nearest("tetha_deg", words), "theta_deg");
  EXPECT_EQ(nearest("alpha_dge", words), "alpha_deg");
  EXPECT_EQ(nearest("d_m", words), "d_mm");
  EXPECT_EQ(nearest("payload", words), "");
  EXPECT_EQ(nearest(std::string(10000, 'd'), words), "");
}

TEST(Numbers, are_read_whole_or_not_at_all) {
  EXPECT_EQ(parse_number("-1.5e-3"), -1.5e-3);
  EXPECT_EQ(parse_number("+1"), 1.0);
  EXPECT_EQ(parse_number("4.9406564584124654e-324"), 4.9406564584124654e-324);
  for (const char* text : {"", "+", "-", "+-1", "1 ", " 1", "1,5", "1e", "1x", "nan", "inf",
                           "1e999", "--1", "0x1p3", "1_000"}) {
    EXPECT_FALSE(parse_number(text)) << text;
  }
}

TEST(InQuotes, clips_long_text_and_shows_bytes) {
  EXPECT_EQ(in_quotes("Größe"), "\"Größe\"");
  EXPECT_EQ(in_quotes("a\x1b[31m"), "\"a\\x1B[31m\"");
  const auto clipped = [](std::size_t letters) {
    return std::string("\"").append(letters, 'a').append("...\"");
  };
  EXPECT_EQ(in_quotes(std::string(39, 'a').append("ß")), clipped(39));
  EXPECT_EQ(in_quotes(std::string(50, 'a')), clipped(40));
}

TEST(Lists, have_commas_but_before_the_last) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(all_of(Words{}), "");
  EXPECT_EQ(all_of(Words{"1"}), "1");
  EXPECT_EQ(all_of(Words{"1", "2"}), "1 and 2");
  EXPECT_EQ(all_of(Words{"1", "2", "3"}), "1, 2 and 3");
  EXPECT_EQ(any_of(Words{"1", "2", "3"}), "1, 2 or 3");
}

TEST(Render, leaves_out_what_does_not_apply) {
  EXPECT_EQ(render({"f", 0, 0, "bad", ""}), "f: bad");
  EXPECT_EQ(render({"f", 3, 0, "bad", "good"}), "f:3: bad; expected good");
  EXPECT_EQ(render({"f", 3, 4, "bad", "good"}), "f:3:4: bad; expected good");
}

}  // namespace
}  // namespace armsig::tool
