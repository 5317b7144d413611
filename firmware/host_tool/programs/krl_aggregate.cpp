// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/krl_aggregate.hpp"

#include <algorithm>
#include <charconv>

#include "firmware/formats/text.hpp"

namespace armsig::tool {

std::optional<std::vector<Bytes>> KrlAggregate::all(std::span<const std::string_view> names) const {
  std::vector<Bytes> found;
  for (const std::string_view name : names) {
    const auto number = numbers.find(std::string(name));
    if (number == numbers.end()) return std::nullopt;
    found.push_back(number->second);
  }
  return found;
}

long krl_bits(std::string_view text) {
  long value = 0;
  const int base = text.starts_with("'B") ? 2 : 16;
  if (text.size() < 4) return 0;
  text = trimmed(text.substr(2, text.size() - 3));
  std::from_chars(text.data(), text.data() + text.size(), value, base);
  return value;
}

KrlAggregate krl_aggregate_at(std::string_view text, std::size_t at) {
  KrlAggregate aggregate{at, std::min(text.find_first_of("}\n", at), text.size()), {}, {}};
  ProgramScanner scanner(text.substr(0, aggregate.end), at + 1);
  std::string name(scanner.word());
  if (scanner.accept(':')) name = scanner.word();
  while (!name.empty()) {
    // Without a blank before it another number could run into the name.
    const auto number = scanner.number();
    if (number && !is_word(text[number->begin - 1])) aggregate.numbers[name] = *number;
    const std::size_t bits = scanner.at();
    if (!number && scanner.accept('\'')) {
      const std::size_t close = text.substr(0, aggregate.end).find('\'', scanner.at());
      if (close != std::string_view::npos) {
        aggregate.bits[name] = trimmed_bytes(text, {bits, close + 1});
      }
    }
    const std::size_t comma = text.substr(0, aggregate.end).find(',', scanner.at());
    if (comma == std::string_view::npos) break;
    scanner.go_to(comma + 1);
    name = scanner.word();
  }
  return aggregate;
}

}  // namespace armsig::tool
