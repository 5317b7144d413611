// SPDX-License-Identifier: MIT
// A folder in memory that is removed with its owner. Not on the host's file system, which User-Mode
// Linux borrows and cannot make sockets in.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

namespace armsig::bench {

class MemoryFolder {
 public:
  MemoryFolder() { EXPECT_NE(::mkdtemp(path.data()), nullptr); }
  ~MemoryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  MemoryFolder(const MemoryFolder&) = delete;
  MemoryFolder& operator=(const MemoryFolder&) = delete;

  std::string path = "/dev/shm/armsig_XXXXXX";
};

}  // namespace armsig::bench
