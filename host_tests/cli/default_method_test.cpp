// SPDX-License-Identifier: MIT
// Without --method `identify` takes the best that the rows support, and says which and why.
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

void simulate(const Folder& folder, const std::string& options) {
  const Outcome outcome =
      run_tool(folder,
               "simulate --arm puma560 --tolerances 1 --sigma-mm 0.2 --arc 180 --seed 3 "
               "--flange-target-mm 80,30,120 --out m.csv --truth-out truth.yaml " +
                   options);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

constexpr const char* kIdentify = "identify --arm puma560 --measurements m.csv --out s.yaml ";

json found_by(const Folder& folder, const std::string& options) {
  const Outcome outcome = run_tool(folder, kIdentify + options + " --json");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome.status == 0 ? json::parse(outcome.out) : json();
}

double tool_error_m(const Folder& folder) {
  return rms_distance(predict(folder, "s.yaml", "1"), predict(folder, "truth.yaml", "1"));
}

TEST(DefaultMethod, uses_free_poses_and_says_so) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(simulate(folder, "--points 25 --free-poses 30"));
  write_joint_poses(Csv::read(folder / "m.csv"), folder / "q.csv");
  const json best = found_by(folder, "");
  EXPECT_EQ(best["method"], "refined");
  EXPECT_EQ(best["why_method"], "which uses the 30 free poses (sweep 0) too");
  const double by_default_m = tool_error_m(folder);
  EXPECT_EQ(found_by(folder, "--method encoder")["why_method"], "");
  EXPECT_LT(3 * by_default_m, tool_error_m(folder));
  const std::string text = run_tool(folder, kIdentify).out;
  EXPECT_NE(text.find("the refined method, which uses the 30 free poses (sweep 0) too"),
            std::string::npos)
      << text;
}

TEST(DefaultMethod, goes_by_features_where_there_are_sweeps_alone) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(simulate(folder, "--points 25"));
  const json best = found_by(folder, "");
  EXPECT_EQ(best["method"], "encoder");
  EXPECT_EQ(best["why_method"], "as there are no free poses (sweep 0)");
  EXPECT_EQ(found_by(folder, "--correct gain")["method"], "refined");
}

// A free pose in which the target was not seen says nothing.
TEST(DefaultMethod, does_not_count_poses_that_were_not_seen) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(simulate(folder, "--points 25 --free-poses 3"));
  Csv rows = Csv::read(folder / "m.csv");
  for (Fields& row : rows.rows) {
    if (row[rows.column("sweep")] != "0") continue;
    for (const char* axis : {"x_mm", "y_mm", "z_mm"}) row[rows.column(axis)].clear();
  }
  rows.write(folder / "m.csv");
  EXPECT_EQ(found_by(folder, "")["method"], "encoder");
}

TEST(DefaultMethod, keeps_to_features_where_free_poses_cannot_be_known) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(simulate(folder, "--points 25 --free-poses 30"));
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  // It waits until somebody reads. NOLINTNEXTLINE(cert-env33-c): our own command line
  ASSERT_EQ(std::system(("cd '" + folder.path().string() + "' && cat m.csv >pipe &").c_str()), 0);
  const Outcome outcome =
      run_tool(folder, "identify --arm puma560 --measurements pipe --out s.yaml --json");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const json result = json::parse(outcome.out);
  EXPECT_EQ(result["method"], "encoder");
  EXPECT_NE(result["why_method"].get<std::string>().find("a pipe"), std::string::npos);
}

// The free poses are the last rows of the file.
TEST(DefaultMethod, sees_the_free_poses_of_a_file_of_any_length) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(simulate(folder, "--points 3400 --free-poses 30"));
  const json many = found_by(folder, "");
  EXPECT_EQ(many["method"], "refined");
  EXPECT_EQ(many["why_method"], "which uses the free poses (sweep 0) too");
}

}  // namespace
}  // namespace armsig::cli
