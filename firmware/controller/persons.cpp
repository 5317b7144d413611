// SPDX-License-Identifier: MIT
#include "firmware/controller/persons.hpp"

#ifndef ARMSIG_SMALL_IMAGE
#include <algorithm>
#include <span>

#include "core/base/crc32.hpp"
#include "firmware/controller/little_endian.hpp"
#include "hal/nonvolatile_memory.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kPersonsCrcAt = kPersonsBytes - 4;

void write_name(LittleEndianWriter& out, const PersonName& name) {
  out.integer(name.size(), 1);
  for (std::size_t i = 0; i < PersonName::capacity(); ++i) {
    out.integer(i < name.size() ? static_cast<std::uint8_t>(name[i]) : 0, 1);
  }
}

// False: it is longer than names are.
bool read_name(LittleEndianReader& in, PersonName& name) {
  const std::uint64_t letters = in.integer(1);
  for (std::size_t i = 0; i < PersonName::capacity(); ++i) {
    const auto letter = static_cast<char>(in.integer(1));
    if (i < letters) name.push_back(letter);
  }
  return letters <= PersonName::capacity();
}

std::uint32_t crc_with_record(const PersonsImage& image, std::uint32_t record_crc) {
  std::array<std::uint8_t, kPersonsBytes> bound{};
  LittleEndianWriter(bound).integer(record_crc, 4);
  std::copy_n(image.begin(), kPersonsCrcAt, bound.begin() + 4);
  return crc32(std::as_bytes(std::span(bound)));
}

}  // namespace

PersonsImage encode(const Persons& persons, std::uint32_t record_crc) {
  PersonsImage image{};
  if (persons.sender.empty() && persons.confirmer.empty()) {
    image.fill(hal::kErasedByte);
    return image;
  }
  LittleEndianWriter out(image);
  write_name(out, persons.sender);
  write_name(out, persons.confirmer);
  out.integer(0, 2);
  out.integer(crc_with_record(image, record_crc), 4);
  return image;
}

Persons decode_persons(const PersonsImage& image, std::uint32_t record_crc) {
  const bool erased =
      std::ranges::all_of(image, [](std::uint8_t byte) { return byte == hal::kErasedByte; });
  if (erased) return {};
  Persons persons;
  LittleEndianReader in(image);
  const bool named = read_name(in, persons.sender) && read_name(in, persons.confirmer);
  const std::uint64_t crc = LittleEndianReader(image, kPersonsCrcAt).integer(4);
  if (named && crc == crc_with_record(image, record_crc)) return persons;
  return {.sender = {}, .confirmer = {}, .unreadable = true};
}

}  // namespace armsig::controller
#endif
