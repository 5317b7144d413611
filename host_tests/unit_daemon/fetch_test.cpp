// SPDX-License-Identifier: MIT
// armsig connect ... fetch, as an operator uses it after an identification: what the controller
// has, as files of the tool.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host_tests/cli/files.hpp"
#include "host_tests/unit_daemon/virtual_daemon.hpp"

namespace armsig::cli {
namespace {

Outcome fetch(const Folder& folder, const std::string& words) {
  return run_tool(folder, "connect console fetch " + words);
}

void identify(VirtualDaemon& daemon) {
  ASSERT_TRUE(daemon.is_in("idle"));
  ASSERT_EQ(daemon.ask("enable"), "ok");
  ASSERT_TRUE(daemon.is_in("holding"));
  ASSERT_EQ(daemon.ask("identify"), "ok");
  ASSERT_TRUE(daemon.hear("# identify done"));
  ASSERT_TRUE(daemon.is_in("holding"));
}

// The number of `key=` in a reply.
double number_in(const std::string& reply, const std::string& key) {
  const std::size_t at = reply.find(" " + key + "=");
  if (at == std::string::npos) return std::nan("");
  return std::stod(reply.substr(at + key.size() + 2));
}

TEST(Fetch, says_what_there_is_not_yet) {
  const Folder folder;
  const VirtualDaemon daemon(folder);
  for (const auto& [words, what] :
       {std::pair{"s.yaml", "NO_SIGNATURE"}, std::pair{"s.yaml --what candidate", "NO_CANDIDATE"},
        std::pair{"log.csv", "nothing was measured"}}) {
    const Outcome outcome = fetch(folder, words);
    EXPECT_EQ(outcome.status, 1) << words;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("identify first"), std::string::npos) << outcome.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "s.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder / "log.csv"));
}

TEST(Fetch, needs_a_file_to_write) {
  const Folder folder;
  EXPECT_EQ(fetch(folder, "").status, 2);
  EXPECT_EQ(run_tool(folder, "connect console fletch s.yaml").status, 2);
}

// Where the record puts the tool is where the controller says that it is.
void expect_tool_of(VirtualDaemon& daemon, const Folder& folder, const std::string& signature) {
  const std::string status = daemon.ask("status");
  std::string header;
  std::string row;
  for (int i = 1; i <= 6; ++i) {
    const std::string key = "q" + std::to_string(i) + "_deg";
    header += (i == 1 ? "" : ",") + key;
    row += (i == 1 ? "" : ",") + std::to_string(number_in(status, key));
  }
  write_file(folder / "q.csv", header + "\n" + row + "\n");
  const Outcome predicted = run_tool(
      folder, "predict --signature " + signature + " --joints q.csv --target 1 --out p.csv");
  ASSERT_EQ(predicted.status, 0) << predicted.err;
  const Csv poses = Csv::read(folder / "p.csv");
  // The readings of `status` are rounded, to 0.001 degrees at worst: 0.02 mm.
  for (const char* axis : {"x", "y", "z"}) {
    EXPECT_NEAR(1e3 * poses.number(0, std::string(axis) + "_m"),
                number_in(status, std::string(axis) + "_mm"), 0.03)
        << status;
  }
}

// The log is measurements of the tool: identified anew, they give the controller's own signature.
void expect_log_gives(const Folder& folder, const std::string& signature) {
  const Outcome identified = run_tool(
      folder, "identify --arm arm.yaml --measurements log.csv --method encoder --out again.yaml");
  ASSERT_EQ(identified.status, 0) << identified.err;
  write_file(
      folder / "q.csv",
      "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n10,-80,70,20,30,40\n-40,-50,110,0,-40,0\n");
  std::vector<Csv> poses;
  for (const std::string& name : {signature, std::string("again.yaml")}) {
    const Outcome predicted =
        run_tool(folder, "predict --signature " + name + " --joints q.csv --target 1 --out p.csv");
    ASSERT_EQ(predicted.status, 0) << predicted.err;
    poses.push_back(Csv::read(folder / "p.csv"));
  }
  for (std::size_t row = 0; row < 2; ++row) {
    for (const char* key : {"x_m", "y_m", "z_m"}) {
      EXPECT_NEAR(poses[0].number(row, key), poses[1].number(row, key), 1e-4) << key;
    }
  }
}

TEST(Fetch, brings_what_the_controller_identified_and_what_it_measured) {
  const Folder folder;
  VirtualDaemon daemon(folder);
  identify(daemon);
  const Outcome candidate = fetch(folder, "candidate.yaml --what candidate");
  ASSERT_EQ(candidate.status, 0) << candidate.err;
  ASSERT_EQ(fetch(folder, "arm.yaml --what nominal").status, 0);
  const Outcome log = fetch(folder, "log.csv --json");
  ASSERT_EQ(log.status, 0) << log.err;
  EXPECT_NE(log.out.find("\"fetched\": \"log\""), std::string::npos) << log.out;
  expect_log_gives(folder, "candidate.yaml");

  ASSERT_EQ(daemon.ask("accept"), "ok");
  const Outcome fetched = fetch(folder, "signature.yaml --name puma --serial 7");
  ASSERT_EQ(fetched.status, 0) << fetched.err;
  EXPECT_NE(fetched.out.find("Next: armsig report --signature signature.yaml"), std::string::npos);
  expect_tool_of(daemon, folder, "signature.yaml");
  EXPECT_NE(read_file(folder / "signature.yaml").find("name: \"puma\""), std::string::npos);
  EXPECT_EQ(run_tool(folder, "report --signature signature.yaml --out report.html").status, 0);
  EXPECT_EQ(
      run_tool(folder, "export --signature signature.yaml --format urdf --out puma.urdf").status,
      0);
}

// The text of `key=` in a reply.
std::string text_in(const std::string& reply, const std::string& key) {
  const std::size_t at = reply.find(" " + key + "=");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + key.size() + 2;
  return reply.substr(begin, reply.find(' ', begin) - begin);
}

// Metres as a text prints them in mm.
std::string millimetres(double metres, int decimals) {
  return fmt::format("{:.{}f}", 1e3 * metres, decimals);
}

// Fetches what is in use and reports it: both say what the controller says, to the last digit.
void expect_figures_of(VirtualDaemon& daemon, const Folder& folder, const std::string& method,
                       const std::string& region) {
  const std::string told = daemon.ask("signature");
  const std::string predicted_mm = text_in(told, "predicted_tool_error_mm");
  const std::string validation_mm = text_in(told, "validation_rms_mm");
  const Outcome fetched = fetch(folder, "s.yaml --json");
  ASSERT_EQ(fetched.status, 0) << fetched.err;
  const auto json = nlohmann::json::parse(fetched.out);
  EXPECT_EQ(std::to_string(json["signature"].get<int>()), text_in(told, "signature"));
  EXPECT_EQ(json["method"], method);
  EXPECT_EQ(json["predicted_region"], region);
  EXPECT_EQ(text_in(told, "predicted_region"), region);
  EXPECT_EQ(std::to_string(json["validation_poses"].get<int>()), text_in(told, "validation_poses"));
  const double predicted_m = json["predicted_tool_error_m"];
  const double validation_m = json["validation_rms_m"];
  EXPECT_EQ(millimetres(predicted_m, 4), predicted_mm);
  EXPECT_EQ(millimetres(validation_m, 4), validation_mm);
  const Outcome words = fetch(folder, "s.yaml");
  EXPECT_TRUE(words.out.contains(millimetres(predicted_m, 3) + " mm RMS over")) << words.out;
  EXPECT_TRUE(words.out.contains(millimetres(validation_m, 3) + " mm RMS")) << words.out;

  const Outcome reported = run_tool(folder, "report --signature s.yaml --out report.html --json");
  ASSERT_EQ(reported.status, 0) << reported.err;
  const auto judged = nlohmann::json::parse(reported.out)["verdict"];
  const std::string verdict = judged.dump();
  const auto& others = judged["other_figures"];
  const auto stated = std::ranges::find_if(
      others, [](const auto& figure) { return figure["name"] == "Predicted tool error, 1σ"; });
  ASSERT_NE(stated, others.end()) << verdict;
  EXPECT_EQ(millimetres((*stated)["rms_m"].get<double>(), 4), predicted_mm) << verdict;
  EXPECT_TRUE(verdict.contains("At validation poses the tool is " + millimetres(validation_m, 3) +
                               " mm from"))
      << verdict;
  EXPECT_TRUE(verdict.contains("over " + text_in(told, "validation_poses") +
                               " validation poses, which no fit has used"))
      << verdict;
  EXPECT_EQ(verdict.contains("over the joint limits it is not known"), region == "configuration");
  const std::string page = read_file(folder / "report.html");
  EXPECT_TRUE(
      page.contains("the signature puts the target " + millimetres(validation_m, 3) + " mm off"));
  EXPECT_FALSE(page.contains("no positions were held out"));
  EXPECT_EQ(page.contains("Predicted tool error at the signature configuration alone: " +
                          millimetres(predicted_m, 3) + " mm"),
            region == "configuration");
}

TEST(Fetch, and_report_tell_one_accuracy) {
  const Folder folder;
  VirtualDaemon daemon(folder, "0", {"--maps-deg", "0.02", "--deflection-mm", "0.5"});
  identify(daemon);
  ASSERT_EQ(daemon.ask("accept"), "ok");
  expect_figures_of(daemon, folder, "encoder", "configuration");
  ASSERT_EQ(daemon.ask("identify accuracy_mm=0.5 minutes=60"), "ok");
  ASSERT_TRUE(daemon.hear("# identify done"));
  ASSERT_TRUE(daemon.is_in("holding"));
  expect_figures_of(daemon, folder, "encoder", "configuration");
  ASSERT_EQ(daemon.ask("accept"), "ok");
  expect_figures_of(daemon, folder, "refined", "limits");
  ASSERT_EQ(daemon.ask("rollback"), "ok");
  expect_figures_of(daemon, folder, "encoder", "configuration");
}

}  // namespace
}  // namespace armsig::cli
