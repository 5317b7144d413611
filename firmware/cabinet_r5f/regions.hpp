// SPDX-License-Identifier: MIT
// What the controller's core may touch, and how: of silicon; the emulated board adds to it.
#pragma once

#include <array>

#include "toolchain/boards/r5f/protection.hpp"

namespace armsig::cabinet {

inline constexpr std::uint8_t kLowest = 0x01;
inline constexpr std::uint8_t kLowerQuarter = 0x03;
inline constexpr std::uint8_t kLowerHalf = 0x0F;
inline constexpr std::uint8_t kUpperHalf = 0xF0;
inline constexpr std::uint8_t kHighest = 0x80;

// The bank is not cached: a reset throws away what lies in the cache, and nobody cleans it first.
inline constexpr std::array kRegions{
    board::Region{0x0000'0000, 16, board::kCodeUncached, 0},  // ATCM: vectors, start-up
    board::Region{0x0002'0000, 16, board::kData, 0},          // BTCM: stack, constants
    board::Region{0x0002'A000, 13, board::kCodeUncached,
                  kLowerQuarter},  // BTCM: code that is rarely run
    board::Region{0x0002'C000, 14, board::kCodeUncached, 0},
    board::Region{0xFFFC'0000, 18, board::kCode, kUpperHalf},  // OCM: code
    board::Region{0xFFFC'0000, 18, board::kData, kLowerHalf},  // OCM: data
    board::Region{0xFFFE'0000, 14, board::kCode, kHighest},    // OCM: 14 KiB more of code
    board::Region{0xFFFF'C000, 13, board::kShared, kLowest},   // OCM: the bank, 15 KiB
    board::Region{0xFFFF'E000, 13, board::kShared, 0},
    board::Region{0xFF00'0000, 21, board::kDevice, 0},  // peripherals of the low-power domain
};

}  // namespace armsig::cabinet
