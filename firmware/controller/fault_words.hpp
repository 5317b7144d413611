// SPDX-License-Identifier: MIT
// What a fault says beside its name.
#pragma once

#include <string_view>

#include "firmware/controller/link.hpp"
#include "firmware/controller/text.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::controller {

// As Line::device_says(); without a code, which of two buses fails: ` says="can1"`.
inline void tell_words(Line& line, const Fault& fault, std::string_view prefix = {}) {
  if (!hal::kSmallImage && fault.code == 0 && !fault.words.empty()) {
    line.text(" ").text(prefix).text("says=\"").text(fault.words).text("\"");
  } else {
    line.device_says(fault.code, fault.words, prefix);
  }
}

}  // namespace armsig::controller
