// SPDX-License-Identifier: MIT
#include "hal/linux/line_server.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace armsig::linux_hal {
namespace {

constexpr int kMostWaiting = 8;
// In one call; an instrument that sends more has its readings counted as old.
constexpr std::size_t kMostBytes = std::size_t{16} * 1024;
constexpr std::size_t kWords = 160;

// One that does not take it has not read it.
void tell(const FileDescriptor& socket, std::string_view words) {
  (void)::send(socket.get(), words.data(), words.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace

template <typename Line>
LineServer<Line>::LineServer(const LineServerConfiguration& configuration)
    : configuration_(configuration),
      nobody_("nobody is connected to " + configuration.address + " port " +
              std::to_string(configuration.port)),
      freshness_(configuration.freshness) {
  configuration_.client = canonical_address(configuration.client);
  malformed_words_.reserve(kWords);
  reply_.reserve(kWords);
}

template <typename Line>
std::uint16_t LineServer<Line>::port() const {
  SocketAddress address;
  address.size = sizeof address.storage;
  if (!listener_.valid() ||
      ::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&address.storage),
                    &address.size) != 0) {
    return 0;
  }
  sockaddr_in v4{};  // whose port is where that of IPv6 is
  std::memcpy(&v4, &address.storage, sizeof v4);
  return ntohs(v4.sin_port);
}

template <typename Line>
void LineServer<Line>::listen(hal::Instant now) {
  if (listener_.valid() || !reopen_.due(now)) return;
  const auto address = address_of(configuration_.address, configuration_.port);
  listen_errno_ = EAFNOSUPPORT;
  if (!address) return;
  FileDescriptor socket(
      ::socket(address->storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  constexpr int kYes = 1;
  const bool listens =
      socket.valid() &&
      ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &kYes, sizeof kYes) == 0 &&
      ::bind(socket.get(), address->get(), address->size) == 0 &&
      ::listen(socket.get(), kMostWaiting) == 0;
  listen_errno_ = listens ? 0 : std::max(errno, 1);
  if (!listens) {
    reopen_.fail(now);
    return;
  }
  listener_ = std::move(socket);
}

template <typename Line>
bool LineServer<Line>::is_in_use(hal::Instant now) const {
  return client_.valid() && now - read_at_ <= configuration_.freshness.silent_after;
}

template <typename Line>
void LineServer<Line>::take_client(FileDescriptor socket, hal::Instant now) {
  if (client_.valid()) tell(client_, "error why=\"another instrument has connected\"\n");
  client_ = std::move(socket);
  line_.clear();
  discarding_ = false;
  lines_ = 0;
  newest_.reset();
  read_at_ = now;
}

template <typename Line>
void LineServer<Line>::accept_all(hal::Instant now) {
  for (int i = 0; i < kMostWaiting; ++i) {
    SocketAddress peer;
    peer.size = sizeof peer.storage;
    FileDescriptor socket(::accept4(listener_.get(), reinterpret_cast<sockaddr*>(&peer.storage),
                                    &peer.size, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (!socket.valid()) return;
    if (!configuration_.client.empty() && text_of(peer.storage) != configuration_.client) {
      tell(socket, "error why=\"the configuration names another client\"\n");
    } else if (is_in_use(now)) {
      tell(socket, "error why=\"another instrument is connected\"\n");
    } else {
      take_client(std::move(socket), now);
    }
  }
}

template <typename Line>
bool LineServer<Line>::receive(hal::Instant now) {
  std::array<char, 2048> bytes{};
  for (std::size_t taken = 0; taken < kMostBytes;) {
    const ssize_t count = ::recv(client_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (count < 0 && errno == EINTR) return false;  // there may be more
    if (count < 0 && errno == EAGAIN) return true;
    if (count <= 0) {
      client_.reset();
      return true;
    }
    taken += static_cast<std::size_t>(count);
    take_bytes({bytes.data(), static_cast<std::size_t>(count)}, now);
  }
  return false;
}

template <typename Line>
void LineServer<Line>::take_bytes(std::string_view bytes, hal::Instant now) {
  for (const char c : bytes) {
    if (c == '\n') {
      end_line(now);
    } else if (!line_.full()) {
      line_.push_back(c);
    } else if (!discarding_) {
      discarding_ = true;
      refuse_line({"the line", "is too long"});
    }
  }
}

template <typename Line>
void LineServer<Line>::end_line(hal::Instant now) {
  std::string_view line(line_.data(), line_.size());
  if (line.ends_with('\r')) line.remove_suffix(1);
  const bool is_told = !line.empty() && !line.starts_with('#');
  if (is_told && !discarding_) take_line(line, now);
  discarding_ = false;
  line_.clear();
  ++lines_;
}

template <typename Line>
void LineServer<Line>::take_line(std::string_view line, hal::Instant now) {
  const auto told = Line::parse(line);
  if (!told) {
    refuse_line(told.error());
    return;
  }
  read_at_ = now;
  const std::uint32_t sequence = told->sequence.value_or(unnumbered_++);
  if (!freshness_.take(sequence, now)) return;
  newest_ = told->reading(std::min(drained_at_, now) - configuration_.age, sequence);
}

template <typename Line>
void LineServer<Line>::refuse_line(const LineProblem& problem) {
  ++malformed_;
  spoilt_ = true;
  // Both have room: nothing is allocated while an arm is measured.
  malformed_words_.assign("line ").append(std::to_string(lines_ + 1)).append(": ");
  malformed_words_.append(problem.key).append(" ").append(problem.what);
  reply_.assign("error why=\"").append(malformed_words_).append("\"\n");
  tell(client_, reply_);
}

template <typename Line>
Result<std::optional<typename Line::Reading>> LineServer<Line>::do_poll(hal::Instant now) {
  listen(now);
  if (listener_.valid()) accept_all(now);
  spoilt_ = false;
  if (!client_.valid() || receive(now)) drained_at_ = now;
  if (newest_) return std::exchange(newest_, std::nullopt);
  if (spoilt_) return std::unexpected(Error::kSensorMalformed);
  if (const auto overdue = freshness_.overdue(now)) {
    return std::unexpected(client_.valid() ? *overdue : Error::kSensorPortGone);
  }
  return std::nullopt;
}

template <typename Line>
std::string_view LineServer<Line>::do_words(Error error) const {
  if (error == Error::kSensorMalformed) return malformed_words_;
  if (error != Error::kSensorPortGone) return {};
  if (listen_errno_ == 0) return nobody_;
  const char* const words = ::strerrordesc_np(listen_errno_);
  return words == nullptr ? std::string_view() : words;
}

template class LineServer<PointLine>;
template class LineServer<LengthLine>;

}  // namespace armsig::linux_hal
