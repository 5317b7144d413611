// SPDX-License-Identifier: MIT
// The real armsigd about an emulated arm, for one test.
#pragma once

#include <string>

#include "host_tests/cli/run_tool.hpp"
#include "host_tests/support/console_process.hpp"

namespace armsig::cli {

// armsigd --virtual, as fast as it goes, with console and store in the folder.
class VirtualDaemon : public test::ConsoleProcess {
 public:
  explicit VirtualDaemon(const Folder& folder, const std::string& speed = "0")
      : ConsoleProcess({ARMSIG_DAEMON, ARMSIG_REFERENCE, "--virtual", "--console",
                        (folder / "console").string(), "--store", (folder / "store").string(),
                        "--speed", speed},
                       (folder / "console").string()) {}
};

}  // namespace armsig::cli
