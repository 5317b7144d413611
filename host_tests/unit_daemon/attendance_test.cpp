// SPDX-License-Identifier: MIT
// What attends the controller: log, service manager, the order of the end.
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "firmware/controller/verbs.hpp"
#include "firmware/linux/asking_console.hpp"
#include "firmware/linux/journal_console.hpp"
#include "firmware/linux/real_time_loop.hpp"
#include "firmware/linux/service_manager.hpp"
#include "hal/linux/socket_console.hpp"
#include "hal/linux/steady_clock.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::daemon {
namespace {

using std::chrono::milliseconds;

// What a journal writes to standard error within `use`.
template <typename F>
std::string log_of(const F& use) {
  testing::internal::CaptureStderr();
  {
    Journal journal;
    use(journal);
  }
  return testing::internal::GetCapturedStderr();
}

TEST(Journal, writes_lines_in_order_and_all_of_them_at_its_end) {
  EXPECT_EQ(log_of([](Journal& journal) {
              journal.begin([] {});
              journal.say(Priority::kNotice, "one");
              journal.say(Priority::kError, "two");
            }),
            "armsigd: one\narmsigd: two\n");
}

TEST(Journal, tells_a_chore_that_fails_once_and_goes_on) {
  std::atomic<int> chores = 0;
  const std::string log = log_of([&chores](Journal& journal) {
    journal.begin([&chores] {
      if (++chores < 3) throw std::bad_alloc();
    });
    while (chores < 4) std::this_thread::yield();
    journal.say(Priority::kNotice, "later");
  });
  EXPECT_EQ(log, "armsigd: beside the controller: std::bad_alloc\narmsigd: later\n");
}

TEST(Journal, tells_the_journal_of_systemd_how_grave_each_line_is) {
  testing::internal::CaptureStderr();
  struct stat status{};
  ASSERT_EQ(::fstat(STDERR_FILENO, &status), 0);
  const std::string stream = std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino);
  ::setenv("JOURNAL_STREAM", stream.c_str(), 1);
  {
    Journal journal;
    journal.tell(Priority::kError, "faulted");
    journal.tell(Priority::kInfo, "progress");
  }
  ::setenv("JOURNAL_STREAM", "1:1", 1);  // of another stream, which a redirection replaced
  {
    Journal journal;
    journal.tell(Priority::kError, "faulted");
  }
  ::unsetenv("JOURNAL_STREAM");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "<3>faulted\n<6>progress\narmsigd: faulted\n");
}

// What a pipe holds, whose reads do not wait.
std::string all_of(int pipe) {
  std::string text;
  std::array<char, 4096> bytes{};
  for (ssize_t size = 0; (size = ::read(pipe, bytes.data(), bytes.size())) > 0;) {
    text.append(bytes.data(), static_cast<std::size_t>(size));
  }
  return text;
}

TEST(Journal, whose_reader_is_stuck_holds_nobody_up_and_counts_what_is_lost) {
  int ends[2]{};
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
  const std::string block(65536, 'x');
  while (::write(ends[1], block.data(), block.size()) > 0) {
  }
  while (::write(ends[1], "x", 1) > 0) {
  }
  ASSERT_EQ(::fcntl(ends[1], F_SETFL, 0), 0);  // a write would wait
  const int kept = ::dup(STDERR_FILENO);
  ::dup2(ends[1], STDERR_FILENO);
  hal::Duration longest{};
  std::string text;
  {
    Journal journal;
    journal.begin([] {});
    const hal::Instant before = linux_hal::monotonic_now();
    for (int i = 0; i < 1000; ++i) journal.say(Priority::kNotice, "mode");
    longest = linux_hal::monotonic_now() - before;
    text += all_of(ends[0]);  // with what is written meanwhile
    journal.end();
  }
  ::dup2(kept, STDERR_FILENO);
  ::close(kept);
  text += all_of(ends[0]);
  text.erase(0, text.find_first_not_of('x'));
  ::close(ends[0]);
  ::close(ends[1]);
  EXPECT_LT(longest, milliseconds(500));
  EXPECT_TRUE(text.starts_with("armsigd: mode\n")) << text.substr(0, 80);
  EXPECT_NE(text.find(" lines of the log were lost\n"), std::string::npos);
}

