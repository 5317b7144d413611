// SPDX-License-Identifier: MIT
#include "host_tests/support/shared_arms.hpp"

#include <filesystem>
#include <stdexcept>

#include <gtest/gtest.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::test {
namespace {

const std::string kFolder = ARMSIG_SHARED_DATA "/arms";

class SharedArms : public ::testing::Environment {
 public:
  void SetUp() override {
    if (!std::filesystem::exists(kFolder)) {
      GTEST_SKIP() << "no arm descriptions in " << kFolder;
    }
  }
};

const ::testing::Environment* const registered =
    ::testing::AddGlobalTestEnvironment(new SharedArms);  // which GoogleTest owns

}  // namespace

Arm shared_arm(const std::string& name) {
  const auto description = tool::read_arm_file(kFolder + "/" + name + ".yaml");
  if (!description) throw std::runtime_error(tool::render(description.error()));
  return description->arm;
}

}  // namespace armsig::test
