// SPDX-License-Identifier: MIT
// Writes the frames of a bus as a pcap file that Wireshark reads (link type 227, SocketCAN).
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "hal/simulated/virtual_can_bus.hpp"

namespace armsig::test {

class CanCapture final : public simulated::CanWatcher {
 public:
  explicit CanCapture(const std::string& path) : file_(path, std::ios::binary) {
    constexpr std::uint32_t kMagicNanoseconds = 0xA1B23C4D;
    constexpr std::uint32_t kLinkTypeSocketCan = 227;
    little(kMagicNanoseconds);
    little(0x00040002);  // version 2.4
    little(0);
    little(0);
    little(65535);
    little(kLinkTypeSocketCan);
  }

  [[nodiscard]] unsigned frames() const { return frames_; }
  void flush() { file_.flush(); }

 private:
  static constexpr std::uint32_t kHeaderBytes = 8;  // identifier (big-endian), length, padding

  void do_see(const hal::ReceivedCanFrame& received) override {
    const hal::CanFrame& frame = received.frame;
    const auto time = received.at.time_since_epoch().count();
    little(static_cast<std::uint32_t>(time / 1'000'000'000));
    little(static_cast<std::uint32_t>(time % 1'000'000'000));
    little(kHeaderBytes + frame.length);
    little(kHeaderBytes + frame.length);
    for (int shift = 24; shift >= 0; shift -= 8) byte(static_cast<std::uint8_t>(frame.id >> shift));
    byte(frame.length);
    for (int i = 0; i < 3; ++i) byte(0);
    for (unsigned i = 0; i < frame.length; ++i) byte(frame.data[i]);
    ++frames_;
  }
  void byte(std::uint8_t value) { file_.put(static_cast<char>(value)); }
  void little(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) byte(static_cast<std::uint8_t>(value >> shift));
  }

  std::ofstream file_;
  unsigned frames_ = 0;
};

}  // namespace armsig::test
