// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/configuration.hpp"

#include "core/base/error.hpp"
#include "firmware/fleet/node/configuration.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::fleet {

using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

namespace {

Read<void> read_number(const YamlMap& map, std::string_view key, double lowest, double highest,
                       double& value) {
  const YamlNode* node = map.find(key);
  if (node == nullptr) return {};
  ARMSIG_TRY(number, tool::read_number(*node, key));
  if (number < lowest || number > highest) {
    return problem_at(*node, std::string(key) + " out of range",
                      std::to_string(lowest) + " to " + std::to_string(highest));
  }
  value = number;
  return {};
}

Read<void> read_integer(const YamlMap& map, std::string_view key, int lowest, int highest,
                        int& value) {
  if (map.find(key) == nullptr) return {};
  ARMSIG_TRY(number, map.integer(key, lowest, highest));
  value = number;
  return {};
}

Read<DriftPlan> read_drift(const YamlMap& root) {
  DriftPlan plan;
  const YamlNode* node = root.find("drift");
  if (node == nullptr) return plan;
  ARMSIG_TRY(
      map, YamlMap::open(*node, "drift",
                         {"pose_sigma_mm", "poses", "shift_mm", "baseline", "correlation",
                          "sigma_ratio", "checks_per_month", "false_alarms_per_1000_arm_months"}));
  auto read = read_number(map, "pose_sigma_mm", 1e-4, 100, plan.pose_sigma_mm);
  if (read) read = read_integer(map, "poses", 1, 1'000, plan.poses);
  if (read) read = read_number(map, "shift_mm", 1e-4, 100, plan.shift_mm);
  if (read) read = read_integer(map, "baseline", 1, 1'000, plan.baseline);
  if (read) read = read_number(map, "correlation", 0, 0.95, plan.correlation);
  if (read) read = read_number(map, "sigma_ratio", 0.1, 10, plan.sigma_ratio);
  if (read) read = read_number(map, "checks_per_month", 0.1, 400, plan.checks_per_month);
  if (read) {
    read = read_number(map, "false_alarms_per_1000_arm_months", 0.1, 40,
                       plan.false_alarms_per_1000_arm_months);
  }
  if (!read) return std::unexpected(read.error());
  return plan;
}

Read<void> read_page_names(const YamlMap& root, std::vector<std::string>& names) {
  constexpr std::size_t kMostNames = 16;
  constexpr std::size_t kLongestName = 253;  // of a host
  const YamlNode* node = root.find("page_names");
  if (node == nullptr) return {};
  ARMSIG_TRY(list, tool::read_list(*node, "page_names", 1, kMostNames));
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(name, tool::read_text(item, "a name of the page"));
    const bool good = !name.empty() && name.size() <= kLongestName &&
                      name.find_first_not_of(
                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                          "0123456789-.") == std::string::npos;
    if (!good) return problem_at(item, "no name of a host", "fleet.plant.example, without a port");
    names.push_back(name);
  }
  return {};
}

Read<HostConfiguration> host_configuration_from(const YamlNode& node) {
  if (auto tag = tool::check_tag(node, "fleet/1"); !tag) return std::unexpected(tag.error());
  ARMSIG_TRY(root, YamlMap::open(node, "the host",
                                 {"armsig", "group", "host", "database", "page_port", "page_names",
                                  "broker", "drift"}));
  HostConfiguration configuration;
  ARMSIG_TRY(group, read_topic_name(root, "group"));
  ARMSIG_TRY(host, read_topic_name(root, "host"));
  ARMSIG_TRY(database, root.text("database"));
  ARMSIG_TRY(broker, read_broker(root));
  ARMSIG_TRY(drift, read_drift(root));
  if (auto port = read_integer(root, "page_port", 1, 65'535, configuration.page_port); !port) {
    return std::unexpected(port.error());
  }
  if (auto names = read_page_names(root, configuration.page_names); !names) {
    return std::unexpected(names.error());
  }
  configuration.group = group;
  configuration.host = host;
  configuration.database = database;
  configuration.broker = broker;
  configuration.drift = drift;
  return configuration;
}

}  // namespace

Read<HostConfiguration> parse_host_configuration(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<HostConfiguration> {
    ARMSIG_TRY(root, tool::parse_yaml(text));
    return host_configuration_from(root);
  };
  return tool::in_file(file, parse());
}

Read<HostConfiguration> read_host_configuration(const std::string& path) {
  ARMSIG_TRY(text, tool::read_text_file(path));
  return parse_host_configuration(text, path);
}

}  // namespace armsig::fleet
