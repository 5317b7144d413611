// SPDX-License-Identifier: MIT
// Files as Windows programs, old editors and mishaps leave them: UTF-16 without a mark, carriage
// returns alone at line ends, nothing but comments.
#include <algorithm>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

std::string in_utf16(const std::string& text, bool little_endian) {
  std::string bytes;
  for (const char c : text) {
    if (!little_endian) bytes += '\0';
    bytes += c;
    if (little_endian) bytes += '\0';
  }
  return bytes;
}

std::string with_returns(std::string text) {
  std::ranges::replace(text, '\n', '\r');
  return text;
}

Outcome identify(const Folder& folder, const std::string& measurements,
                 const std::string& arm = "arm.yaml", const std::string& more = "") {
  std::filesystem::remove(folder / "s.yaml");
  return run_tool(folder, "identify --arm " + arm + " --measurements " + measurements +
                              " --out s.yaml " + more);
}

void expect_refused(const Outcome& outcome, const std::string& words) {
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
}

TEST(Encodings, utf_16_without_a_mark_is_read) {
  const Folder folder;
  ASSERT_EQ(measure_two_joints(folder).status, 0);
  ASSERT_EQ(identify(folder, "m.csv").status, 0);
  for (const bool little_endian : {true, false}) {
    write_file(folder / "wide.csv", in_utf16(read_file(folder / "m.csv"), little_endian));
    const Outcome plain = identify(folder, "wide.csv");
    EXPECT_EQ(plain.status, 0) << plain.err;
    const Outcome mapped = identify(folder, "wide.csv", "arm.yaml", "--columns auto");
    EXPECT_EQ(mapped.status, 0) << mapped.err;
  }
}

TEST(Encodings, a_description_in_utf_16_is_refused_with_the_cure) {
  const Folder folder;
  ASSERT_EQ(measure_two_joints(folder).status, 0);
  write_file(folder / "wide.yaml", in_utf16(kTwoJointArm, true));
  expect_refused(identify(folder, "m.csv", "wide.yaml"),
                 "wide.yaml: text in UTF-16; expected UTF-8: save it so");
}

TEST(Encodings, carriage_returns_alone_end_lines) {
  const Folder folder;
  ASSERT_EQ(measure_two_joints(folder).status, 0);
  const std::string rows = read_file(folder / "m.csv");
  write_file(folder / "old.csv", "# an old editor\r" + with_returns(rows));
  write_file(folder / "old.yaml", "# an old editor\r" + with_returns(kTwoJointArm));
  const Outcome outcome = identify(folder, "old.csv", "old.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  // Lines are counted as the editor counts them.
  write_file(folder / "broken.csv", with_returns("sweep,target,q1_deg,q2_deg,x_mm,y_mm,z_mm\n"
                                                 "1,1,0,0,1,2,3\n1,1,1O,0,1,2,3\n"));
  expect_refused(identify(folder, "broken.csv"), "broken.csv:3:5: q1_deg: \"1O\" is not a number");
  write_file(folder / "joints.csv", with_returns("Name;A1 [deg];A2 [deg]\nP1;10;20\nP2;30;40\n"));
  write_file(folder / "points.txt", with_returns("P1 1 2 3\nP2 4 5 6\n"));
  const Outcome joined = run_tool(folder,
                                  "join --arm arm.yaml --joints joints.csv --points points.txt "
                                  "--units mm --out joined.csv");
  EXPECT_EQ(joined.status, 0) << joined.err;
  EXPECT_EQ(Csv::read(folder / "joined.csv").rows.size(), 2U);
}

TEST(Encodings, a_file_of_comments_is_called_so) {
  const Folder folder;
  ASSERT_EQ(measure_two_joints(folder).status, 0);
  write_file(folder / "comments.csv", "# nothing yet\n\n# but it will come\n");
  write_file(folder / "comments.yaml", "# nothing yet\n");
  write_file(folder / "blank.csv", "\n\n");
  write_file(folder / "empty.csv", "");
  expect_refused(identify(folder, "comments.csv"), "comments.csv: the file holds only comments");
  expect_refused(identify(folder, "comments.csv", "arm.yaml", "--columns auto"),
                 "comments.csv: the file holds only comments");
  expect_refused(identify(folder, "blank.csv"), "blank.csv: the file holds only blank lines");
  expect_refused(identify(folder, "empty.csv"), "empty.csv: the file is empty");
  expect_refused(identify(folder, "m.csv", "comments.yaml"),
                 "comments.yaml: the file holds only comments");
  expect_refused(run_tool(folder, "import --dh comments.csv --out a.yaml"),
                 "comments.csv: the file holds only comments");
}

}  // namespace
}  // namespace armsig::cli
