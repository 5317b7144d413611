// SPDX-License-Identifier: MIT
// A Modbus RTU server on one end of a pseudo-terminal, in a thread of its own.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "hal/linux/file_descriptor.hpp"

namespace armsig::test {

class PtyServer {
 public:
  using Bytes = std::vector<std::uint8_t>;
  // The answer to a request of eight bytes, on the server's thread; empty: none.
  using Script = std::function<Bytes(const Bytes&)>;

  explicit PtyServer(Script script) : script_(std::move(script)) {
    master_ = linux_hal::FileDescriptor(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC));
    EXPECT_EQ(grantpt(master_.get()), 0);
    EXPECT_EQ(unlockpt(master_.get()), 0);
    device = ptsname(master_.get());
    // Held open, or the line would hang up whenever the other side closes it.
    slave_ = linux_hal::FileDescriptor(::open(device.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC));
    termios settings{};
    tcgetattr(slave_.get(), &settings);
    cfmakeraw(&settings);
    tcsetattr(slave_.get(), TCSANOW, &settings);
    thread_ = std::thread([this] { serve(); });
  }
  ~PtyServer() { stop(); }
  PtyServer(const PtyServer&) = delete;
  PtyServer& operator=(const PtyServer&) = delete;

  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  void unplug() {
    stop();
    slave_.reset();
    master_.reset();
  }

  std::string device;

 private:
  static constexpr std::size_t kRequestBytes = 8;

  void serve() {
    Bytes request;
    while (!stop_) {
      pollfd ready{.fd = master_.get(), .events = POLLIN, .revents = 0};
      if (::poll(&ready, 1, 10) <= 0) continue;
      std::array<std::uint8_t, 64> buffer{};
      const ssize_t count = ::read(master_.get(), buffer.data(), buffer.size());
      if (count <= 0) continue;
      request.insert(request.end(), buffer.begin(), buffer.begin() + count);
      if (request.size() < kRequestBytes) continue;
      const Bytes answer = script_(request);
      request.clear();
      if (!answer.empty()) {
        EXPECT_EQ(::write(master_.get(), answer.data(), answer.size()),
                  static_cast<ssize_t>(answer.size()));
      }
    }
  }

  Script script_;
  linux_hal::FileDescriptor master_;
  linux_hal::FileDescriptor slave_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace armsig::test
