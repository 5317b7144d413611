// SPDX-License-Identifier: MIT
#include "firmware/formats/file_roles.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>

#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"

namespace armsig::tool {
namespace {

// Where a file that does not exist yet would be.
std::string future_place(std::string_view path) {
  std::error_code ignored;
  const auto from_root = std::filesystem::absolute(std::filesystem::path(path), ignored);
  const auto place = std::filesystem::weakly_canonical(from_root, ignored);
  return ignored ? std::string(path) : place.string();
}

// Some file systems take "M.csv" and "m.csv" for one file, and nothing says so before it exists.
bool equal_but_for_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  };
  return std::ranges::equal(a, b, {}, lower, lower);
}

bool is_same_file(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return false;
  struct stat status_a{};
  struct stat status_b{};
  const bool exists_a = ::stat(std::string(a).c_str(), &status_a) == 0;
  const bool exists_b = ::stat(std::string(b).c_str(), &status_b) == 0;
  if (exists_a && exists_b) {
    return S_ISREG(status_a.st_mode) && status_a.st_dev == status_b.st_dev &&
           status_a.st_ino == status_b.st_ino;
  }
  return !exists_a && !exists_b && equal_but_for_case(future_place(a), future_place(b));
}

Read<void> check_apart(const FileRole& written, const FileRole& other) {
  if (!is_same_file(written.path, other.path)) return {};
  return std::unexpected(
      Problem{std::string(written.option), 0, 0,
              fmt::format("{} is the file of {} too", in_quotes(written.path), other.option),
              "another file"});
}

}  // namespace

Read<void> check_roles(std::initializer_list<FileRole> read,
                       std::initializer_list<FileRole> written) {
  for (const FileRole* file = written.begin(); file != written.end(); ++file) {
    for (const FileRole& other : read) {
      if (auto apart = check_apart(*file, other); !apart) return apart;
    }
    // What may be left out is empty then; --out may not.
    if (file->path.empty() && file->option == "--out") {
      return std::unexpected(
          Problem{"--out", 0, 0, "an empty name", "a file, or - for standard output"});
    }
    if (!file->path.empty()) {
      if (auto writable = check_writable(std::string(file->path)); !writable) return writable;
    }
    for (const FileRole* earlier = written.begin(); earlier != file; ++earlier) {
      if (auto apart = check_apart(*file, *earlier); !apart) return apart;
    }
  }
  return {};
}

}  // namespace armsig::tool
