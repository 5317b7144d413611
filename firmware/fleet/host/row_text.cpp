// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/row_text.hpp"

#include <cmath>

#include <fmt/format.h>

namespace armsig::fleet {
namespace {

constexpr std::array<std::string_view, kItems.size()> kKeys{"journal",
                                                            "number",
                                                            "previous",
                                                            "dropped",
                                                            "arm",
                                                            "serial",
                                                            "firmware",
                                                            "mode",
                                                            "fault",
                                                            "model",
                                                            "signature",
                                                            "identified_ms",
                                                            "predicted_tool_error_mm",
                                                            "validation_rms_mm",
                                                            "verdict",
                                                            "dx_mm",
                                                            "dy_mm",
                                                            "dz_mm",
                                                            "check_sigma_mm",
                                                            "poses",
                                                            "air_c",
                                                            "late_p50_us",
                                                            "late_p99_us",
                                                            "late_max_us",
                                                            "sensor",
                                                            "document",
                                                            "document_part",
                                                            "document_parts",
                                                            "document_text",
                                                            "signature_number",
                                                            "predicted_region",
                                                            "validation_poses",
                                                            "check_signature"};

// Bytes that are no UTF-8 become '?': neither JSON nor the record takes them.
std::string json_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (std::size_t i = 0; i < text.size();) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const std::size_t size = byte < 0x80U              ? 1
                             : (byte & 0xE0U) == 0xC0U ? 2
                             : (byte & 0xF0U) == 0xE0U ? 3
                             : (byte & 0xF8U) == 0xF0U ? 4
                                                       : 0;
    bool good = size > 0 && i + size <= text.size() && byte != 0xC0U && byte != 0xC1U;
    for (std::size_t j = 1; good && j < size; ++j) {
      good = (static_cast<unsigned char>(text[i + j]) & 0xC0U) == 0x80U;
    }
    // Overlong forms, surrogates and what lies beyond the last character.
    if (good && size > 2) {
      const auto second = static_cast<unsigned char>(text[i + 1]);
      good = !(byte == 0xE0U && second < 0xA0U) && !(byte == 0xEDU && second > 0x9FU) &&
             !(byte == 0xF0U && second < 0x90U) && !(byte == 0xF4U && second > 0x8FU) &&
             byte <= 0xF4U;
    }
    if (!good) {
      quoted += '?';
      ++i;
    } else if (size > 1) {
      quoted += text.substr(i, size);
      i += size;
    } else {
      if (byte == '"' || byte == '\\') quoted += '\\';
      quoted += byte < 0x20U ? ' ' : text[i];
      ++i;
    }
  }
  return quoted + '"';
}

std::string json_of(const Value& value) {
  if (const auto* integer = std::get_if<std::uint64_t>(&value)) return std::to_string(*integer);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* text = std::get_if<Text>(&value)) return json_quoted(text->view());
  const auto* real = std::get_if<double>(&value);
  if (real == nullptr || !std::isfinite(*real)) return "null";
  return fmt::format("{}", *real);
}

}  // namespace

std::string_view key_of(Item item) { return kKeys[static_cast<std::size_t>(item) - 1]; }

std::string json_of(const Readings& readings) {
  std::string json = "{";
  for (const Reading& reading : readings) {
    if (reading.item <= Item::kDropped) continue;
    if (json.size() > 1) json += ',';
    json.append("\"").append(key_of(reading.item)).append("\":").append(json_of(reading.value));
  }
  return json + '}';
}

void ArrayText::add(std::string_view element) {
  if (text_.size() > 1) text_ += ',';
  text_ += '"';
  for (const char c : element) {
    if (c == '"' || c == '\\') text_ += '\\';
    text_ += c;
  }
  text_ += '"';
}

}  // namespace armsig::fleet
