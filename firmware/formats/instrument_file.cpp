// SPDX-License-Identifier: MIT
#include "firmware/formats/instrument_file.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<std::string_view, 3> kKinds{"socket", "plane", "wire"};
constexpr std::size_t kMostInstruments = 8;
constexpr std::size_t kMostLengths = 200;
// A wire whose gain nobody states is an encoder and a drum: a part in a thousand.
constexpr double kUnstatedGain = 1e-3;
constexpr double kUnstatedZero_m = 0.05;

Read<double> read_positive(const YamlMap& map, std::string_view name) {
  ARMSIG_TRY(found, map.require_quantity(name, Dimension::kLength));
  ARMSIG_TRY(value, map.quantity(name, Dimension::kLength));
  if (value > 0) return value;
  return problem_at(*found.value,
                    fmt::format("{}: {} is not positive", found.key->text, found.value->text),
                    "a length above 0");
}

Read<InstrumentKind> read_kind(const YamlMap& map) {
  ARMSIG_TRY(kind, map.text("kind"));
  const auto* found = std::ranges::find(kKinds, kind);
  if (found == kKinds.end()) {
    return problem_at(*map.find("kind"), "kind: " + in_quotes(kind), "socket, plane or wire");
  }
  return static_cast<InstrumentKind>(found - kKinds.begin());
}

Read<double> read_gain_sigma(const YamlMap& map) {
  const YamlNode* node = map.find("gain_sigma");
  if (node == nullptr) return kUnstatedGain;
  ARMSIG_TRY(sigma, read_number(*node, "gain_sigma"));
  if (!(sigma >= 0 && sigma < 1)) {
    return problem_at(*node, fmt::format("gain_sigma: {}", node->text), "a part of 1, 0 or more");
  }
  return sigma;
}

Read<Instrument> read_instrument(const YamlNode& item, std::size_t number) {
  std::vector<std::string> known{"name", "kind", "gain_sigma"};
  add_names(known, "zero", Dimension::kLength);
  add_names(known, "zero_sigma", Dimension::kLength);
  ARMSIG_TRY(map, YamlMap::open(item, fmt::format("instrument {}", number), known));
  ARMSIG_TRY(name, map.name_under("name"));
  ARMSIG_TRY(kind, read_kind(map));
  Instrument instrument{.name = name, .kind = kind};
  if (kind != InstrumentKind::kWire) {
    for (const YamlNode& key : map.node().keys) {
      if (key.text == "name" || key.text == "kind") continue;
      return problem_at(key, key.text + " of an instrument that is no wire",
                        "a wire, or no such key");
    }
    return instrument;
  }
  ARMSIG_TRY(gain_sigma, read_gain_sigma(map));
  ARMSIG_TRY(zero, map.find_quantity("zero", Dimension::kLength));
  if (zero) {
    ARMSIG_TRY(zero_m, map.quantity("zero", Dimension::kLength));
    instrument.zero_m = zero_m;
  }
  instrument.zero_sigma_m = kUnstatedZero_m;
  ARMSIG_TRY(zero_sigma, map.find_quantity("zero_sigma", Dimension::kLength));
  if (zero_sigma) {
    ARMSIG_TRY(zero_sigma_m, read_positive(map, "zero_sigma"));
    instrument.zero_sigma_m = zero_sigma_m;
  }
  instrument.gain_sigma = gain_sigma;
  return instrument;
}

Read<std::vector<Instrument>> read_instruments(const YamlNode& node) {
  ARMSIG_TRY(list, read_list(node, "instruments", 1, kMostInstruments));
  std::vector<Instrument> instruments;
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(instrument, read_instrument(item, instruments.size() + 1));
    if (std::ranges::find(instruments, instrument.name, &Instrument::name) != instruments.end()) {
      return problem_at(item, "a second instrument " + in_quotes(instrument.name),
                        "each name once");
    }
    instruments.push_back(std::move(instrument));
  }
  return instruments;
}

// A place is told by its name in a cell of a table of touches, which has no quotes.
Read<void> check_place(const YamlNode& at, std::string_view name) {
  if (!name.empty() && name.front() != '#' && trimmed(name) == name &&
      name.find(',') == std::string_view::npos && !first_unprintable(name)) {
    return {};
  }
  return problem_at(at, fmt::format("{} is no name of a place", in_quotes(name)),
                    "a name without a comma, a # in front, or blanks at its ends");
}

