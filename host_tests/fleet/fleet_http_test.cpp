// SPDX-License-Identifier: MIT
// The host's page as careless and hostile readers ask for it; in virtual time.
#include <arpa/inet.h>
#include <sys/socket.h>

#include <cerrno>
#include <deque>
#include <string>

#include <gtest/gtest.h>

#include "firmware/fleet/host/http_server.hpp"

namespace armsig::fleet {
namespace {

class FleetHttp : public testing::Test {
 protected:
  struct Reader {
    linux_hal::FileDescriptor socket;
    std::string heard;
    bool ended = false;
  };

  void SetUp() override {
    server = HttpServer::open(0, {"fleet.plant.example"});
    ASSERT_TRUE(server);
  }
  Reader& connect() {
    Reader& reader = readers.emplace_back();
    reader.socket = linux_hal::FileDescriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(server->port()));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(
        ::connect(reader.socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
        0);
    return reader;
  }
  static void send(Reader& reader, const std::string& text) {
    (void)::send(reader.socket.get(), text.data(), text.size(), MSG_NOSIGNAL);
  }
  void serve(int rounds) {
    for (int i = 0; i < rounds; ++i) {
      std::vector<pollfd> ready;
      server->add_to(ready);
      (void)::poll(ready.data(), ready.size(), 1);
      server->service(ready.data(), now_ms, [&](std::string_view path) {
        return Answer{.status = 200, .type = "text/plain", .body = body + std::string(path)};
      });
    }
  }
  // What has come to the reader.
  static std::string heard(Reader& reader) {
    char buffer[4096];
    for (;;) {
      const ssize_t count = ::recv(reader.socket.get(), buffer, sizeof buffer, MSG_DONTWAIT);
      reader.ended = reader.ended || count == 0 || (count < 0 && errno != EAGAIN);
      if (count <= 0) return reader.heard;
      reader.heard.append(buffer, static_cast<std::size_t>(count));
    }
  }
  std::string asked(const std::string& request) {
    Reader& reader = connect();
    send(reader, request);
    serve(4);
    return heard(reader);
  }

  std::optional<HttpServer> server;
  std::deque<Reader> readers;
  std::uint64_t now_ms = 1'000;
  std::string body = "body of ";
};

TEST_F(FleetHttp, AnswersByItsOwnNamesAlone) {
  const auto status = [&](const std::string& host) {
    return asked("GET /metrics HTTP/1.1\r\n" + host + "\r\n").substr(0, 12);
  };
  for (const char* ours :
       {"Host: 127.0.0.1:8080\r\n", "Host: localhost\r\n", "host:LOCALHOST:9\r\n",
        "Host: [::1]:8080\r\n", "Accept: x\r\nHost: fleet.plant.example\r\n"}) {
    EXPECT_EQ(status(ours), "HTTP/1.1 200") << ours;
  }
  for (const char* not_ours :
       {"", "Host: evil.example\r\n", "Host: evil.example:8080\r\n", "Host: 127.0.0.1.evil\r\n",
        "Host: \r\n", "Host: localhost\r\nHost: evil.example\r\n",
        "Host: evil.example\r\nHost: localhost\r\n", "X-Host: localhost\r\n",
        "Host: localhost@evil.example\r\n"}) {
    EXPECT_EQ(status(not_ours), "HTTP/1.1 403") << not_ours;
  }
}

// More than there are places, each with a byte now and then: the next one who asks is answered.
TEST_F(FleetHttp, SlowOnesKeepNobodyOut) {
  constexpr int kSlow = 200;
  for (int i = 0; i < kSlow; ++i) {
    send(connect(), "GET / HTTP/1.1\r\nHost: localhost\r\nX: ");
    serve(1);
  }
  for (Reader& slow : readers) send(slow, "x");
  serve(2);
  EXPECT_TRUE(asked("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n").contains("of /metrics"));
  now_ms += 6'000;
  serve(2);
  int left = 0;
  for (Reader& slow : readers) {
    heard(slow);
    left += slow.ended ? 0 : 1;
  }
  EXPECT_EQ(left, 0) << "a whole request has five seconds";
}

// Who does not read what it asked for takes neither a place nor memory for long.
TEST_F(FleetHttp, OnesThatDoNotReadKeepNobodyOut) {
  body = std::string(8U << 20U, 'x');  // more than a socket holds
  for (int i = 0; i < 40; ++i) {
    send(connect(), "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    serve(2);
  }
  std::vector<pollfd> ready;
  server->add_to(ready);
  EXPECT_LE(ready.size(), 1U + 16U);
  body = "body of ";
  EXPECT_TRUE(asked("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n").contains("of /metrics"));
}

TEST_F(FleetHttp, EndsARequestThatIsTooLong) {
  Reader& reader = connect();
  for (int i = 0; i < 8; ++i) {
    send(reader, std::string(1024, 'x'));
    serve(1);
  }
  serve(2);
  EXPECT_EQ(heard(reader), "");
  EXPECT_TRUE(reader.ended);
}

}  // namespace
}  // namespace armsig::fleet
