// SPDX-License-Identifier: MIT
#include "firmware/fleet/node/controller_lines.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

#include "firmware/fleet/node/sha256.hpp"
#include "firmware/formats/console_line.hpp"

namespace armsig::fleet {
namespace {

// Empty: there is none.
std::string_view value_of(std::string_view line, std::string_view key) {
  return tool::value_in(line, key).value_or(std::string_view());
}

double number_in(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  return value;
}

void add_number(Readings& readings, Item item, double value) {
  if (std::isfinite(value)) readings.push_back({item, value});
}

void add_whole(Readings& readings, Item item, double value) {
  if (value >= 0 && value < 1e15) readings.push_back({item, static_cast<std::uint64_t>(value)});
}

Value text_or_nothing(std::string_view text) { return text.empty() ? Value() : Value(Text(text)); }

// The first bin's upper end in which `share` of all counts is reached: bins end at 1, 2, 4, ... us.
void add_quantile(Readings& readings, Item item, std::string_view bins, double share) {
  std::array<double, 32> counts{};
  std::size_t size = 0;
  double all = 0;
  while (!bins.empty() && size < counts.size()) {
    const std::size_t comma = bins.find(',');
    counts[size] = number_in(bins.substr(0, comma));
    if (!(counts[size] >= 0)) return;
    all += counts[size++];
    bins = comma == std::string_view::npos ? std::string_view{} : bins.substr(comma + 1);
  }
  double below = 0;
  for (std::size_t i = 0; i < size && all > 0; ++i) {
    below += counts[i];
    if (below < share * all) continue;
    readings.push_back({item, std::ldexp(1.0, static_cast<int>(i))});
    return;
  }
}

}  // namespace

Readings readings_of_status(std::string_view line) {
  Readings readings;
  if (!line.starts_with("ok mode=")) return readings;
  readings.push_back({Item::kMode, Text(value_of(line, "mode"))});
  std::string fault(value_of(line, "fault"));
  const std::string_view joint = value_of(line, "fault_joint");
  const std::string_view says = value_of(line, "fault_says");
  if (!joint.empty()) fault.append(" joint ").append(joint);
  if (!says.empty()) fault.append(": ").append(says);
  readings.push_back({Item::kFault, text_or_nothing(fault)});
  readings.push_back({Item::kModel, text_or_nothing(value_of(line, "model"))});
  readings.push_back({Item::kSensor, text_or_nothing(value_of(line, "sensor"))});
  const std::string_view bins = value_of(line, "late_bins");
  add_quantile(readings, Item::kLateness50, bins, 0.5);
  add_quantile(readings, Item::kLateness99, bins, 0.99);
  add_number(readings, Item::kLatenessMax, number_in(value_of(line, "late_max_us")));
  return readings;
}

Readings readings_of_signature(std::string_view line) {
  Readings readings;
  if (!line.starts_with("ok model=")) return readings;
  readings.push_back({Item::kModel, text_or_nothing(value_of(line, "model"))});
  const std::string_view document = document_of_signature(line);
  if (document.empty()) {
    for (const Item item : kOfSignature) readings.push_back({item, {}});
    return readings;
  }
  Readings known;
  known.push_back({Item::kSignatureHash, Text(sha256(document))});
  add_whole(known, Item::kSignatureNumber, number_in(value_of(line, "signature")));
  add_whole(known, Item::kSignatureDate, 1e3 * number_in(value_of(line, "identified_unix_s")));
  // A predicted error without its region is no figure.
  if (const std::string_view region = value_of(line, "predicted_region"); !region.empty()) {
    add_number(known, Item::kPredicted, number_in(value_of(line, "predicted_tool_error_mm")));
    known.push_back({Item::kPredictedRegion, Text(region)});
  }
  add_number(known, Item::kValidation, number_in(value_of(line, "validation_rms_mm")));
  add_whole(known, Item::kValidationPoses, number_in(value_of(line, "validation_poses")));
  add_number(known, Item::kAir, number_in(value_of(line, "air_c")));
  // What is not known of it has no value: nothing of a former signature stays.
  for (const Item item : kOfSignature) {
    const auto* const found = std::ranges::find(known.begin(), known.end(), item, &Reading::item);
    readings.push_back(found != known.end() ? *found : Reading{item, {}});
  }
  return readings;
}

Readings with_hash(Readings signature, std::string_view document) {
  for (Reading& reading : signature) {
    if (reading.item == Item::kSignatureHash) reading.value = Text(sha256(document));
  }
  return signature;
}

std::string_view document_of_signature(std::string_view line) {
  const std::size_t parameters = line.find(" theta1_deg=");
  if (!line.starts_with("ok model=") || parameters == std::string_view::npos) return {};
  return line.substr(parameters + 1);
}

std::vector<Readings> readings_of_document(std::string_view document) {
  const std::uint64_t parts = (document.size() + Text::kLongest - 1) / Text::kLongest;
  if (parts > kMostDocumentParts) return {};
  const std::string hash = sha256(document);
  std::vector<Readings> rows;
  while (!document.empty()) {
    Readings& row = rows.emplace_back();
    row.push_back({Item::kDocumentHash, Text(hash)});
    row.push_back({Item::kDocumentPart, std::uint64_t{rows.size()}});
    row.push_back({Item::kDocumentParts, parts});
    row.push_back({Item::kDocumentText, Text(document.substr(0, Text::kLongest))});
    document.remove_prefix(std::min(document.size(), Text::kLongest));
  }
  return rows;
}

Readings readings_of_check(std::string_view line) {
  Readings readings;
  if (!line.starts_with("# check verdict=")) return readings;
  std::string verdict(value_of(line, "verdict"));
  const std::string_view reason = value_of(line, "reason");
  if (!reason.empty()) verdict.append(": ").append(reason);
  readings.push_back({Item::kVerdict, text_or_nothing(verdict)});
  add_number(readings, Item::kResidualX, number_in(value_of(line, "dx_mm")));
  add_number(readings, Item::kResidualY, number_in(value_of(line, "dy_mm")));
  add_number(readings, Item::kResidualZ, number_in(value_of(line, "dz_mm")));
  add_number(readings, Item::kCheckSigma, number_in(value_of(line, "sigma_mm")));
  add_whole(readings, Item::kCheckPoses, number_in(value_of(line, "poses")));
  add_whole(readings, Item::kCheckSignature, number_in(value_of(line, "signature")));
  return readings;
}

}  // namespace armsig::fleet
