// SPDX-License-Identifier: MIT
// armsig connect ... send, as an engineer uses it who found a signature at a desk.
#include <string>

#include <gtest/gtest.h>

#include "host_tests/cli/files.hpp"
#include "host_tests/unit_daemon/virtual_daemon.hpp"

namespace armsig::cli {
namespace {

Outcome send(const Folder& folder, const std::string& words) {
  return run_tool(folder, "connect console send " + words);
}

// The parameters of the signature in use.
std::string parameters(VirtualDaemon& daemon) {
  const std::string reply = daemon.ask("signature");
  const std::size_t at = reply.find(" theta1_deg=");
  return at == std::string::npos ? reply : reply.substr(at);
}

TEST(Send, brings_back_what_was_fetched_to_beat_the_drawing_and_be_accepted) {
  const Folder folder;
  VirtualDaemon daemon(folder);
  ASSERT_TRUE(daemon.is_in("idle"));
  ASSERT_EQ(daemon.ask("enable"), "ok");
  ASSERT_TRUE(daemon.is_in("holding"));
  ASSERT_EQ(daemon.ask("identify"), "ok");
  ASSERT_TRUE(daemon.hear("# identify done"));
  ASSERT_TRUE(daemon.is_in("holding"));
  ASSERT_EQ(daemon.ask("accept"), "ok");
  const std::string before = parameters(daemon);
  ASSERT_EQ(run_tool(folder, "connect console fetch signature.yaml").status, 0);
  ASSERT_EQ(daemon.ask("rollback"), "ok");
  ASSERT_EQ(parameters(daemon), "ok model=nominal");

  const Outcome outcome = send(folder, "signature.yaml");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("Next: armsig connect console compare --wait"), std::string::npos);
  ASSERT_EQ(daemon.ask("compare"), "ok");
  ASSERT_TRUE(daemon.hear("# identify done"));
  ASSERT_TRUE(daemon.is_in("holding"));
  ASSERT_EQ(daemon.ask("accept"), "ok");
  EXPECT_EQ(parameters(daemon), before);
}

TEST(Send, refuses_the_signature_of_another_arm_and_a_file_that_is_none) {
  const Folder folder;
  const VirtualDaemon daemon(folder);
  ASSERT_EQ(
      run_tool(folder, "simulate --arm ur10e --tolerances 1 --sigma-mm 0.1 --out m.csv").status, 0);
  const Outcome identified = run_tool(
      folder, "identify --arm ur10e --measurements m.csv --method encoder --out other.yaml");
  ASSERT_EQ(identified.status, 0) << identified.err;
  Outcome outcome = send(folder, "other.yaml");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("of its nominal model is"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("fetch --what nominal"), std::string::npos) << outcome.err;
  outcome = send(folder, "other.yaml --json");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.out.find("\"error\""), std::string::npos) << outcome.out;
  EXPECT_EQ(send(folder, "none.yaml").status, 2);
  EXPECT_EQ(send(folder, "").status, 2);
  EXPECT_EQ(run_tool(folder, "connect nowhere send other.yaml").status, 2);
}

}  // namespace
}  // namespace armsig::cli
