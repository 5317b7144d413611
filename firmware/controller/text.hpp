// SPDX-License-Identifier: MIT
// The lines of the console: numbers to text and back, without the C library's formatting, which
// wants a heap.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/fixed_vector.hpp"
#include "hal/device_object.hpp"

namespace armsig::controller {

// A line that is being put together; what does not fit is left out.
class Line {
 public:
  Line& text(std::string_view words);
  Line& integer(std::uint64_t value);
  // In hexadecimal, with at least `digits` of them: 0x2310.
  Line& hex(std::uint32_t value, unsigned digits);
  // Of bits, the numbers of those that are set, from 1: 3,5.
  Line& numbers(std::uint32_t bits);
  // With `decimals` digits after the point, at most 9.
  Line& number(double value, unsigned decimals);
  // A device's own code and what it means: ` code=0x2310 says="words"`, with `prefix` before either
  // key; nothing where the code is 0.
  Line& device_says(std::uint32_t code, std::string_view words, std::string_view prefix = {});
  // What an emergency has beside its code: ` register=0x21 own=0102030405`, the error register and
  // the maker's five bytes, with `prefix` before either key; nothing of one that is zero.
#ifdef ARMSIG_SMALL_IMAGE
  Line& device_details(const hal::DeviceDetails& /*details*/, std::string_view /*prefix*/ = {}) {
    return *this;
  }
#else
  Line& device_details(const hal::DeviceDetails& details, std::string_view prefix = {});
#endif
  // An object of a device that is not as wanted: ` object=605Ah:0 found=0x0 wanted=0x6`, with
  // `prefix` before each key; nothing where there is none.
  Line& device_object(const hal::DeviceObject& object, std::string_view prefix = {});
  // By how much an orientation is missed: ` orientation_missed_deg=0.0312`.
  Line& orientation_missed(double angle_rad);
  // Why something ended: ` error=NAME reason="words"`.
  Line& reason(Error error);
  void clear() { characters_.clear(); }
  [[nodiscard]] std::string_view view() const { return {characters_.data(), characters_.size()}; }

 private:
  Line& hex_digits(std::uint32_t value, unsigned digits);

  FixedVector<char, 1024> characters_;
};

// The first `count` characters of `text`, and all from `begin` on; at most its length. Without
// std::string_view::substr(), which can throw and so brings exceptions into an image.
[[nodiscard]] constexpr std::string_view head(std::string_view text, std::size_t count) {
  text.remove_suffix(text.size() - count);
  return text;
}
[[nodiscard]] constexpr std::string_view tail(std::string_view text, std::size_t begin) {
  text.remove_prefix(begin);
  return text;
}

// The value of `key`, decimal, with an optional sign, point and exponent. Errors: kUnknownRequest
// (no number: ` why="KEY needs a number"` goes to `out`), kOutOfRange (one that is not finite, or
// too long to be read).
[[nodiscard]] Result<double> needed_number(std::string_view key, std::string_view text, Line& out);

struct Request {
  std::string_view verb;
  std::string_view subject;  // a word that follows the verb, without "="
  FixedVector<std::pair<std::string_view, std::string_view>, 16> arguments;
};

// "verb [subject] key=value ...". Errors: kUnknownRequest (no verb, another word without "=", a key
// twice),
// kCapacityExceeded.
[[nodiscard]] Result<Request> parse_request(std::string_view line);

}  // namespace armsig::controller
