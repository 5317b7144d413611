// SPDX-License-Identifier: MIT
// A signature knows the measurements that it was found from: no certificate is of others, and no
// row that was fitted checks the fit.
#include <algorithm>

#include <nlohmann/json.hpp>

#include "host_tests/cli/identified_arm.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;

Outcome report(const Folder& folder, const std::string& options) {
  return run_tool(folder, "report --signature s.yaml --out r.html " + options);
}

json report_data(const Folder& folder) {
  const std::string page = read_file(folder / "r.html");
  const std::size_t begin = page.find("id=\"report\">") + 12;
  return json::parse(page.substr(begin, page.find("</script>", begin) - begin), nullptr, false);
}

// In metres, turned round, without sigma and with other numbers of the targets.
Csv in_other_words(Csv rows) {
  for (std::string& name : rows.header) {
    if (name == "x_mm" || name == "y_mm" || name == "z_mm") name.replace(1, 3, "_m");
  }
  for (Fields& row : rows.rows) {
    for (const char* axis : {"x_m", "y_m", "z_m"}) {
      std::string& field = row[rows.column(axis)];
      field += "e-3";
    }
  }
  std::ranges::reverse(rows.rows);
  return rows;
}

constexpr const char* kSigned = "--operator Smith --instrument AT402 ";

TEST(Origin, is_kept_with_the_signature) {
  const Folder folder;
  identified(folder);
  const std::string text = read_file(folder / "s.yaml");
  for (const char* part :
       {"origin:\n", "  arm: \"arm.yaml\"\n", "  measurements: \"m.csv\"\n",
        "  options: \"--method refined\"\n", "  rows_crc32: 0x", "  fitted: [0x"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
}

TEST(Report, certifies_the_rows_that_were_fitted_however_they_are_written) {
  const Folder folder;
  identified(folder);
  in_other_words(Csv::read(folder / "m.csv")).write(folder / "again.csv");
  for (const char* file : {"m.csv", "again.csv"}) {
    const Outcome outcome =
        report(folder, kSigned + ("--json --measurements " + std::string(file)));
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(json::parse(outcome.out)["certified"], true) << file;
    EXPECT_FALSE(report_data(folder)["certificate"].is_null());
    EXPECT_EQ(report_data(folder)["about"]["other_measurements"], "");
  }
}

TEST(Report, certifies_no_other_measurements_and_says_what_they_are) {
  const Folder folder;
  identified(folder);
  const Outcome refused = report(folder, kSigned + std::string("--measurements held.csv"));
  EXPECT_EQ(refused.status, 1);
  EXPECT_NE(refused.err.find("held.csv holds other measurements than m.csv"), std::string::npos)
      << refused.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "r.html"));
  // A later measurement is shown, and nothing is there to sign.
  const Outcome later = report(folder, "--json --measurements held.csv");
  ASSERT_EQ(later.status, 0) << later.err;
  EXPECT_EQ(json::parse(later.out)["certified"], false);
  EXPECT_NE(later.err.find("it was fitted to 0 of the 30 rows"), std::string::npos) << later.err;
  EXPECT_TRUE(report_data(folder)["certificate"].is_null());
  // One row less, or one that is another, is another set.
  Csv less = Csv::read(folder / "m.csv");
  const std::size_t rows = less.rows.size();
  less.rows.pop_back();
  less.write(folder / "less.csv");
  const Outcome part = report(folder, "--measurements less.csv");
  EXPECT_EQ(part.status, 0);
  const std::string all = std::to_string(rows - 1);
  EXPECT_NE(part.err.find("fitted to " + all + " of the " + all + " rows"), std::string::npos)
      << part.err;
  EXPECT_EQ(report(folder, kSigned + std::string("--measurements less.csv")).status, 1);
}

TEST(Report, certifies_nothing_where_the_origin_is_not_stated) {
  const Folder folder;
  identified(folder);
  const Outcome outcome =
      run_tool(folder, "report --signature truth.yaml --measurements m.csv --json --out r.html");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(json::parse(outcome.out)["certified"], false);
  EXPECT_NE(outcome.err.find("does not say which measurements it was found from"),
            std::string::npos)
      << outcome.err;
}

TEST(Report, certifies_ranges_by_the_sensor_description_of_then_alone) {
  const Folder folder;
  ASSERT_EQ(run_tool(folder, "demo --out demo").status, 0);
  ASSERT_EQ(run_tool(folder,
                     "identify --arm demo/puma560.yaml --measurements demo/robot1-measurements.csv "
                     "--sensor demo/sensor.yaml --out s.yaml")
                .status,
            0);
  const std::string rows = "--json --measurements demo/robot1-measurements.csv --sensor ";
  std::string sensor = read_file(folder / "demo/sensor.yaml");
  write_file(folder / "same.yaml", "# with a comment\n" + sensor);
  const std::size_t at = sensor.find("range_sigma_m: ");
  ASSERT_NE(at, std::string::npos);
  write_file(folder / "other.yaml", sensor.insert(at + 15, "1"));
  EXPECT_EQ(json::parse(report(folder, rows + "same.yaml").out)["certified"], true);
  const Outcome other = report(folder, rows + "other.yaml");
  EXPECT_EQ(json::parse(other.out)["certified"], false);
  EXPECT_NE(other.err.find("by another sensor description"), std::string::npos) << other.err;
}

TEST(Check, is_none_by_the_rows_that_were_fitted) {
  const Folder folder;
  identified(folder);
  in_other_words(Csv::read(folder / "m.csv")).write(folder / "again.csv");
  for (const char* file : {"m.csv", "again.csv"}) {
    const Outcome outcome =
        run_tool(folder, "check --signature s.yaml --measurements " + std::string(file));
    EXPECT_EQ(outcome.status, 1) << outcome.out;
    EXPECT_NE(outcome.err.find("are among those that the signature was fitted to, and no check"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(outcome.out.find("consistent"), std::string::npos) << outcome.out;
  }
}

TEST(Check, leaves_out_the_rows_that_were_fitted_and_says_how_many) {
  const Folder folder;
  Csv held = identified(folder);
  const json alone =
      json::parse(run_tool(folder, "check --signature s.yaml --measurements held.csv --json").out);
  EXPECT_EQ(alone["rows_fitted"], 0);
  const Csv fitted = Csv::read(folder / "m.csv");
  ASSERT_EQ(fitted.header, held.header);
  held.rows.insert(held.rows.end(), fitted.rows.begin(), fitted.rows.begin() + 7);
  held.write(folder / "both.csv");
  const std::string check = "check --signature s.yaml --measurements both.csv ";
  const json both = json::parse(run_tool(folder, check + "--json").out);
  EXPECT_EQ(both["rows_fitted"], 7);
  for (const char* figure : {"verdict", "rows", "chi_square", "rms_m"}) {
    EXPECT_EQ(both[figure], alone[figure]) << figure;
  }
  EXPECT_NE(run_tool(folder, check).out.find("7 more rows had a part in the signature"),
            std::string::npos);
}

// Poses beside the sweeps have no part in what the features give.
TEST(Check, takes_the_poses_that_the_method_did_not_use) {
  const Folder folder;
  identified(folder, "encoder");
  const json result =
      json::parse(run_tool(folder, "check --signature s.yaml --measurements m.csv --json").out);
  EXPECT_EQ(result["verdict"], "consistent");
  EXPECT_EQ(result["rows"], 20);
  EXPECT_EQ(result["rows_fitted"], 120);
}

}  // namespace
}  // namespace armsig::cli
