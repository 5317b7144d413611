// SPDX-License-Identifier: MIT
#include "firmware/formats/origin.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/base/crc32.hpp"
#include "core/base/error.hpp"
#include "core/calibration/reading_hash.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {
namespace {

constexpr double kStepsOfARow = 1e9;  // a degree, a metre

// Decimal numbers of a file stand on a step, whichever unit they are written in.
std::uint64_t steps_of(double value) {
  constexpr double kMost = 9e18;  // what 64 bits hold
  return static_cast<std::uint64_t>(std::llround(std::clamp(kStepsOfARow * value, -kMost, kMost)));
}

constexpr int kMostOriginRows = 2'000'000'000;

// "0x" and `digits` hexadecimal digits.
template <typename Number>
Read<Number> read_hex(const YamlNode& node, std::string_view what) {
  constexpr std::size_t kDigits = 2 * sizeof(Number);
  Number number = 0;
  const std::string& text = node.text;
  if (node.kind == YamlNode::Kind::kScalar && text.size() == kDigits + 2 &&
      text.starts_with("0x")) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + 2, end, number, 16);
    if (error == std::errc{} && stop == end) return number;
  }
  return problem_at(node, fmt::format("{}: {}", what, in_quotes(text)),
                    fmt::format("0x and {} hexadecimal digits", kDigits));
}

Read<std::string> text_if_there(const YamlMap& map, std::string_view key) {
  const YamlNode* node = map.find(key);
  return node == nullptr ? Read<std::string>{} : read_text(*node, key);
}

Read<std::vector<std::uint64_t>> read_fitted(const YamlMap& map) {
  ARMSIG_TRY(node, map.require("fitted"));
  ARMSIG_TRY(list, read_list(*node, "fitted", 0, kMostRowHashes));
  std::vector<std::uint64_t> fitted;
  fitted.reserve(list->size());
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(hash, read_hex<std::uint64_t>(item, "fitted"));
    if (!fitted.empty() && hash <= fitted.back()) {
      return problem_at(item, "fitted: hashes that do not ascend", "each once, in ascending order");
    }
    fitted.push_back(hash);
  }
  return fitted;
}

}  // namespace

std::optional<std::uint64_t> row_hash(const MeasurementRow& row, const JointTypes& types) {
  using calibration::mixed;
  std::uint64_t hash = calibration::kFirstHash;
  for (std::size_t i = 0; i < row.q.size(); ++i) {
    const bool turns = types[i] == JointType::kRevolute;
    hash = mixed(hash, steps_of(turns ? degrees(row.q[i]) : row.q[i]));
  }
  if (row.p_S) {
    for (const double x_m : *row.p_S) hash = mixed(hash, steps_of(x_m));
    return hash;
  }
  bool heard = false;
  for (const std::optional<double>& range_m : row.ranges_m) {
    hash = mixed(hash, range_m ? steps_of(*range_m) : std::numeric_limits<std::uint64_t>::max());
    heard = heard || range_m;
  }
  return heard ? std::optional(hash) : std::nullopt;
}

void make_set(std::vector<std::uint64_t>& hashes) {
  std::ranges::sort(hashes);
  const auto repeated = std::ranges::unique(hashes);
  hashes.erase(repeated.begin(), repeated.end());
}

std::uint32_t set_crc32(const std::vector<std::uint64_t>& set) {
  std::uint32_t crc = 0;
  for (const std::uint64_t hash : set) {
    std::array<std::byte, sizeof hash> bytes{};
    for (std::size_t k = 0; k < bytes.size(); ++k) {
      bytes[k] = static_cast<std::byte>((hash >> (8 * k)) & 0xFFU);
    }
    crc = crc32(bytes, crc);
  }
  return crc;
}

bool Origin::tells_of(std::uint64_t hash) const {
  return fitted.size() < kMostRowHashes || hash <= fitted.back();
}

bool Origin::has_fitted(std::uint64_t hash) const {
  return std::ranges::binary_search(fitted, hash);
}

std::string origin_text(const std::optional<Origin>& origin) {
  if (!origin) return {};
  std::string text = "origin:\n";
  const auto add = [&](std::string_view key, const std::string& value) {
    if (!value.empty()) text += fmt::format("  {}: {}\n", key, yaml_quoted(value));
  };
  add("arm", origin->arm);
  add("measurements", origin->measurements);
  add("columns", origin->columns);
  add("sensor", origin->sensor);
  add("options", origin->options);
  if (origin->sensor_crc32)
    text += fmt::format("  sensor_crc32: 0x{:08X}\n", *origin->sensor_crc32);
  text += fmt::format("  rows: {}\n  rows_crc32: 0x{:08X}\n", origin->rows, origin->rows_crc32);
  text += "  fitted: [";
  const std::size_t kept = std::min(origin->fitted.size(), kMostRowHashes);
  for (std::size_t k = 0; k < kept; ++k) {
    constexpr std::size_t kALine = 4;
    if (k > 0) text += k % kALine == 0 ? ",\n    " : ", ";
    text += fmt::format("0x{:016X}", origin->fitted[k]);
  }
  return text + "]\n";
}

Read<std::optional<Origin>> read_origin_section(const YamlMap& root) {
  const YamlNode* node = root.find("origin");
  if (node == nullptr) return std::nullopt;
  ARMSIG_TRY(map, YamlMap::open(*node, "origin",
                                {"arm", "measurements", "columns", "sensor", "options",
                                 "sensor_crc32", "rows", "rows_crc32", "fitted"}));
  Origin origin;
  ARMSIG_TRY(measurements, map.text("measurements"));
  origin.measurements = measurements;
  for (const auto& [key, value] :
       {std::pair{"arm", &origin.arm}, std::pair{"columns", &origin.columns},
        std::pair{"sensor", &origin.sensor}, std::pair{"options", &origin.options}}) {
    ARMSIG_TRY(text, text_if_there(map, key));
    *value = text;
  }
  if (const YamlNode* crc_node = map.find("sensor_crc32")) {
    ARMSIG_TRY(crc, read_hex<std::uint32_t>(*crc_node, "sensor_crc32"));
    origin.sensor_crc32 = crc;
  }
  ARMSIG_TRY(rows, map.integer("rows", 0, kMostOriginRows));
  origin.rows = static_cast<std::size_t>(rows);
  ARMSIG_TRY(crc_node, map.require("rows_crc32"));
  ARMSIG_TRY(crc, read_hex<std::uint32_t>(*crc_node, "rows_crc32"));
  origin.rows_crc32 = crc;
  ARMSIG_TRY(fitted, read_fitted(map));
  origin.fitted = fitted;
  return origin;
}

}  // namespace armsig::tool
