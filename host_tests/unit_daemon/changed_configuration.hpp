// SPDX-License-Identifier: MIT
// The reference configuration with one change, and that such a change is refused at its place.
#pragma once

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "firmware/linux/daemon_configuration.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::daemon {

inline std::string reference() {
  std::ifstream file(ARMSIG_REFERENCE);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The reference without the grid, which takes long to place, and with the first `from` after `near`
// put as `to`.
struct Changed {
  std::string text;
  int line = 0;
};
inline Changed change(const std::string& near, const std::string& from, const std::string& to) {
  Changed changed{reference().substr(0, reference().find("\ngrid:") + 1), 0};
  std::size_t at = changed.text.find(near);
  at = at == std::string::npos ? at : changed.text.find(from, at);
  if (at == std::string::npos) {
    ADD_FAILURE() << near << " / " << from << " is not in the reference";
    return changed;
  }
  changed.line = 1 + static_cast<int>(std::count(
                         changed.text.begin(), changed.text.begin() + static_cast<long>(at), '\n'));
  changed.text.replace(at, from.size(), to);
  return changed;
}

inline void expect_refused(const std::string& near, const std::string& from, const std::string& to,
                           const std::string& words) {
  const Changed changed = change(near, from, to);
  const auto read = parse_configuration(changed.text, "cabinet.yaml");
  ASSERT_FALSE(read) << from << " -> " << to << " was accepted";
  const std::string message = tool::render(read.error());
  EXPECT_EQ(test::failure_of(read).line, changed.line) << message;
  EXPECT_GT(test::failure_of(read).column, 0) << message;
  EXPECT_FALSE(test::failure_of(read).expected.empty()) << message;
  EXPECT_NE(message.find(words), std::string::npos) << message;
  EXPECT_TRUE(message.starts_with("cabinet.yaml:")) << message;
}

}  // namespace armsig::daemon