TEST(JournalConsole, logs_commands_answers_and_what_the_controller_says_but_no_questions) {
  test::LineConsole person;
  const std::string log = log_of([&](Journal& journal) {
    JournalConsole logged(person, journal);
    hal::Console& console = logged;
    for (const char* request : {"status", "move q1_deg=10", "log row=3"}) {
      person.requests.emplace_back(request);
      EXPECT_EQ(console.read_line()->text(), request);
    }
    (void)console.write_line(1, "ok mode=holding");
    (void)console.write_line(1, "ok");
    (void)console.write_line(1, "ok place=A1 at_place=1 touches=1");
    (void)console.write_line(1, "error WRONG_MODE the present mode does not allow it");
    console.broadcast("# mode faulted error=DRIVE_EMERGENCY joint=4 code=0x2310");
  });
  EXPECT_EQ(log,
            "armsigd: console 1: move q1_deg=10\n"
            "armsigd: console 1 is answered: ok\n"
            "armsigd: console 1 is answered: ok place=A1 at_place=1 touches=1\n"
            "armsigd: console 1 is answered: error WRONG_MODE the present mode does not allow it\n"
            "armsigd: mode faulted error=DRIVE_EMERGENCY joint=4 code=0x2310\n");
  EXPECT_EQ(person.replies.size(), 4U);
  EXPECT_EQ(person.told.size(), 1U);
}

TEST(AskingConsole, passes_on_what_changes_nothing_with_its_replies_and_what_is_said_unasked) {
  test::LineConsole reporter;
  const std::string log = log_of([&](Journal& journal) {
    AskingConsole asking(reporter, journal);
    hal::Console& console = asking;
    for (const char* request :
         {"status", "signature", "fetch what=signature part=1", "log row=3", "system", "touches"}) {
      reporter.requests.emplace_back(request);
      const auto line = console.read_line();
      ASSERT_TRUE(line) << request;
      EXPECT_EQ(line->text(), request);
      (void)console.write_line(line->client, request);
    }
    console.broadcast("# mode holding");
  });
  EXPECT_EQ(log, "");
  EXPECT_EQ(reporter.replies.size(), 6U);
  EXPECT_EQ(reporter.told, std::vector<std::string>{"# mode holding"});
}

TEST(AskingConsole, refuses_every_request_that_changes_something_and_says_so_in_the_log) {
  test::LineConsole reporter;
  std::size_t refused = 0;
  const std::string log = log_of([&](Journal& journal) {
    AskingConsole asking(reporter, journal);
    hal::Console& console = asking;
    for (const controller::Verb& verb : controller::verbs()) {
      reporter.requests.emplace_back(verb.name);
      EXPECT_EQ(console.read_line().has_value(), verb.only_asks) << verb.name;
      refused += verb.only_asks ? 0 : 1;
    }
    for (const char* request : {"", "nonsense", "statusx", "send part=1 bytes=3956 hex=00ff",
                                "touch place=A1", "drop-touch"}) {
      reporter.requests.emplace_back(request);
      EXPECT_FALSE(console.read_line()) << request;
    }
  });
  EXPECT_EQ(reporter.replies.size(), refused + 6);
  for (const std::string& reply : reporter.replies)
    EXPECT_TRUE(reply.starts_with("error NOT_PERMITTED \""));
  EXPECT_NE(log.find("armsigd: reporting console 1 is refused: enable\n"), std::string::npos)
      << log;
  EXPECT_NE(log.find("is refused: send part=1 bytes=3956\n"), std::string::npos) << log;
}

// By which the reporting console is of a group that armsigd is not in
// (firmware/linux/armsig.tmpfiles).
TEST(SocketConsole, in_a_folder_that_gives_its_group_is_of_that_group) {
  const std::string folder = testing::TempDir() + "report_" + std::to_string(::getpid());
  const gid_t group = ::geteuid() == 0 ? 12345 : ::getegid();
  ASSERT_EQ(::mkdir(folder.c_str(), 0700), 0);
  ASSERT_EQ(::chown(folder.c_str(), static_cast<uid_t>(-1), group), 0);
  ASSERT_EQ(::chmod(folder.c_str(), 02750), 0);
  {
    const auto console = linux_hal::SocketConsole::open(folder + "/console");
    ASSERT_TRUE(console);
    struct stat status{};
    ASSERT_EQ(::stat((folder + "/console").c_str(), &status), 0);
    EXPECT_EQ(status.st_gid, group);
    EXPECT_EQ(status.st_mode & 07777U, 0660U);
  }
  EXPECT_EQ(::rmdir(folder.c_str()), 0);
}

