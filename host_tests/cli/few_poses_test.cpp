// SPDX-License-Identifier: MIT
// Real arms measured at few poses: what is stated for the others is what they are missed by.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "host_tests/cli/refined_arm.hpp"

namespace armsig::cli {
namespace {

constexpr std::size_t kChoices = 7;
constexpr std::size_t kJudged = 200;

Csv part(const Csv& all, std::size_t first, std::size_t count) {
  Csv some{all.header, {}};
  for (std::size_t k = first; k < first + count; ++k) some.rows.push_back(all.rows[k]);
  return some;
}

// Observed over stated RMS, of rows that were not used; their noise is the arm's, as nobody states
// a sigma.
double observed_over_stated(const Folder& folder, const Csv& fitted, const Csv& judged) {
  const Outcome outcome = refine(folder, fitted);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  write_joint_poses(judged, folder / "q.csv");
  const Outcome predicted =
      run_tool(folder, "predict --signature s.yaml --joints q.csv --target 1 --sigma --out p.csv");
  EXPECT_EQ(predicted.status, 0) << predicted.err;
  const Csv at = Csv::read(folder / "p.csv");
  double observed = 0;
  double stated = 0;
  for (std::size_t k = 0; k < at.rows.size(); ++k) {
    for (const std::string axis : {"x", "y", "z"}) {
      observed += std::pow(at.number(k, axis + "_m") - 1e-3 * judged.number(k, axis + "_mm"), 2);
    }
    stated += std::pow(at.number(k, "sigma_m"), 2);
  }
  return std::sqrt(observed / stated);
}

// The middle one of several choices of so many rows: a single choice of few may be lucky or not.
double typical(const std::string& arm, const std::string& file, std::size_t count) {
  const Folder folder;
  std::filesystem::copy_file(kShared / "arms" / arm, folder / "arm.yaml");
  const Csv all = Csv::read(kShared / file);
  std::vector<double> ratios;
  for (std::size_t choice = 0; choice < kChoices; ++choice) {
    Csv shuffled = all;
    std::mt19937 random(static_cast<unsigned>(choice));
    for (std::size_t k = shuffled.rows.size(); k-- > 1;) {
      std::swap(shuffled.rows[k], shuffled.rows[random() % (k + 1)]);
    }
    ratios.push_back(
        observed_over_stated(folder, part(shuffled, 0, count), part(shuffled, count, kJudged)));
  }
  std::ranges::sort(ratios);
  return ratios[kChoices / 2];
}

TEST(FewPoses, of_real_arms_are_stated_as_they_are) {
  if (!std::filesystem::exists(kShared)) GTEST_SKIP() << "no measured data";
  for (const std::size_t count : {20U, 40U}) {
    const double ur5 = typical("ur5.yaml", "ur5-laser-tracker/grid.csv", count);
    EXPECT_GT(ur5, 0.8) << count;
    EXPECT_LT(ur5, 1.25) << count;
    const double ur10 = typical("ur10.yaml", "ur10-laser-tracker/poses.csv", count);
    EXPECT_GT(ur10, 0.8) << count;
    EXPECT_LT(ur10, 1.25) << count;
    std::printf("%zu poses, observed over stated: UR5 %.2f, UR10 %.2f\n", count, ur5, ur10);
  }
}

}  // namespace
}  // namespace armsig::cli
