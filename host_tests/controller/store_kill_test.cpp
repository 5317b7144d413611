// SPDX-License-Identifier: MIT
// kill -9 in the middle of a store, a few hundred times: what was committed before, or what was
// being committed, is there afterwards.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/controller/signature_store.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/linux/file_memory.hpp"

namespace armsig::controller {
namespace {

constexpr hal::MemoryLayout kLayout{.page_bytes = 256, .pages_per_sector = 8, .sectors = 10};
constexpr int kKills = 250;

SignatureRecord record_of(int robot) {
  const KnownTarget target{1, 6, Vector3(0.1, 0.2, 0.3)};
  SignatureRecord record;
  record.signature = signature_of(tool::table2_robot(robot), JointVector{0, -1, 1, 0.5, 0.2, 0},
                                  Pose{rotation_x(0.3), Vector3(1, 2, 3)}, {&target, 1});
  return record;
}

// Stores one record after the other until it is killed; tells the number of each that is committed.
[[noreturn]] void store_for_ever(const std::string& path, int told) {
  auto memory = linux_hal::FileMemory::open(path, kLayout);
  SignatureRecord found;
  if (!memory) _exit(1);
  SignatureStore store(*memory);
  (void)store.load(tool::puma560(), found);
  const std::array<SignatureRecord, 2> records{record_of(1), record_of(2)};
  std::uint32_t sequence = found.sequence;
  for (;;) {
    store.begin_write(records[sequence % 2]);
    Result<bool> done = false;
    while (done && !*done) done = store.step();
    if (!done) _exit(2);
    ++sequence;
    if (::write(told, &sequence, sizeof sequence) != sizeof sequence) _exit(3);
  }
}

TEST(StoreKilled, has_the_committed_record_or_the_next_one_at_every_moment) {
  std::string folder = std::filesystem::temp_directory_path() / "armsig_kill_XXXXXX";
  ASSERT_NE(::mkdtemp(folder.data()), nullptr);
  const std::string path = folder + "/signatures";
  {
    ASSERT_TRUE(linux_hal::FileMemory::open(path, kLayout));
  }
  std::mt19937 random(3);
  std::uint32_t committed = 0;
  std::uint32_t in_the_middle = 0;
  // Kills come at any moment of a store where a third of them let one be told, however slow the
  // machine is.
  double longest_us = 8000;
  for (int kill = 0; kill < kKills; ++kill) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe(pipe.data()), 0);
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) store_for_ever(path, pipe[1]);
    ::close(pipe[1]);
    const auto latest_us = static_cast<std::uint32_t>(longest_us);
    std::this_thread::sleep_for(std::chrono::microseconds(random() % latest_us));
    ::kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status)) << WEXITSTATUS(status);
    longest_us *= 1.05;
    for (std::uint32_t told = 0; ::read(pipe[0], &told, sizeof told) == sizeof told;) {
      if (told != committed) longest_us *= 0.86;
      committed = told;
    }
    longest_us = std::clamp(longest_us, 1e3, 1e6);
    ::close(pipe[0]);

    auto memory = linux_hal::FileMemory::open(path, kLayout);
    ASSERT_TRUE(memory) << describe(memory.error());
    SignatureStore store(*memory);
    SignatureRecord found;
    const auto loaded = store.load(tool::puma560(), found);
    if (committed == 0 && !loaded) continue;  // killed before the first was done
    ASSERT_TRUE(loaded) << "kill " << kill << ": " << describe(loaded.error());
    ASSERT_TRUE(found.sequence == committed || found.sequence == committed + 1)
        << found.sequence << " after " << committed;
    if (found.sequence != committed) ++in_the_middle;
    SignatureRecord expected = record_of(found.sequence % 2 == 1 ? 1 : 2);
    expected.sequence = found.sequence;
    ASSERT_EQ(encode(found), encode(expected));
    committed = found.sequence;
  }
  std::printf("%d kills, %u records committed, %u of them not told any more\n", kKills, committed,
              in_the_middle);
  EXPECT_GT(committed, 0U);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace armsig::controller
