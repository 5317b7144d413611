// SPDX-License-Identifier: MIT
// A short life of the daemon's store, console and controller in virtual time, once for each of its
// system calls, which then fails: either it is told by name, or it does not matter; what was told
// as done is stored, nothing leaks, and the next life is as if nothing had been.
#include "host_tests/support/failing_calls.hpp"

#include <sys/un.h>

#include <array>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error_name.hpp"
#include "core/identification.hpp"
#include "firmware/controller/signature_store.hpp"
#include "firmware/linux/daemon.hpp"
#include "firmware/virtual_cabinet/virtual_cabinet.hpp"
#include "hal/linux/file_memory.hpp"
#include "hal/linux/socket_console.hpp"
#include "host_tests/support/puma_cabinet.hpp"

#if !defined(__SANITIZE_ADDRESS__)

namespace armsig::daemon {
namespace {

using controller::Mode;
using test::CountedCalls;
using test::failing_calls;

std::ptrdiff_t open_files() {
  return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {});
}

// An operator's end of the console; its calls do not count.
class Operator {
 public:
  explicit Operator(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): the interface of sockets
    EXPECT_EQ(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~Operator() { ::close(socket_); }
  Operator(const Operator&) = delete;
  Operator& operator=(const Operator&) = delete;
  void say(const std::string& line) {
    (void)::send(socket_, line.data(), line.size(), MSG_NOSIGNAL);
  }
  // The next reply that is here; "gone" where the connection ended.
  std::optional<std::string> reply() {
    std::array<char, 4096> some{};
    const ssize_t count = ::recv(socket_, some.data(), some.size(), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN)) return "gone";
    if (count > 0) heard_.append(some.data(), static_cast<std::size_t>(count));
    while (true) {
      const std::size_t end = heard_.find('\n');
      if (end == std::string::npos) return std::nullopt;
      const std::string line = heard_.substr(0, end);
      heard_.erase(0, end + 1);
      if (!line.starts_with("#")) return line;
    }
  }

