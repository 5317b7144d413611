// SPDX-License-Identifier: MIT
// The readings of one row as bytes of the journal: number of the item, then eight bytes, one, or a
// length and so many.
#pragma once

#include <span>

#include "core/base/error.hpp"
#include "firmware/fleet/wire/items.hpp"

namespace armsig::fleet {

inline constexpr std::size_t kLongestRowBytes = 208;
using RowBytes = FixedVector<std::byte, kLongestRowBytes>;

// Appends `reading`; false, and nothing changed, where there is no room.
[[nodiscard]] bool add_reading(RowBytes& row, const Reading& reading);

// Errors: kRecordCorrupt (what nobody wrote, or an item twice).
[[nodiscard]] Result<Readings> readings_of(std::span<const std::byte> row);

}  // namespace armsig::fleet
