// SPDX-License-Identifier: MIT
// The lines of a CSV file, one at a time, in constant memory.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/encoding.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/text_file.hpp"

namespace armsig::tool {

// Skips blank lines, comment lines (#) and a UTF-8 byte order mark; takes LF and CRLF, CR in a file
// that begins without any LF, and a last line without an end. A file in UTF-16 is read as UTF-8.
class LineReader {
 public:
  [[nodiscard]] static Read<LineReader> open(const std::string& path);
  // `first_line`: the number of the text's first line.
  [[nodiscard]] static LineReader over(std::string_view text, std::string_view file,
                                       std::size_t first_line = 1);

  // Moves to the next line that is neither blank nor a comment (#); false at the end of the file.
  // Refuses a file that can't be read, and a line longer than any of ours.
  [[nodiscard]] Read<bool> next();
  // The same, comments among the lines.
  [[nodiscard]] Read<bool> next_or_comment();

  [[nodiscard]] std::string_view line() const {
    return {buffer_.data() + line_start_, line_length_};  // valid until next()
  }
  [[nodiscard]] std::size_t number() const { return number_; }  // of line(), from 1
  [[nodiscard]] const std::string& file() const { return file_; }

  // Of a file in which next() has found nothing: that it is empty, or has only comments.
  [[nodiscard]] std::string_view what_it_is() const;

  // How much of the file has been read, 0 to 1; nothing where its size is unknown (a pipe).
  [[nodiscard]] std::optional<double> progress() const;

 private:
  explicit LineReader(std::string_view file) : file_(file) {}
  [[nodiscard]] Read<bool> next_raw();
  [[nodiscard]] Read<void> refill();
  [[nodiscard]] Read<void> decode(std::string_view bytes);
  void choose_line_end();

  std::string file_;
  FileHandle handle_;  // null once everything is in the buffer
  std::optional<Utf16Decoder> decoder_;
  std::size_t size_ = 0;
  std::vector<char> buffer_;
  std::size_t end_ = 0;    // of what the buffer holds
  std::size_t start_ = 0;  // of what is not yet delivered
  std::size_t line_start_ = 0;
  std::size_t line_length_ = 0;
  std::size_t number_ = 0;
  char line_end_ = '\n';
  bool commented_ = false;        // a comment was passed over
  std::size_t bytes_before_ = 0;  // of the file, before the buffer
};

}  // namespace armsig::tool
