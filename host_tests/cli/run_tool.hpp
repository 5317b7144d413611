// SPDX-License-Identifier: MIT
// Runs the installed command as a user would, in a folder of its own.
#pragma once

#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

namespace armsig::cli {

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

// A folder that is new for each test and removed after it.
class Folder {
 public:
  Folder() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            (std::string("armsig-") + test->test_suite_name() + "-" + test->name() + "-" +
             std::to_string(getpid()));
    std::filesystem::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

struct Outcome {
  int status = -1;
  std::string out;
  std::string err;
};

// `armsig ARGUMENTS` with `folder` as its working directory.
inline Outcome run_tool(const Folder& folder, const std::string& arguments) {
  const std::string command = "cd '" + folder.path().string() + "' && '" ARMSIG_TOOL "' " +
                              arguments + " >.out 2>.err </dev/null";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, read_file(folder / ".out"),
          read_file(folder / ".err")};
}

// What a person sees of it on a terminal of `columns`, without the carriage returns.
inline std::string shown_on_terminal(const Folder& folder, const std::string& arguments,
                                     unsigned short columns) {
  const std::string command =
      "cd '" + folder.path().string() + "' && exec '" ARMSIG_TOOL "' " + arguments;
  const winsize size{.ws_row = 24, .ws_col = columns, .ws_xpixel = 0, .ws_ypixel = 0};
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    ::_exit(127);
  }
  std::string shown;
  std::array<char, 4096> bytes{};
  ssize_t count = 0;
  while ((count = ::read(terminal, bytes.data(), bytes.size())) > 0) {
    shown.append(bytes.data(), static_cast<std::size_t>(count));
  }
  ::waitpid(child, nullptr, 0);
  ::close(terminal);
  std::erase(shown, '\r');
  return shown;
}

}  // namespace armsig::cli
