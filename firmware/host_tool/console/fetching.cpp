// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/fetching.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/controller/fetching.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/console_line.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {
namespace {

constexpr const char* kExpected = "a controller of this armsig";

// The bytes that pairs of hexadecimal digits stand for; false where they are none, or other than as
// many as there is room for.
bool from_hex(std::string_view digits, std::span<std::uint8_t> bytes) {
  if (digits.size() != 2 * bytes.size()) return false;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const char* const first = digits.data() + 2 * i;
    const auto [end, error] = std::from_chars(first, first + 2, bytes[i], 16);
    if (error != std::errc{} || end != first + 2) return false;
  }
  return true;
}

// What helps against an error of the controller.
std::string cure_of(std::string_view error) {
  if (error.contains("NO_CANDIDATE")) return "a candidate: identify first";
  if (error.contains("NO_SIGNATURE")) {
    return "a signature in use: accept the candidate first, or fetch it by --what candidate; where "
           "there is none, identify first";
  }
  if (error.contains("WRONG_MODE")) return "a controller without a sequence or a commit under way";
  if (error.contains("RECORD_CORRUPT")) return "a line that loses nothing: try again";
  return kExpected;
}

}  // namespace

std::unexpected<Problem> Fetcher::refused(std::string what, std::string expected) const {
  return std::unexpected(Problem{name_, 0, 0, std::move(what), std::move(expected)});
}

Read<std::vector<std::string>> Fetcher::ask(const std::string& request,
                                            const std::vector<std::string>& keys) {
  const auto silent = [&] {
    return refused(fmt::format("no reply to \"{}\" within {} s", request,
                               std::chrono::duration<double>(longest_).count()),
                   "--timeout-s, or a controller that runs");
  };
  if (!console_.send(request)) return silent();
  const auto until = std::chrono::steady_clock::now() + longest_;
  for (;;) {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    const auto line = console_.receive(std::max(left, std::chrono::milliseconds(0)));
    if (!line) return silent();
    if (!is_reply(*line)) continue;  // what it says unasked
    if (is_error(*line)) {
      return refused(shown(*line), cure_of(*line));
    }
    std::vector<std::string> values;
    for (const std::string& key : keys) {
      values.emplace_back(value_in(*line, key).value_or(""));
      if (!values.back().empty()) continue;
      return refused(fmt::format("no {} in the reply to \"{}\"", key, request), kExpected);
    }
    return values;
  }
}

Read<double> Fetcher::number(const std::string& text) const {
  if (const auto number = parse_number(text)) return *number;
  return refused("not a number: " + in_quotes(text), kExpected);
}

Read<void> Fetcher::image(std::string_view what, std::span<std::uint8_t> bytes) {
  const std::size_t parts = (bytes.size() + controller::kPartBytes - 1) / controller::kPartBytes;
  for (std::size_t part = 0; part < parts; ++part) {
    ARMSIG_TRY(reply, ask(fmt::format("fetch what={} part={}", what, part + 1), {"bytes", "hex"}));
    const std::size_t begin = part * controller::kPartBytes;
    const auto room = bytes.subspan(begin, std::min(controller::kPartBytes, bytes.size() - begin));
    if (reply[0] != std::to_string(bytes.size()) || !from_hex(reply[1], room)) {
      return refused(
          fmt::format("a {} of {} bytes, {} expected", what, shown(reply[0]), bytes.size()),
          kExpected);
    }
  }
  return {};
}

Read<Arm> Fetcher::drawing() {
  controller::DrawingImage bytes{};
  if (auto whole = image("nominal", bytes); !whole) return std::unexpected(whole.error());
  const auto drawing = controller::decode_drawing(bytes);
  if (!drawing) return refused(std::string(describe(drawing.error())), kExpected);
  return *drawing;
}

Read<controller::SignatureRecord> Fetcher::record(std::string_view what, const Arm& drawing) {
  controller::RecordImage bytes{};
  if (auto whole = image(what, bytes); !whole) return std::unexpected(whole.error());
  controller::SignatureRecord record;
  const auto decoded = controller::decode(bytes, drawing, record);
  if (decoded) return record;
  return refused(std::string(describe(decoded.error())),
                 "a record that does not change while it is fetched: try again");
}

Read<void> Fetcher::deliver(const controller::RecordImage& record, const std::string& by) {
  const std::size_t parts = (record.size() + controller::kPartBytes - 1) / controller::kPartBytes;
  for (std::size_t part = 0; part < parts; ++part) {
    std::string request = fmt::format("send part={} bytes={}", part + 1, record.size());
    if (!by.empty()) request += " by=" + by;
    request += " hex=";
    const std::size_t begin = part * controller::kPartBytes;
    const std::size_t end = std::min(begin + controller::kPartBytes, record.size());
    for (std::size_t i = begin; i < end; ++i) request += fmt::format("{:02x}", record[i]);
    const bool last = part + 1 == parts;
    const auto reply =
        ask(request, last ? std::vector<std::string>{"received"} : std::vector<std::string>{});
    if (!reply) return std::unexpected(reply.error());
  }
  return {};
}

Read<std::vector<MeasurementRow>> Fetcher::log(const JointTypes& types) {
  ARMSIG_TRY(counted, ask("log", {"rows"}));
  ARMSIG_TRY(count, number(counted[0]));
  if (count < 1) return refused("nothing was measured since its start", "identify first");
  std::vector<std::string> keys{"sweep", "x_mm", "y_mm", "z_mm", "sigma_mm"};
  for (std::size_t i = 0; i < types.size(); ++i) {
    keys.push_back(fmt::format("q{}_{}", i + 1, types[i] == JointType::kRevolute ? "deg" : "mm"));
  }
  std::vector<MeasurementRow> rows;
  for (std::size_t k = 1; k <= static_cast<std::size_t>(count); ++k) {
    ARMSIG_TRY(texts, ask(fmt::format("log row={}", k), keys));
    std::vector<double> values;
    for (const std::string& text : texts) {
      ARMSIG_TRY(value, number(text));
      values.push_back(value);
    }
    MeasurementRow row;
    row.line = k;
    row.sweep = static_cast<std::size_t>(values[0]);
    row.p_S = 1e-3 * Vector3(values[1], values[2], values[3]);
    row.sigma_m = 1e-3 * values[4];
    for (std::size_t i = 0; i < types.size(); ++i) {
      const double reading = values[5 + i];
      row.q.push_back(types[i] == JointType::kRevolute ? radians(reading) : 1e-3 * reading);
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace armsig::tool
