// SPDX-License-Identifier: MIT
// CRC-32 of IEEE 802.3: reflected polynomial 0xEDB88320, initial value and final complement of all
// ones. It guards signature files and the records in flash; the check value of "123456789" is
// 0xCBF43926.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace armsig {

inline constexpr std::array<std::uint32_t, 256> kCrc32Table = [] {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 1U) != 0 ? (remainder >> 1U) ^ 0xEDB88320U : remainder >> 1U;
    }
    table[byte] = remainder;
  }
  return table;
}();

// The remainder after one more byte; the CRC-32 is its complement, and so is where it begins.
[[nodiscard]] constexpr std::uint32_t crc32_remainder(std::uint32_t before, std::uint8_t byte) {
  return kCrc32Table[(before ^ byte) & 0xFFU] ^ (before >> 8U);
}

// The CRC-32 of `bytes`; to continue over a further piece, pass the CRC of what went before.
[[nodiscard]] constexpr std::uint32_t crc32(std::span<const std::byte> bytes,
                                            std::uint32_t before = 0) {
  std::uint32_t crc = ~before;
  for (const std::byte byte : bytes) {
    crc = crc32_remainder(crc, std::to_integer<std::uint8_t>(byte));
  }
  return ~crc;
}

}  // namespace armsig
