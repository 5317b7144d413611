// SPDX-License-Identifier: MIT
// Names that mean something to the readers of our exports, through every exporter into Python's
// compiler, expat, a YAML and a JSON parser: the name comes back, and nothing else does.
#include <string>
#include <vector>

#include "core/identification.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/host_tool/signature/record.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/cli/run_tool.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::tool {
namespace {

const std::vector<std::string> kLegalNames{
    "Puma 560",
    "say \"hello\"",
    "it's",
    R"(back\slash \n \r \x0d \u000a \)",
    "\"\"\" + __import__('os') + \"\"\"",
    "{} {0} {name} ${HOME} $(reboot) `reboot`",
    "100 % %s %n %1$s",
    "/* */ // <!-- --> ]]> <![CDATA[",
    "</script><script>alert(1)</script>&amp;&#13;",
    "# : - ? ! & * | > @ , [ ] { }",
    "key: value",
    "--out",
    "- item",
    "---",
    "...",
    "%YAML 1.2",
    "null",
    "~",
    "1.5",
    "!!python/object:os.system",
    " a blank before and after ",
    "x,=cmd|' /C calc'!A0",
    "coding: utf-7 +AAo-import os",
    "vim: set fenc=utf-7 : coding=utf-7",
    "[SECTION]VAR loadusr -w reboot \\",
    "Größe 机械臂 ロボット",
    "ذراع آلية עברית",
    "🦾 emoji 👩‍🚀",
    std::string(kLongestName, 'a'),
};

// What no reader of ours lets in, put into the record by hand.
const std::vector<std::string> kIllegalNames{
    "a\rimport os",
    "a\nimport os",
    "a\x0Cimport os",
    "a\xC2\x85import os",
    "a\xE2\x80\xA8loadusr",
    "\x1B]0;x\x07",
    "\xE2\x80\xAE"
    "abc",
    "bytes \x80\xFF",
    "\xEF\xBB\xBF"
    "x",
    "a\x7F",
    std::string("a\0b", 3),
};

SignatureRecord named(const std::string& name) {
  const auto ur5e = read_arm("ur5e");  // which every format holds
  EXPECT_TRUE(ur5e);
  const ArmDescription arm{.name = name, .arm = ur5e->arm};
  const JointVector q{0.1, -0.6, 0.7, 0.2, 0.5, 0.3};
  SignatureRecord record = exact_record(signature_of(arm.arm, q, Pose{}, {}), arm);
  record.serial = name;
  return record;
}

// Every export of every name, for one run of the reader: N.name, N.urdf, N.rtb, ...
void write_exports(const cli::Folder& folder, const std::vector<std::string>& names) {
  for (std::size_t k = 0; k < names.size(); ++k) {
    cli::write_file(folder / (std::to_string(k) + ".name"), names[k]);
    for (const std::string& format : export_formats()) {
      if (format == "maps-csv") continue;  // of an arm with maps only
      const auto text = export_text(format, named(names[k]));
      ASSERT_TRUE(text) << format << ": " << render(text.error());
      cli::write_file(folder / (std::to_string(k) + "." + format), text->text);
    }
  }
}

void expect_read(const cli::Folder& folder, const std::string& legal) {
  const std::string command = "cd '" + folder.path().string() +
                              "' && /usr/bin/python3 '" ARMSIG_READ_NAMES "' " + legal +
                              " >.read 2>&1";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  EXPECT_EQ(status, 0) << cli::read_file(folder / ".read");
}

TEST(HostileNames, come_back_from_every_export_as_they_were) {
  const cli::Folder folder;
  write_exports(folder, kLegalNames);
  expect_read(folder, "legal");
}

TEST(HostileNames, that_no_reader_lets_in_are_escaped_once_more) {
  const cli::Folder folder;
  write_exports(folder, kIllegalNames);
  expect_read(folder, "illegal");
}

TEST(HostileNames, come_back_from_an_arm_description_or_are_refused_at_their_place) {
  for (const std::string& name : kLegalNames) {
    const auto arm = parse_arm(arm_text({.name = name, .arm = puma560()}), "A");
    ASSERT_TRUE(arm) << render(arm.error());
    EXPECT_EQ(arm->name, name);
  }
  for (const std::string& name : kIllegalNames) {
    if (name.starts_with("bytes")) continue;  // become U+FFFD: YAML holds characters only
    const auto arm = parse_arm(arm_text({.name = name, .arm = puma560()}), "A");
    ASSERT_FALSE(arm) << shown(name);
    EXPECT_EQ(test::failure_of(arm).line, 2) << shown(name);
    EXPECT_NE(test::failure_of(arm).what.find("the character"), std::string::npos) << shown(name);
  }
}

}  // namespace
}  // namespace armsig::tool
