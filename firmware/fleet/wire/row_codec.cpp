// SPDX-License-Identifier: MIT
#include "firmware/fleet/wire/row_codec.hpp"

#include <bit>

namespace armsig::fleet {
namespace {

constexpr std::byte kAbsent{0x80};  // with the number of the item: it has no value

void put_eight(RowBytes& row, std::uint64_t bits) {
  for (int i = 0; i < 8; ++i) row.push_back(static_cast<std::byte>(bits >> (8 * i) & 0xFFU));
}

std::size_t size_of(const Value& value) {
  if (std::holds_alternative<std::monostate>(value)) return 1;
  if (std::holds_alternative<bool>(value)) return 2;
  if (const Text* text = std::get_if<Text>(&value)) return 2 + text->view().size();
  return 9;
}

// Takes bytes from the front as long as there are enough.
class Bytes {
 public:
  explicit Bytes(std::span<const std::byte> bytes) : left_(bytes) {}
  [[nodiscard]] bool empty() const { return left_.empty(); }
  [[nodiscard]] std::span<const std::byte> take(std::size_t count) {
    if (left_.size() < count) {
      good_ = false;
      left_ = {};
      return {};
    }
    const auto taken = left_.first(count);
    left_ = left_.subspan(count);
    return taken;
  }
  [[nodiscard]] std::uint64_t number(std::size_t size) {
    std::uint64_t bits = 0;
    int shift = 0;
    for (const std::byte byte : take(size)) {
      bits |= std::to_integer<std::uint64_t>(byte) << shift;
      shift += 8;
    }
    return bits;
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  std::span<const std::byte> left_;
  bool good_ = true;
};

Value value_of(Datatype type, Bytes& bytes) {
  switch (type) {
    case Datatype::kDouble:
      return std::bit_cast<double>(bytes.number(8));
    case Datatype::kBoolean:
      return bytes.number(1) != 0;
    case Datatype::kString: {
      const auto text = bytes.take(bytes.number(1));
      return Text({reinterpret_cast<const char*>(text.data()), text.size()});
    }
    default:
      return bytes.number(8);
  }
}

}  // namespace

bool suits(Item item, const Value& value) {
  if (std::holds_alternative<std::monostate>(value)) return true;
  switch (info(item).type) {
    case Datatype::kDouble:
      return std::holds_alternative<double>(value);
    case Datatype::kBoolean:
      return std::holds_alternative<bool>(value);
    case Datatype::kString:
      return std::holds_alternative<Text>(value);
    default:
      return std::holds_alternative<std::uint64_t>(value);
  }
}

bool add_reading(RowBytes& row, const Reading& reading) {
  if (!suits(reading.item, reading.value)) return false;
  if (row.size() + size_of(reading.value) > RowBytes::capacity()) return false;
  const auto number = static_cast<std::byte>(reading.item);
  const Value& value = reading.value;
  row.push_back(std::holds_alternative<std::monostate>(value) ? number | kAbsent : number);
  if (const auto* integer = std::get_if<std::uint64_t>(&value)) put_eight(row, *integer);
  if (const auto* real = std::get_if<double>(&value)) {
    put_eight(row, std::bit_cast<std::uint64_t>(*real));
  }
  if (const auto* flag = std::get_if<bool>(&value)) row.push_back(std::byte{*flag});
  if (const auto* text = std::get_if<Text>(&value)) {
    row.push_back(static_cast<std::byte>(text->view().size()));
    for (const char c : text->view()) row.push_back(static_cast<std::byte>(c));
  }
  return true;
}

Result<Readings> readings_of(std::span<const std::byte> row) {
  Bytes bytes(row);
  Readings readings;
  while (!bytes.empty()) {
    const std::uint64_t first = bytes.number(1);
    const auto item = item_of(first & 0x7FU);
    if (!item || readings.full()) return std::unexpected(Error::kRecordCorrupt);
    Reading reading{*item, {}};
    if ((first & 0x80U) == 0) reading.value = value_of(info(*item).type, bytes);
    if (!bytes.good()) return std::unexpected(Error::kRecordCorrupt);
    for (const Reading& other : readings) {
      if (other.item == *item) return std::unexpected(Error::kRecordCorrupt);
    }
    readings.push_back(reading);
  }
  return readings;
}

}  // namespace armsig::fleet
