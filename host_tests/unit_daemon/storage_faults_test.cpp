// SPDX-License-Identifier: MIT
// The store of signatures on a device that fails now and then, under a kernel that forgets: after a
// write that failed, pages of its cache count as written that the device never had. Of every
// history what is in use is what is stored, and what was answered with success stays.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/controller/signature_store.hpp"
#include "firmware/linux/daemon.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/linux/file_memory.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::test {
namespace {

template <typename Function>
Function* next_function(const char* name) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): what dlsym is for
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// What lies under the one file that is watched. The file itself is the kernel's cache.
class FailingDevice {
 public:
  // What is written, forgotten or owed as one: a block of the file system.
  static constexpr std::size_t kPage = 512;

  void begin(const std::string& path, std::uint64_t seed) {
    path_ = path;
    struct stat status{};
    ASSERT_EQ(::stat(path.c_str(), &status), 0);
    inode_ = status.st_ino;
    device_.resize(static_cast<std::size_t>(status.st_size));
    dirty_.assign((device_.size() + kPage - 1) / kPage, false);
    cached(device_);
    random_ = simulated::Random(seed);
  }
  void end() { inode_ = 0; }
  // The next sync fails, and the cache forgets what it did not write; or a signal comes.
  void lose_next() { next_ = Next::kLost; }
  void interrupt_next() { next_ = Next::kInterrupted; }

  [[nodiscard]] bool watches(int file) const {
    struct stat status{};
    return inode_ != 0 && ::fstat(file, &status) == 0 && status.st_ino == inode_;
  }
  void written(std::size_t at, std::size_t size) {
    for (std::size_t page = at / kPage; page * kPage < at + size; ++page) dirty_[page] = true;
  }

  // Everything that is dirty reaches the device, or the call fails; then each page may have come
  // there, may be forgotten, or may still be owed.
  int sync(std::size_t first, std::size_t last) {
    const Next next = std::exchange(next_, Next::kByChance);
    if (next == Next::kInterrupted || (next == Next::kByChance && random_.chance(kSignal))) {
      errno = EINTR;
      return -1;
    }
    if (next == Next::kLost) {
      dirty_.assign(dirty_.size(), false);
      forgotten_ = true;
      errno = EIO;
      return -1;
    }
    const bool fails = random_.chance(kFault);
    for (std::size_t page = first; page < std::min(last, dirty_.size()); ++page) {
      if (!dirty_[page]) continue;
      const double fate = fails ? random_.uniform() : 0;
      if (fate < 0.4) reach(page);
      dirty_[page] = fate >= 0.8;
    }
    forgotten_ = forgotten_ || fails;
    if (fails) errno = EIO;
    return fails ? -1 : 0;
  }
  ssize_t read_past_cache(void* into, std::size_t size, std::size_t at) {
    if (std::any_of(dirty_.begin(), dirty_.end(), [](bool dirty) { return dirty; }) &&
        sync(at / kPage, (at + size + kPage - 1) / kPage) != 0) {
      if (errno == EINTR) return -1;
      errno = EIO;
      return -1;
    }
    const std::size_t count = std::min(size, device_.size() - std::min(at, device_.size()));
    std::copy_n(device_.begin() + static_cast<std::ptrdiff_t>(at), count,
                static_cast<std::uint8_t*>(into));
    return static_cast<ssize_t>(count);
  }
  void forget() {
    if (!std::exchange(forgotten_, false)) return;
    std::vector<std::uint8_t> cache(device_.size());
    cached(cache);
    for (std::size_t page = 0; page < dirty_.size(); ++page) {
      if (dirty_[page]) copy(page, cache, device_);
    }
    for (std::size_t page = 0; page < dirty_.size(); ++page) {
      if (!dirty_[page]) put(page);
    }
  }
  // What the device has is all there is.
  void cut_power() {
    dirty_.assign(dirty_.size(), false);
    for (std::size_t page = 0; page < dirty_.size(); ++page) put(page);
  }

 private:
  enum class Next : std::uint8_t { kByChance, kLost, kInterrupted };
  static constexpr double kFault = 0.015;
  static constexpr double kSignal = 0.01;

