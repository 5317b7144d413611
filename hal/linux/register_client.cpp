// SPDX-License-Identifier: MIT
#include "hal/linux/register_client.hpp"

#include <netinet/tcp.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/base/check.hpp"
#include "hal/linux/internet_address.hpp"
#include "hal/linux/keyed_line.hpp"

namespace armsig::linux_hal {
namespace {

// A server that is there takes a connection at once, another one never.
constexpr hal::Duration kConnectTimeout = std::chrono::seconds(1);

// What numbers of registers are; what they are not, in words, or nothing.
std::string_view take(std::span<const double> metres, hal::PointReading& point) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(std::abs(metres[axis]) <= kFarthest_mm / 1e3)) return "the registers hold no point";
    point.p_S[static_cast<Eigen::Index>(axis)] = metres[axis];
  }
  return {};
}

std::string_view take(std::span<const double> metres, hal::LengthReading& reading) {
  bool any = false;
  for (const double length_m : metres) {
    const bool is_one = length_m > 0 && length_m <= kFarthest_mm / 1e3;
    reading.lengths_m.push_back(is_one ? std::optional(length_m) : std::nullopt);
    any = any || is_one;
  }
  return any ? "" : "the registers hold no length";
}

}  // namespace

template <typename Reading>
RegisterClient<Reading>::RegisterClient(const RegisterClientConfiguration& configuration)
    : configuration_(configuration), freshness_(configuration.freshness) {
  const auto request = modbus::request_of(configuration.profile);
  ARMSIG_CHECK(request && address_of(configuration.address, configuration.port));
  request_ = *request;
}

template <typename Reading>
void RegisterClient<Reading>::connect(hal::Instant now) {
  if (socket_.valid() || !reconnect_.due(now)) return;
  const auto address = address_of(configuration_.address, configuration_.port);
  FileDescriptor socket(
      ::socket(address->storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  constexpr int kYes = 1;
  const bool begun =
      socket.valid() &&
      ::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &kYes, sizeof kYes) == 0 &&
      (::connect(socket.get(), address->get(), address->size) == 0 || errno == EINPROGRESS);
  if (!begun) {
    drop(now, errno);
    return;
  }
  socket_ = std::move(socket);
  connecting_ = true;
  connecting_since_ = now;
  answer_.clear();
  asked_at_.reset();
  ask_at_ = now;
}

template <typename Reading>
bool RegisterClient<Reading>::is_connected(hal::Instant now) {
  if (!socket_.valid()) return false;
  if (!connecting_) return true;
  pollfd waits{.fd = socket_.get(), .events = POLLOUT, .revents = 0};
  if (::poll(&waits, 1, 0) <= 0) {
    if (now - connecting_since_ > kConnectTimeout) drop(now, ETIMEDOUT);
    return false;
  }
  int reason = 0;
  socklen_t size = sizeof reason;
  if (::getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &reason, &size) != 0) reason = errno;
  if (reason != 0) {
    drop(now, reason);
    return false;
  }
  connecting_ = false;
  errno_ = 0;
  return true;
}

template <typename Reading>
void RegisterClient<Reading>::drop(hal::Instant now, int reason) {
  socket_.reset();
  connecting_ = false;
  errno_ = reason;
  reconnect_.fail(now);
}

// Nothing is sent before the answer to what was sent has come, or has not come in time.
template <typename Reading>
void RegisterClient<Reading>::ask(hal::Instant now) {
  if (asked_at_) {
    if (now - *asked_at_ > configuration_.answer_timeout) drop(now, ETIMEDOUT);
    return;
  }
  if (now < ask_at_) return;
  const auto request = modbus::encode_tcp(request_, ++transaction_);
  const ssize_t sent =
      ::send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent != static_cast<ssize_t>(request.size())) {
    drop(now, sent < 0 ? errno : ENOBUFS);
    return;
  }
  asked_at_ = now;
  ask_at_ = now + configuration_.poll_period;
}

