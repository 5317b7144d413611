// SPDX-License-Identifier: MIT
// The bridge of an emulated tracker: tells armsigd by TCP where the target is.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "hal/clock.hpp"
#include "hal/linux/file_descriptor.hpp"
#include "hal/simulated/cartesian_sensor.hpp"

namespace armsig::bench {

class PointBridge {
 public:
  PointBridge(std::uint16_t port, hal::Duration period, double sigma_m, std::uint64_t seed)
      : port_(port),
        period_(period),
        tracker_({.sigma_m = sigma_m,
                  .dropout_probability = 0,
                  .outlier_probability = 0,
                  .least_outlier_m = 0,
                  .largest_outlier_m = 0},
                 simulated::Random(seed)) {}

  // To be called often: each period a line, where somebody listens.
  void run(hal::Instant now, const Vector3& target_S) {
    if (now < next_) return;
    next_ = now + period_;
    if (!socket_.valid()) connect();
    if (!socket_.valid()) return;
    const Vector3 p_mm = 1e3 * tracker_.measure(target_S).p_S;
    const std::string line = fmt::format("point x_mm={:.4f} y_mm={:.4f} z_mm={:.4f} seq={}\n",
                                         p_mm.x(), p_mm.y(), p_mm.z(), ++sequence_);
    const ssize_t sent =
        ::send(socket_.get(), line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent != static_cast<ssize_t>(line.size())) socket_.reset();
  }

 private:
  void connect() {
    linux_hal::FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port_);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const bool connected =
        ::connect(socket.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    if (connected) socket_ = std::move(socket);
  }

  std::uint16_t port_;
  hal::Duration period_;
  simulated::CartesianSensor tracker_;
  linux_hal::FileDescriptor socket_;
  hal::Instant next_;
  std::uint32_t sequence_ = 0;
};

}  // namespace armsig::bench
