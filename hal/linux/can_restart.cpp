// SPDX-License-Identifier: MIT
#include "hal/linux/can_restart.hpp"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "hal/linux/file_descriptor.hpp"

namespace armsig::linux_hal {
namespace {

// A netlink message RTM_NEWLINK that is filled from front to back (rtnetlink(7)).
class LinkRequest {
 public:
  explicit LinkRequest(unsigned interface_index) {
    ifinfomsg link{};
    link.ifi_family = AF_UNSPEC;
    link.ifi_index = static_cast<int>(interface_index);
    put(&link, sizeof link);
  }

  // Opens an attribute that contains the following ones, until close() of its position.
  std::size_t open(std::uint16_t type) {
    const std::size_t at = size_;
    const rtattr header{.rta_len = 0, .rta_type = type};
    put(&header, sizeof header);
    return at;
  }
  void close(std::size_t at) {
    const auto length = static_cast<std::uint16_t>(size_ - at);
    std::memcpy(bytes_.data() + at + offsetof(rtattr, rta_len), &length, sizeof length);
  }
  void attribute(std::uint16_t type, const void* value, std::size_t length) {
    const std::size_t at = open(type);
    put(value, length);
    close(at);
    size_ = NLMSG_ALIGN(size_);
  }
  // The whole message, asking for an acknowledgement.
  const void* finish() {
    const nlmsghdr header{.nlmsg_len = static_cast<std::uint32_t>(size_),
                          .nlmsg_type = RTM_NEWLINK,
                          .nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK,
                          .nlmsg_seq = 1,
                          .nlmsg_pid = 0};
    std::memcpy(bytes_.data(), &header, sizeof header);
    return bytes_.data();
  }
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void put(const void* value, std::size_t length) {
    std::memcpy(bytes_.data() + size_, value, length);
    size_ += length;
  }

  alignas(nlmsghdr) std::array<std::byte, 128> bytes_{};
  std::size_t size_ = NLMSG_HDRLEN;
};

}  // namespace

int restart_can_controller(unsigned interface_index) {
  LinkRequest request(interface_index);
  const std::size_t info = request.open(IFLA_LINKINFO);
  request.attribute(IFLA_INFO_KIND, "can", 3);
  const std::size_t data = request.open(IFLA_INFO_DATA);
  const std::uint32_t restart = 1;
  request.attribute(IFLA_CAN_RESTART, &restart, sizeof restart);
  request.close(data);
  request.close(info);

  const FileDescriptor socket(
      ::socket(AF_NETLINK, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, NETLINK_ROUTE));
  const void* message = request.finish();
  if (!socket.valid() || ::send(socket.get(), message, request.size(), 0) < 0) return errno;
  // The kernel has carried the request out before send() returned; its answer is there already.
  struct {
    nlmsghdr header;
    nlmsgerr error;
    std::array<std::byte, 256> echo;
  } answer{};
  const ssize_t count = ::recv(socket.get(), &answer, sizeof answer, 0);
  if (count < static_cast<ssize_t>(sizeof(nlmsghdr) + sizeof(int)) ||
      answer.header.nlmsg_type != NLMSG_ERROR) {
    return EIO;
  }
  return -answer.error.error;
}

}  // namespace armsig::linux_hal
