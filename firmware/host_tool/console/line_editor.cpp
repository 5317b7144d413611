// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/line_editor.hpp"

#include <utility>

namespace armsig::tool {
namespace {

constexpr char kEscape = 0x1B;
constexpr char kDelete = 0x7F;

constexpr char ctrl(char letter) { return static_cast<char>(letter & 0x1F); }

}  // namespace

void LineEditor::set_text(std::string text) {
  text_ = std::move(text);
  cursor_ = text_.size();
}

void LineEditor::recall(std::size_t at) {
  if (recalled_ == history_.size()) unfinished_ = text_;
  recalled_ = at;
  set_text(at == history_.size() ? unfinished_ : history_[at]);
}

std::optional<std::string> LineEditor::key(char byte) {
  if (!sequence_.empty() || byte == kEscape) {
    escape(byte);
    return std::nullopt;
  }
  if (byte == '\r' || byte == '\n') {
    std::string line = std::exchange(text_, {});
    cursor_ = 0;
    const bool worth_keeping = !line.empty() && (history_.empty() || history_.back() != line);
    if (worth_keeping) history_.push_back(line);
    if (history_.size() > kMostLines) history_.erase(history_.begin());
    recalled_ = history_.size();
    return line;
  }
  const bool printable = byte >= ' ' && byte < kDelete;
  if (!printable) {
    control(byte);
  } else if (text_.size() < kLongestLine) {
    text_.insert(cursor_++, 1, byte);
  }
  return std::nullopt;
}

void LineEditor::control(char byte) {
  switch (byte) {
    case kDelete:
    case ctrl('H'):
      if (cursor_ > 0) text_.erase(--cursor_, 1);
      break;
    case ctrl('A'):
      cursor_ = 0;
      break;
    case ctrl('E'):
      cursor_ = text_.size();
      break;
    case ctrl('K'):
      text_.erase(cursor_);
      break;
    case ctrl('U'):
      text_.erase(0, std::exchange(cursor_, 0));
      break;
    case ctrl('W'): {
      const std::size_t word = text_.find_last_not_of(' ', cursor_ > 0 ? cursor_ - 1 : 0);
      const std::size_t blank = word == std::string::npos ? word : text_.find_last_of(' ', word);
      const std::size_t begin = blank == std::string::npos ? 0 : blank + 1;
      if (begin < cursor_) {
        text_.erase(begin, cursor_ - begin);
        cursor_ = begin;
      }
      break;
    }
    case ctrl('C'):
      set_text({});
      recalled_ = history_.size();
      break;
    default:
      break;
  }
}

// ESC [ letter, ESC O letter and ESC [ number ~ (ECMA-48, 5.4).
void LineEditor::escape(char byte) {
  sequence_ += byte;
  const bool opened = sequence_.size() > 1;
  if (!opened) return;
  if (sequence_.size() == 2 && (byte == '[' || byte == 'O')) return;
  const bool number = byte >= '0' && byte <= '9';
  constexpr std::size_t kLongestSequence = 8;
  if (sequence_.size() > 2 && number && sequence_.size() < kLongestSequence) return;
  const std::string keys = std::exchange(sequence_, {}).substr(1);
  if (keys == "[A" || keys == "OA") {
    if (recalled_ > 0) recall(recalled_ - 1);
  } else if (keys == "[B" || keys == "OB") {
    if (recalled_ < history_.size()) recall(recalled_ + 1);
  } else if (keys == "[C" || keys == "OC") {
    if (cursor_ < text_.size()) ++cursor_;
  } else if (keys == "[D" || keys == "OD") {
    if (cursor_ > 0) --cursor_;
  } else if (keys == "[H" || keys == "OH" || keys == "[1~") {
    cursor_ = 0;
  } else if (keys == "[F" || keys == "OF" || keys == "[4~") {
    cursor_ = text_.size();
  } else if (keys == "[3~") {
    if (cursor_ < text_.size()) text_.erase(cursor_, 1);
  }
}

}  // namespace armsig::tool