  void cached(std::vector<std::uint8_t>& bytes) const {
    const int file = next_function<int(const char*, int, ...)>("open")(path_.c_str(), O_RDONLY);
    ASSERT_EQ(next_function<ssize_t(int, void*, size_t, off_t)>("pread")(file, bytes.data(),
                                                                         bytes.size(), 0),
              static_cast<ssize_t>(bytes.size()));
    ::close(file);
  }
  static void copy(std::size_t page, const std::vector<std::uint8_t>& from,
                   std::vector<std::uint8_t>& into) {
    const std::size_t begin = page * kPage;
    const std::size_t count = std::min(kPage, into.size() - begin);
    std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(begin), count,
                into.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  void reach(std::size_t page) {
    std::vector<std::uint8_t> cache(device_.size());
    cached(cache);
    copy(page, cache, device_);
  }
  // The cache has of it what the device has.
  void put(std::size_t page) {
    const int file = next_function<int(const char*, int, ...)>("open")(path_.c_str(), O_WRONLY);
    const std::size_t begin = page * kPage;
    const std::size_t count = std::min(kPage, device_.size() - begin);
    ASSERT_EQ(next_function<ssize_t(int, const void*, size_t, off_t)>("pwrite")(
                  file, device_.data() + begin, count, static_cast<off_t>(begin)),
              static_cast<ssize_t>(count));
    ::close(file);
  }

  std::string path_;
  ino_t inode_ = 0;
  std::vector<std::uint8_t> device_;
  std::vector<bool> dirty_;
  bool forgotten_ =
      false;  // what the cache has of a page that is not dirty may not be the device's
  Next next_ = Next::kByChance;
  simulated::Random random_{1};
};
FailingDevice device;
// As of a file system that has no way past the cache.
bool without_direct = false;

}  // namespace
}  // namespace armsig::test

// NOLINTBEGIN(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp): glibc's names
extern "C" {
int open(const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & (O_CREAT | O_TMPFILE)) != 0) {
    va_list rest;
    va_start(rest, flags);
    mode = va_arg(rest, mode_t);
    va_end(rest);
  }
  if (armsig::test::without_direct && (flags & O_DIRECT) != 0) {
    errno = EINVAL;
    return -1;
  }
  return armsig::test::next_function<int(const char*, int, ...)>("open")(path, flags, mode);
}
ssize_t pread(int file, void* into, size_t size, off_t at) {
  if (armsig::test::device.watches(file) && (::fcntl(file, F_GETFL) & O_DIRECT) != 0) {
    return armsig::test::device.read_past_cache(into, size, static_cast<std::size_t>(at));
  }
  return armsig::test::next_function<ssize_t(int, void*, size_t, off_t)>("pread")(file, into, size,
                                                                                  at);
}
ssize_t __pread_chk(int file, void* into, size_t size, off_t at, size_t /*room*/) {
  return pread(file, into, size, at);
}
ssize_t pwrite(int file, const void* from, size_t size, off_t at) {
  const ssize_t count = armsig::test::next_function<ssize_t(int, const void*, size_t, off_t)>(
      "pwrite")(file, from, size, at);
  if (count > 0 && armsig::test::device.watches(file)) {
    armsig::test::device.written(static_cast<std::size_t>(at), static_cast<std::size_t>(count));
  }
  return count;
}
int fdatasync(int file) {
  if (!armsig::test::device.watches(file)) {
    return armsig::test::next_function<int(int)>("fdatasync")(file);
  }
  return armsig::test::device.sync(0, SIZE_MAX);
}
int posix_fadvise(int file, off_t at, off_t size, int advice) noexcept {
  if (!armsig::test::device.watches(file)) {
    return armsig::test::next_function<int(int, off_t, off_t, int)>("posix_fadvise")(file, at, size,
                                                                                     advice);
  }
  armsig::test::device.forget();
  return 0;
}
}
// NOLINTEND(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)

namespace armsig::controller {
namespace {

using test::device;

SignatureRecord record_of(int number) {
  const KnownTarget target{1, 6, Vector3(0.1, 0.2, 0.3)};
  SignatureRecord record;
  record.signature = signature_of(tool::table2_robot(1 + number % 2),
                                  JointVector{0, -1, 1, 0.5, 0.2, 0}, Pose{}, {&target, 1});
  record.air_celsius = number;
  return record;
}

// A process that has the store open.
struct Process {
  explicit Process(const std::string& path)
      : memory(linux_hal::FileMemory::open(path, daemon::kStoreLayout)) {
    if (memory) store.emplace(*memory);
  }
  // The number of the record in use, -1: none; nothing where the store can't be read.
  std::optional<int> in_use() {
    SignatureRecord found;
    if (!store) return {};
    if (const auto loaded = store->load(tool::puma560(), found)) {
      return static_cast<int>(found.air_celsius);
    } else if (loaded.error() == Error::kNoSignature) {
      return -1;
    }
    return {};
  }

