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

// The remainder of each byte followed by as many zero bytes as the table's index, so that four
// bytes are taken at once (slicing by four; Kounavis and Berry, A systematic approach to building
// high performance software-based CRC generators, 2005).
inline constexpr auto kCrc32Tables = [] {
  std::array<std::array<std::uint32_t, 256>, 4> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) {
      remainder = (remainder & 1U) != 0 ? (remainder >> 1U) ^ 0xEDB88320U : remainder >> 1U;
    }
    tables[0][byte] = remainder;
  }
  for (std::size_t zeros = 1; zeros < tables.size(); ++zeros) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t shorter = tables[zeros - 1][byte];
      tables[zeros][byte] = tables[0][shorter & 0xFFU] ^ (shorter >> 8U);
    }
  }
  return tables;
}();

// The remainder after one more byte; the CRC-32 is its complement, and so is where it begins.
[[nodiscard]] constexpr std::uint32_t crc32_remainder(std::uint32_t before, std::uint8_t byte) {
  return kCrc32Tables[0][(before ^ byte) & 0xFFU] ^ (before >> 8U);
}

// The CRC-32 of `bytes`; to continue over a further piece, pass the CRC of what went before.
[[nodiscard]] constexpr std::uint32_t crc32(std::span<const std::byte> bytes,
                                            std::uint32_t before = 0) {
  const auto at = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  std::uint32_t crc = ~before;
  std::size_t i = 0;
  for (; i + 4 <= bytes.size(); i += 4) {
    crc ^= at(i) | at(i + 1) << 8U | at(i + 2) << 16U | at(i + 3) << 24U;
    crc = kCrc32Tables[3][crc & 0xFFU] ^ kCrc32Tables[2][(crc >> 8U) & 0xFFU] ^
          kCrc32Tables[1][(crc >> 16U) & 0xFFU] ^ kCrc32Tables[0][crc >> 24U];
  }
  for (; i < bytes.size(); ++i) {
    crc = crc32_remainder(crc, std::to_integer<std::uint8_t>(bytes[i]));
  }
  return ~crc;
}

}  // namespace armsig
