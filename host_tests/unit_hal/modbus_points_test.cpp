// SPDX-License-Identifier: MIT
// Points in the registers of a Modbus TCP server, over a real connection in a time that the test
// makes; the server is libmodbus, or a few lines that answer wrongly.
#include <poll.h>

#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include <gtest/gtest.h>
#include <modbus.h>

#include "hal/linux/internet_address.hpp"
#include "hal/linux/register_client.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::linux_hal {
namespace {

using std::chrono::milliseconds;
using Polled = Result<std::optional<hal::PointReading>>;

// Listens at a port that the system chooses.
class Listener {
 public:
  Listener() : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const auto address = address_of("127.0.0.1", 0);
    EXPECT_EQ(::bind(socket_.get(), address->get(), address->size), 0);
    EXPECT_EQ(::listen(socket_.get(), 4), 0);
  }
  [[nodiscard]] std::uint16_t port() const {
    sockaddr_in bound{};
    socklen_t size = sizeof bound;
    EXPECT_EQ(::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&bound), &size), 0);
    return ntohs(bound.sin_port);
  }
  // Empty where nobody connects.
  [[nodiscard]] FileDescriptor accept() const {
    pollfd waits{.fd = socket_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&waits, 1, 1000) <= 0) return {};
    return FileDescriptor(::accept4(socket_.get(), nullptr, nullptr, SOCK_CLOEXEC));
  }

 private:
  FileDescriptor socket_;
};

RegisterClientConfiguration configured(std::uint16_t port) {
  RegisterClientConfiguration c;
  c.address = "127.0.0.1";
  c.port = port;
  c.profile = {.metres_a_step = 1e-3, .registers = {0, 2, 4}, .counter = 6};
  return c;
}

// The instrument's side, one request at a time.
class Server {
 public:
  Server()
      : registers_(modbus_mapping_new(0, 0, 0, 16)), context_(modbus_new_tcp("127.0.0.1", 0)) {}
  ~Server() {
    modbus_free(context_);
    modbus_mapping_free(registers_);
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void point(float x_mm, float y_mm, float z_mm, std::uint16_t number) {
    std::uint16_t* at = registers_->tab_input_registers;
    for (const float coordinate : {x_mm, y_mm, z_mm}) {
      const auto bits = std::bit_cast<std::uint32_t>(coordinate);
      *at++ = static_cast<std::uint16_t>(bits >> 16);
      *at++ = static_cast<std::uint16_t>(bits);
    }
    *at = number;
  }
  bool accept() {
    client_ = listener_->accept();
    modbus_set_socket(context_, client_.get());
    return client_.valid();
  }
  // Answers what has been asked; false where nothing was within a second.
  bool answer() {
    pollfd waits{.fd = client_.get(), .events = POLLIN, .revents = 0};
    if (::poll(&waits, 1, 1000) <= 0) return false;
    std::array<std::uint8_t, MODBUS_TCP_MAX_ADU_LENGTH> request{};
    const int bytes = modbus_receive(context_, request.data());
    return bytes > 0 && modbus_reply(context_, request.data(), bytes, registers_) > 0;
  }
  void end() {
    client_.reset();
    listener_.reset();
  }
  [[nodiscard]] const FileDescriptor& client() const { return client_; }
  [[nodiscard]] std::uint16_t port() const { return listener_->port(); }

 private:
  std::optional<Listener> listener_{std::in_place};
  FileDescriptor client_;
  modbus_mapping_t* registers_;
  modbus_t* context_;
};

struct Asked {
  explicit Asked(RegisterClientConfiguration configuration) : points(configuration) {}
  Polled poll(int later_ms = 50) {
    now += milliseconds(later_ms);
    return points.poll(now);
  }
  // Connects, and sends the first request.
  void begin(Server& server) {
    (void)poll(0);
    ASSERT_TRUE(server.accept());
    for (int i = 0; i < 100 && !is_asking(server); ++i) (void)poll(0);
    ASSERT_TRUE(is_asking(server));
  }
  static bool is_asking(const Server& server) {
    pollfd waits{.fd = server.client().get(), .events = POLLIN, .revents = 0};
    return ::poll(&waits, 1, 5) > 0;
  }
  // What comes of a request that the server answers.
  Polled exchange(Server& server) {
    for (int i = 0; i < 3 && !is_asking(server); ++i) (void)poll();
    EXPECT_TRUE(server.answer());
    Polled polled = poll(1);
    for (int i = 0; i < 20 && polled && !*polled; ++i) {  // it may be on its way for a moment
      std::this_thread::yield();
      polled = poll(0);
    }
    return polled;
  }

