// SPDX-License-Identifier: MIT
// A payload as protoc reads it by a schema of the tests' own.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

namespace armsig::fleet::test {

inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// Runs protoc over `input`.
inline std::string by_protoc(const std::string& option, const std::string& input) {
  const auto base =
      std::filesystem::temp_directory_path() / ("armsig-wire-" + std::to_string(::getpid()));
  std::ofstream(base, std::ios::binary) << input;
  const std::string out = base.string() + ".out";
  const std::string command = ARMSIG_PROTOC " --" + option +
                              "=Payload -I" ARMSIG_SCHEMA_FOLDER " own_schema.proto <" +
                              base.string() + " >" + out;
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::string result = file_text(out);
  std::filesystem::remove(base);
  std::filesystem::remove(out);
  return result;
}

inline std::string decoded(std::span<const std::byte> payload) {
  return by_protoc("decode", {reinterpret_cast<const char*>(payload.data()), payload.size()});
}

inline std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

}  // namespace armsig::fleet::test
