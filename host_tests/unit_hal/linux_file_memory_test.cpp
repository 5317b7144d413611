// SPDX-License-Identifier: MIT
#include <signal.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/linux/file_memory.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::linux_hal {
namespace {

constexpr hal::MemoryLayout kLayout{.page_bytes = 256, .pages_per_sector = 16, .sectors = 2};

struct Folder {
  Folder() : path(testing::TempDir() + "file_memory_XXXXXX") {
    EXPECT_NE(mkdtemp(path.data()), nullptr);
  }
  ~Folder() { (void)std::system(("rm -rf '" + path + "'").c_str()); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file() const { return path + "/store"; }
  std::string path;
};

std::array<std::uint8_t, 256> page_of(std::uint8_t value) {
  std::array<std::uint8_t, 256> page{};
  page.fill(value);
  return page;
}

TEST(FileMemory, is_made_erased_and_whole) {
  const Folder folder;
  auto memory = FileMemory::open(folder.file(), kLayout);
  ASSERT_TRUE(memory);
  std::vector<std::uint8_t> all(kLayout.bytes());
  ASSERT_TRUE(memory->read(0, all));
  EXPECT_TRUE(std::ranges::all_of(all, [](std::uint8_t byte) { return byte == 0xFF; }));
  EXPECT_NE(access((folder.file() + ".new").c_str(), F_OK), 0);
}

TEST(FileMemory, keeps_a_page_over_a_restart) {
  const Folder folder;
  ASSERT_TRUE(FileMemory::open(folder.file(), kLayout)->program_page(512, page_of(0x5A)));
  auto memory = FileMemory::open(folder.file(), kLayout);
  ASSERT_TRUE(memory);
  std::array<std::uint8_t, 256> page{};
  ASSERT_TRUE(memory->read(512, page));
  EXPECT_EQ(page, page_of(0x5A));
  ASSERT_TRUE(memory->read(256, page));
  EXPECT_EQ(page, page_of(0xFF));
}

TEST(FileMemory, refuses_to_program_a_page_twice_until_it_is_erased) {
  const Folder folder;
  auto memory = FileMemory::open(folder.file(), kLayout);
  ASSERT_TRUE(memory);
  ASSERT_TRUE(memory->program_page(0, page_of(1)));
  EXPECT_EQ(test::failure_of(memory->program_page(0, page_of(1))), Error::kNotErased);
  ASSERT_TRUE(memory->erase_sector(0));
  EXPECT_TRUE(memory->program_page(0, page_of(2)));
}

TEST(FileMemory, erases_one_sector_only) {
  const Folder folder;
  auto memory = FileMemory::open(folder.file(), kLayout);
  ASSERT_TRUE(memory);
  ASSERT_TRUE(memory->program_page(0, page_of(1)));
  ASSERT_TRUE(memory->program_page(4096, page_of(2)));
  ASSERT_TRUE(memory->erase_sector(0));
  std::array<std::uint8_t, 256> page{};
  ASSERT_TRUE(memory->read(0, page));
  EXPECT_EQ(page, page_of(0xFF));
  ASSERT_TRUE(memory->read(4096, page));
  EXPECT_EQ(page, page_of(2));
}

TEST(FileMemory, refuses_a_second_user_of_the_file) {
  const Folder folder;
  const auto memory = FileMemory::open(folder.file(), kLayout);
  ASSERT_TRUE(memory);
  EXPECT_EQ(test::failure_of(FileMemory::open(folder.file(), kLayout)), Error::kSystemRefused);
}

TEST(FileMemory, refuses_a_file_of_another_size_and_layouts_that_cannot_be_kept_whole) {
  const Folder folder;
  std::ofstream(folder.file()) << "short";
  const auto other = FileMemory::open(folder.file(), kLayout);
  ASSERT_FALSE(other);
  EXPECT_EQ(test::failure_of(other), Error::kStorageLayout);
  EXPECT_EQ(test::failure_of(FileMemory::open(folder.path + "/other", {})),
            Error::kAddressOutOfRange);
  EXPECT_EQ(test::failure_of(FileMemory::open(folder.path + "/other", {300, 1, 1})),
            Error::kAddressOutOfRange);
}

TEST(FileMemory, refuses_a_folder_that_does_not_exist) {
  EXPECT_EQ(test::failure_of(FileMemory::open("/nonexistent/store", kLayout)),
            Error::kStorageFault);
}

TEST(FileMemory, meets_a_full_disk_when_it_is_made_and_leaves_nothing) {
  if (geteuid() != 0) GTEST_SKIP() << "mounting a small disk needs root";
  const Folder folder;
  if (mount("none", folder.path.c_str(), "tmpfs", 0, "size=64k") != 0) {
    GTEST_SKIP() << "a small disk cannot be mounted here";
  }
  const hal::MemoryLayout too_large{.page_bytes = 4096, .pages_per_sector = 16, .sectors = 2};
  EXPECT_EQ(test::failure_of(FileMemory::open(folder.file(), too_large)), Error::kStorageFull);
  EXPECT_NE(access(folder.file().c_str(), F_OK), 0);
  EXPECT_NE(access((folder.file() + ".new").c_str(), F_OK), 0);
  auto memory = FileMemory::open(folder.file(), kLayout);
  ASSERT_TRUE(memory);
  (void)std::system(("head -c 65536 /dev/zero > '" + folder.path + "/filler' 2>/dev/null").c_str());
  EXPECT_TRUE(memory->program_page(0, page_of(7)));
  memory = std::unexpected(Error::kStorageFault);
  EXPECT_EQ(umount(folder.path.c_str()), 0);
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  return names;
}

TEST(FileMemory, is_made_without_following_a_link_that_lies_in_its_way) {
  const Folder folder;
  const std::string victim = folder.path + "/victim";
  std::ofstream(victim) << "precious";
  ASSERT_EQ(symlink(victim.c_str(), (folder.file() + ".new").c_str()), 0);
  ASSERT_TRUE(FileMemory::open(folder.file(), kLayout));
  // A link that leads nowhere is not filled either.
  const std::string nowhere = folder.path + "/nowhere";
  ASSERT_EQ(symlink(nowhere.c_str(), (folder.path + "/dangling").c_str()), 0);
  EXPECT_FALSE(FileMemory::open(folder.path + "/dangling", kLayout));
  EXPECT_NE(access(nowhere.c_str(), F_OK), 0);
  std::string kept;
  std::ifstream(victim) >> kept;
  EXPECT_EQ(kept, "precious");
}

// Two processes find no file and make one, at once: one gets it, and what it writes stays.
TEST(FileMemory, of_two_first_starts_neither_loses_a_page) {
  for (int trial = 0; trial < 40; ++trial) {
    const Folder folder;
    std::array<pid_t, 2> children{};
    for (pid_t& child : children) {
      child = fork();
      ASSERT_GE(child, 0);
      if (child == 0) {
        auto memory = FileMemory::open(folder.file(), kLayout);
        if (!memory) _exit(memory.error() == Error::kSystemRefused ? 1 : 2);
        const bool kept = memory->program_page(0, page_of(0x5A)).has_value();
        usleep(2000);
        _exit(kept ? 0 : 3);
      }
    }
    int used = 0;
    for (const pid_t child : children) {
      int status = 0;
      ASSERT_EQ(waitpid(child, &status, 0), child);
      ASSERT_TRUE(WIFEXITED(status));
      // The second may come when the first has gone: then it finds the page.
      EXPECT_TRUE(WEXITSTATUS(status) != 2) << "trial " << trial;
      if (WEXITSTATUS(status) == 0) ++used;
    }
    EXPECT_EQ(used, 1) << "trial " << trial;
    auto memory = FileMemory::open(folder.file(), kLayout);
    ASSERT_TRUE(memory);
    std::array<std::uint8_t, 256> page{};
    ASSERT_TRUE(memory->read(0, page));
    EXPECT_EQ(page, page_of(0x5A)) << "trial " << trial;
    EXPECT_EQ(names_in(folder.path), std::vector<std::string>{"store"});
  }
}

TEST(FileMemory, refuses_a_change_of_a_file_that_was_removed_or_replaced) {
  const Folder folder;
  auto memory = FileMemory::open(folder.file(), kLayout);
  ASSERT_TRUE(memory);
  ASSERT_TRUE(memory->program_page(0, page_of(1)));
  ASSERT_EQ(unlink(folder.file().c_str()), 0);
  for (const bool replaced : {false, true}) {
    if (replaced) std::ofstream(folder.file()) << std::string(kLayout.bytes(), '\xFF');
    const auto programmed = memory->program_page(replaced ? 256 : 512, page_of(2));
    ASSERT_FALSE(programmed);
    EXPECT_EQ(test::failure_of(programmed), Error::kStorageReplaced);
    const auto erased = memory->erase_sector(1);
    ASSERT_FALSE(erased);
    EXPECT_EQ(test::failure_of(erased), Error::kStorageReplaced);
  }
}

// Groups of two sectors, 4 MiB apart on a device that the file has to itself.
TEST(FileMemory, lays_groups_of_sectors_apart_and_reads_across_them) {
  constexpr hal::MemoryLayout kSpreadLayout{.page_bytes = 256, .pages_per_sector = 8, .sectors = 5};
  constexpr std::size_t kStride = std::size_t{1} << 20U;
  const Folder folder;
  {
    auto memory = FileMemory::open(folder.file(), kSpreadLayout, {2, kStride});
    ASSERT_TRUE(memory);
    ASSERT_TRUE(memory->program_page(4096 - 256, page_of(1)));
    ASSERT_TRUE(memory->program_page(4096, page_of(2)));
    std::array<std::uint8_t, 512> both{};
    ASSERT_TRUE(memory->read(4096 - 256, both));
    EXPECT_EQ(both[0], 1);
    EXPECT_EQ(both[511], 2);
  }
  EXPECT_EQ(std::filesystem::file_size(folder.file()), 2 * kStride + 2048);
  std::ifstream file(folder.file(), std::ios::binary);
  file.seekg(kStride);
  EXPECT_EQ(file.get(), 2);
  EXPECT_EQ(test::failure_of(FileMemory::open(folder.file(), kSpreadLayout, {2, 100})),
            Error::kAddressOutOfRange);
  struct stat status{};
  ASSERT_EQ(stat(folder.file().c_str(), &status), 0);
  EXPECT_GE(static_cast<std::size_t>(status.st_blocks) * 512, 2 * kStride) << "not allocated";
}

// The child writes pages of one value each, over and over, until it is killed at some moment.
TEST(FileMemory, a_page_is_old_or_new_after_a_kill_at_any_moment) {
  const Folder folder;
  ASSERT_TRUE(FileMemory::open(folder.file(), kLayout));
  for (int trial = 0; trial < 60; ++trial) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      auto memory = FileMemory::open(folder.file(), kLayout);
      for (std::uint8_t value = 0; memory; value = static_cast<std::uint8_t>((value + 1) % 100)) {
        (void)memory->erase_sector(0);
        for (std::size_t page = 0; page < 16; ++page) {
          (void)memory->program_page(256 * page, page_of(value));
        }
      }
      _exit(1);
    }
    usleep(static_cast<useconds_t>(500 + 137 * trial));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    auto memory = FileMemory::open(folder.file(), kLayout);
    ASSERT_TRUE(memory);
    for (std::size_t at = 0; at < kLayout.bytes(); at += 256) {
      std::array<std::uint8_t, 256> page{};
      ASSERT_TRUE(memory->read(at, page));
      EXPECT_EQ(page, page_of(page[0])) << "page at " << at << " is torn";
    }
  }
}

}  // namespace
}  // namespace armsig::linux_hal
