// SPDX-License-Identifier: MIT
// What the targets of the fuzzer share. A target takes any bytes, gives them to one door of armsig,
// and ends the process by FUZZ_CHECK where a promise is broken; the sanitizers end it where memory
// or arithmetic is.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>

#include "firmware/formats/problem.hpp"

// Ends the process, so that the fuzzer keeps the bytes that led here.
#define FUZZ_CHECK(condition)                                                            \
  do {                                                                                   \
    if (!(condition)) {                                                                  \
      (void)std::fprintf(stderr, "%s:%d: broken: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                      \
    }                                                                                    \
  } while (false)

namespace armsig::fuzz {

using Bytes = std::span<const std::uint8_t>;

struct Target {
  std::string_view name;
  void (*run)(Bytes bytes) = nullptr;
};

// Those of each file of this folder.
[[nodiscard]] std::span<const Target> description_targets();
[[nodiscard]] std::span<const Target> table_targets();
[[nodiscard]] std::span<const Target> foreign_targets();
[[nodiscard]] std::span<const Target> name_targets();
[[nodiscard]] std::span<const Target> bus_targets();
[[nodiscard]] std::span<const Target> console_targets();
[[nodiscard]] std::span<const Target> store_targets();
[[nodiscard]] std::span<const Target> kinematics_targets();
[[nodiscard]] std::span<const Target> linuxcnc_targets();
[[nodiscard]] std::span<const Target> program_targets();
[[nodiscard]] std::span<const Target> library_targets();

[[nodiscard]] inline std::array<std::span<const Target>, 11> all_targets() {
  return {description_targets(), table_targets(),   foreign_targets(), name_targets(),
          bus_targets(),         console_targets(), store_targets(),   kinematics_targets(),
          linuxcnc_targets(),    program_targets(), library_targets()};
}

[[nodiscard]] inline std::string_view text_of(Bytes bytes) {
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as characters
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// What a person gets to read of a refusal: words, on one line.
template <typename T>
void check_words(const tool::Read<T>& read) {
  if (read) return;
  const tool::Problem& problem = read.error();
  FUZZ_CHECK(!problem.what.empty());
  FUZZ_CHECK(problem.line >= 0 && problem.column >= 0);
  for (const char c : tool::render(problem)) FUZZ_CHECK(c != '\n' && c != '\r' && c != '\x1B');
}

// A file that holds `text`, for the readers that open one themselves. In memory.
class File {
 public:
  explicit File(std::string_view text);
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File();

  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  int descriptor_;
  std::string path_;
};

// Writes by `write(path)` and gives what stands in the file.
class Scratch {
 public:
  Scratch();
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch();

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::string content() const;

 private:
  std::string folder_;
  std::string path_;
};

// The bytes as a tape of decisions: numbers and choices, zeros at the end of it.
class Tape {
 public:
  explicit Tape(Bytes bytes) : left_(bytes) {}

  [[nodiscard]] bool empty() const { return left_.empty(); }
  [[nodiscard]] std::uint8_t byte() {
    if (left_.empty()) return 0;
    const std::uint8_t first = left_.front();
    left_ = left_.subspan(1);
    return first;
  }
  [[nodiscard]] std::size_t below(std::size_t n) { return n == 0 ? 0 : byte() % n; }
  [[nodiscard]] std::uint32_t word() {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = (value << 8U) | byte();
    return value;
  }
  // -1 to 1.
  [[nodiscard]] double share() {
    const std::uint32_t high = byte();
    const std::uint32_t low = byte();
    return static_cast<double>(high << 8U | low) / 32767.5 - 1;
  }
  [[nodiscard]] Bytes take(std::size_t most) {
    const Bytes first = left_.first(most < left_.size() ? most : left_.size());
    left_ = left_.subspan(first.size());
    return first;
  }

 private:
  Bytes left_;
};

}  // namespace armsig::fuzz
