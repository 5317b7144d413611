// SPDX-License-Identifier: MIT
#include "firmware/formats/table_cells.hpp"

#include <algorithm>

#include "firmware/formats/text.hpp"

namespace armsig::tool {

Cells::Cells(std::string_view line, char separator, Quotes quotes)
    : line_(separator == kBlanks ? trimmed(line) : line), separator_(separator), quotes_(quotes) {
  // Positions are those of the whole line.
  if (separator == kBlanks) {
    const auto before = static_cast<std::size_t>(line_.data() - line.data());
    line_ = line.substr(0, before + line_.size());
    at_ = before;
    more_ = at_ < line_.size();
  }
}

bool Cells::is_blank(char c) const {
  return separator_ != kBlanks && c != separator_ && (c == ' ' || c == '\t');
}

bool Cells::separates(char c) const {
  return separator_ == kBlanks ? c == ' ' || c == '\t' : c == separator_;
}

void Cells::skip_blanks() {
  while (at_ < line_.size() && is_blank(line_[at_])) ++at_;
}

bool Cells::next() {
  if (!more_) return false;
  skip_blanks();
  position_ = at_;
  if (quotes_ == Quotes::kEnclose && at_ < line_.size() && line_[at_] == '"') {
    take_quoted();
  } else {
    take_plain();
  }
  more_ = at_ < line_.size();
  if (!more_) return true;
  ++at_;                                                         // the separator
  while (separator_ == kBlanks && separates(line_[at_])) ++at_;  // no line ends with a blank
  return true;
}

void Cells::take_plain() {
  const std::size_t start = at_;
  const std::size_t stop =
      separator_ == kBlanks ? line_.find_first_of(" \t", at_) : line_.find(separator_, at_);
  at_ = std::min(stop, line_.size());
  text_ = trimmed(line_.substr(start, at_ - start));
}

void Cells::take_quoted() {
  unquoted_.clear();
  bool closed = false;
  for (++at_; at_ < line_.size() && !closed; ++at_) {
    if (line_[at_] != '"') {
      unquoted_ += line_[at_];
    } else if (at_ + 1 < line_.size() && line_[at_ + 1] == '"') {
      unquoted_ += line_[++at_];
    } else {
      closed = true;
    }
  }
  skip_blanks();
  const std::size_t rest = at_;
  while (at_ < line_.size() && !separates(line_[at_])) ++at_;
  if (!closed || at_ > rest) well_quoted_ = false;
  unquoted_ += line_.substr(rest, at_ - rest);
  text_ = trimmed(unquoted_);
}

std::optional<std::vector<std::string>> split_line(std::string_view line, char separator) {
  std::vector<std::string> texts;
  Cells cells(line, separator);
  while (cells.next()) texts.emplace_back(cells.text());
  if (!cells.well_quoted()) return std::nullopt;
  while (!texts.empty() && texts.back().empty()) texts.pop_back();
  return texts;
}

}  // namespace armsig::tool
