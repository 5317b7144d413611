// SPDX-License-Identifier: MIT
// A signature that comes to a controller from outside, part after part.
#pragma once

#include <algorithm>
#include <string>

#include "firmware/controller/receiving.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::test {

inline std::string part_of(const controller::RecordImage& image, std::size_t part) {
  std::string request =
      "send part=" + std::to_string(part) + " bytes=" + std::to_string(image.size()) + " hex=";
  const std::size_t begin = (part - 1) * controller::kPartBytes;
  for (std::size_t i = begin; i < std::min(begin + controller::kPartBytes, image.size()); ++i) {
    request += "0123456789abcdef"[image[i] / 16];
    request += "0123456789abcdef"[image[i] % 16];
  }
  return request;
}

inline constexpr std::size_t kParts =
    (controller::kRecordBytes + controller::kPartBytes - 1) / controller::kPartBytes;

// The answer to the last part.
inline std::string sent(PumaCabinet& puma, const controller::RecordImage& image) {
  for (std::size_t part = 1; part < kParts; ++part) {
    const std::string reply = puma.ask(part_of(image, part));
    if (reply != "ok") return "part " + std::to_string(part) + ": " + reply;
  }
  return puma.ask(part_of(image, kParts));
}

}  // namespace armsig::test