  ModbusPoints points;
  hal::Instant now{milliseconds(10'000)};
};

TEST(ModbusPoints, are_handed_out_once_each_with_the_earliest_time_they_can_be_of) {
  Server server;
  Asked asked(configured(server.port()));
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  server.point(1, 2, 3, 7);
  (void)asked.exchange(server);
  const hal::Instant before = asked.now;
  server.point(812.5F, -31.25F, 455, 8);
  const auto polled = asked.exchange(server);
  ASSERT_TRUE(polled && *polled);
  EXPECT_EQ((*polled)->p_S, Vector3(0.8125, -0.03125, 0.455));
  EXPECT_EQ((*polled)->sequence, 8U);
  EXPECT_FALSE((*polled)->covariance_m2);
  // It may have come into the registers right after they were read before.
  EXPECT_LE((*polled)->at, before - milliseconds(100));
  EXPECT_GE((*polled)->at, before - milliseconds(100 + 60));
  const auto again = asked.exchange(server);
  EXPECT_TRUE(again && !*again) << "the same number";
  EXPECT_EQ(asked.points.malformed(), 0U);
}

// Its number may have changed as soon as it was read last.
TEST(ModbusPoints, are_as_old_as_the_last_answer_that_had_a_point) {
  Server server;
  Asked asked(configured(server.port()));
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  server.point(1, 2, 3, 7);
  const hal::Instant read_at = asked.now;
  ASSERT_TRUE(asked.exchange(server));
  server.point(std::nanf(""), 2, 3, 8);
  for (int i = 0; i < 3; ++i) ASSERT_FALSE(asked.exchange(server));
  server.point(4, 5, 6, 8);
  const auto polled = asked.exchange(server);
  ASSERT_TRUE(polled && *polled);
  EXPECT_EQ((*polled)->at, read_at - milliseconds(100));
}

TEST(ModbusPoints, without_a_counter_are_new_once_a_period) {
  Server server;
  RegisterClientConfiguration configuration = configured(server.port());
  configuration.profile.counter.reset();
  configuration.profile.update_period = milliseconds(200);
  Asked asked(configuration);
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  server.point(1, 2, 3, 0);
  const hal::Instant asked_at = asked.now;
  const auto first = asked.exchange(server);
  ASSERT_TRUE(first && *first);
  EXPECT_EQ((*first)->at, asked_at - milliseconds(300));
  (void)asked.poll(asked.now < asked_at + milliseconds(199) ? 150 : 0);
  EXPECT_FALSE(Asked::is_asking(server)) << "before the period is over";
  const auto second = asked.exchange(server);
  ASSERT_TRUE(second && *second);
  EXPECT_NE((*second)->sequence, (*first)->sequence);
}

TEST(ModbusPoints, tell_what_the_server_refuses) {
  Server server;
  RegisterClientConfiguration configuration = configured(server.port());
  configuration.profile.registers[0] = 40;
  Asked asked(configuration);
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  const auto polled = asked.exchange(server);
  ASSERT_FALSE(polled);
  EXPECT_EQ(test::failure_of(polled), Error::kSensorException);
  EXPECT_EQ(asked.points.words(Error::kSensorException), "illegal data address");
  EXPECT_EQ(asked.points.malformed(), 1U);
}

TEST(ModbusPoints, tell_registers_that_hold_no_point) {
  Server server;
  Asked asked(configured(server.port()));
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  for (const float wrong : {std::nanf(""), INFINITY, 100'001.0F, -100'001.0F}) {
    server.point(1, 2, wrong, 1);
    const auto polled = asked.exchange(server);
    EXPECT_EQ(test::failure_of(polled), Error::kSensorMalformed) << wrong;
    EXPECT_EQ(asked.points.words(Error::kSensorMalformed), "the registers hold no point");
  }
  server.point(1, 2, 3, 2);
  const auto well = asked.exchange(server);
  EXPECT_TRUE(well && *well) << "nothing ended";
}

TEST(ModbusPoints, drop_a_server_that_speaks_something_else) {
  Server server;
  Asked asked(configured(server.port()));
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  constexpr std::string_view kHttp = "HTTP/1.1 400 Bad Request\r\n\r\n";
  ASSERT_GT(::send(server.client().get(), kHttp.data(), kHttp.size(), MSG_NOSIGNAL), 0);
  Polled polled = asked.poll(1);
  for (int i = 0; i < 1000 && polled; ++i) {
    std::this_thread::yield();
    polled = asked.poll(0);
  }
  EXPECT_EQ(test::failure_of(polled), Error::kSensorMalformed);
  EXPECT_EQ(asked.points.words(Error::kSensorMalformed), "what answers is no Modbus TCP server");
}

TEST(ModbusPoints, connect_anew_where_an_answer_does_not_come) {
  Server server;
  Asked asked(configured(server.port()));
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  (void)asked.poll(201);
  std::array<char, 64> rest{};
  (void)::recv(server.client().get(), rest.data(), rest.size(), 0);
  EXPECT_EQ(::recv(server.client().get(), rest.data(), rest.size(), 0), 0) << "hung up";
  (void)asked.poll(100);
  ASSERT_TRUE(server.accept());
  server.point(1, 2, 3, 5);
  const auto polled = asked.exchange(server);
  EXPECT_TRUE(polled && *polled);
}

TEST(ModbusPoints, tell_a_server_that_is_silent_from_one_that_is_gone) {
  Server server;
  RegisterClientConfiguration configuration = configured(server.port());
  configuration.answer_timeout = milliseconds(2000);
  Asked asked(configuration);
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  EXPECT_EQ(test::failure_of(asked.poll(501)), Error::kSensorSilent);
  server.end();
  Polled polled = asked.poll(0);
  for (int i = 0; i < 50 && polled; ++i) polled = asked.poll(20);
  EXPECT_EQ(test::failure_of(polled), Error::kSensorPortGone);
  EXPECT_FALSE(asked.points.words(Error::kSensorPortGone).empty());
}

TEST(ModbusPoints, of_a_server_that_repeats_itself_are_stale) {
  Server server;
  Asked asked(configured(server.port()));
  ASSERT_NO_FATAL_FAILURE(asked.begin(server));
  server.point(1, 2, 3, 5);
  Polled polled;
  for (int i = 0; i < 20 && polled; ++i) {
    if (Asked::is_asking(server)) {
      EXPECT_TRUE(server.answer());
    }
    polled = asked.poll();
  }
  EXPECT_EQ(test::failure_of(polled), Error::kSensorStale);
}

TEST(ModbusPoints, without_a_server_say_why_and_try_again) {
  std::uint16_t port = 0;
  {
    const Listener gone;
    port = gone.port();
  }
  Asked asked(configured(port));
  Polled polled = asked.poll(0);
  for (int i = 0; i < 50 && polled; ++i) polled = asked.poll(20);
  EXPECT_EQ(test::failure_of(polled), Error::kSensorPortGone);
  EXPECT_EQ(asked.points.words(Error::kSensorPortGone), "Connection refused");
}

// One that is no length is not read; the others count.
TEST(ModbusLengths, are_read_by_one_request) {
  Server server;
  ModbusLengths lengths(configured(server.port()));
  hal::Instant now{milliseconds(10'000)};
  (void)lengths.poll(now);
  ASSERT_TRUE(server.accept());
  const auto exchange = [&] {
    for (int i = 0; i < 100 && !Asked::is_asking(server); ++i) (void)lengths.poll(now);
    EXPECT_TRUE(server.answer());
    now += milliseconds(51);
    auto polled = lengths.poll(now);
    for (int i = 0; i < 1000 && polled && !*polled; ++i) {
      std::this_thread::yield();
      polled = lengths.poll(now);
    }
    return polled;
  };
  server.point(812.5F, std::nanf(""), 455, 8);
  const auto polled = exchange();
  ASSERT_TRUE(polled && *polled);
  ASSERT_EQ((*polled)->lengths_m.size(), 3U);
  EXPECT_EQ((*polled)->lengths_m[0], 0.8125);
  EXPECT_FALSE((*polled)->lengths_m[1]);
  EXPECT_EQ((*polled)->lengths_m[2], 0.455);
  EXPECT_EQ((*polled)->sequence, 8U);
  server.point(0, -1, 100'001.0F, 9);
  EXPECT_EQ(test::failure_of(exchange()), Error::kSensorMalformed);
  EXPECT_EQ(lengths.words(Error::kSensorMalformed), "the registers hold no length");
}

}  // namespace
}  // namespace armsig::linux_hal
