// SPDX-License-Identifier: MIT
// Who answers for a stored signature: who sent it, and who confirmed it in place of a measurement.
// They are stored behind the record, in what its last page has room for. The record itself, as it
// is fetched and sent, has them not: they are of this controller.
//
//   offset  bytes
//        0      1  letters of the sender's name, 0 to 32
//        1     32  the name; unused ones zero
//       33      1  letters of the name of who confirmed it
//       34     32  the name
//       66      2  zero
//       68      4  CRC-32 of the CRC-32 of the record and of all before
// Of a record that nobody sent all are as after an erase.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::controller {

// Of a person, as they tell it.
using PersonName = FixedVector<char, 32>;

[[nodiscard]] inline std::string_view view(const PersonName& name) {
  return {name.data(), name.size()};
}

#ifndef ARMSIG_SMALL_IMAGE
struct Persons {
  PersonName sender;        // empty: nobody sent it, or without a name
  PersonName confirmer;     // empty: it was measured
  bool unreadable = false;  // something is stored that is no names
};

inline constexpr std::size_t kPersonsBytes = 72;
using PersonsImage = std::array<std::uint8_t, kPersonsBytes>;

// `record_crc`: crc_of() the record that they answer for.
[[nodiscard]] PersonsImage encode(const Persons& persons, std::uint32_t record_crc);
[[nodiscard]] Persons decode_persons(const PersonsImage& image, std::uint32_t record_crc);
#else
inline constexpr std::size_t kPersonsBytes = 0;
#endif

}  // namespace armsig::controller
