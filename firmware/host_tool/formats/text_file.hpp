// SPDX-License-Identifier: MIT
// Whole text files in and out. Measurements are not read here: csv_lines.hpp streams them.
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "firmware/host_tool/formats/problem.hpp"

namespace armsig::tool {

struct FileCloser {
  // Files are only read through it: closing can't lose anything.
  void operator()(std::FILE* file) const { (void)std::fclose(file); }
};
using FileHandle = std::unique_ptr<std::FILE, FileCloser>;

// Opens `path` for reading; the problem says why it can't be ("No such file or directory").
[[nodiscard]] Read<FileHandle> open_file(const std::string& path);

// The content of `path`. Refuses a file above 16 MiB: no description or signature is that large.
[[nodiscard]] Read<std::string> read_text_file(const std::string& path);

// A file that appears under its name only when it is complete: written beside it under a temporary
// name, synchronised to the disk, then renamed. Without commit() the temporary file is removed and
// whatever stood under the name before is untouched. What is no regular file (a pipe, a terminal)
// is written to directly.
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

// Writes `text` to `path` through an AtomicFile.
[[nodiscard]] Read<void> write_text_file(const std::string& path, std::string_view text);

}  // namespace armsig::tool
