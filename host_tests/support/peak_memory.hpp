// SPDX-License-Identifier: MIT
// How much memory reading costs.
#pragma once

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include <gtest/gtest.h>

namespace armsig::test {

// The most memory that a child process had in use, after `work`, KiB.
inline long peak_kib(const std::function<void()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::_exit(0);
  }
  int status = 0;
  rusage usage{};
  ::wait4(child, &status, 0, &usage);
  EXPECT_EQ(status, 0);
  return usage.ru_maxrss;
}

// Memory beyond that of the process itself for reading `text`, in bytes.
template <typename Reader>
double cost_of(const std::string& text, const Reader& read) {
  const long base = peak_kib([] {});
  return 1024.0 * static_cast<double>(peak_kib([&] { read(text); }) - base);
}

}  // namespace armsig::test
