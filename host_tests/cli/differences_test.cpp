// SPDX-License-Identifier: MIT
// The table of what is different about an arm, where a user meets it.
#include <cmath>

#include <nlohmann/json.hpp>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {
namespace {

using Json = nlohmann::json;

// The Puma with one row changed, identified from its sweeps and poses.
Outcome identified(const Folder& folder, const std::string& from, const std::string& to,
                   const std::string& options) {
  write_file(folder / "arm.yaml", kPuma560);
  std::string built = kPuma560;
  const std::size_t at = built.find(from);
  EXPECT_NE(at, std::string::npos);
  built.replace(at, from.size(), to);
  write_file(folder / "built.yaml", built);
  EXPECT_EQ(run_tool(folder,
                     "simulate --arm arm.yaml --truth built.yaml --sigma-mm 0.05 "
                     "--hand-target-mm 80,30,120 --arc 150 --points 30 --mixed-poses 30 "
                     "--seed 2 --out m.csv")
                .status,
            0);
  const Outcome outcome =
      run_tool(folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml " + options);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  return outcome;
}

TEST(DifferenceTable, says_which_joint_differs_and_what_that_does) {
  for (const std::string method : {"--method encoder", "--method refined"}) {
    SCOPED_TRACE(method);
    const Folder folder;
    // The elbow 1 mm further out.
    const Json json =
        Json::parse(identified(folder, "a_mm: 431.8", "a_mm: 432.8", method + " --json").out);
    const Json& differences = json["differences"];
    double sum = 0;
    bool found = false;
    for (const Json& line : differences["joints"]) {
      sum += line["adds_m"].get<double>();
      const bool planted = line["joint"] == 3 && line["what"] == "shift away from axis 2";
      found = found || planted;
      const char* value = line.contains("value_m") ? "value_m" : "value_rad";
      const char* sigma = line.contains("value_m") ? "sigma_m" : "sigma_rad";
      EXPECT_NEAR(line[value].get<double>(), planted ? 1e-3 : 0.0, 4 * line[sigma].get<double>())
          << line;
      EXPECT_GT(line["effect_rms_m"].get<double>(), 0);
    }
    EXPECT_TRUE(found);
    const double total_m = differences["total_rms_m"].get<double>();
    EXPECT_NEAR(sum, total_m, 1e-3 * total_m);
    EXPECT_NEAR(total_m, 0.9e-3, 0.2e-3);
  }
}

TEST(DifferenceTable, is_printed_for_a_person) {
  const Folder folder;
  const Outcome outcome =
      identified(folder, "theta_deg: 0, d_mm: 430.7", "theta_deg: 0.3, d_mm: 430.7", "");
  EXPECT_NE(outcome.out.find("What is different from the drawing"), std::string::npos);
  EXPECT_NE(outcome.out.find("tilt about the link from axis 2 to 3"), std::string::npos);
  EXPECT_NE(outcome.out.find("+0.30"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("joint 1 is"), std::string::npos);
}

TEST(DifferenceTable, holds_the_errors_of_the_readings_that_were_found) {
  const Folder folder;
  const Json json = Json::parse(
      identified(folder, "a_mm: 431.8", "a_mm: 432.0", "--method refined --correct gain --json")
          .out);
  int scales = 0;
  for (const Json& line : json["differences"]["joints"]) {
    if (line["kind"] != "scale") continue;
    ++scales;
    EXPECT_NEAR(line["value"].get<double>(), 0, 4 * line["sigma"].get<double>());
  }
  EXPECT_EQ(scales, 6);
}

}  // namespace
}  // namespace armsig::cli
