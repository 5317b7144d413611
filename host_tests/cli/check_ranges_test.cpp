// SPDX-License-Identifier: MIT
// `check` of ranges from a sensor that is not as described, and of rows in another unit: the arm is
// not to blame, and it is said what is.
#include <nlohmann/json.hpp>

#include "core/base/pose.hpp"
#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

std::string sensor_with_third_at(double x_mm) {
  return "armsig: sensor/1\nname: five\nreceivers:\n  - {x_mm: -600, y_mm: -700, z_mm: 1900}\n"
         "  - {x_mm: 800, y_mm: -500, z_mm: 2100}\n  - {x_mm: " +
         std::to_string(x_mm) +
         ", y_mm: 900, z_mm: 2000}\n  - {x_mm: 700, y_mm: 600, z_mm: 1800}\n"
         "  - {x_mm: 0, y_mm: 0, z_mm: 2300}\npath: one-way\nrange_sigma_mm: 0.1\n";
}

// The signature s.yaml of a Puma, and held-out poses of it in held.csv.
void identify_puma(const Folder& folder) {
  write_file(folder / "arm.yaml", kPuma560);
  write_file(folder / "sensor.yaml", sensor_with_third_at(-500));
  const std::string simulate =
      "simulate --arm arm.yaml --sensor sensor.yaml --sigma-mm 0.1 --flange-target-mm 80,30,120 ";
  ASSERT_EQ(run_tool(folder, simulate + "--tolerances 1 --points 16 --free-poses 40 --seed 3 "
                                        "--out m.csv --truth-out truth.yaml")
                .status,
            0);
  ASSERT_EQ(run_tool(folder, simulate + "--truth truth.yaml --points 2 --free-poses 20 --seed 4 "
                                        "--out held.csv")
                .status,
            0);
  Csv held = Csv::read(folder / "held.csv");
  std::erase_if(held.rows, [&](const Fields& row) { return row[held.column("sweep")] != "0"; });
  held.write(folder / "held.csv");
  const Outcome outcome = run_tool(folder,
                                   "identify --arm arm.yaml --measurements m.csv --sensor "
                                   "sensor.yaml --out s.yaml --method refined");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

TEST(CheckRanges, names_a_receiver_whose_ranges_are_outliers) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_puma(folder));
  const std::string check = "check --signature s.yaml --measurements held.csv --sensor sensor.yaml";
  const Outcome sound = run_tool(folder, check);
  EXPECT_EQ(sound.status, 0) << sound.out;
  EXPECT_EQ(sound.out.find("receiver"), std::string::npos) << sound.out;
  write_file(folder / "sensor.yaml", sensor_with_third_at(-470));
  const Outcome moved = run_tool(folder, check);
  EXPECT_NE(moved.out.find("  receiver 3: "), std::string::npos) << moved.out;
  EXPECT_NE(moved.out.find(" of its 20 ranges are outliers"), std::string::npos) << moved.out;
  EXPECT_EQ(moved.out.find("Next: nothing"), std::string::npos) << moved.out;
  const auto json = nlohmann::json::parse(run_tool(folder, check + " --json").out);
  ASSERT_EQ(json["receivers_rejected"].size(), 1U);
  EXPECT_EQ(json["receivers_rejected"][0]["receiver"], 3);
}

TEST(CheckRanges, does_not_put_another_unit_down_to_the_sensor) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(identify_puma(folder));
  const Csv held = Csv::read(folder / "held.csv");
  const auto check = [&](const Csv& rows) {
    rows.write(folder / "held.csv");
    return run_tool(folder,
                    "check --signature s.yaml --measurements held.csv --sensor sensor.yaml");
  };
  Csv radians_as_degrees = held;
  for (std::size_t k = 0; k < held.rows.size(); ++k) {
    for (int joint = 1; joint <= 6; ++joint) {
      const std::string name = "q" + std::to_string(joint) + "_deg";
      radians_as_degrees.rows[k][held.column(name)] = std::to_string(radians(held.number(k, name)));
    }
  }
  const Outcome small = check(radians_as_degrees);
  EXPECT_EQ(small.status, 1);
  EXPECT_NE(small.out.find("not in the units and columns that their header says"),
            std::string::npos)
      << small.out << small.err;
  Csv degrees_as_radians = held;
  for (std::string& name : degrees_as_radians.header) {
    if (name.starts_with('q')) name.replace(name.size() - 3, 3, "rad");
  }
  const Outcome large = check(degrees_as_radians);
  EXPECT_EQ(large.status, 2);
  EXPECT_NE(large.err.find("20 of 20 rows are so: the unit (degrees or radians) or the order"),
            std::string::npos)
      << large.err;
}

}  // namespace
}  // namespace armsig::cli
