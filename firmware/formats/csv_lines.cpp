// SPDX-License-Identifier: MIT
#include "firmware/formats/csv_lines.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/encoding.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kBuffer = std::size_t{256} << 10U;
constexpr std::size_t kLongestLine = std::size_t{64} << 10U;

}  // namespace

Read<LineReader> LineReader::open(const std::string& path) {
  auto handle = open_file(path);
  if (!handle) return std::unexpected(std::move(handle).error());
  LineReader reader(path);
  struct stat status{};
  if (::fstat(::fileno(handle->get()), &status) == 0 && S_ISREG(status.st_mode)) {
    reader.size_ = static_cast<std::size_t>(status.st_size);
  }
  reader.handle_ = std::move(*handle);
  reader.buffer_.resize(kBuffer);
  if (auto begun = reader.refill(); !begun) return std::unexpected(std::move(begun).error());
  const std::string_view beginning(reader.buffer_.data(), reader.end_);
  if (is_utf16(beginning)) {
    reader.decoder_.emplace(beginning);
    reader.size_ /= 2;  // mostly: of the text
    const std::string bytes(beginning);
    reader.end_ = 0;
    if (auto decoded = reader.decode(bytes); !decoded) {
      return std::unexpected(std::move(decoded).error());
    }
  }
  reader.choose_line_end();
  return reader;
}

// Appends `bytes` of UTF-16 to the buffer; none: there are no more.
Read<void> LineReader::decode(std::string_view bytes) {
  std::string text;
  if (!decoder_->append(bytes, text) || (bytes.empty() && !decoder_->is_whole())) {
    return std::unexpected(
        Problem{file_, 0, 0, "text in UTF-16 that breaks off in mid-character", "a whole file"});
  }
  buffer_.resize(std::max(buffer_.size(), end_ + text.size()));
  std::ranges::copy(text, buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
  end_ += text.size();
  return {};
}

LineReader LineReader::over(std::string_view text, std::string_view file, std::size_t first_line) {
  LineReader reader(file);
  reader.number_ = first_line - 1;
  reader.buffer_.assign(text.begin(), text.end());
  reader.end_ = text.size();
  reader.size_ = text.size();
  reader.choose_line_end();
  return reader;
}

void LineReader::choose_line_end() {
  if (has_lone_returns({buffer_.data(), end_})) line_end_ = '\r';
}

std::string_view LineReader::what_it_is() const {
  if (commented_) return "the file holds only comments";
  return number_ > 0 ? "the file holds only blank lines" : "the file is empty";
}

std::optional<double> LineReader::progress() const {
  if (size_ == 0) return std::nullopt;
  return std::min(1.0, static_cast<double>(bytes_before_ + start_) / static_cast<double>(size_));
}

Read<void> LineReader::refill() {
  std::memmove(buffer_.data(), buffer_.data() + start_, end_ - start_);
  bytes_before_ += start_;
  end_ -= start_;
  start_ = 0;
  // Room for what two bytes of UTF-16 become at most: three.
  const std::size_t room =
      decoder_ ? std::min((buffer_.size() - end_) / 3 * 2, kBuffer / 2) : buffer_.size() - end_;
  std::vector<char> bytes(decoder_ ? room : 0);
  char* into = decoder_ ? bytes.data() : buffer_.data() + end_;
  const std::size_t count = std::fread(into, 1, room, handle_.get());
  if (decoder_ && (count > 0 || std::ferror(handle_.get()) == 0)) {
    if (auto decoded = decode({bytes.data(), count}); !decoded) return decoded;
  } else {
    end_ += count;
  }
  if (count > 0) return {};
  if (std::ferror(handle_.get()) != 0) {
    return std::unexpected(
        Problem{file_, 0, 0, "can't be read: " + std::generic_category().message(errno), ""});
  }
  handle_.reset();
  return {};
}

Read<bool> LineReader::next_raw() {
  for (std::size_t searched = 0;;) {
    const char* unread = buffer_.data() + start_;
    const std::size_t count = end_ - start_;
    const void* end =
        count > searched ? std::memchr(unread + searched, line_end_, count - searched) : nullptr;
    if (end == nullptr && count <= kLongestLine && handle_) {
      searched = count;
      if (auto more = refill(); !more) return std::unexpected(std::move(more).error());
      continue;
    }
    if (end == nullptr && count == 0) return false;
    ++number_;
    line_start_ = start_;
    line_length_ =
        end == nullptr ? count : static_cast<std::size_t>(static_cast<const char*>(end) - unread);
    if (line_length_ > kLongestLine) {
      return std::unexpected(Problem{file_, static_cast<int>(number_), 0, "the line is too long",
                                     fmt::format("at most {} characters", kLongestLine)});
    }
    start_ += line_length_ + (end == nullptr ? 0 : 1);
    if (line_length_ > 0 && unread[line_length_ - 1] == '\r') --line_length_;
    return true;
  }
}

Read<bool> LineReader::next_or_comment() {
  for (;;) {
    ARMSIG_TRY(more, next_raw());
    if (!more) return false;
    if (number_ == 1 && line().starts_with(kByteOrderMark)) {
      line_start_ += kByteOrderMark.size();
      line_length_ -= kByteOrderMark.size();
    }
    if (!trimmed(line()).empty()) return true;
  }
}

Read<bool> LineReader::next() {
  for (;;) {
    ARMSIG_TRY(more, next_or_comment());
    if (!more || trimmed(line()).front() != '#') return more;
    commented_ = true;
  }
}

}  // namespace armsig::tool
