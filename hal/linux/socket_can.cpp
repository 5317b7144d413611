// SPDX-License-Identifier: MIT
#include "hal/linux/socket_can.hpp"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "hal/linux/can_restart.hpp"
#include "hal/linux/steady_clock.hpp"

namespace armsig::linux_hal {
namespace {

// Error frames handled in one receive(), so that a storm of them does not keep the caller.
constexpr int kMaxErrorFrames = 32;
// A controller that stays on the bus this long has recovered.
constexpr hal::Duration kLastingRecovery = std::chrono::seconds(10);
constexpr std::uint32_t kOnlyBaseDataFrames = CAN_EFF_FLAG | CAN_RTR_FLAG;

// The bound of the interface's own queue is beyond a process's rights; this one keeps stale
// controlwords from piling up: some forty frames (each costs its socket buffer, 768 bytes and
// more).
constexpr int kSendBufferBytes = 32 * 1024;
constexpr int kReceiveBufferBytes = 1024 * 1024;

bool is_gone(int number) { return number == ENODEV || number == ENXIO || number == EBADF; }

template <typename T>
bool set_option(int socket, int level, int option, const T& value) {
  return ::setsockopt(socket, level, option, &value, sizeof value) == 0;
}

hal::Duration since_epoch(const timespec& time) {
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

}  // namespace

std::optional<unsigned> send_queue_frames(const std::string& interface_name) {
  ifreq request{};
  if (interface_name.size() >= sizeof request.ifr_name) return std::nullopt;
  std::memcpy(request.ifr_name, interface_name.c_str(), interface_name.size());
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (::ioctl(socket.get(), SIOCGIFTXQLEN, &request) != 0) return std::nullopt;
  return static_cast<unsigned>(request.ifr_qlen);
}

SocketCan::SocketCan(const SocketCanConfiguration& configuration) : configuration_(configuration) {
  (void)do_status();
}

int SocketCan::open_socket() {
  if (configuration_.interface_name.empty() || configuration_.interface_name.size() >= IFNAMSIZ) {
    return EINVAL;
  }
  FileDescriptor socket(::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW));
  if (!socket.valid()) return errno;
  const unsigned index = ::if_nametoindex(configuration_.interface_name.c_str());
  if (index == 0) return errno;

