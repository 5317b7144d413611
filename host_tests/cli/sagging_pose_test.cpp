// SPDX-License-Identifier: MIT
// Thirty poses, three targets on the hand each, of which one sags: no blunder of a sensor, as all
// its targets deviate alike, and nothing that an arm's reading does.
#include <nlohmann/json.hpp>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

constexpr std::size_t kTargets = 3;
constexpr std::size_t kSagging = 4;  // the pose

// Of an LR Mate 200iD with waves in its readings and gravity, as good.csv; `sag_mm` at one pose.
Csv thirty_poses(const Folder& folder, int seed, double sag_mm) {
  Csv all;
  for (const char* target : {"80,30,100", "-60,90,40", "20,-110,150"}) {
    const Outcome outcome =
        run_tool(folder,
                 "simulate --arm lrmate200id --tolerances 1 --sigma-mm 0.03 --points 2 "
                 "--free-poses 30 --maps-deg 0.005 --deflection-mm 0.3 --flange-target-mm " +
                     std::string(target) + " --seed " + std::to_string(seed) +
                     " --out good.csv --truth-out truth.yaml");
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    Csv rows = Csv::read(folder / "good.csv");
    keep_mixed(rows);
    const std::string number = std::to_string(all.rows.size() / rows.rows.size() + 1);
    for (Fields& row : rows.rows) row[rows.column("target")] = number;
    std::string& z = rows.rows[kSagging][rows.column("z_mm")];
    z = std::to_string(std::stod(z) - sag_mm);
    all.header = rows.header;
    all.rows.insert(all.rows.end(), rows.rows.begin(), rows.rows.end());
  }
  return all;
}

// A map that turns a joint by more than a tenth of what its reading moves is no arm's, and no
// signature holds it.
TEST(SaggingPose, is_not_taken_for_a_reading_that_jumps) {
  for (const int seed : {5, 6, 13}) {
    const Folder folder;
    const Csv rows = thirty_poses(folder, seed, 6);
    ASSERT_EQ(rows.rows.size(), 30 * kTargets);
    rows.write(folder / "m.csv");
    const Outcome outcome =
        run_tool(folder,
                 "identify --arm lrmate200id --measurements m.csv --method refined --out s.yaml "
                 "--json");
    ASSERT_EQ(outcome.status, 0) << seed << outcome.err;
    EXPECT_LT(json::parse(outcome.out)["refinement"]["rows_rejected"], kTargets) << seed;
    measured_again(rows).write(folder / "later.csv");
    EXPECT_EQ(run_tool(folder, "check --signature s.yaml --measurements later.csv").status, 0);
  }
}

}  // namespace
}  // namespace armsig::cli
