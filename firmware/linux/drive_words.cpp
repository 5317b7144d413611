// SPDX-License-Identifier: MIT
#include "firmware/linux/drive_words.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/base/error_name.hpp"
#include "core/base/pose.hpp"
#include "hal/canopen/drive_setup.hpp"
#include "hal/canopen/emergency.hpp"
#include "hal/cia402/state_machine.hpp"

namespace armsig::daemon {
namespace {

using canopen::CheckedConfiguration;
using cia402::ObjectOutcome;

constexpr std::string_view kNoCounts = "counts not reported: prove the ratio";

constexpr std::array kWords{
    ObjectWords{0x6502, 0, "modes", "modes not reported: the mode is tried"},
    ObjectWords{0x607E, 0, "polarity", "its sense is not reported: prove it"},
    ObjectWords{0x608F, 1, "encoder increments", kNoCounts},
    ObjectWords{0x608F, 2, "in motor revolutions", ""},
    ObjectWords{0x6091, 1, "gear, motor revolutions", ""},
    ObjectWords{0x6091, 2, "gear, shaft revolutions", ""},
    ObjectWords{0x6092, 1, "feed, units", ""},
    ObjectWords{0x6092, 2, "feed, shaft revolutions", ""},
    ObjectWords{0x6093, 1, "older factor, increments", ""},
    ObjectWords{0x6093, 2, "older factor, units", ""},
    ObjectWords{0x60A8, 0, "unit of positions", ""},
    ObjectWords{0x60AA, 0, "unit of accelerations", ""},
    ObjectWords{0x1017, 0, "own heartbeat, ms", ""},
    ObjectWords{0x1016, 1, "watches master's heartbeat", "does not see that this process dies"},
    ObjectWords{0x1400, 5, "watches commands, ms", "does not see that its commands cease"},
    ObjectWords{0x100C, 0, "guard time, ms", "cannot be guarded by its master"},
    ObjectWords{0x100D, 0, "guard life factor", "cannot be guarded by its master"},
    ObjectWords{0x1005, 0, "identifier of SYNC", ""},
    ObjectWords{0x1006, 0, "cycle, us", "does not know the time between SYNCs"},
    ObjectWords{0x1014, 0, "identifier of emergencies", ""},
    ObjectWords{0x1600, 1, "RPDO1, first object", ""},
    ObjectWords{0x1600, 2, "RPDO1, second object", ""},
    ObjectWords{0x1A00, 1, "TPDO1, first object", ""},
    ObjectWords{0x1A00, 2, "TPDO1, second object", ""},
    ObjectWords{0x6081, 0, "profile speed", ""},
    ObjectWords{0x6083, 0, "profile acceleration", ""},
    ObjectWords{0x6084, 0, "profile deceleration", ""},
    ObjectWords{0x60C0, 0, "interpolation", "interpolates by its own rule"},
    ObjectWords{0x60C4, 6, "interpolation buffer", "opens its buffer by its own rule"},
    ObjectWords{0x60C2, 1, "interpolation period", "may go from target to target in steps"},
    ObjectWords{0x60C2, 2, "its power of ten", "may go from target to target in steps"},
    ObjectWords{0x6007, 0, "when the master is gone", "holds torque when this process dies"},
    ObjectWords{0x605A, 0, "quick stop", "may lose torque when its own ramp ends"},
    ObjectWords{0x605B, 0, "shutdown", "nothing: not commanded under torque"},
    ObjectWords{0x605C, 0, "disable operation", "may drop until its brake holds"},
    ObjectWords{0x605D, 0, "halt", ""},
    ObjectWords{0x605E, 0, "fault reaction", "stops by its own rule in a fault"},
    ObjectWords{0x6085, 0, "quick stop ramp", ""},
    ObjectWords{0x60B0, 0, "position offset", "nothing: no offset can be added"},
    ObjectWords{0x6065, 0, "following window", ""},
    ObjectWords{0x6060, 0, "mode", ""},
    ObjectWords{0x6061, 0, "mode shown", ""},
    ObjectWords{0x607C, 0, "home offset", ""},
    ObjectWords{0x607D, 1, "lower software limit", ""},
    ObjectWords{0x607D, 2, "upper software limit", ""},
    ObjectWords{0x607F, 0, "largest profile speed", ""},
    ObjectWords{0x6080, 0, "largest motor speed", ""},
    ObjectWords{0x6072, 0, "largest torque, 0.1 %", ""},
    ObjectWords{0x6077, 0, "torque, 0.1 %", ""},
    ObjectWords{0x60E0, 0, "positive torque limit", ""},
    ObjectWords{0x60E1, 0, "negative torque limit", ""},
    ObjectWords{0x60FD, 0, "inputs", ""},
    ObjectWords{0x6041, 0, "statusword", ""},
    ObjectWords{0x603F, 0, "error", ""},
    ObjectWords{0x1003, 1, "last error stored", ""},
    ObjectWords{0x6064, 0, "position, counts", ""},
    ObjectWords{0x1000, 0, "device type", ""},
    ObjectWords{0x67FF, 0, "type of the axis", ""},
    ObjectWords{0x1018, 1, "vendor", ""},
    ObjectWords{0x1018, 2, "product", ""},
    ObjectWords{0x1018, 3, "revision", ""},
    ObjectWords{0x1018, 4, "serial number", ""},
};

// Told in the first lines of a node.
constexpr std::uint16_t kFirstOfHead = 0x6041;

std::string name_of(std::uint16_t index, std::uint8_t subindex) {
  return fmt::format("{:04X}h:{}", index, subindex);
}

std::string value_words(const ObjectOutcome& outcome) {
  if (outcome) return fmt::format("0x{:X}", *outcome);
  if (cia402::is_absent(outcome)) return "absent";
  return outcome.error().error == Error::kSdoTimeout
             ? "-"
             : fmt::format("!{:08X}", outcome.error().abort_code);
}

// The modes of the configuration, by their bits in 6502h.
struct ConfiguredMode {
  cia402::PositionMode mode;
  std::string_view words;
};
constexpr std::array kConfiguredModes{
    ConfiguredMode{cia402::PositionMode::kCyclic, "mode: cyclic"},
    ConfiguredMode{cia402::PositionMode::kInterpolated, "mode: interpolated"},
    ConfiguredMode{cia402::PositionMode::kProfile, "mode: profile"}};

// What the drive knows instead of the mode that it lacks.
std::string mode_that_would_do(std::uint32_t modes) {
  for (const ConfiguredMode& known : kConfiguredModes) {
    const bool has = (modes >> (static_cast<unsigned>(known.mode) - 1) & 1U) != 0;
    if (has) return fmt::format("; \"{}\" would do", known.words);
  }
  return "; it knows no mode of positions";
}

std::string refusal_words(const cia402::SetupRefusal& refusal) {
  const auto told = [](const std::optional<std::uint32_t>& value) {
    return value ? fmt::format("0x{:X}", *value) : std::string("nothing");
  };
  std::string words = fmt::format(
      "{}: found {}, wanted {}: {}", name_of(refusal.object.index, refusal.object.subindex),
      told(refusal.object.found), told(refusal.object.wanted), describe(refusal.error));
  if (refusal.error == Error::kSdoAborted) {
    words += fmt::format(" ({})", canopen::describe_sdo_abort(refusal.code));
  }
  const std::uint16_t index = cia402::object_of_first_axis(refusal.object.index);
  if (index == cia402::kSupportedModes && refusal.object.found) {
    words += mode_that_would_do(*refusal.object.found);
  }
  return words;
}

std::string state_words(const NodeReading& node) {
  const ObjectOutcome status = node.at(cia402::kStatusWord);
  std::string words = "state not reported";
  if (status) {
    words = cia402::describe(cia402::decode_state(static_cast<std::uint16_t>(*status)));
  }
  ObjectOutcome error = node.at(0x603F);
  if (!error) error = node.at(0x1003, 1);
  if (error && (*error & 0xFFFF) != 0) {
    const auto code = static_cast<std::uint16_t>(*error & 0xFFFF);
    words += fmt::format(", error {:04X}h {}", code, canopen::describe_emergency(code));
  } else {
    words += error ? ", no error" : ", errors not reported";
  }
  if (const auto mode = node.at(cia402::kModeDisplay)) {
    words += fmt::format(", mode {}", static_cast<std::int8_t>(*mode & 0xFF));
  }
  return words;
}

struct Mode {
  std::uint8_t bit;  // of 6502h
  std::string_view words;
};
constexpr std::array kModes{Mode{0, "profile position"},
                            Mode{1, "velocity"},
                            Mode{2, "profile velocity"},
                            Mode{3, "profile torque"},
                            Mode{5, "homing"},
                            Mode{6, "interpolated position"},
                            Mode{7, "cyclic synchronous position"},
                            Mode{8, "cyclic synchronous velocity"},
                            Mode{9, "cyclic synchronous torque"}};

std::string mode_words(const NodeReading& node) {
  const ObjectOutcome modes = node.at(cia402::kSupportedModes);
  if (!modes) return "modes not reported";
  std::string words;
  for (const Mode& mode : kModes) {
    if ((*modes >> mode.bit & 1U) == 0) continue;
    words += words.empty() ? "modes: " : ", ";
    words += mode.words;
  }
  return words.empty() ? "no mode of the standard" : words;
}

std::string position_words(const NodeReading& node, const CheckedConfiguration& configuration) {
  const ObjectOutcome position = node.at(cia402::kActualPosition);
  if (!position) return {};
  const auto counts = static_cast<std::int32_t>(*position);
  if (!node.joint) return fmt::format(", at {} counts", counts);
  const double reading = configuration.scaling(*node.joint).reading(counts);
  const bool turns = configuration->axes[*node.joint].scaling.type == JointType::kRevolute;
  return fmt::format(", at {} counts = {:.3f} {}", counts, turns ? degrees(reading) : 1e3 * reading,
                     turns ? "deg" : "mm");
}

std::string type_words(const NodeReading& node) {
  ObjectOutcome type = node.at(cia402::kDeviceType);
  if (const auto of_axis = node.at(cia402::kLogicalDeviceType); node.axis > 1 && of_axis) {
    type = of_axis;
  }
  if (!type) return "device type not reported";
  const std::uint32_t profile = *type & 0xFFFF;
  return profile == 402 ? "drive of CiA 402" : fmt::format("device of profile {}", profile);
}

std::string head_words(const NodeReading& node) {
  std::string words = fmt::format("node {}", node.node);
  words += node.interface.empty() ? ", " : fmt::format(" on {}, ", node.interface);
  if (node.one_of_several) words += fmt::format("axis {}, ", node.axis);
  words += node.joint ? fmt::format("joint {}: ", *node.joint + 1) : "not configured: ";
  if (node.answers == 0) return words + "does not answer\n";
  words += type_words(node);
  if (!node.name.empty()) words += fmt::format(" \"{}\"", node.name);
  words += "\n ";
  std::uint8_t subindex = 1;
  for (const std::string_view what : {"vendor", "product", "revision", "serial"}) {
    const auto value = node.at(0x1018, subindex++);
    if (value) words += fmt::format(" {} 0x{:X}", what, *value);
  }
  return words + "\n";
}

bool is(const hal::DeviceObject& object, const ObjectWords& words) {
  return object.index == words.index && object.subindex == words.subindex;
}

std::string note_of(const ObjectWords& words, const ObjectOutcome& found, const Rehearsal& setup) {
  if (setup.refusal && is(setup.refusal->object, words)) return "refused";
  const bool gap = std::ranges::any_of(
      setup.report.gaps, [&](const hal::DeviceObject& object) { return is(object, words); });
  const bool untold = cia402::is_absent(found) && words.index >= 0x6000;
  return gap || untold ? std::string(words.cost) : std::string();
}

bool in_head(std::uint16_t number) {
  const std::uint16_t index = cia402::object_of_first_axis(number);
  return index == kFirstOfHead || index == cia402::kLogicalDeviceType || index == 0x603F ||
         index == 0x1003 || index == 0x6064 || index == 0x1000 || index == 0x1018 ||
         index == 0x6061;
}

// The objects that are told of an axis: the known ones, and what the configuration writes besides.
std::vector<ObjectWords> words_for(const NodeReading& node,
                                   const CheckedConfiguration& configuration) {
  std::vector<ObjectWords> all(kWords.begin(), kWords.end());
  for (ObjectWords& words : all) words.index = cia402::object_of_axis(node.axis, words.index);
  if (!node.joint) return all;
  for (const auto& further : configuration->axes[*node.joint].further_writes()) {
    const ObjectWords words{cia402::object_of_axis(node.axis, further.index), further.subindex,
                            "by the configuration", ""};
    const bool known = std::ranges::any_of(all, [&](const ObjectWords& other) {
      return other.index == words.index && other.subindex == words.subindex;
    });
    if (!known) all.push_back(words);
  }
  return all;
}

// A row for each object that the device has, that would be written, or that it costs to lack.
std::string rows_of(const NodeReading& node, const CheckedConfiguration& configuration,
                    const Rehearsal& setup) {
  std::string rows = fmt::format("  {:<8}{:<27}{:<12}{:<12}{}\n", "object", "what", "found",
                                 "is written", "costs");
  for (const ObjectWords& words : words_for(node, configuration)) {
    if (in_head(words.index)) continue;
    const ObjectOutcome found = node.read(words.index, words.subindex);
    const auto written = setup.writes.find({words.index, words.subindex});
    const std::string note = note_of(words, found, setup);
    if (!found && note.empty() && written == setup.writes.end()) continue;
    std::string row = fmt::format(
        "  {:<8}{:<27}{:<12}{:<12}{}", name_of(words.index, words.subindex), words.what,
        value_words(found),
        written == setup.writes.end() ? "-" : fmt::format("0x{:X}", written->second), note);
    row.erase(row.find_last_not_of(' ') + 1);
    rows += row + "\n";
  }
  return rows;
}

std::string verdict_words(const NodeReading& node, const Rehearsal& setup) {
  if (node.answers > 1) return "refused: two devices answer as this node";
  if (setup.refusal) return "refused at " + refusal_words(*setup.refusal);
  std::string words = "would be set up";
  if (!setup.report.is_supervised()) words += "; holds torque when this process dies";
  return words;
}

// At blanks, so that no line is longer than a terminal of 100 columns.
std::string wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 96;
  std::string lines;
  std::string rest = text;
  while (rest.size() > kWidth && rest.rfind(' ', kWidth) != std::string::npos) {
    const std::size_t at = rest.rfind(' ', kWidth);
    lines += "  " + rest.substr(0, at) + "\n";
    rest = "  " + rest.substr(at + 1);
  }
  return lines + "  " + rest + "\n";
}

nlohmann::ordered_json number_or_null(const ObjectOutcome& outcome) {
  return outcome ? nlohmann::ordered_json(*outcome) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json json_of_object(const NodeReading& node, const ObjectWords& words,
                                      const Rehearsal* setup) {
  const ObjectOutcome found = node.read(words.index, words.subindex);
  nlohmann::ordered_json json{{"object", name_of(words.index, words.subindex)},
                              {"what", words.what},
                              {"found", number_or_null(found)}};
  if (!found && found.error().error == Error::kSdoAborted) {
    json["abort"] = found.error().abort_code;
  }
  if (setup == nullptr) return json;
  const auto written = setup->writes.find({words.index, words.subindex});
  if (written != setup->writes.end()) json["written"] = written->second;
  if (const std::string note = note_of(words, found, *setup); !note.empty()) json["costs"] = note;
  return json;
}

nlohmann::ordered_json json_of_node(const NodeReading& node,
                                    const CheckedConfiguration& configuration) {
  nlohmann::ordered_json json{{"node", node.node}, {"axis", node.axis}, {"answers", node.answers}};
  if (!node.interface.empty()) json["interface"] = node.interface;
  if (node.joint) json["joint"] = *node.joint + 1;
  if (node.answers == 0) return json;
  if (!node.name.empty()) json["name"] = node.name;
  json["state"] = state_words(node);
  json["modes"] = mode_words(node);
  std::optional<Rehearsal> setup;
  if (node.joint) {
    setup = rehearse(node, configuration);
    json["set_up"] = !setup->refusal && node.answers == 1;
    json["verdict"] = verdict_words(node, *setup);
    json["supervised"] = !setup->refusal && setup->report.is_supervised();
    if (setup->refusal) json["error"] = name(setup->refusal->error);
  }
  nlohmann::ordered_json objects = nlohmann::ordered_json::array();
  for (const ObjectWords& words : words_for(node, configuration)) {
    objects.push_back(json_of_object(node, words, setup ? &*setup : nullptr));
  }
  json["objects"] = std::move(objects);
  return json;
}

}  // namespace

std::span<const ObjectWords> object_words() { return kWords; }

Rehearsal rehearse(const NodeReading& reading, const CheckedConfiguration& configuration) {
  Rehearsal rehearsal;
  std::map<ObjectKey, std::uint32_t> written;
  cia402::SetupRun run;
  run.begin(canopen::drive_setup(configuration, *reading.joint),
            configuration->axes[*reading.joint]);
  while (const auto request = run.request()) {
    const ObjectKey key{request->index, request->subindex};
    ObjectOutcome outcome = reading.read(request->index, request->subindex);
    if (request->bytes != 0) {
      if (!cia402::is_absent(outcome)) {
        written[key] = request->value;
        outcome = request->value;
      }
    } else if (const auto known = written.find(key); known != written.end()) {
      outcome = known->second;
    }
    rehearsal.refusal = run.take(outcome);
    if (rehearsal.refusal) break;
  }
  if (!rehearsal.refusal) rehearsal.writes = std::move(written);
  rehearsal.report = run.report();
  return rehearsal;
}

bool all_would_be_set_up(const std::vector<NodeReading>& nodes,
                         const CheckedConfiguration& configuration) {
  return std::ranges::all_of(nodes, [&](const NodeReading& node) {
    return !node.joint || (node.answers == 1 && !rehearse(node, configuration).refusal);
  });
}

std::string drives_in_words(const DriveScan& scan, const CheckedConfiguration& configuration) {
  std::string words;
  if (scan.heard_master()) {
    words += fmt::format("another master is on {}\n",
                         scan.interface().empty() ? "the bus" : scan.interface());
  }
  for (const NodeReading& node : scan.nodes()) {
    words += head_words(node);
    if (node.answers == 0) continue;
    words += wrapped(state_words(node) + position_words(node, configuration));
    words += wrapped(mode_words(node));
    const Rehearsal setup = node.joint ? rehearse(node, configuration) : Rehearsal{};
    words += rows_of(node, configuration, setup);
    if (node.joint) words += wrapped(verdict_words(node, setup));
  }
  return words;
}

std::string drives_as_json(std::span<const DriveScan> scans,
                           const CheckedConfiguration& configuration) {
  const bool other_master = std::ranges::any_of(scans, &DriveScan::heard_master);
  nlohmann::ordered_json json{{"armsig", "drives/1"}, {"other_master", other_master}};
  nlohmann::ordered_json nodes = nlohmann::ordered_json::array();
  for (const DriveScan& scan : scans) {
    for (const NodeReading& node : scan.nodes()) nodes.push_back(json_of_node(node, configuration));
  }
  json["nodes"] = std::move(nodes);
  return json.dump(2) + "\n";
}

}  // namespace armsig::daemon
