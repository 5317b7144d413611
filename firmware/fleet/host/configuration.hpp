// SPDX-License-Identifier: MIT
// The YAML file of armsig-fleet, checked as a whole.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/fleet/wire/mqtt_connection.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::fleet {

// How drift is watched: firmware/drift says what the numbers mean.
struct DriftPlan {
  double pose_sigma_mm = 0.1;
  int poses = 20;
  double shift_mm = 0.1;
  int baseline = 20;
  double correlation = 0.3;
  double sigma_ratio = 1.1;
  double checks_per_month = 30.4;
  double false_alarms_per_1000_arm_months = 1;
};

struct HostConfiguration {
  std::string group;
  std::string host;
  std::string database;                 // as libpq describes it
  int page_port = 8080;                 // on the loopback
  std::vector<std::string> page_names;  // by which a proxy asks for it, beside the loopback's
  BrokerSettings broker;
  DriftPlan drift;
};

[[nodiscard]] tool::Read<HostConfiguration> parse_host_configuration(std::string_view text,
                                                                     std::string_view file);
[[nodiscard]] tool::Read<HostConfiguration> read_host_configuration(const std::string& path);

}  // namespace armsig::fleet
