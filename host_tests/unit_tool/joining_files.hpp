// SPDX-License-Identifier: MIT
// A joint log and a tracker's points in files of a test, removed with it.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "firmware/host_tool/joining/join.hpp"

namespace armsig::tool {

class JoiningFiles : public ::testing::Test {
 protected:
  JoiningFiles() {
    folder_ =
        std::filesystem::temp_directory_path() / ("armsig-joining-" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
    types_.resize(2, JointType::kRevolute);
    files_ = {(folder_ / "joints").string(), (folder_ / "points").string()};
  }
  ~JoiningFiles() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  void joints(const std::string& text) { write(files_.joints, text); }
  void points(const std::string& text) { write(files_.points, text); }
  static void write(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
  }

  Read<Joined> joined(const JoinSettings& settings, const std::string& units = "") {
    ARMSIG_TRY(stated, stated_units(units));
    ARMSIG_TRY(log, read_joint_log(files_.joints, types_, stated, joint_columns_));
    ARMSIG_TRY(tracked, read_tracked_points(files_.points, stated, point_columns_));
    return join(log, tracked, settings, types_);
  }
  Read<Joined> joined(JoinBy by, const std::string& units = "") {
    return joined(settings_by(by), units);
  }
  static JoinSettings settings_by(JoinBy by) {
    JoinSettings settings;
    settings.by = by;
    settings.target = 7;
    return settings;
  }
  std::string refusal(const JoinSettings& settings, const std::string& units = "") {
    const auto result = joined(settings, units);
    EXPECT_FALSE(result);
    return result ? "" : render(result.error());
  }
  std::string refusal(JoinBy by, const std::string& units = "") {
    return refusal(settings_by(by), units);
  }

  struct Files {
    std::string joints, points;
  };
  std::filesystem::path folder_;
  Files files_;
  std::string joint_columns_ = "auto";
  std::string point_columns_ = "auto";
  JointTypes types_;
};

}  // namespace armsig::tool
