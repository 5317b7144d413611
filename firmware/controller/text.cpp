// SPDX-License-Identifier: MIT
#include "firmware/controller/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/error_name.hpp"
#include "core/base/pose.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::controller {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view next_word(std::string_view& rest) {
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);
  std::size_t length = 0;
  while (length < rest.size() && !is_blank(rest[length])) ++length;
  const std::string_view word = head(rest, length);
  rest.remove_prefix(length);
  return word;
}

}  // namespace

Line& Line::text(std::string_view words) {
  for (const char c : words) {
    if (!characters_.full()) characters_.push_back(c);
  }
  return *this;
}

Line& Line::integer(std::uint64_t value) {
  std::array<char, 20> digits{};
  std::size_t first = digits.size();
  do {
    digits[--first] = static_cast<char>('0' + value % 10);
    value /= 10;
  } while (value != 0);
  return text({digits.data() + first, digits.size() - first});
}

Line& Line::hex(std::uint32_t value, unsigned digits) {
  return text("0x").hex_digits(value, digits);
}

Line& Line::hex_digits(std::uint32_t value, unsigned digits) {
  bool begun = false;
  for (unsigned digit = 8; digit-- > 0;) {
    const std::uint32_t nibble = (value >> (4 * digit)) & 0xFU;
    begun = begun || nibble != 0 || digit < digits;
    if (begun) text({&"0123456789ABCDEF"[nibble], 1});
  }
  return *this;
}

Line& Line::number(double value, unsigned decimals) {
  if (!std::isfinite(value)) return text("none");
  std::uint64_t scale = 1;
  for (unsigned i = 0; i < decimals; ++i) scale *= 10;
  const double magnitude = std::abs(value) * static_cast<double>(scale);
  if (magnitude > 9e18) return text("huge");
  const auto scaled = static_cast<std::uint64_t>(std::llround(magnitude));
  if (value < 0 && scaled != 0) text("-");
  integer(scaled / scale);
  if (decimals == 0) return *this;
  text(".");
  for (std::uint64_t digit = scale / 10; digit > 0; digit /= 10) {
    integer(scaled / digit % 10);
  }
  return *this;
}

Line& Line::device_says(std::uint32_t code, std::string_view words, std::string_view prefix) {
  constexpr unsigned kEmergencyDigits = 4;
  constexpr unsigned kAbortDigits = 8;
  if (code == 0) return *this;
  const bool aborted = !hal::kSmallImage && code > 0xFFFF;
  const unsigned digits = aborted ? kAbortDigits : kEmergencyDigits;
  text(" ").text(prefix).text("code=").hex(code, digits);
  if (words.empty()) return *this;
  return text(" ").text(prefix).text("says=\"").text(words).text("\"");
}

#ifndef ARMSIG_SMALL_IMAGE
Line& Line::device_details(const hal::DeviceDetails& details, std::string_view prefix) {
  constexpr unsigned kByteDigits = 2;
  if (details.error_register != 0) {
    text(" ").text(prefix).text("register=").hex(details.error_register, kByteDigits);
  }
  if (std::ranges::all_of(details.own, [](std::uint8_t byte) { return byte == 0; })) return *this;
  text(" ").text(prefix).text("own=");
  for (const std::uint8_t byte : details.own) hex_digits(byte, kByteDigits);
  return *this;
}
#endif

Line& Line::device_object(const hal::DeviceObject& object, std::string_view prefix) {
  constexpr unsigned kIndexDigits = 4;
  if (object.index == 0) return *this;
  text(" ").text(prefix).text("object=").hex_digits(object.index, kIndexDigits);
  text("h:").integer(object.subindex);
  const auto tell = [&](std::string_view key, const std::optional<std::uint32_t>& value) {
    text(" ").text(prefix).text(key);
    if (value) {
      hex(*value, 1);
    } else {
      text("none");
    }
  };
  tell("found=", object.found);
  tell("wanted=", object.wanted);
  return *this;
}

