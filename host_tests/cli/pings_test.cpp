// SPDX-License-Identifier: MIT
// Ranges that are medians of several pings: what is predicted of the tool is what is found.
#include <cmath>

#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

constexpr const char* kEightReceivers =
    "armsig: sensor/1\nname: eight around a square\nreceivers:\n"
    "  - {x_mm: -600, y_mm: -600, z_mm: 2000}\n  - {x_mm: 0, y_mm: -600, z_mm: 2100}\n"
    "  - {x_mm: 600, y_mm: -600, z_mm: 2000}\n  - {x_mm: -600, y_mm: 0, z_mm: 2100}\n"
    "  - {x_mm: 600, y_mm: 0, z_mm: 2100}\n  - {x_mm: -600, y_mm: 600, z_mm: 2000}\n"
    "  - {x_mm: 0, y_mm: 600, z_mm: 2100}\n  - {x_mm: 600, y_mm: 600, z_mm: 2000}\n"
    "path: one-way\nrange_sigma_mm: 0.2\nfacing: [0, 0, -1]\n";

// Observed over predicted tool error, root mean square over some arms.
double observed_over_predicted(const std::string& method) {
  constexpr int kArms = 8;
  double sum = 0;
  for (int seed = 1; seed <= kArms; ++seed) {
    const Folder folder;
    write_file(folder / "arm.yaml", kPuma560);
    write_file(folder / "sensor.yaml", kEightReceivers);
    const std::string simulate =
        "simulate --arm arm.yaml --sensor sensor.yaml --pings 4 --arc 180 --points 24 "
        "--tolerances 1 --truth-out truth.yaml --seed " +
        std::to_string(seed);
    EXPECT_EQ(run_tool(folder, simulate + " --out m.csv").status, 0);
    EXPECT_EQ(run_tool(folder, simulate + " --free-poses 60 --out good.csv").status, 0);
    const Outcome outcome =
        run_tool(folder,
                 "identify --arm arm.yaml --measurements m.csv --sensor sensor.yaml "
                 "--out s.yaml --json --method " +
                     method);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    if (outcome.status != 0) return 0;
    const double predicted_m =
        nlohmann::json::parse(outcome.out)["predicted_tool_error_m"].get<double>();
    write_joint_poses(Csv::read(folder / "good.csv"), folder / "q.csv");
    const double observed_m =
        rms_distance(predict(folder, "s.yaml", "6"), predict(folder, "truth.yaml", "6"));
    sum += observed_m * observed_m / (predicted_m * predicted_m) / kArms;
  }
  return std::sqrt(sum);
}

TEST(Pings, are_counted_in_the_predicted_tool_error) {
  for (const std::string method : {"encoder", "refined"}) {
    SCOPED_TRACE(method);
    const double ratio = observed_over_predicted(method);
    EXPECT_GT(ratio, 0.75);
    EXPECT_LT(ratio, 1.3);
  }
}

}  // namespace
}  // namespace armsig::cli
