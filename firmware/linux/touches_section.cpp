// SPDX-License-Identifier: MIT
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/sections.hpp"

namespace armsig::daemon {

// What stands in the files is looked at when a touch is made: they come and go with a person.
tool::Read<void> read_touch_files(const tool::YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(map, tool::YamlMap::open(node, "touches", {"file", "plan"}));
  ARMSIG_TRY(file, map.text("file"));
  c.touches.file = file;
  const tool::YamlNode* const plan = map.find("plan");
  if (plan == nullptr) return {};
  ARMSIG_TRY(path, map.text("plan"));
  if (path == file) {
    return tool::problem_at(*plan, "plan: the file of the touches", "another file");
  }
  c.touches.plan = path;
  return {};
}

}  // namespace armsig::daemon
