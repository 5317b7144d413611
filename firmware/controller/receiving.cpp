// SPDX-License-Identifier: MIT
#include "firmware/controller/receiving.hpp"

#include <algorithm>

namespace armsig::controller {
namespace {

struct Part {
  double bytes = 0;
  double number = 0;
  std::string_view hex;
};

Result<Part> part_in(const Request& request, Line& out) {
  Part part;
  for (const auto& [key, value] : request.arguments) {
    if (key == "hex") {
      part.hex = value;
      continue;
    }
    if (key != "bytes" && key != "part") return std::unexpected(Error::kUnknownRequest);
    ARMSIG_TRY(number, needed_number(key, value, out));
    (key == "bytes" ? part.bytes : part.number) = number;
  }
  if (request.arguments.size() != 3) return std::unexpected(Error::kUnknownRequest);
  return part;
}

// Of a hexadecimal digit; 16 for anything else.
std::uint8_t value_of_digit(char c) {
  if (c >= '0' && c <= '9') return static_cast<std::uint8_t>(c - '0');
  if (c >= 'a' && c <= 'f') return static_cast<std::uint8_t>(c - 'a' + 10);
  return 16;
}

}  // namespace

std::uint32_t told_drawing_crc(const Arm& drawing) {
  Arm told = drawing;
  told.couplings = {};
  return drawing_crc(told);
}

Result<bool> Receiving::take(const Request& request, Line& out) {
  const auto part = part_in(request, out);
  if (!part) return std::unexpected(part.error());
  constexpr auto kBytes = static_cast<double>(kRecordBytes);
  if (part->bytes > kBytes) return std::unexpected(Error::kCapacityExceeded);
  if (part->bytes != kBytes) return std::unexpected(Error::kRecordCorrupt);
  if (part->number == 1) received_ = 0;
  const std::size_t next = received_ / kPartBytes + 1;
  if (received_ == kRecordBytes || part->number != static_cast<double>(next)) {
    return std::unexpected(Error::kOutOfRange);
  }
  const std::size_t count = std::min(kPartBytes, kRecordBytes - received_);
  if (part->hex.size() != 2 * count) return std::unexpected(Error::kRecordCorrupt);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t high = value_of_digit(part->hex[2 * i]);
    const std::uint8_t low = value_of_digit(part->hex[2 * i + 1]);
    if (high > 15 || low > 15) return std::unexpected(Error::kUnknownRequest);
    image_[received_ + i] = static_cast<std::uint8_t>(high << 4U | low);
  }
  received_ += count;
  return received_ == kRecordBytes;
}

Result<void> Receiving::open(const Arm& drawing, SignatureRecord& record) const {
  if (auto decoded = decode(image_, drawing, record); !decoded) return decoded;
  if (record.signature.targets.empty()) return std::unexpected(Error::kRecordUnsuitable);
  if (record.machine.drawing_crc != told_drawing_crc(drawing)) {
    return std::unexpected(Error::kRecordOtherMachine);
  }
  return {};
}

}  // namespace armsig::controller
