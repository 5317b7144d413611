// SPDX-License-Identifier: MIT
// `identify` of ranges that give hardly any position: the sensor description is not that of the
// sensor, and the refusal says so instead of missing the sweeps.
#include <functional>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

const Fields kReceivers{
    "{x_mm: -600, y_mm: -700, z_mm: 1500}", "{x_mm: 800, y_mm: -500, z_mm: 1700}",
    "{x_mm: -500, y_mm: 900, z_mm: 1600}", "{x_mm: 700, y_mm: 600, z_mm: 1300}"};

void write_sensor(const Folder& folder, const Fields& receivers, const std::string& more = "") {
  std::string text = "armsig: sensor/1\nname: four\nreceivers:\n";
  for (const std::string& receiver : receivers) text += "  - " + receiver + "\n";
  write_file(folder / "sensor.yaml", text + "path: one-way\nrange_sigma_mm: 0.1\n" + more);
}

// Ranges to the four receivers in m.csv, all of which agree with sensor.yaml.
void measure(const Folder& folder) {
  write_file(folder / "arm.yaml", kTwoJointArm);
  write_sensor(folder, kReceivers);
  const Outcome outcome = run_tool(folder,
                                   "simulate --arm arm.yaml --sensor sensor.yaml --sigma-mm 0.1 "
                                   "--points 24 --seed 4 --out m.csv");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

void expect_said(const Folder& folder, const std::string& what, const std::string& expected) {
  for (const std::string method : {"encoder", "refined"}) {
    const Outcome outcome =
        run_tool(folder,
                 "identify --arm arm.yaml --measurements m.csv --sensor sensor.yaml --out s.yaml "
                 "--method " +
                     method);
    EXPECT_EQ(outcome.status, 1) << method;
    EXPECT_NE(outcome.err.find("rows with ranges give no position: "), std::string::npos)
        << outcome.err;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("; expected " + expected), std::string::npos) << outcome.err;
  }
}

void change_ranges(const Folder& folder, const std::function<std::string(double, int)>& changed) {
  Csv rows = Csv::read(folder / "m.csv");
  for (std::size_t k = 0; k < rows.rows.size(); ++k) {
    for (int receiver = 1; receiver <= 4; ++receiver) {
      const std::string name = "r" + std::to_string(receiver) + "_mm";
      const double range = rows.number(k, name);
      rows.rows[k][rows.column(name)] = changed(range, receiver);
    }
  }
  rows.write(folder / "m.csv");
}

TEST(RangeSlips, none_is_seen_where_there_is_none) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(measure(folder));
  const Outcome outcome = run_tool(
      folder, "identify --arm arm.yaml --measurements m.csv --sensor sensor.yaml --out s.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(RangeSlips, receivers_that_are_swapped_are_named) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(measure(folder));
  write_sensor(folder, {kReceivers[0], kReceivers[2], kReceivers[1], kReceivers[3]});
  expect_said(folder, "the ranges do not meet in a point; with receivers 2 and 3 swapped",
              "the receivers in the order of the columns r1, r2, ...");
}

TEST(RangeSlips, ranges_out_and_back_and_in_metres_are_named) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(measure(folder));
  change_ranges(folder, [](double range, int) { return std::to_string(2 * range); });
  expect_said(folder, "with half the ranges", "ranges and receivers in the units of their names");
  change_ranges(folder, [](double range, int) { return std::to_string(range / 2000); });
  expect_said(folder, "with a thousand times the ranges",
              "ranges and receivers in the units of their names");
}

TEST(RangeSlips, receivers_in_metres_under_the_name_of_millimetres_are_named) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(measure(folder));
  write_sensor(folder,
               {kReceivers[0], "{x_mm: 0.8, y_mm: -0.5, z_mm: 1.7}", kReceivers[2], kReceivers[3]});
  expect_said(folder, "with a thousand times the place of receiver 2",
              "the place of every receiver in the unit of its name");
  write_sensor(folder, {"{x_mm: -0.6, y_mm: -0.7, z_mm: 1.5}", "{x_mm: 0.8, y_mm: -0.5, z_mm: 1.7}",
                        "{x_mm: -0.5, y_mm: 0.9, z_mm: 1.6}", "{x_mm: 0.7, y_mm: 0.6, z_mm: 1.3}"});
  expect_said(folder, "with a thousandth the ranges",
              "ranges and receivers in the units of their names");
}

TEST(RangeSlips, a_receiver_elsewhere_is_told_by_what_to_look_at) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(measure(folder));
  write_sensor(
      folder, {kReceivers[0], "{x_mm: 830, y_mm: -500, z_mm: 1700}", kReceivers[2], kReceivers[3]});
  expect_said(folder, "the ranges do not meet in a point",
              "where the receivers stand, in the order of the columns r1, r2, ...");
}

TEST(RangeSlips, a_receiver_that_never_hears_is_named) {
  const Folder folder;
  ASSERT_NO_FATAL_FAILURE(measure(folder));
  change_ranges(folder, [](double range, int receiver) {
    return receiver == 3 ? std::string() : std::to_string(range);
  });
  expect_said(folder, "receiver 3 was never heard", "a `facing` direction");
}

}  // namespace
}  // namespace armsig::cli
