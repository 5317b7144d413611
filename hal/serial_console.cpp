// SPDX-License-Identifier: MIT
#include "hal/serial_console.hpp"

#include <array>

namespace armsig::hal {

std::optional<ConsoleLine> SerialConsole::do_read_line() {
  if (taken_ == count_) {
    taken_ = count_ = 0;
    const auto count = line_.read(received_);
    if (!count) {
      // What is left of the line is no request: it is thrown away up to its end.
      reading_.characters.clear();
      reading_.error = count.error();
      return std::nullopt;
    }
    count_ = *count;
  }
  while (taken_ < count_) {
    if (auto whole = take(received_[taken_++])) return whole;
  }
  return std::nullopt;
}

std::optional<ConsoleLine> SerialConsole::take(std::uint8_t byte) {
  if (byte == '\r' || byte == '\n') {
    if (reading_.characters.empty() && !reading_.error) return std::nullopt;
    const ConsoleLine whole = reading_;
    reading_.characters.clear();
    reading_.error.reset();
    return whole;
  }
  const bool is_text = (byte >= ' ' && byte <= '~') || byte == '\t';
  if (!is_text && !reading_.error) reading_.error = Error::kNotText;
  if (reading_.characters.full() && !reading_.error) reading_.error = Error::kLineTooLong;
  if (reading_.error) {
    reading_.characters.clear();
  } else {
    reading_.characters.push_back(static_cast<char>(byte));
  }
  return std::nullopt;
}

// One write, so that a line is queued whole or not at all.
Result<void> SerialConsole::send(std::string_view text) {
  std::array<std::uint8_t, 1026> bytes;
  const std::size_t length = text.size() < bytes.size() - 2 ? text.size() : bytes.size() - 2;
  for (std::size_t i = 0; i < length; ++i) bytes[i] = static_cast<std::uint8_t>(text[i]);
  bytes[length] = '\r';
  bytes[length + 1] = '\n';
  return line_.write(std::span(bytes).first(length + 2));
}

Result<void> SerialConsole::do_write_line(ConsoleClient /*client*/, std::string_view text) {
  if (!send(text)) return std::unexpected(Error::kConsoleGone);
  return {};
}

void SerialConsole::do_broadcast(std::string_view text) { (void)send(text); }

}  // namespace armsig::hal
