// SPDX-License-Identifier: MIT
// The YAML file of armsig-node, checked as a whole.
#pragma once

#include <string>
#include <string_view>

#include "firmware/fleet/node/edge_node.hpp"
#include "firmware/fleet/wire/mqtt_connection.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::fleet {

struct NodeConfiguration {
  std::string console;
  std::string journal;
  std::uint64_t slots = 0;           // of the journal
  std::string serial;                // of the arm; empty: not told
  std::uint64_t period_ms = 10'000;  // between two looks at the controller
  EdgeSettings edge;
  BrokerSettings broker;
};

[[nodiscard]] tool::Read<NodeConfiguration> parse_node_configuration(std::string_view text,
                                                                     std::string_view file);
[[nodiscard]] tool::Read<NodeConfiguration> read_node_configuration(const std::string& path);

// The section `broker`, which the host has too.
[[nodiscard]] tool::Read<BrokerSettings> read_broker(const tool::YamlMap& root);
// A name that stands in a topic: 1 to 64 letters, digits, '-', '_' and '.'.
[[nodiscard]] tool::Read<std::string> read_topic_name(const tool::YamlMap& root,
                                                      std::string_view key);

}  // namespace armsig::fleet
