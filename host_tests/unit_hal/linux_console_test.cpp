// SPDX-License-Identifier: MIT
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/linux/socket_console.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::linux_hal {
namespace {

std::string socket_path() {
  static int number = 0;
  return testing::TempDir() + "console_" + std::to_string(getpid()) + "_" +
         std::to_string(number++);
}

class Operator {
 public:
  explicit Operator(const std::string& path, int flags = 0)
      : socket_(::socket(AF_UNIX, SOCK_STREAM | flags, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    EXPECT_EQ(connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
  }
  void say(const std::string& text) const {
    EXPECT_EQ(send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(text.size()));
  }
  // As much as the socket takes at once.
  [[nodiscard]] std::size_t flood(const std::string& text) const {
    std::size_t total = 0;
    for (;;) {
      const ssize_t count =
          send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count <= 0) return total;
      total += static_cast<std::size_t>(count);
    }
  }
  [[nodiscard]] std::string hear() const {
    std::array<char, 4096> buffer{};
    const ssize_t count = recv(socket_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    return count > 0 ? std::string(buffer.data(), static_cast<std::size_t>(count)) : "";
  }
  // True when the other side has hung up.
  [[nodiscard]] bool hung_up() const {
    char c = 0;
    return recv(socket_.get(), &c, 1, MSG_DONTWAIT) == 0;
  }
  void finish() const { shutdown(socket_.get(), SHUT_WR); }
  void hang_up() { socket_.reset(); }

 private:
  FileDescriptor socket_;
};

std::optional<hal::ConsoleLine> read_line(SocketConsole& console) {
  for (int i = 0; i < 20; ++i) {
    if (auto line = console.read_line()) return line;
  }
  return std::nullopt;
}

TEST(SocketConsole, is_open_to_owner_and_group_only) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  struct stat status{};
  ASSERT_EQ(stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0660U);
}

TEST(SocketConsole, leaves_no_socket_behind) {
  const std::string path = socket_path();
  ASSERT_TRUE(SocketConsole::open(path));
  EXPECT_NE(access(path.c_str(), F_OK), 0);
}

TEST(SocketConsole, reads_lines_and_replies) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator person(path);
  person.say("sta");
  EXPECT_FALSE(read_line(**console));
  person.say("tus\r\nenable joint=1\n");
  const auto first = read_line(**console);
  ASSERT_TRUE(first);
  EXPECT_EQ(first->text(), "status");
  EXPECT_TRUE((*console)->write_line(first->client, "ok mode=Idle"));
  EXPECT_EQ(person.hear(), "ok mode=Idle\n");
  EXPECT_EQ(read_line(**console)->text(), "enable joint=1");
}

TEST(SocketConsole, answers_every_line_of_a_script_that_has_closed_its_side) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator script(path);
  script.say("one\ntwo\nthree\n");
  script.finish();
  std::string replies;
  while (const auto line = read_line(**console)) {
    EXPECT_TRUE((*console)->write_line(line->client, "ok " + std::string(line->text())));
    replies += script.hear();
  }
  EXPECT_EQ(replies, "ok one\nok two\nok three\n");
  EXPECT_TRUE(script.hung_up());
}

TEST(SocketConsole, replies_to_the_client_that_asked) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator first(path);
  const Operator second(path);
  first.say("a\n");
  ASSERT_TRUE(read_line(**console));
  second.say("b\n");
  const auto line = read_line(**console);
  ASSERT_TRUE(line);
  EXPECT_TRUE((*console)->write_line(line->client, "ok"));
  EXPECT_EQ(first.hear(), "");
  EXPECT_EQ(second.hear(), "ok\n");
  (*console)->broadcast("# note");
  EXPECT_EQ(first.hear(), "# note\n");
  EXPECT_EQ(second.hear(), "# note\n");
}

TEST(SocketConsole, a_flood_does_not_keep_another_client_waiting) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator flooder(path);
  ASSERT_FALSE(read_line(**console));
  const Operator other(path);
  ASSERT_FALSE(read_line(**console));
  EXPECT_GT(flooder.flood("status\nstatus\nstatus\nstatus\n"), 5000U);
  other.say("disable\n");
  bool heard = false;
  for (int i = 0; i < 3; ++i) {
    const auto line = (*console)->read_line();
    heard = heard || (line && line->text() == "disable");
  }
  EXPECT_TRUE(heard);
}

TEST(SocketConsole, a_client_that_takes_no_replies_is_disconnected) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator deaf(path);
  deaf.say("x\n");
  const auto line = read_line(**console);
  ASSERT_TRUE(line);
  const std::string reply(4000, 'r');
  Result<void> written;
  for (int i = 0; i < 1000 && written; ++i) written = (*console)->write_line(line->client, reply);
  EXPECT_EQ(test::failure_of(written), Error::kConsoleGone);
}

TEST(SocketConsole, binary_garbage_is_refused_a_line_at_a_time) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator person(path);
  person.say(std::string("\x00\xFF\x1B[A\n", 6) + "status\n");
  const auto garbage = read_line(**console);
  ASSERT_TRUE(garbage);
  EXPECT_EQ(garbage->error, Error::kNotText);
  EXPECT_EQ(read_line(**console)->text(), "status");
}

TEST(SocketConsole, a_line_too_long_is_refused_once_and_the_next_one_is_heard) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator person(path);
  person.say(std::string(3000, 'x').append("\nstatus\n"));
  const auto refused = read_line(**console);
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->error, Error::kLineTooLong);
  const auto next = read_line(**console);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->text(), "status");
}

