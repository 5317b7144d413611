// SPDX-License-Identifier: MIT
// Names that mean something to the readers of our exports: any bytes as the name of an arm, through
// every exporter, into expat, a YAML and a JSON parser, as host_tests/exports/read_names.py has
// them go into Python's compiler.
#include <expat.h>

#include <algorithm>
#include <array>
#include <map>

#include <nlohmann/json.hpp>
#include <yaml-cpp/yaml.h>

#include "core/identification.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

// Of an arm that every format holds.
const tool::SignatureRecord& ur_record() {
  static const tool::SignatureRecord record = [] {
    tool::SignatureRecord made;
    const auto ur5e = tool::read_arm("ur5e");
    FUZZ_CHECK(ur5e);
    made.nominal = ur5e->arm;
    made.signature =
        signature_of(made.nominal, JointVector{0.1, -0.6, 0.7, 0.2, 0.5, 0.3}, Pose{}, {});
    made.method = "exact";
    made.time = "1986-04-07T12:00:00Z";
    made.version = "1";
    return made;
  }();
  return record;
}

tool::SignatureRecord named(const std::string& name) {
  tool::SignatureRecord record = ur_record();
  record.arm_name = record.serial = name;
  return record;
}

// By format.
std::map<std::string, std::string> exports_of(const std::string& name) {
  std::map<std::string, std::string> texts;
  for (const std::string& format : tool::export_formats()) {
    if (format == "maps-csv") continue;  // of an arm with maps only
    auto exported = tool::export_text(format, named(name));
    FUZZ_CHECK(exported);
    texts.emplace(format, std::move(exported->text));
  }
  return texts;
}

bool is_legal(std::string_view name) { return !name.empty() && !tool::why_no_name(name); }

struct Elements {
  std::string robot;  // its name
  std::size_t robots = 0;
  bool others = false;  // elements that no export of ours has
};

void XMLCALL on_element(void* user, const XML_Char* name, const XML_Char** attributes) {
  constexpr std::array<std::string_view, 8> kOurs{"robot", "link",   "joint", "parent",
                                                  "child", "origin", "axis",  "limit"};
  auto& seen = *static_cast<Elements*>(user);
  if (std::ranges::find(kOurs, std::string_view(name)) == kOurs.end()) seen.others = true;
  if (std::string_view(name) != "robot") return;
  ++seen.robots;
  for (; *attributes != nullptr; attributes += 2) {
    if (std::string_view(*attributes) == "name") seen.robot = *(attributes + 1);
  }
}

void check_urdf(const std::string& text, const std::string* name) {
  const XML_Parser parser = XML_ParserCreate(nullptr);
  Elements seen;
  XML_SetUserData(parser, &seen);
  XML_SetStartElementHandler(parser, on_element);
  const bool parsed =
      XML_Parse(parser, text.data(), static_cast<int>(text.size()), XML_TRUE) == XML_STATUS_OK;
  XML_ParserFree(parser);
  FUZZ_CHECK(parsed);
  FUZZ_CHECK(seen.robots == 1 && !seen.others);
  if (name != nullptr) FUZZ_CHECK(seen.robot == *name);
}

void check_json(const std::string& text, const std::string* name) {
  const auto document = nlohmann::json::parse(text, nullptr, false);
  FUZZ_CHECK(!document.is_discarded() && document.is_object());
  FUZZ_CHECK(document["name"] == document["serial"]);
  if (name != nullptr) FUZZ_CHECK(document["name"] == *name);
}

void check_ur_yaml(const std::string& text) {
  const YAML::Node document = YAML::Load(text);
  FUZZ_CHECK(document.IsMap() && document.size() == 1);
  FUZZ_CHECK(document["kinematics"].IsMap() && document["kinematics"].size() == 7);
}

// Lines of the same beginnings whatever the name is: a name can't begin a line of its own.
void check_lines(const std::string& text, const std::string& innocent) {
  const auto count = [](const std::string& lines) { return std::ranges::count(lines, '\n'); };
  FUZZ_CHECK(count(text) == count(innocent));
}

void check_characters(const std::string& text) {
  for (std::string_view left = text; !left.empty();) {
    const tool::Character character = tool::first_character(left);
    FUZZ_CHECK(character.length > 0);
    FUZZ_CHECK(character.code == '\n' || tool::is_printable(character.code));
    left.remove_prefix(character.length);
  }
}

void fuzz_names(Bytes bytes) {
  const std::string name(text_of(bytes).substr(0, 2 * tool::kLongestName));
  const bool legal = is_legal(name);
  static const std::map<std::string, std::string> innocent = exports_of("a");
  for (const auto& [format, text] : exports_of(name)) {
    check_characters(text);
    check_lines(text, innocent.at(format));
    if (format == "urdf") check_urdf(text, legal ? &name : nullptr);
    if (format == "json") check_json(text, legal ? &name : nullptr);
    if (format == "ur-yaml") check_ur_yaml(text);
  }
  if (!legal) return;
  const auto arm = tool::parse_arm(tool::arm_text({.name = name, .arm = ur_record().nominal}), "F");
  FUZZ_CHECK(arm && arm->name == name);
  const auto written = tool::signature_text(named(name));
  FUZZ_CHECK(written);
  const auto read = tool::parse_signature(*written, "F");
  FUZZ_CHECK(read && read->arm_name == name && read->serial == name);
}

constexpr std::array kTargets{Target{"names", fuzz_names}};

}  // namespace

std::span<const Target> name_targets() { return kTargets; }

}  // namespace armsig::fuzz
