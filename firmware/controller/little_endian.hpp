// SPDX-License-Identifier: MIT
// Numbers as bytes in non-volatile memory, the low byte first.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

namespace armsig::controller {

class LittleEndianWriter {
 public:
  explicit LittleEndianWriter(std::span<std::uint8_t> image) : image_(image) {}
  void integer(std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) {
      image_[at_++] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }
  void real(double value) { integer(std::bit_cast<std::uint64_t>(value), 8); }

 private:
  std::span<std::uint8_t> image_;
  std::size_t at_ = 0;
};

class LittleEndianReader {
 public:
  explicit LittleEndianReader(std::span<const std::uint8_t> image, std::size_t at = 0)
      : image_(image), at_(at) {}
  std::uint64_t integer(std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      value |= static_cast<std::uint64_t>(image_[at_++]) << (8 * i);
    }
    return value;
  }
  double real() {
    const auto value = std::bit_cast<double>(integer(8));
    finite_ = finite_ && std::isfinite(value);
    return value;
  }
  [[nodiscard]] bool all_finite() const { return finite_; }

 private:
  std::span<const std::uint8_t> image_;
  std::size_t at_;
  bool finite_ = true;
};

}  // namespace armsig::controller
