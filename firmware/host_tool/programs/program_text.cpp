// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/program_text.hpp"

#include <algorithm>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

// The end of what begins at `at`, with its counterpart; the end of the line at the latest.
std::size_t end_of_quoted(std::string_view text, std::size_t at, char close) {
  const std::size_t end = text.find_first_of(std::string{close, '\n'}, at + 1);
  if (end == std::string_view::npos) return text.size();
  return text[end] == '\n' ? end : end + 1;
}

}  // namespace

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) || c == '_' || c == '$';
}

std::string without_comments(std::string_view text, const Comments& comments) {
  std::string plain(text);
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at;
    if (text[at] == comments.to_end_of_line) {
      end = std::min(text.find('\n', at), text.size());
    } else if (comments.double_quotes && text[at] == '"') {
      end = end_of_quoted(text, at, '"');
    } else if (comments.parentheses && text[at] == '(') {
      end = end_of_quoted(text, at, ')');
    }
    if (end == at) ++at;
    for (; at < end; ++at) {
      if (!is_blank(plain[at])) plain[at] = ' ';
    }
  }
  return plain;
}

std::string in_capitals(std::string_view text) {
  std::string capitals(text);
  for (char& c : capitals) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return capitals;
}

void ProgramScanner::skip_blanks() {
  while (!at_end() && is_blank(text_[at_])) ++at_;
}

bool ProgramScanner::accept(char c) {
  skip_blanks();
  if (peek() != c || at_end()) return false;
  ++at_;
  return true;
}

std::string_view ProgramScanner::word() {
  skip_blanks();
  const std::size_t begin = at_;
  while (!at_end() && is_word(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

std::optional<Bytes> ProgramScanner::number() {
  skip_blanks();
  std::size_t end = at_;
  const auto digits = [&] {
    const std::size_t begin = end;
    while (end < text_.size() && is_digit(text_[end])) ++end;
    return end > begin;
  };
  if (end < text_.size() && (text_[end] == '-' || text_[end] == '+')) ++end;
  bool any = digits();
  if (end < text_.size() && text_[end] == '.') {
    ++end;
    any = digits() || any;
  }
  if (!any) return std::nullopt;
  if (end < text_.size() && (text_[end] == 'e' || text_[end] == 'E')) {
    const std::size_t before = end++;
    if (end < text_.size() && (text_[end] == '-' || text_[end] == '+')) ++end;
    if (!digits()) end = before;
  }
  if (end < text_.size() && (is_word(text_[end]) || text_[end] == '.')) return std::nullopt;
  const Bytes bytes{at_, end};
  if (!parse_number(text_at(text_, bytes))) return std::nullopt;
  at_ = end;
  return bytes;
}

std::optional<std::vector<Bytes>> ProgramScanner::list(char open, char close) {
  const std::size_t before = at_;
  std::vector<Bytes> numbers;
  if (accept(open)) {
    do {
      const auto one = number();
      if (!one) break;
      numbers.push_back(*one);
      if (accept(close)) return numbers;
    } while (accept(','));
  }
  at_ = before;
  return std::nullopt;
}

bool ProgramScanner::next_word() {
  while (!at_end() && is_word(text_[at_])) ++at_;
  while (!at_end() && !is_word(text_[at_])) ++at_;
  return !at_end();
}

LineNumbers::LineNumbers(std::string_view text) {
  for (std::size_t at = text.find('\n'); at != std::string_view::npos;
       at = text.find('\n', at + 1)) {
    ends_.push_back(at);
  }
}

int LineNumbers::line_of(std::size_t at) const {
  return static_cast<int>(std::ranges::lower_bound(ends_, at) - ends_.begin()) + 1;
}

std::vector<double> values_at(std::string_view text, const std::vector<Bytes>& places) {
  std::vector<double> values;
  values.reserve(places.size());
  for (const Bytes& place : places) values.push_back(*parse_number(text_at(text, place)));
  return values;
}

Bytes trimmed_bytes(std::string_view text, Bytes bytes) {
  while (bytes.begin < bytes.end && is_blank(text[bytes.begin])) ++bytes.begin;
  while (bytes.end > bytes.begin && is_blank(text[bytes.end - 1])) --bytes.end;
  return bytes;
}

std::vector<Bytes> arguments_from(std::string_view text, std::size_t at, char end) {
  std::vector<Bytes> arguments;
  int depth = 0;
  std::size_t begin = at;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (depth == 0 && c == end) break;
    if (c == '(' || c == '[' || c == '{') ++depth;
    if (c == ')' || c == ']' || c == '}') --depth;
    if (depth < 0) break;
    if (depth == 0 && c == ',') {
      arguments.push_back(trimmed_bytes(text, {begin, at}));
      begin = at + 1;
    }
  }
  arguments.push_back(trimmed_bytes(text, {begin, at}));
  return arguments;
}

}  // namespace armsig::tool
