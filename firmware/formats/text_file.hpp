// SPDX-License-Identifier: MIT
// Whole text files in and out. Measurements are not read here: csv_lines.hpp streams them.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct FileCloser {
  // Files are only read through it: closing can't lose anything.
  void operator()(std::FILE* file) const { (void)std::fclose(file); }
};
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

// Opens `path` for reading; the problem says why it can't be ("No such file or directory").
[[nodiscard]] Read<FileHandle> open_file(const std::string& path);

// No file of its kind is larger.
inline constexpr std::size_t kLargestDescription = std::size_t{256} << 10U;  // arm, sensor, daemon
inline constexpr std::size_t kLargestSignature = std::size_t{4} << 20U;
inline constexpr std::size_t kLargestUrdf = std::size_t{4} << 20U;
inline constexpr std::size_t kLargestProgram = std::size_t{64} << 20U;  // of a robot

// The content of `path`. Refuses a file of more than `largest` bytes.
[[nodiscard]] Read<std::string> read_text_file(const std::string& path,
                                               std::size_t largest = kLargestDescription);

// From now on SIGHUP, SIGINT, SIGQUIT, SIGTERM, SIGXCPU and SIGXFSZ, where they end the process,
// end it without a temporary file left behind. For a program to call when it starts; SIGKILL and a
// power cut leave one, whose name ends in .tmp-PID-N.
void remove_temporaries_on_signals();

// A file that appears under its name only when it is complete: written beside it under a temporary
// name, synchronised to the disk, then renamed. Of a symbolic link the file that it names. Without
// commit() the temporary file is removed and whatever stood under the name before is untouched.
// What is no regular file (a pipe, a terminal) is written to directly.
class AtomicFile {
 public:
  [[nodiscard]] static Read<AtomicFile> create(const std::string& path);
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) = delete;
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  // Buffered; a failure to write is reported by commit().
  void write(std::string_view text);
  [[nodiscard]] Read<void> commit();

 private:
  AtomicFile() = default;
  void flush();

  std::string path_;            // as the caller named it
  std::string real_path_;       // symbolic links resolved
  std::string temporary_path_;  // empty: written to directly
  int descriptor_ = -1;
  int first_errno_ = 0;  // of the first write that failed
  std::string buffer_;
};

// Can a file be made under the name `path`, or is there one that can be written to? Said before the
// work whose result would be lost, and no promise.
[[nodiscard]] Read<void> check_writable(const std::string& path);

// Writes `text` to `path` through an AtomicFile.
[[nodiscard]] Read<void> write_text_file(const std::string& path, std::string_view text);

}  // namespace armsig::tool