 private:
  int socket_;
  std::string heard_;
};

struct Life {
  std::optional<Error> refused;  // where it never began
  std::string rollback;          // the replies
  std::string enable;
  std::string disable;
  std::string signature;
};

class FailingCalls : public testing::Test {
 protected:
  void SetUp() override {
    std::string made = (std::filesystem::temp_directory_path() / "armsig-calls-XXXXXX").string();
    ASSERT_NE(::mkdtemp(made.data()), nullptr);
    folder_ = made;
    store_two_records(folder_ / "two");
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static void store_two_records(const std::string& path) {
    auto memory = linux_hal::FileMemory::open(path, kStoreLayout, kStoreSpread);
    ASSERT_TRUE(memory);
    controller::SignatureStore store(*memory);
    controller::SignatureRecord found;
    (void)store.load(tool::puma560(), found);
    // What the emulated drives tell of themselves, but for their numbers.
    controller::Machine machine{.drives = {},
                                .drawing_crc = controller::drawing_crc(tool::puma560())};
    for (int joint = 0; joint < 6; ++joint) {
      machine.drives.push_back({.counts_per_revolution = 4000, .gear_ratio = 100});
    }
    const KnownTarget target{1, 6, Vector3(0.15, 0, 0.05)};
    for (const int robot : {1, 2}) {
      controller::SignatureRecord record;
      record.signature = signature_of(tool::table2_robot(robot), test::puma_configuration(),
                                      simulated::demo_base_pose(), {&target, 1});
      record.machine = machine;
      store.begin_write(record);
      Result<bool> done = false;
      while (done && !*done) done = store.step();
      ASSERT_TRUE(done);
    }
  }

  // Starts on what the store holds, goes back to the record before where `changes`, enables,
  // disables, ends.
  Life live(bool changes) {
    Life life;
    const std::string at = (folder_ / "console").string();
    const CountedCalls counted;
    auto memory =
        linux_hal::FileMemory::open((folder_ / "store").string(), kStoreLayout, kStoreSpread);
    if (!memory) {
      life.refused = memory.error();
      return life;
    }
    auto console = linux_hal::SocketConsole::open(at);
    if (!console) {
      life.refused = console.error();
      return life;
    }
    serve(life, *memory, **console, at, changes);
    return life;
  }
  static void serve(Life& life, hal::NonvolatileMemory& memory, hal::Console& console,
                    const std::string& at, bool changes) {
    const std::array<hal::Console*, 1> consoles{&console};
    const controller::Configuration configuration = test::puma_controller();
    cabinet::World world = test::puma_world();
    world.drive.emplace();
    cabinet::VirtualCabinet cabinet(configuration, test::puma_bus(), world, memory, consoles);
    const auto run_to = [&](Mode mode) {
      for (int i = 0; i < 2000 && cabinet.state().snapshot().mode != mode; ++i) cabinet.step();
    };
    run_to(Mode::kIdle);
    failing_calls.counting = false;
    Operator operates(at);
    const auto ask = [&](const std::string& request) -> std::string {
      failing_calls.counting = false;
      operates.say(request + "\n");
      for (int i = 0; i < 500; ++i) {
        failing_calls.counting = true;
        cabinet.step();
        failing_calls.counting = false;
        if (auto reply = operates.reply()) return *reply;
      }
      return "silent";
    };
    if (changes) life.rollback = ask("rollback");
    life.enable = ask("enable");
    failing_calls.counting = true;
    run_to(Mode::kHolding);
    life.disable = ask("disable");
    failing_calls.counting = true;
    for (int i = 0; i < 500; ++i) cabinet.step();
    failing_calls.counting = false;
    life.signature = ask("signature");
    EXPECT_FALSE(cabinet.state().snapshot().fault) << failing_calls.failed;
  }
  Life live_failing(long n, bool changes) {
    failing_calls = {.counting = false, .failing = n, .calls = 0};
    Life life = live(changes);
    failing_calls.failing = 0;
    return life;
  }
  static bool is_answer(const std::string& reply) {
    return reply == "gone" || reply == "silent" || reply.starts_with("ok") ||
           reply.starts_with("error ");
  }
  // The next life has the record `sequences` allows, and nothing is left beside the store.
  void expect_whole(const std::string& sequences, const std::string& where) {
    const Life next = live_failing(0, false);
    ASSERT_FALSE(next.refused) << where << ": " << name(*next.refused);
    EXPECT_EQ(next.enable, "ok") << where;
    const std::size_t found = next.signature.find(" signature=");
    ASSERT_NE(found, std::string::npos) << where << ": " << next.signature;
    EXPECT_NE(sequences.find(next.signature[found + 11]), std::string::npos)
        << where << ": " << next.signature;
  }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  std::filesystem::path folder_;
};

TEST_F(FailingCalls, of_a_life_with_a_rollback_are_told_or_do_not_matter_and_lose_nothing) {
  const auto begin = [&] {
    std::filesystem::copy_file(folder_ / "two", folder_ / "store",
                               std::filesystem::copy_options::overwrite_existing);
  };
  begin();
  const Life whole = live_failing(0, true);
  const long calls = failing_calls.calls;
  ASSERT_FALSE(whole.refused);
  ASSERT_TRUE(whole.rollback.starts_with("ok")) << whole.rollback;
  ASSERT_GT(calls, 30);
  expect_whole("1", "no call failed");
  const std::ptrdiff_t open_before = open_files();
  int told = 0;
  for (long n = 1; n <= calls; ++n) {
    begin();
    const Life life = live_failing(n, true);
    const std::string where =
        "call " + std::to_string(n) + " of " + std::to_string(calls) + ", " + failing_calls.failed;
    ASSERT_EQ(open_files(), open_before) << where;
    ASSERT_EQ(files(), 2U) << where;
    if (life.refused) {
      ++told;
      EXPECT_FALSE(name(*life.refused).empty());
      expect_whole("2", where);
      continue;
    }
    for (const std::string& reply : {life.rollback, life.enable, life.disable}) {
      EXPECT_TRUE(is_answer(reply)) << where << ": " << reply;
    }
    if (life.rollback.starts_with("error ")) ++told;
    expect_whole(life.rollback.starts_with("ok") ? "1" : "12", where);
  }
  EXPECT_GE(told, 10);
}

TEST_F(FailingCalls, of_the_first_life_leave_no_store_or_a_whole_one) {
  const auto begin = [&] { std::filesystem::remove(folder_ / "store"); };
  begin();
  const Life whole = live_failing(0, false);
  const long calls = failing_calls.calls;
  ASSERT_FALSE(whole.refused);
  const std::ptrdiff_t open_before = open_files();
  int told = 0;
  for (long n = 1; n <= calls; ++n) {
    begin();
    const Life life = live_failing(n, false);
    const std::string where =
        "call " + std::to_string(n) + " of " + std::to_string(calls) + ", " + failing_calls.failed;
    ASSERT_EQ(open_files(), open_before) << where;
    ASSERT_LE(files(), 2U) << where << ": an unfinished store is left";
    if (life.refused) ++told;
    const Life next = live_failing(0, false);
    ASSERT_FALSE(next.refused) << where << ": " << name(*next.refused);
    EXPECT_EQ(next.enable, "ok") << where;
    EXPECT_TRUE(next.signature.starts_with("ok model=nominal")) << where << next.signature;
  }
  EXPECT_GE(told, 8);
}

}  // namespace
}  // namespace armsig::daemon

#endif
