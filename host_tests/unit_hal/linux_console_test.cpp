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

namespace armsig::linux_hal {
namespace {

std::string socket_path() {
  static int number = 0;
  return testing::TempDir() + "console_" + std::to_string(getpid()) + "_" +
         std::to_string(number++);
}

class Operator {
 public:
  explicit Operator(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
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
  EXPECT_EQ(written.error(), Error::kConsoleGone);
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
  EXPECT_EQ(written.error(), Error::kConsoleGone);
  EXPECT_EQ((*console)->write_line(4711, "ok").error(), Error::kConsoleGone);
}

TEST(SocketConsole, refuses_the_ninth_client_with_a_word) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  std::vector<std::unique_ptr<Operator>> people;
  for (std::size_t i = 0; i <= SocketConsole::kMaxClients; ++i) {
    people.push_back(std::make_unique<Operator>(path));
    (void)read_line(**console);
  }
  EXPECT_TRUE(people.back()->hear().starts_with("error BUSY"));
  people.front()->hang_up();
  (void)read_line(**console);
  const Operator next(path);
  next.say("status\n");
  EXPECT_TRUE(read_line(**console));
}

TEST(SocketConsole, takes_the_place_of_a_dead_socket_but_of_no_live_one_and_no_file) {
  const std::string path = socket_path();
  const auto console = SocketConsole::open(path);
  ASSERT_TRUE(console);
  EXPECT_EQ(SocketConsole::open(path).error(), Error::kSystemRefused);

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
  EXPECT_EQ(SocketConsole::open(file).error(), Error::kSystemRefused);
  EXPECT_EQ(access(file.c_str(), F_OK), 0);
  unlink(file.c_str());
  EXPECT_EQ(SocketConsole::open(std::string(200, 'x')).error(), Error::kAddressOutOfRange);
}

}  // namespace
}  // namespace armsig::linux_hal