// The manager's end of the socket.
struct Manager {
  Manager() {
    path = testing::TempDir() + "notify_" + std::to_string(::getpid());
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    EXPECT_EQ(::bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  ~Manager() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
    ::unlink(path.c_str());
  }
  [[nodiscard]] std::string heard() const {
    std::array<char, 64> text{};
    const ssize_t size = ::recv(socket.get(), text.data(), text.size(), MSG_DONTWAIT);
    return size < 0 ? "" : std::string(text.data(), static_cast<std::size_t>(size));
  }
  std::string path;
  linux_hal::FileDescriptor socket{::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
};

TEST(ServiceManager, hears_that_the_service_is_ready_alive_and_stopping) {
  const Manager manager;
  ::setenv("WATCHDOG_USEC", "2000000", 1);
  ServiceManager told;
  told.ready();
  EXPECT_EQ(manager.heard(), "READY=1");
  const hal::Instant now{std::chrono::seconds(100)};
  told.alive(now);
  EXPECT_EQ(manager.heard(), "WATCHDOG=1");
  told.alive(now + milliseconds(999));
  EXPECT_EQ(manager.heard(), "") << "twice in the time allowed is enough";
  told.alive(now + milliseconds(1000));
  EXPECT_EQ(manager.heard(), "WATCHDOG=1");
  told.stopping();
  EXPECT_EQ(manager.heard(), "STOPPING=1");
}

TEST(ServiceManager, that_watches_another_process_or_nobody_hears_no_signs_of_life) {
  const Manager manager;
  ServiceManager unwatched;
  unwatched.alive(hal::Instant(std::chrono::seconds(100)));
  ::setenv("WATCHDOG_USEC", "2000000", 1);
  ::setenv("WATCHDOG_PID", "1", 1);
  ServiceManager of_another;
  of_another.alive(hal::Instant(std::chrono::seconds(100)));
  EXPECT_EQ(manager.heard(), "");
  EXPECT_FALSE(of_another.watchdog());
}

TEST(ServiceManager, need_not_be_there) {
  ::setenv("NOTIFY_SOCKET", "nonsense", 1);
  ServiceManager none;
  none.ready();
  ::unsetenv("NOTIFY_SOCKET");
}

TEST(ProcessWatch, has_progressed_when_both_threads_have) {
  ProcessWatch watch;
  EXPECT_FALSE(watch.progressed());
  watch.ticked();
  EXPECT_FALSE(watch.progressed());
  watch.stepped();
  EXPECT_TRUE(watch.progressed());
  EXPECT_FALSE(watch.progressed());
}

TEST(SendQueue, of_an_interface_is_read_and_none_is_told) {
  const auto places = linux_hal::send_queue_frames("lo");
  ASSERT_TRUE(places);
  EXPECT_GT(*places, 0U);
  EXPECT_FALSE(linux_hal::send_queue_frames("no-such-one"));
  EXPECT_FALSE(linux_hal::send_queue_frames("a-name-that-is-far-too-long"));
}

TEST(Histogram, counts_on_after_49_days_at_1_kHz) {
  controller::Histogram histogram;
  histogram.counts[3] = 0xFFFF'FFFF;
  histogram.add(std::chrono::microseconds(5));
  EXPECT_EQ(histogram.counts[3], 0x1'0000'0000U);
}

// A console that keeps the background's thread, as a disk does that is being written, until the
// arm is at rest.
class SlowConsole final : public hal::Console {
 public:
  std::atomic<bool> entered{false};
  std::atomic<bool> at_rest{false};
  std::atomic<bool> gave_up{false};

 private:
  std::optional<hal::ConsoleLine> do_read_line() override {
    entered = true;
    linux_hal::SteadyClock clock;
    for (int i = 0; i < 2000 && !at_rest; ++i) {
      clock.wait_until(clock.now() + milliseconds(1));
      gave_up = i == 1999;
    }
    return std::nullopt;
  }
  Result<void> do_write_line(hal::ConsoleClient, std::string_view) override { return {}; }
  void do_broadcast(std::string_view) override {}
};

TEST(RealTimeLoop, brings_the_arm_to_rest_before_it_waits_for_the_background) {
  SlowConsole console;
  const std::array<hal::Console*, 1> consoles{&console};
  test::RamMemory memory;
  linux_hal::SteadyClock clock;
  const controller::Configuration configuration = test::puma_controller();
  cabinet::VirtualCabinet cabinet(configuration, test::puma_bus(), test::puma_world(), memory,
                                  consoles, &clock);
  ProcessWatch watch;
  Journal journal;
  const std::sig_atomic_t stop = SIGTERM;
  bool was_slow = false;
  EXPECT_TRUE(run_in_real_time(
      {.controller = cabinet.controller(),
       .clock = cabinet.clock(),
       .period = configuration.period,
       .priority = 0,
       .watch = watch,
       .journal = journal},
      [&] {
        while (!console.entered) clock.wait_until(clock.now() + milliseconds(1));
      },
      [&] {
        was_slow = !console.gave_up;
        console.at_rest = true;
      },
      stop));
  EXPECT_TRUE(was_slow);
  EXPECT_FALSE(console.gave_up) << "the arm was brought to rest only after the disk was done";
}

}  // namespace
}  // namespace armsig::daemon
