// SPDX-License-Identifier: MIT
// What the controller's core may touch, and how: of silicon; the emulated board adds to it.
#pragma once

#include <array>

#include "toolchain/boards/r5f/protection.hpp"

namespace armsig::cabinet {

inline constexpr std::uint8_t kLowest = 0x01;
inline constexpr std::uint8_t kLowestThree = 0x07;
inline constexpr std::uint8_t kLowerHalf = 0x0F;
inline constexpr std::uint8_t kUpperHalf = 0xF0;
inline constexpr std::uint8_t kUpperQuarter = 0xC0;
inline constexpr std::uint8_t kAllButLowestThree = 0xF8;

// The bank is not cached: a reset throws away what lies in the cache, and nobody cleans it first.
inline constexpr std::array kRegions{
    board::Region{0x0000'0000, 16, board::kCodeUncached, 0},  // ATCM: vectors, start-up
    board::Region{0x0002'0000, 16, board::kData, 0},          // BTCM: stack, constants
    board::Region{0x0002'A000, 13, board::kCodeUncached,
                  kLowestThree},  // BTCM: code that is rarely run
    board::Region{0x0002'C000, 14, board::kCodeUncached, 0},
    board::Region{0xFFFC'0000, 18, board::kCode, kUpperHalf},          // OCM: code
    board::Region{0xFFFC'0000, 18, board::kData, kLowerHalf},          // OCM: data
    board::Region{0xFFFE'0000, 15, board::kCode, kUpperQuarter},       // OCM: 24 KiB more of code
    board::Region{0xFFFE'6000, 13, board::kCode, kAllButLowestThree},  // and 3 KiB
    board::Region{0xFFFF'C000, 13, board::kShared, kLowest},           // OCM: the bank, 15 KiB
    board::Region{0xFFFF'E000, 13, board::kShared, 0},
    board::Region{0xFF00'0000, 21, board::kDevice, 0},  // peripherals of the low-power domain
};

}  // namespace armsig::cabinet
