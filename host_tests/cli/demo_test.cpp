// SPDX-License-Identifier: MIT
// The demonstration runs what a person runs: its signatures are those of `identify` on its own
// files, with the same figures, and none of its sound arms is warned of.
#include <cmath>

#include <nlohmann/json.hpp>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

// Without when it was written, and the checksum over that.
std::string without_time(const std::string& signature) {
  std::string kept;
  for (const std::string& line : split(signature, '\n')) {
    if (!line.starts_with("created:") && !line.starts_with("time:") && !line.starts_with("crc32:"))
      kept += line + "\n";
  }
  return kept;
}

TEST(Demonstration, shows_what_identify_says_of_the_same_files) {
  const Folder folder;
  const Outcome demo = run_tool(folder, "demo --out d --json");
  ASSERT_EQ(demo.status, 0) << demo.err;
  EXPECT_EQ(demo.err, "");
  const json robots = json::parse(demo.out)["robots"];
  ASSERT_EQ(robots.size(), 7U);
  for (std::size_t k = 1; k <= robots.size(); k += 3) {
    const std::string robot = "robot" + std::to_string(k);
    const Outcome identified =
        run_tool(folder, "identify --arm d/puma560.yaml --measurements d/" + robot +
                             "-measurements.csv --sensor d/sensor.yaml --out s.yaml --json");
    ASSERT_EQ(identified.status, 0) << identified.err;
    const json said = json::parse(identified.out);
    const json& shown = robots[k - 1]["encoder"];
    EXPECT_EQ(said["warnings"], shown["warnings"]);
    EXPECT_EQ(said["predicted_tool_error_m"], shown["predicted_tool_error_m"]);
    EXPECT_EQ(without_time(read_file(folder / "s.yaml")),
              without_time(read_file(folder / ("d/" + robot + "-encoder.yaml"))));
  }
}

TEST(Demonstration, states_the_accuracy_of_its_sound_arms_and_warns_of_none) {
  const Folder folder;
  const Outcome demo = run_tool(folder, "demo --out d --json --seed 11");
  ASSERT_EQ(demo.status, 0) << demo.err;
  const json robots = json::parse(demo.out)["robots"];
  for (const std::string method : {"encoder", "paper"}) {
    double squares = 0;
    for (const json& robot : robots) {
      const json& shown = robot[method];
      EXPECT_TRUE(shown["warnings"].empty()) << shown["warnings"];
      squares += std::pow(shown["rms_tool_error_m"].get<double>() /
                              shown["predicted_tool_error_m"].get<double>(),
                          2) /
                 7;
    }
    EXPECT_GT(std::sqrt(squares), 2.0 / 3) << method;
    EXPECT_LT(std::sqrt(squares), 4.0 / 3) << method;
  }
}

}  // namespace
}  // namespace armsig::cli
