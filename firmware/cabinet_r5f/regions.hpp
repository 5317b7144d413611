// SPDX-License-Identifier: MIT
// What the controller's core may touch, and how: of silicon; the emulated board adds to it.
#pragma once

#include <array>

#include "toolchain/boards/r5f/protection.hpp"

namespace armsig::cabinet {

inline constexpr std::uint8_t kLowerHalf = 0x0F;
inline constexpr std::uint8_t kUpperHalf = 0xF0;
inline constexpr std::uint8_t kUpperThreeEighths = 0xE0;

// The bank is not cached: a reset throws away what lies in the cache, and nobody cleans it first.
inline constexpr std::array kRegions{
    board::Region{0x0000'0000, 16, board::kCodeUncached, 0},   // ATCM: vectors, start-up
    board::Region{0x0002'0000, 16, board::kData, 0},           // BTCM: stack, constants
    board::Region{0x0002'C000, 14, board::kCodeUncached, 0},   // BTCM: code that is rarely run
    board::Region{0xFFFC'0000, 18, board::kCode, kUpperHalf},  // OCM: code
    board::Region{0xFFFC'0000, 18, board::kData, kLowerHalf},  // OCM: data
    board::Region{0xFFFE'0000, 14, board::kCode, kUpperThreeEighths},  // OCM: 10 KiB more of code
    board::Region{0xFFFF'C000, 14, board::kShared, 0},                 // OCM: the bank, 16 KiB
    board::Region{0xFF00'0000, 21, board::kDevice, 0},  // peripherals of the low-power domain
};

}  // namespace armsig::cabinet
