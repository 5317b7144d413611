// SPDX-License-Identifier: MIT
// What is stated of sweeps alone is the accuracy anywhere in the work volume, by the command: over
// arms that gravity bends and whose readings are wrong many times a turn, which no sweep shows
// whole.
//
// A sample by default; ARMSIG_SWEEPS=10 takes so many of every arm. Prints a table.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "core/base/low_discrepancy.hpp"
#include "firmware/formats/signature_file.hpp"
#include "host_tests/cli/predictions.hpp"

namespace armsig {
namespace {

using cli::Folder;

constexpr std::array<const char*, 6> kArms{"puma560",  "ur10e",  "cobra600",
                                           "stanford", "iiwa14", "irb120"};
constexpr int kPoses = 200;

struct Bent {
  double sag_mm = 0;
  double maps_deg = 0;
  double sigma_mm = 0;
  double most = 0;  // that may be observed over what is stated, RMS over the arms
};

// Poses over the joint limits, none of them one that predicted_rms() looks at.
void write_poses(const Folder& folder) {
  const auto truth = tool::read_signature_file((folder / "truth.yaml").string());
  ASSERT_TRUE(truth.has_value());
  const Arm& arm = truth->nominal;
  std::string text;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const bool revolute = arm.joints[i].type == JointType::kRevolute;
    text += fmt::format("{}q{}_{}", i == 0 ? "" : ",", i + 1, revolute ? "rad" : "m");
  }
  for (int k = 1; k <= kPoses; ++k) {
    const JointVector q = evenly_spread_configuration(types_of(arm.joints), arm.limits, 5000 + k);
    for (std::size_t i = 0; i < q.size(); ++i) {
      text += fmt::format("{}{:.9f}", i == 0 ? "\n" : ",", q[i]);
    }
  }
  cli::write_file(folder / "q.csv", text + "\n");
}

// An arm as it is, and as it is drawn.
struct Drawn {
  std::string made;
  std::string drawn;
  const char* hand_mm = "80,30,120";
};

// Observed over stated RMS error of the tool.
std::optional<double> judge(const Folder& folder, const Drawn& arm, const Bent& bent,
                            const char* method, int seed) {
  const cli::Outcome simulated = cli::run_tool(
      folder, fmt::format("simulate --arm {} --tolerances 1 --points 36 --arc 150 "
                          "--flange-target-mm {} --sigma-mm {} --deflection-mm {} --maps-deg {} "
                          "--seed {} --out m.csv --truth-out truth.yaml",
                          arm.made, arm.hand_mm, bent.sigma_mm, bent.sag_mm, bent.maps_deg, seed));
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  const cli::Outcome identified =
      cli::run_tool(folder, fmt::format("identify --arm {} --measurements m.csv --method {} "
                                        "--out s.yaml --json",
                                        arm.drawn, method));
  EXPECT_EQ(identified.status, 0) << arm.drawn << identified.err;
  if (identified.status != 0) return std::nullopt;
  const auto json = nlohmann::json::parse(identified.out);
  const double stated_m = json.contains("predicted_over_limits_m")
                              ? json["predicted_over_limits_m"].get<double>()
                              : json["predicted_tool_error_m"].get<double>();
  write_poses(folder);
  return cli::rms_distance(cli::predict(folder, "s.yaml", "1"),
                           cli::predict(folder, "truth.yaml", "1")) /
         stated_m;
}

int seeds() {
  const char* value = std::getenv("ARMSIG_SWEEPS");  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? 1 : std::max(1, std::atoi(value));
}

void expect_honest(const char* method) {
  // Waves of the readings alone are told worst: the axes take the long ones, noise the short ones.
  constexpr std::array<Bent, 4> kBent{
      {{0.5, 0, 0.03, 1.5}, {1, 0, 0.03, 1.5}, {0, 0.02, 0.03, 2}, {1, 0.02, 0.1, 1.5}}};
  fmt::print("{}\n| sag mm | maps ° | sigma mm | observed over stated | most |\n", method);
  fmt::print("|--:|--:|--:|--:|--:|\n");
  for (const Bent& bent : kBent) {
    double squares = 0;
    double most = 0;
    int count = 0;
    for (const char* arm : kArms) {
      for (int seed = 1; seed <= seeds(); ++seed) {
        const auto ratio = judge(Folder(), {arm, arm}, bent, method, seed);
        if (!ratio) continue;
        squares += *ratio * *ratio;
        most = std::max(most, *ratio);
        ++count;
      }
    }
    const double ratio = std::sqrt(squares / count);
    fmt::print("| {} | {} | {} | {:.2f} | {:.2f} |\n", bent.sag_mm, bent.maps_deg, bent.sigma_mm,
               ratio, most);
    EXPECT_LT(ratio, bent.most) << bent.sag_mm << " " << bent.maps_deg << " " << bent.sigma_mm;
  }
}

TEST(SweepsAlone, state_by_features_what_an_arm_that_bends_is_missed_by) {
  expect_honest("encoder");
}

TEST(SweepsAlone, state_refined_what_an_arm_that_bends_is_missed_by) { expect_honest("refined"); }

// The drawing's last link frame is in the wrist, and no lever of its frames that of the tool.
TEST(SweepsAlone, state_what_a_weight_at_the_tool_bends) {
  const cli::Outcome shown = cli::run_tool(Folder(), "arms --show puma560");
  ASSERT_EQ(shown.status, 0);
  std::string heavy = shown.out;
  const std::string last = "d_mm: 0, a_mm: 0, alpha_deg: 0, limits_deg: [-266";
  ASSERT_NE(heavy.find(last), std::string::npos);
  heavy.replace(heavy.find(last), last.size(),
                "d_mm: 120, a_mm: 80, alpha_deg: 0, limits_deg: [-266");
  for (const char* method : {"encoder", "refined"}) {
    for (const double sag_mm : {1.0, 2.0, 4.0}) {
      double squares = 0;
      const int count = 2 + seeds();
      for (int seed = 1; seed <= count; ++seed) {
        const Folder folder;
        cli::write_file(folder / "heavy.yaml", heavy);
        const auto ratio =
            judge(folder, {"heavy.yaml", "puma560", "0,30,20"}, {sag_mm, 0, 0.03}, method, seed);
        ASSERT_TRUE(ratio.has_value());
        EXPECT_LT(*ratio, 1.5) << method << sag_mm << " " << seed;
        squares += *ratio * *ratio / count;
      }
      fmt::print("{}, {} mm at the tool: {:.2f}\n", method, sag_mm, std::sqrt(squares));
      EXPECT_GT(squares, 0.5 * 0.5) << method << sag_mm;
    }
  }
}

}  // namespace
}  // namespace armsig
