// SPDX-License-Identifier: MIT
// Text in the encodings that measuring programs write, as UTF-8.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace armsig::tool {

// Whether `bytes` begin with a byte order mark of UTF-16.
[[nodiscard]] bool is_utf16(std::string_view bytes);

// `bytes` as UTF-8 without a byte order mark: of UTF-16 where a byte order mark says so, of UTF-8
// as it is. Nothing where UTF-16 breaks off in mid-character.
[[nodiscard]] std::optional<std::string> in_utf8(std::string_view bytes);

}  // namespace armsig::tool
