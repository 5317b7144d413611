// SPDX-License-Identifier: MIT
// The real armsigd about an emulated arm, for one test.
#pragma once

#include <string>
#include <vector>

#include "host_tests/cli/run_tool.hpp"
#include "host_tests/support/console_process.hpp"

namespace armsig::cli {

// armsigd --virtual, as fast as it goes, with console and store in the folder.
class VirtualDaemon : public test::ConsoleProcess {
 public:
  explicit VirtualDaemon(const Folder& folder, const std::string& speed = "0",
                         const std::vector<std::string>& arm = {},
                         const std::string& configuration = ARMSIG_REFERENCE)
      : ConsoleProcess(command(folder, speed, arm, configuration), (folder / "console").string()) {}

 private:
  static std::vector<std::string> command(const Folder& folder, const std::string& speed,
                                          const std::vector<std::string>& arm,
                                          const std::string& configuration) {
    std::vector<std::string> words{ARMSIG_DAEMON,
                                   configuration,
                                   "--virtual",
                                   "--console",
                                   (folder / "console").string(),
                                   "--store",
                                   (folder / "store").string(),
                                   "--speed",
                                   speed};
    words.insert(words.end(), arm.begin(), arm.end());
    return words;
  }
};

}  // namespace armsig::cli
