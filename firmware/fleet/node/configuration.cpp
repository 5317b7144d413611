// SPDX-License-Identifier: MIT
#include "firmware/fleet/node/configuration.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "firmware/formats/text_file.hpp"

namespace armsig::fleet {

using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

namespace {

constexpr int kMostMebibytes = 4'000;

// Below half a second the looks would cost more than they tell.
Read<void> read_period(const YamlMap& root, NodeConfiguration& configuration) {
  ARMSIG_TRY(period, root.find_quantity("period", Dimension::kTime));
  if (!period) return {};
  ARMSIG_TRY(seconds, root.quantity("period", Dimension::kTime));
  if (seconds < 0.5 || seconds > 3600) {
    return problem_at(*period->value, "a period out of range", "0.5 s to an hour");
  }
  configuration.period_ms = static_cast<std::uint64_t>(std::llround(1e3 * seconds));
  return {};
}

Read<NodeConfiguration> node_configuration_from(const YamlNode& node) {
  if (auto tag = tool::check_tag(node, "node/1"); !tag) return std::unexpected(tag.error());
  std::vector<std::string> known{"armsig", "console", "journal", "journal_mib", "group",
                                 "node",   "host",    "serial",  "broker"};
  tool::add_names(known, "period", Dimension::kTime);
  ARMSIG_TRY(root, YamlMap::open(node, "the reporter", known));
  NodeConfiguration configuration;
  ARMSIG_TRY(console, root.text("console"));
  ARMSIG_TRY(journal, root.text("journal"));
  ARMSIG_TRY(group, read_topic_name(root, "group"));
  ARMSIG_TRY(name, read_topic_name(root, "node"));
  ARMSIG_TRY(host, read_topic_name(root, "host"));
  ARMSIG_TRY(broker, read_broker(root));
  int mebibytes = 16;
  if (root.find("journal_mib") != nullptr) {
    ARMSIG_TRY(told, root.integer("journal_mib", 1, kMostMebibytes));
    mebibytes = told;
  }
  if (root.find("serial") != nullptr) {
    ARMSIG_TRY(serial, root.name_under("serial"));
    configuration.serial = serial;
  }
  if (auto period = read_period(root, configuration); !period) {
    return std::unexpected(period.error());
  }
  configuration.console = console;
  configuration.journal = journal;
  configuration.slots =
      ((std::uint64_t(mebibytes) << 20U) - Journal::kFirstSlotAt) / Journal::kSlotSize;
  configuration.edge.group = group;
  configuration.edge.node = name;
  configuration.edge.host = host;
  configuration.broker = broker;
  return configuration;
}

bool is_loopback(std::string_view address) {
  return address == "localhost" || address == "127.0.0.1" || address == "::1";
}

}  // namespace

Read<std::string> read_topic_name(const YamlMap& root, std::string_view key) {
  ARMSIG_TRY(node, root.require(key));
  ARMSIG_TRY(name, tool::read_text(*node, key));
  const bool good = name.size() <= 64 && std::ranges::all_of(name, [](char c) {
                      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                             (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
                    });
  if (!good) {
    return problem_at(*node, std::string(key) + " \"" + name + "\"",
                      "1 to 64 letters, digits, '-', '_' and '.'");
  }
  return name;
}

Read<BrokerSettings> read_broker(const YamlMap& root) {
  ARMSIG_TRY(node, root.require("broker"));
  ARMSIG_TRY(
      map, YamlMap::open(*node, "broker", {"address", "port", "authority", "certificate", "key"}));
  BrokerSettings broker;
  ARMSIG_TRY(address, map.text("address"));
  broker.address = address;
  const bool plain = map.find("authority") == nullptr && map.find("certificate") == nullptr &&
                     map.find("key") == nullptr;
  if (plain && !is_loopback(address)) {
    return problem_at(*node, "a broker elsewhere without TLS",
                      "authority, certificate and key, or an address of the loopback");
  }
  if (!plain) {
    ARMSIG_TRY(authority, map.text("authority"));
    ARMSIG_TRY(certificate, map.text("certificate"));
    ARMSIG_TRY(key, map.text("key"));
    broker.authority = authority;
    broker.certificate = certificate;
    broker.key = key;
  }
  broker.port = plain ? 1883 : 8883;
  if (map.find("port") != nullptr) {
    ARMSIG_TRY(port, map.integer("port", 1, 65'535));
    broker.port = port;
  }
  return broker;
}

Read<NodeConfiguration> parse_node_configuration(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<NodeConfiguration> {
    ARMSIG_TRY(root, tool::parse_yaml(text));
    return node_configuration_from(root);
  };
  return tool::in_file(file, parse());
}

Read<NodeConfiguration> read_node_configuration(const std::string& path) {
  ARMSIG_TRY(text, tool::read_text_file(path));
  return parse_node_configuration(text, path);
}

}  // namespace armsig::fleet
