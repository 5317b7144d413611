// SPDX-License-Identifier: MIT
// Numbers as bytes in non-volatile memory, the low byte first.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <span>

#include "core/base/crc32.hpp"

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

// Writes a part of an image that is written from its beginning, and knows the CRC-32 of all that
// was written: an image need not be in memory as a whole to be told in parts.
class PartWriter {
 public:
  // `part` is from byte `begin` of the image on.
  PartWriter(std::span<std::uint8_t> part, std::size_t begin) : part_(part), begin_(begin) {}
  void integer(std::uint64_t value, std::size_t bytes) {
    // Every byte of every record comes by here: as little as can be for each.
    for (; bytes > 0; --bytes, value >>= 8U, ++at_) {
      const auto byte = static_cast<std::uint8_t>(value);
      if (at_ - begin_ < part_.size()) part_[at_ - begin_] = byte;  // wraps before the part
      remainder_ = crc32_remainder(remainder_, byte);
    }
  }
  void real(double value) { integer(std::bit_cast<std::uint64_t>(value), 8); }
  [[nodiscard]] std::uint32_t crc() const { return ~remainder_; }

 private:
  std::span<std::uint8_t> part_;
  std::size_t begin_;
  std::size_t at_ = 0;
  std::uint32_t remainder_ = ~std::uint32_t{0};
};

class LittleEndianReader {
 public:
  explicit LittleEndianReader(std::span<const std::uint8_t> image, std::size_t at = 0)
      : image_(image), at_(at) {}
  std::uint64_t integer(std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = bytes; i-- > 0;) value = value << 8U | image_[at_ + i];
    at_ += bytes;
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
