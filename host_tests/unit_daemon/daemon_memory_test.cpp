// SPDX-License-Identifier: MIT
// Memory that runs out at any allocation of armsigd, from its first signal handler to its end by
// SIGTERM: it says so in words and ends by itself, or it does not matter; and the next one starts.
#include <algorithm>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/cli/run_tool.hpp"

#if !defined(__SANITIZE_ADDRESS__)

namespace armsig::cli {
namespace {

// armsigd about an emulated arm, whose allocation `failing` fails (0: none), until it serves or is
// gone; then it is told to end.
Outcome run_daemon(const Folder& folder, long failing) {
  write_file(folder / "run",
             "cd '" + folder.path().string() +
                 "' || exit 3\n"
                 "rm -f .out\n"
                 "LD_PRELOAD='" ARMSIG_FAILING_HEAP
                 "' ARMSIG_COUNTED_ALLOCATIONS=.count "
                 "ARMSIG_FAILING_ALLOCATION=" +
                 std::to_string(failing) +
                 " '" ARMSIG_DAEMON "' '" ARMSIG_REFERENCE
                 "' --virtual --ideal --console ./console --store ./store >.out 2>.err &\n"
                 "child=$!\n"
                 "until grep -qs 'console at' .out || ! kill -0 $child 2>/dev/null; do\n"
                 "  sleep 0.01\n"
                 "done\n"
                 "kill -TERM $child 2>/dev/null\n"
                 "wait $child\n");
  const std::string command = "exec timeout 60 sh '" + (folder / "run").string() + "'";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(folder / ".out"),
          read_file(folder / ".err")};
}

// All of them on request (ARMSIG_EVERY_ALLOCATION=1), about 60 otherwise.
TEST(FailingMemory, of_the_daemon_ends_it_in_words) {
  const Folder folder;
  const Outcome whole = run_daemon(folder, 0);
  ASSERT_EQ(whole.status, 0) << whole.err;
  const long allocations = std::stol(read_file(folder / ".count"));
  ASSERT_GT(allocations, 500) << "nothing was counted";
  const long step =
      std::getenv("ARMSIG_EVERY_ALLOCATION") != nullptr ? 1 : std::max(1L, allocations / 60);
  int told = 0;
  for (long n = 1; n <= allocations; n += step) {
    const Outcome ended = run_daemon(folder, n);
    const std::string where =
        "allocation " + std::to_string(n) + " of " + std::to_string(allocations);
    ASSERT_TRUE(ended.status >= 0 && ended.status <= 2)
        << where << ": status " << ended.status << "\n"
        << ended.err;
    if (ended.status == 0) continue;
    ++told;
    EXPECT_TRUE(ended.err.starts_with("armsigd: ")) << where << ": " << ended.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "console")) << where << ": a socket is left";
  }
  EXPECT_GT(told, 20);
  EXPECT_EQ(run_daemon(folder, 0).status, 0);
}

}  // namespace
}  // namespace armsig::cli

#endif
