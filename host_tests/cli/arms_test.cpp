// SPDX-License-Identifier: MIT
// `--arm NAME`: drawings that come with the command.
#include <regex>
#include <sstream>
#include <vector>

#include "host_tests/cli/run_tool.hpp"

namespace armsig::cli {
namespace {

std::vector<std::string> listed_names(const Folder& folder) {
  const Outcome listed = run_tool(folder, "arms");
  EXPECT_EQ(listed.status, 0) << listed.err;
  std::istringstream lines(listed.out);
  std::vector<std::string> names;
  for (std::string line; std::getline(lines, line) && !line.empty();) {
    if (line.starts_with("  --arm")) continue;
    names.push_back(line.substr(2, line.find(' ', 2) - 2));
  }
  return names;
}

const std::regex kNoNumber("[^a-z](nan|inf)[^a-z]");

TEST(KnownArms, every_arm_that_is_listed_has_a_source_and_can_be_simulated_and_identified) {
  const Folder folder;
  const std::vector<std::string> names = listed_names(folder);
  EXPECT_GE(names.size(), 20U);
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    const Outcome shown = run_tool(folder, "arms --show " + name);
    ASSERT_EQ(shown.status, 0) << shown.err;
    EXPECT_TRUE(shown.out.starts_with("# ")) << "no source";
    for (const std::string& command :
         {"simulate --arc 60 --points 12 --sigma-mm 0.02 --tolerances 1 --out m.csv --truth-out "
          "t.yaml --arm " +
              name,
          "identify --measurements m.csv --out s.yaml --arm " + name,
          "evaluate --signature s.yaml --truth t.yaml --arm " + name}) {
      const Outcome outcome = run_tool(folder, command);
      EXPECT_EQ(outcome.status, 0) << command << outcome.err;
      EXPECT_FALSE(std::regex_search(outcome.out, kNoNumber)) << command << outcome.out;
    }
    EXPECT_FALSE(std::regex_search(read_file(folder / "s.yaml"), kNoNumber));
  }
}

TEST(KnownArms, a_name_is_taken_in_capitals_too) {
  const Folder folder;
  EXPECT_EQ(run_tool(folder,
                     "simulate --arm UR10e --arc 60 --points 12 --sigma-mm 0 --seed 1"
                     " --out m.csv --truth-out t.yaml")
                .status,
            0);
}

TEST(KnownArms, is_shown_by_a_name_in_capitals_and_a_slip_names_the_nearest) {
  const Folder folder;
  const Outcome shown = run_tool(folder, "arms --show UR10E");
  EXPECT_EQ(shown.status, 0) << shown.err;
  EXPECT_EQ(shown.out, run_tool(folder, "arms --show ur10e").out);
  for (const std::string slip : {"UR-10E", "Ur10ee", "ur10 e"}) {
    const Outcome near = run_tool(folder, "arms --show '" + slip + "'");
    EXPECT_EQ(near.status, 2);
    EXPECT_NE(near.err.find(slip + ": no known arm; expected ur10e, or another"), std::string::npos)
        << near.err;
  }
}

TEST(KnownArms, a_name_that_is_not_known_is_refused_with_the_nearest_one) {
  const Folder folder;
  const Outcome slip = run_tool(folder, "identify --measurements m.csv --out s.yaml --arm ur10w");
  EXPECT_EQ(slip.status, 2);
  EXPECT_NE(slip.err.find("ur10w: neither a file nor a known arm; expected ur10"),
            std::string::npos)
      << slip.err;
  const Outcome far = run_tool(folder, "identify --measurements m.csv --out s.yaml --arm gantry99");
  EXPECT_EQ(far.status, 2);
  EXPECT_NE(far.err.find("a name that `armsig arms` lists"), std::string::npos) << far.err;
}

}  // namespace
}  // namespace armsig::cli