TEST(SocketConsole, a_client_that_left_is_gone) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  Operator person(path);
  person.say("x\n");
  const auto line = read_line(**console);
  ASSERT_TRUE(line);
  person.hang_up();
  Result<void> written = (*console)->write_line(line->client, "ok");
  if (written) written = (*console)->write_line(line->client, "ok");
  EXPECT_EQ(test::failure_of(written), Error::kConsoleGone);
  EXPECT_EQ(test::failure_of((*console)->write_line(4711, "ok")), Error::kConsoleGone);
}

TEST(SocketConsole, hears_what_a_client_said_before_it_left_though_it_takes_no_reply) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  const Operator other(path);
  Operator hasty(path);
  for (int i = 0; i < 3; ++i) (void)(*console)->read_line();
  other.say("status\n");
  hasty.say("stop\n");
  hasty.hang_up();
  (*console)->broadcast("# mode idle");  // which a client that is gone cannot take
  bool heard = false;
  for (int i = 0; i < 6; ++i) {
    const auto line = (*console)->read_line();
    heard = heard || (line && line->text() == "stop");
  }
  EXPECT_TRUE(heard);
}

// A console with every place taken, by clients of which some have said a line.
struct FullHouse {
  explicit FullHouse(std::size_t speakers = 0) {
    for (std::size_t i = 0; i < SocketConsole::kMaxClients; ++i) {
      people.push_back(std::make_unique<Operator>(path));
      (void)read_line(*console);
    }
    for (std::size_t i = 0; i < speakers; ++i) answer(*people[i]);
  }
  void answer(const Operator& person) const {
    person.say("status\n");
    const auto line = read_line(*console);
    ASSERT_TRUE(line);
    ASSERT_TRUE(console->write_line(line->client, "ok"));
    EXPECT_EQ(person.hear(), "ok\n");
  }
  const std::string path = socket_path();
  std::unique_ptr<SocketConsole> console = *SocketConsole::open(path);
  std::vector<std::unique_ptr<Operator>> people;
};

TEST(SocketConsole, eight_silent_clients_do_not_keep_a_ninth_from_stop) {
  const FullHouse house;
  const Operator ninth(house.path);
  ninth.say("stop\n");
  const auto line = read_line(*house.console);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->text(), "stop");
  EXPECT_TRUE(house.console->write_line(line->client, "ok"));
  EXPECT_EQ(ninth.hear(), "ok\n");
  EXPECT_TRUE(house.people[0]->hear().starts_with("# disconnected"));
  EXPECT_TRUE(house.people[0]->hung_up());
  EXPECT_FALSE(house.people[1]->hung_up());
}

TEST(SocketConsole, a_ninth_client_takes_the_place_of_the_one_that_was_quiet_for_longest) {
  FullHouse house(SocketConsole::kMaxClients);
  house.answer(*house.people[0]);
  const Operator ninth(house.path);
  house.answer(ninth);
  EXPECT_FALSE(house.people[0]->hung_up());
  EXPECT_TRUE(house.people[1]->hear().starts_with("# disconnected"));
  EXPECT_FALSE(house.people[2]->hung_up());
}

TEST(SocketConsole, a_flood_of_connections_takes_no_place_of_one_that_has_spoken) {
  FullHouse house(SocketConsole::kMaxClients - 1);
  for (int i = 0; i < 100; ++i) {
    house.people.push_back(std::make_unique<Operator>(house.path));
    (void)house.console->read_line();
  }
  for (std::size_t i = 0; i + 1 < SocketConsole::kMaxClients; ++i) house.answer(*house.people[i]);
}

// A client with a time-out of its own (a socket that does not block) is refused where the queue is
// full, instead of waiting for its turn.
TEST(SocketConsole, a_crowd_that_comes_between_two_looks_is_let_in_without_waiting) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  std::vector<std::unique_ptr<Operator>> crowd;
  for (int i = 0; i < 60; ++i) {
    crowd.push_back(std::make_unique<Operator>(path, SOCK_NONBLOCK));
    ASSERT_FALSE(testing::Test::HasFailure()) << "client " << i;
  }
}

TEST(SocketConsole, a_client_that_waits_for_its_reply_keeps_its_place) {
  FullHouse house;
  house.people[0]->say("accept\n");
  const auto line = read_line(*house.console);
  ASSERT_TRUE(line);
  house.people[1]->say("stop\n");  // not read yet
  const Operator ninth(house.path);
  const auto stop = house.console->read_line();
  ASSERT_TRUE(stop);
  EXPECT_EQ(stop->text(), "stop");
  EXPECT_TRUE(house.console->write_line(line->client, "ok"));
  EXPECT_TRUE(house.console->write_line(stop->client, "ok"));
  EXPECT_TRUE(house.people[2]->hear().starts_with("# disconnected"));
}

TEST(SocketConsole, takes_the_place_of_a_dead_socket_but_of_no_live_one_and_no_file) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  EXPECT_EQ(test::failure_of(SocketConsole::open(path)), Error::kSystemRefused);

  const std::string dead = socket_path();
  {
    const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, dead.c_str(), dead.size() + 1);
    ASSERT_EQ(bind(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  EXPECT_TRUE(SocketConsole::open(dead));

  const std::string file = socket_path();
  std::ofstream(file) << "precious";
  EXPECT_EQ(test::failure_of(SocketConsole::open(file)), Error::kSystemRefused);
  EXPECT_EQ(access(file.c_str(), F_OK), 0);
  unlink(file.c_str());
  EXPECT_EQ(test::failure_of(SocketConsole::open(std::string(200, 'x'))),
            Error::kAddressOutOfRange);
}

}  // namespace
}  // namespace armsig::linux_hal
