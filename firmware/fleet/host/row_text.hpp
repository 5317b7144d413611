// SPDX-License-Identifier: MIT
// Rows as PostgreSQL reads them: JSON of readings, and lists of values as one argument.
#pragma once

#include <string>
#include <string_view>

#include "firmware/fleet/wire/items.hpp"

namespace armsig::fleet {

// The key of an item in the record ("mode", "dx_mm").
[[nodiscard]] std::string_view key_of(Item item);

// {"mode": "idle", "air_c": 20.5}; numbers that are not finite are null.
[[nodiscard]] std::string json_of(const Readings& readings);

// A list of texts, as an argument of type text[] and, element by element, of any other.
class ArrayText {
 public:
  void add(std::string_view element);
  [[nodiscard]] std::string text() const { return text_ + '}'; }

 private:
  std::string text_ = "{";
};

}  // namespace armsig::fleet