Read<void> read_places(const YamlNode& node, InstrumentDescription& description) {
  if (node.kind != YamlNode::Kind::kMap) {
    return problem_at(node, fmt::format("places: {}", word_of(node.kind)),
                      "a map of places to the names of instruments");
  }
  for (std::size_t k = 0; k < node.keys.size(); ++k) {
    if (auto place = check_place(node.keys[k], node.keys[k].text); !place) return place;
    ARMSIG_TRY(name, read_text(node.items[k], node.keys[k].text));
    const auto found = std::ranges::find(description.instruments, name, &Instrument::name);
    if (found == description.instruments.end()) {
      return problem_at(node.items[k], "there is no instrument " + in_quotes(name),
                        "the name of one under instruments");
    }
    description.place_instruments[node.keys[k].text] =
        static_cast<std::size_t>(found - description.instruments.begin());
  }
  return {};
}

Read<KnownLength> read_length(const YamlNode& item, std::size_t number) {
  std::vector<std::string> known{"from", "to"};
  add_names(known, "length", Dimension::kLength);
  add_names(known, "sigma", Dimension::kLength);
  ARMSIG_TRY(map, YamlMap::open(item, fmt::format("length {}", number), known));
  ARMSIG_TRY(from, map.name_under("from"));
  ARMSIG_TRY(to, map.name_under("to"));
  if (from == to) {
    return problem_at(item, fmt::format("a length from {} to itself", in_quotes(from)),
                      "two places");
  }
  ARMSIG_TRY(length_m, read_positive(map, "length"));
  ARMSIG_TRY(sigma_m, read_positive(map, "sigma"));
  return KnownLength{from, to, length_m, sigma_m, item.line};
}

Read<void> read_lengths(const YamlNode& node, InstrumentDescription& description) {
  ARMSIG_TRY(list, read_list(node, "lengths", 1, kMostLengths));
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(length, read_length(item, description.lengths.size() + 1));
    for (const std::string& place : {length.from, length.to}) {
      if (auto told = check_place(item, place); !told) return told;
      const Instrument& of = description.instruments[description.instrument_of(place)];
      if (of.kind == InstrumentKind::kSocket) continue;
      return problem_at(item, fmt::format("{} is no socket", in_quotes(place)),
                        "a length between two sockets");
    }
    description.lengths.push_back(std::move(length));
  }
  return {};
}

Read<InstrumentDescription> instrument_from(const YamlNode& root) {
  if (auto tag = check_tag(root, kInstrumentTag); !tag) {
    return std::unexpected(std::move(tag).error());
  }
  ARMSIG_TRY(map, YamlMap::open(
                      root, "the instrument description",
                      {"armsig", "name", "tool_mm", "tool_m", "instruments", "places", "lengths"}));
  InstrumentDescription description;
  ARMSIG_TRY(name, map.name_under("name"));
  description.name = name;
  const bool metres = map.find("tool_m") != nullptr;
  if (metres && map.find("tool_mm") != nullptr) {
    return problem_at(*map.find("tool_mm"), "tool_mm beside tool_m", "one of them");
  }
  ARMSIG_TRY(tool, map.vector3(metres ? "tool_m" : "tool_mm"));
  description.tool_F = metres ? tool : Vector3(tool / 1e3);
  ARMSIG_TRY(list, map.require("instruments"));
  ARMSIG_TRY(instruments, read_instruments(*list));
  description.instruments = std::move(instruments);
  if (const YamlNode* places = map.find("places")) {
    if (auto read = read_places(*places, description); !read) {
      return std::unexpected(std::move(read).error());
    }
  }
  if (const YamlNode* lengths = map.find("lengths")) {
    if (auto read = read_lengths(*lengths, description); !read) {
      return std::unexpected(std::move(read).error());
    }
  }
  return description;
}

}  // namespace

std::size_t InstrumentDescription::instrument_of(std::string_view place) const {
  const auto found = place_instruments.find(place);
  return found == place_instruments.end() ? 0 : found->second;
}

Read<InstrumentDescription> parse_instrument(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<InstrumentDescription> {
    ARMSIG_TRY(root, parse_yaml(text));
    return instrument_from(root);
  };
  return in_file(file, parse());
}

Read<InstrumentDescription> read_instrument_file(const std::string& path) {
  ARMSIG_TRY(text, read_text_file(path));
  return parse_instrument(text, path);
}

}  // namespace armsig::tool