template <typename Reading>
RegisterClient<Reading>::Polled RegisterClient<Reading>::receive(hal::Instant now) {
  std::array<std::uint8_t, modbus::kMostTcpBytes> bytes{};
  for (;;) {  // a byte of one answer at least each time
    const auto whole = modbus::tcp_answer_bytes({answer_.data(), answer_.size()});
    if (!whole) {
      drop(now, EPROTO);
      return refuse(Error::kSensorMalformed, "what answers is no Modbus TCP server");
    }
    if (*whole > 0 && answer_.size() == *whole) break;
    const std::size_t wanted = *whole > 0 ? *whole : modbus::kTcpHeaderBytes;
    const ssize_t count =
        ::recv(socket_.get(), bytes.data(), wanted - answer_.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return std::nullopt;
    if (count <= 0) {
      drop(now, count < 0 ? errno : ECONNRESET);
      return std::nullopt;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) answer_.push_back(bytes[i]);
  }
  auto taken = take_answer({answer_.data(), answer_.size()}, now);
  answer_.clear();
  return taken;
}

// One that nobody waits for any more is passed over.
template <typename Reading>
RegisterClient<Reading>::Polled RegisterClient<Reading>::take_answer(
    std::span<const std::uint8_t> answer, hal::Instant now) {
  if (!asked_at_ || modbus::tcp_transaction(answer) != transaction_) return std::nullopt;
  reconnect_.succeed();
  const hal::Instant asked_at = *std::exchange(asked_at_, std::nullopt);
  const auto registers = modbus::decode_tcp(request_, answer);
  if (!registers) {
    const modbus::Failure& failure = registers.error();
    const bool says_why = failure.error == Error::kSensorException;
    return refuse(failure.error, says_why ? modbus::describe_exception(failure.exception) : "");
  }
  return take_numbers(
      modbus::numbers_in(configuration_.profile, request_, {registers->data(), registers->size()}),
      asked_at, now);
}

// A counter that is not as it was read last has changed since that was asked for. Without one the
// registers may have held the reading for a period.
template <typename Reading>
RegisterClient<Reading>::Polled RegisterClient<Reading>::take_numbers(
    const modbus::RegisterNumbers& numbers, hal::Instant asked_at, hal::Instant now) {
  Reading reading;
  if (const std::string_view why = take({numbers.metres.data(), numbers.metres.size()}, reading);
      !why.empty()) {
    return refuse(Error::kSensorMalformed, why);
  }
  const hal::Duration period = configuration_.profile.update_period;
  const hal::Instant asked_before = std::exchange(used_asked_at_, asked_at);
  if (!numbers.sequence) ask_at_ = std::max(ask_at_, asked_at + period);
  reading.sequence = numbers.sequence ? *numbers.sequence : unnumbered_++;
  if (!freshness_.take(reading.sequence, now)) return std::nullopt;
  reading.at = (numbers.sequence ? asked_before : asked_at - period) - configuration_.age;
  return reading;
}

template <typename Reading>
RegisterClient<Reading>::Polled RegisterClient<Reading>::refuse(Error error,
                                                                std::string_view words) {
  ++malformed_;
  refused_words_ = words;
  return std::unexpected(error);
}

template <typename Reading>
RegisterClient<Reading>::Polled RegisterClient<Reading>::do_poll(hal::Instant now) {
  connect(now);
  if (is_connected(now)) {
    auto received = receive(now);
    if (socket_.valid()) ask(now);
    if (!received || *received) return received;
  }
  if (const auto overdue = freshness_.overdue(now)) {
    return std::unexpected(errno_ == 0 ? *overdue : Error::kSensorPortGone);
  }
  return std::nullopt;
}

template <typename Reading>
std::string_view RegisterClient<Reading>::do_words(Error error) const {
  if (error == Error::kSensorMalformed || error == Error::kSensorException) return refused_words_;
  if (error != Error::kSensorPortGone || errno_ == 0) return {};
  const char* const words = ::strerrordesc_np(errno_);
  return words == nullptr ? std::string_view() : words;
}

template class RegisterClient<hal::PointReading>;
template class RegisterClient<hal::LengthReading>;

}  // namespace armsig::linux_hal
