// SPDX-License-Identifier: MIT
#include "firmware/formats/touches.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/csv_table.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {
namespace {

Read<std::vector<Touch>> touches_from(LineReader lines, const JointTypes& types,
                                      const InstrumentDescription& description) {
  std::vector<Quantity> quantities = joint_quantities(types);
  const std::size_t place = quantities.size();
  const std::size_t length = place + 1;
  quantities.push_back({.name = "place", .dimension = Dimension::kText});
  quantities.push_back(
      {.name = "length", .dimension = Dimension::kLength, .required = false, .may_be_empty = true});
  ARMSIG_TRY(table, CsvTable::open(std::move(lines), std::move(quantities)));
  std::vector<Touch> touches;
  for (;;) {
    ARMSIG_TRY(more, table.next());
    if (!more) break;
    Touch touch{.line = table.line(),
                .place = std::string(table.field(place)),
                .q = JointVector(types.size())};
    if (touch.place.empty()) return table.problem(place, "a place without a name", "a name");
    for (std::size_t i = 0; i < types.size(); ++i) touch.q[i] = table.value(i);
    const bool wire = description.instruments[description.instrument_of(touch.place)].kind ==
                      InstrumentKind::kWire;
    const bool given = table.has(length) && !std::isnan(table.value(length));
    if (wire != given) {
      return table.problem(
          given ? length : place,
          fmt::format("{}: a {} {} length", in_quotes(touch.place),
                      wire ? "wire" : "place that is no wire", wire ? "without a" : "with a"),
          wire ? "length_mm of every row of a wire" : "no length, or the place listed as a wire");
    }
    if (given) touch.length_m = table.value(length);
    touches.push_back(std::move(touch));
  }
  if (touches.empty()) return table.problem("the file ends after its header", "rows of touches");
  return touches;
}

}  // namespace

bool is_place_name(std::string_view name) {
  const auto begins = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
  };
  const auto follows = [&](char c) { return begins(c) || c == '_' || c == '-' || c == '.'; };
  return !name.empty() && name.size() <= kLongestPlace && begins(name.front()) &&
         std::ranges::all_of(name, follows);
}

Read<std::vector<Touch>> read_touches(const std::string& path, const JointTypes& types,
                                      const InstrumentDescription& description) {
  ARMSIG_TRY(lines, LineReader::open(path));
  return touches_from(std::move(lines), types, description);
}

Read<std::vector<Touch>> parse_touches(std::string_view text, std::string_view file,
                                       const JointTypes& types,
                                       const InstrumentDescription& description) {
  return touches_from(LineReader::over(text, file), types, description);
}

std::string touches_text(std::span<const Touch> touches, const JointTypes& types,
                         const InstrumentDescription& description) {
  const bool wires = std::ranges::find(description.instruments, InstrumentKind::kWire,
                                       &Instrument::kind) != description.instruments.end();
  std::string text = fmt::format("place,{}{}\n", joint_header(types), wires ? ",length_mm" : "");
  auto out = std::back_inserter(text);
  for (const Touch& touch : touches) {
    text += touch.place;
    for (std::size_t i = 0; i < types.size(); ++i) {
      const Unit unit = unit_of(types[i]);
      fmt::format_to(out, ",{:.3f}", touch.q[i] * unit.divide / unit.multiply);
    }
    const Instrument& of = description.instruments[description.instrument_of(touch.place)];
    if (of.kind == InstrumentKind::kWire) fmt::format_to(out, ",{:.3f}", 1e3 * touch.length_m);
    if (wires && of.kind != InstrumentKind::kWire) text += ",";
    text += "\n";
  }
  return text;
}

}  // namespace armsig::tool