  Result<linux_hal::FileMemory> memory;
  std::optional<SignatureStore> store;
};

struct Count {
  int accepted = 0, refused = 0, unread = 0;
};

// One life of a store: accepts, rollbacks, restarts and power cuts.
void live(const std::string& path, std::uint64_t seed, Count& count) {
  ::unlink(path.c_str());
  {
    ASSERT_TRUE(Process(path).memory);
  }
  ASSERT_NO_FATAL_FAILURE(device.begin(path, seed));
  simulated::Random random(seed + 1'000'000);
  std::optional<Process> process;
  std::optional<int> used;
  const auto start = [&] {
    process.reset();
    process.emplace(path);
    return process->in_use();
  };
  used = start();
  for (int number = 1; number <= 12; ++number) {
    if (used) {
      const bool accepts = *used < 0 || random.chance(0.7);
      Result<bool> done = false;
      if (accepts) {
        process->store->begin_write(record_of(number));
      } else if (const auto begun = process->store->begin_rollback(); !begun) {
        done = std::unexpected(begun.error());
      }
      while (done && !*done) done = process->store->step();
      ++(done ? count.accepted : count.refused);
      // As Commit does: what is stored is what counts.
      used = process->in_use();
      if (done && accepts && used) ASSERT_EQ(*used, number) << "seed " << seed;
    }
    if (!used) ++count.unread;
    const std::optional<int> before = used;
    const double what = random.uniform();
    if (what < 0.6) device.cut_power();
    if (what < 0.9) used = start();
    if (before && used) ASSERT_EQ(*used, *before) << "seed " << seed << " change " << number;
  }
  process.reset();
  device.end();
}

struct Folder {
  Folder() : path(testing::TempDir() + "storage_faults_XXXXXX") {
    EXPECT_NE(::mkdtemp(path.data()), nullptr);
  }
  ~Folder() {
    device.end();
    (void)std::system(("rm -r '" + path + "'").c_str());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string store() const { return path + "/store"; }
  std::string path;
};

class StorageFaults : public testing::TestWithParam<bool> {
 protected:
  void SetUp() override { test::without_direct = !GetParam(); }
  void TearDown() override { test::without_direct = false; }
};
INSTANTIATE_TEST_SUITE_P(PastTheCache, StorageFaults, testing::Bool());

TEST_P(StorageFaults, a_page_that_the_device_never_had_is_not_read) {
  const Folder folder;
  auto memory = linux_hal::FileMemory::open(folder.store(), daemon::kStoreLayout);
  ASSERT_TRUE(memory);
  ASSERT_NO_FATAL_FAILURE(device.begin(folder.store(), 1));
  std::array<std::uint8_t, daemon::kStoreLayout.page_bytes> page{};
  page.fill(0x5A);
  device.lose_next();
  EXPECT_FALSE(memory->program_page(0, page));
  ASSERT_TRUE(memory->read(0, page));
  EXPECT_TRUE(std::ranges::all_of(page, [](auto byte) { return byte == hal::kErasedByte; }));
}

TEST_P(StorageFaults, a_signal_is_no_fault) {
  const Folder folder;
  auto memory = linux_hal::FileMemory::open(folder.store(), daemon::kStoreLayout);
  ASSERT_TRUE(memory);
  ASSERT_NO_FATAL_FAILURE(device.begin(folder.store(), 1));
  std::array<std::uint8_t, daemon::kStoreLayout.page_bytes> page{};
  device.interrupt_next();
  EXPECT_TRUE(memory->program_page(0, page));
}

TEST_P(StorageFaults, what_is_in_use_is_what_a_power_cut_leaves) {
  const Folder folder;
  Count count;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    ASSERT_NO_FATAL_FAILURE(live(folder.store(), seed, count));
  }
  EXPECT_GT(count.accepted, 300);
  EXPECT_GT(count.refused, 100);
  std::printf("%d accepted, %d refused, %d times unread\n", count.accepted, count.refused,
              count.unread);
}

}  // namespace
}  // namespace armsig::controller