  std::array<can_filter, kMaxCanFilters> filters{};
  std::size_t count = 0;
  for (const CanFilter& filter : configuration_.filters) {
    filters[count++] = {filter.id & CAN_SFF_MASK,
                        (filter.mask & CAN_SFF_MASK) | kOnlyBaseDataFrames};
  }
  if (count == 0) filters[count++] = {0, kOnlyBaseDataFrames};
  const int number = socket.get();
  const can_err_mask_t errors = CAN_ERR_MASK;
  const int on = 1;
  const bool configured = ::setsockopt(number, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                       static_cast<socklen_t>(count * sizeof(can_filter))) == 0 &&
                          set_option(number, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, errors) &&
                          set_option(number, SOL_SOCKET, SO_TIMESTAMPNS, on) &&
                          set_option(number, SOL_SOCKET, SO_RXQ_OVFL, on) &&
                          set_option(number, SOL_SOCKET, SO_SNDBUF, kSendBufferBytes) &&
                          set_option(number, SOL_SOCKET, SO_RCVBUF, kReceiveBufferBytes);
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(index);
  if (!configured ||
      ::bind(number, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return errno;
  }
  socket_ = std::move(socket);
  interface_index_ = index;
  kernel_drops_ = 0;
  controller_ = hal::CanState::kActive;
  return 0;
}

void SocketCan::close_socket(int reason) {
  socket_.reset();
  up_ = false;
  last_errno_ = reason;
}

bool SocketCan::interface_is_up() {
  ifreq request{};
  std::memcpy(request.ifr_name, configuration_.interface_name.c_str(),
              configuration_.interface_name.size());
  if (::ioctl(socket_.get(), SIOCGIFFLAGS, &request) != 0) {
    if (is_gone(errno)) close_socket(errno);
    return false;
  }
  return (request.ifr_flags & IFF_UP) != 0;
}

Result<void> SocketCan::do_send(const hal::CanFrame& frame) {
  if (!up_) return std::unexpected(Error::kBusDown);
  if (controller_ == hal::CanState::kBusOff) return std::unexpected(Error::kBusOff);
  can_frame raw{};
  raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
  raw.len = frame.length;
  std::ranges::copy(frame.data, raw.data);
  if (::send(socket_.get(), &raw, sizeof raw, MSG_DONTWAIT) == sizeof raw) {
    ++counts_.sent;
    return {};
  }
  if (errno == EAGAIN || errno == ENOBUFS || errno == EINTR) {
    return std::unexpected(Error::kBusBusy);
  }
  if (is_gone(errno)) close_socket(errno);
  up_ = false;
  return std::unexpected(Error::kBusDown);
}

std::optional<hal::ReceivedCanFrame> SocketCan::do_receive() {
  for (int errors = 0; socket_.valid() && errors < kMaxErrorFrames; ++errors) {
    can_frame raw{};
    iovec part{.iov_base = &raw, .iov_len = sizeof raw};
    alignas(cmsghdr) std::array<char, 256> control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t count = ::recvmsg(socket_.get(), &message, MSG_DONTWAIT);
    if (count < 0) {
      if (errno == ENETDOWN) up_ = false;
      if (is_gone(errno)) close_socket(errno);
      return std::nullopt;
    }
    if (count != CAN_MTU || raw.len > CAN_MAX_DLEN) continue;
    const hal::Instant at = take_control(message);
    if ((raw.can_id & CAN_ERR_FLAG) != 0) {
      take_error_frame(raw.can_id & CAN_ERR_MASK, raw.data[1]);
      continue;
    }
    ++counts_.received;
    hal::ReceivedCanFrame received{.frame = {}, .at = at};
    received.frame.id = raw.can_id & CAN_SFF_MASK;
    received.frame.length = raw.len;
    std::ranges::copy(raw.data, received.frame.data.begin());
    return received;
  }
  return std::nullopt;
}

hal::Instant SocketCan::take_control(msghdr& message) {
  hal::Instant at = now_;
  for (cmsghdr* part = CMSG_FIRSTHDR(&message); part != nullptr;
       part = CMSG_NXTHDR(&message, part)) {
    if (part->cmsg_level != SOL_SOCKET) continue;
    if (part->cmsg_type == SO_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
      at = hal::Instant(since_epoch(stamp) - wall_ahead_);
    } else if (part->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t drops = 0;
      std::memcpy(&drops, CMSG_DATA(part), sizeof drops);
      counts_.lost += drops - kernel_drops_;
      kernel_drops_ = drops;
    }
  }
  return at;
}

// linux/can/error.h: classes in the identifier, the controller's status in data[1].
void SocketCan::take_error_frame(std::uint32_t error_class, std::uint8_t controller_status) {
  ++counts_.error_frames;
  if ((error_class & CAN_ERR_CRTL) != 0) {
    if ((controller_status & (CAN_ERR_CRTL_RX_OVERFLOW | CAN_ERR_CRTL_TX_OVERFLOW)) != 0) {
      ++counts_.lost;
    }
    if ((controller_status & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      controller_ = hal::CanState::kPassive;
    } else if ((controller_status & (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING)) != 0) {
      controller_ = hal::CanState::kWarning;
    } else if ((controller_status & CAN_ERR_CRTL_ACTIVE) != 0) {
      controller_ = hal::CanState::kActive;
    }
  }
  if ((error_class & CAN_ERR_RESTARTED) != 0) leave_bus_off();
  if ((error_class & CAN_ERR_BUSOFF) != 0 && controller_ != hal::CanState::kBusOff) {
    const hal::Instant now = monotonic_now();
    controller_ = hal::CanState::kBusOff;
    ++counts_.bus_offs;
    if (now - restarted_at_ > kLastingRecovery) restart_.succeed();
    restart_.fail(now);
  }
}

void SocketCan::leave_bus_off() {
  if (controller_ != hal::CanState::kBusOff) return;
  controller_ = hal::CanState::kActive;
  restarted_at_ = monotonic_now();
  ++counts_.restarts;
}

hal::CanStatus SocketCan::do_status() {
  const hal::Instant now = monotonic_now();
  timespec wall{};
  clock_gettime(CLOCK_REALTIME, &wall);
  now_ = now;
  wall_ahead_ = since_epoch(wall) - now.time_since_epoch();
  if (!socket_.valid() && reopen_.due(now)) {
    last_errno_ = open_socket();
    if (last_errno_ == 0) {
      reopen_.succeed();
    } else {
      reopen_.fail(now);
    }
  }
  const bool was_up = up_;
  up_ = socket_.valid() && interface_is_up();
  // A controller starts anew with its interface.
  if (up_ && !was_up) controller_ = hal::CanState::kActive;
  if (up_ && controller_ == hal::CanState::kBusOff && restart_.due(now)) {
    restart_asked_ = interface_index_;
    restart_.fail(now);
    if (!configuration_.maintained) maintain();
  }
  take_restart();
  return last_status();
}

void SocketCan::maintain() {
  const unsigned interface_index = restart_asked_.exchange(0);
  if (interface_index != 0) restart_result_ = restart_can_controller(interface_index);
}

void SocketCan::take_restart() {
  const int result = restart_result_.exchange(kNoResult);
  if (result == kNoResult) return;
  last_errno_ = result;
  // Where there is no controller to restart, there is none that is off the bus either. Elsewhere
  // an error frame tells when it is back.
  if (up_ && result == EOPNOTSUPP) leave_bus_off();
}

hal::CanStatus SocketCan::last_status() const {
  hal::CanStatus status = counts_;
  status.state = up_ ? controller_ : hal::CanState::kDown;
  return status;
}

}  // namespace armsig::linux_hal
