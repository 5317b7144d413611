// SPDX-License-Identifier: MIT
// What checks have shown, in the file beside the store: whole or not at all, and never waited for.
#include "firmware/linux/check_file.hpp"

#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "firmware/controller/check_image.hpp"
#include "host_tests/cli/files.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/unit_daemon/virtual_daemon.hpp"

namespace armsig::daemon {
namespace {

using cli::Folder;
using controller::CheckState;
using controller::CheckSubject;
using controller::Recalled;

constexpr CheckSubject kSubject{.record_crc = 1, .poses_crc = 2};

CheckState learnt(int checks) {
  CheckState state;
  state.sequence = 3;
  state.identified_at_s = 4;
  state.learnt = checks;
  for (auto& mean : state.reference) {
    for (int i = 0; i < checks; ++i) mean.add({1e-5, 2e-5, 3e-5});
  }
  return state;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(CheckFile, has_what_was_kept_last_and_nothing_at_first) {
  const Folder folder;
  CheckFile file((folder / "store").string());
  CheckState state = learnt(0);
  ASSERT_EQ(file.read(kSubject, state).value(), Recalled::kNothing);
  ASSERT_TRUE(file.write(kSubject, learnt(5)));
  ASSERT_TRUE(file.write(kSubject, learnt(6)));
  ASSERT_EQ(CheckFile((folder / "store").string()).read(kSubject, state).value(),
            Recalled::kEverything);
  EXPECT_EQ(state.learnt, 6);
  EXPECT_FALSE(std::filesystem::exists(folder / "store.checks.new"));
}

TEST(CheckFile, cut_at_any_byte_or_longer_is_refused) {
  const Folder folder;
  CheckFile file((folder / "store").string());
  ASSERT_TRUE(file.write(kSubject, learnt(5)));
  const std::string whole = bytes_of(folder / "store.checks");
  ASSERT_EQ(whole.size(), controller::kCheckImageBytes);
  for (std::size_t bytes = 0; bytes <= whole.size() + 1; ++bytes) {
    if (bytes == whole.size()) continue;
    std::string changed = whole;
    changed.resize(bytes);
    cli::write_file(folder / "store.checks", changed);
    CheckState state = learnt(0);
    EXPECT_EQ(test::failure_of(file.read(kSubject, state)), Error::kRecordCorrupt) << bytes;
    EXPECT_EQ(state.learnt, 0);
  }
}

TEST(CheckFile, that_was_begun_and_not_ended_leaves_the_one_before) {
  const Folder folder;
  CheckFile file((folder / "store").string());
  ASSERT_TRUE(file.write(kSubject, learnt(5)));
  cli::write_file(folder / "store.checks.new", "half");
  CheckState state = learnt(0);
  ASSERT_EQ(file.read(kSubject, state).value(), Recalled::kEverything);
  EXPECT_EQ(state.learnt, 5);
  ASSERT_TRUE(file.write(kSubject, learnt(6)));
  EXPECT_FALSE(std::filesystem::exists(folder / "store.checks.new"));
}

TEST(CheckFile, that_cannot_be_written_keeps_the_one_before) {
  const Folder folder;
  CheckFile file((folder / "store").string());
  ASSERT_TRUE(file.write(kSubject, learnt(5)));
  // A folder of that name is not unlinked, not opened for writing.
  std::filesystem::create_directory(folder / "store.checks.new");
  EXPECT_EQ(test::failure_of(file.write(kSubject, learnt(6))), Error::kStorageFault);
  CheckState state = learnt(0);
  ASSERT_EQ(file.read(kSubject, state).value(), Recalled::kEverything);
  EXPECT_EQ(state.learnt, 5);
  EXPECT_EQ(test::failure_of(CheckFile("/nowhere/store").write(kSubject, learnt(1))),
            Error::kStorageFault);
}

TEST(CheckFile, that_is_no_file_is_refused_at_once) {
  const Folder folder;
  CheckFile file((folder / "store").string());
  CheckState state = learnt(0);
  ASSERT_EQ(::mkfifo((folder / "store.checks").c_str(), 0600), 0);
  EXPECT_FALSE(file.read(kSubject, state));
  std::filesystem::remove(folder / "store.checks");
  cli::write_file(folder / "elsewhere", "x");
  std::filesystem::create_symlink(folder / "elsewhere", folder / "store.checks");
  EXPECT_EQ(test::failure_of(file.read(kSubject, state)), Error::kStorageFault);
  // And what is kept takes its place, not the place of what it points to.
  ASSERT_TRUE(file.write(kSubject, learnt(5)));
  EXPECT_EQ(bytes_of(folder / "elsewhere"), "x");
  EXPECT_EQ(file.read(kSubject, state).value(), Recalled::kEverything);
}

void power_up(cli::VirtualDaemon& daemon) {
  ASSERT_TRUE(daemon.is_in("idle"));
  ASSERT_EQ(daemon.ask("enable"), "ok");
  ASSERT_TRUE(daemon.is_in("holding"));
}

// The learnt= of the next check.
std::string next_check(cli::VirtualDaemon& daemon) {
  if (daemon.ask("check") != "ok") return "refused";
  while (const auto line = daemon.told(std::chrono::seconds(60))) {
    if (line->starts_with("# check verdict=")) return line->substr(line->rfind(" learnt="));
  }
  return "silent";
}

TEST(CheckFile, of_armsigd_outlives_a_kill_and_is_named_where_it_is_torn) {
  const Folder folder;
  cli::VirtualDaemon daemon(folder);
  power_up(daemon);
  ASSERT_EQ(daemon.ask("identify"), "ok");
  ASSERT_TRUE(daemon.hear("# identify done"));
  ASSERT_TRUE(daemon.is_in("holding"));
  ASSERT_EQ(daemon.ask("accept"), "ok");
  EXPECT_EQ(next_check(daemon), " learnt=1 of=20");
  daemon.end(SIGKILL);
  daemon.start();
  power_up(daemon);
  EXPECT_EQ(next_check(daemon), " learnt=2 of=20");
  EXPECT_EQ(daemon.end(SIGTERM), 0);
  cli::write_file(folder / "store.checks", bytes_of(folder / "store.checks").substr(0, 500));
  daemon.start();
  power_up(daemon);
  ASSERT_EQ(daemon.ask("check"), "ok");
  EXPECT_TRUE(daemon.hear("# check history unused error=RECORD_CORRUPT"));
  const auto verdict = daemon.hear("# check verdict=\"as accepted\"");
  ASSERT_TRUE(verdict);
  EXPECT_TRUE(verdict->ends_with(" learnt=1 of=20")) << *verdict;
}

}  // namespace
}  // namespace armsig::daemon