Line& Line::numbers(std::uint32_t bits) {
  for (unsigned bit = 0, told = 0; bit < 32; ++bit) {
    if ((bits >> bit & 1U) != 0) text(told++ == 0 ? "" : ",").integer(bit + 1);
  }
  return *this;
}

Line& Line::orientation_missed(double angle_rad) {
  return text(" orientation_missed_deg=").number(degrees(angle_rad), 4);
}

Line& Line::reason(Error error) {
  return text(" error=").text(name(error)).text(" reason=\"").text(describe(error)).text("\"");
}

namespace {

constexpr std::size_t kMostDigits = 30;

bool is_not_finite(std::string_view unsigned_text) {
  return unsigned_text == "nan" || unsigned_text == "inf" || unsigned_text == "infinity";
}

// Whether `text` has a minus at `at`, which goes past it, or past a plus.
bool take_sign(std::string_view text, std::size_t& at) {
  const bool negative = at < text.size() && text[at] == '-';
  if (at < text.size() && (text[at] == '-' || text[at] == '+')) ++at;
  return negative;
}

// One division or multiplication by an exact power of ten, so that "0.1" is the nearest double.
double scaled(double value, int exponent) {
  double power = 1;
  for (int i = 0; i < std::abs(exponent); ++i) power *= 10;
  return exponent < 0 ? value / power : value * power;
}

// Errors: kUnknownRequest (no number), kOutOfRange (not finite, or too long).
Result<double> read_number(std::string_view text) {
  std::size_t at = 0;
  const bool negative = take_sign(text, at);
  double value = 0;
  int exponent = 0;
  std::size_t digits = 0;
  bool after_point = false;
  for (; at < text.size() && (is_digit(text[at]) || (text[at] == '.' && !after_point)); ++at) {
    if (text[at] == '.') {
      after_point = true;
      continue;
    }
    value = 10 * value + (text[at] - '0');
    if (after_point) --exponent;
    ++digits;
  }
  if (digits == 0) {
    return std::unexpected(is_not_finite(tail(text, at)) ? Error::kOutOfRange
                                                         : Error::kUnknownRequest);
  }
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    ++at;
    const bool falls = take_sign(text, at);
    int told = 0;
    std::size_t told_digits = 0;
    for (; at < text.size() && is_digit(text[at]) && told_digits < 3; ++at, ++told_digits) {
      told = 10 * told + (text[at] - '0');
    }
    if (told_digits == 0) return std::unexpected(Error::kUnknownRequest);
    exponent += falls ? -told : told;
  }
  if (at != text.size()) return std::unexpected(Error::kUnknownRequest);
  if (digits > kMostDigits) return std::unexpected(Error::kOutOfRange);
  value = scaled(value, exponent);
  if (!std::isfinite(value)) return std::unexpected(Error::kOutOfRange);
  return negative ? -value : value;
}

}  // namespace

Result<double> needed_number(std::string_view key, std::string_view text, Line& out) {
  const auto number = read_number(text);
  if (!number && number.error() == Error::kUnknownRequest) {
    out.text(" why=\"").text(key).text(" needs a number\"");
  }
  return number;
}

Result<Request> parse_request(std::string_view line) {
  Request request;
  request.verb = next_word(line);
  if (request.verb.empty()) return std::unexpected(Error::kUnknownRequest);
  for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos && request.subject.empty() && request.arguments.empty()) {
      request.subject = word;
      continue;
    }
    if (equals == std::string_view::npos || equals == 0) {
      return std::unexpected(Error::kUnknownRequest);
    }
    if (request.arguments.full()) return std::unexpected(Error::kCapacityExceeded);
    const std::string_view key = head(word, equals);
    if (std::ranges::any_of(request.arguments,
                            [&](const auto& argument) { return argument.first == key; })) {
      return std::unexpected(Error::kUnknownRequest);
    }
    request.arguments.push_back({key, tail(word, equals + 1)});
  }
  return request;
}

}  // namespace armsig::controller
