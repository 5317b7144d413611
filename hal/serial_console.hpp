// SPDX-License-Identifier: MIT
// The operator's lines over a serial line: one client that never leaves.
#pragma once

#include "hal/byte_stream.hpp"
#include "hal/console.hpp"

namespace armsig::hal {

class SerialConsole final : public Console {
 public:
  static constexpr ConsoleClient kClient = 1;

  // `line` must outlive the console.
  explicit SerialConsole(ByteStream& line) : line_(line) {}

 private:
  // Lines end with CR, LF or both; empty ones are passed over. Also kCharactersLost, as the error
  // of the line that they were lost from.
  std::optional<ConsoleLine> do_read_line() override;
  Result<void> do_write_line(ConsoleClient client, std::string_view text) override;
  void do_broadcast(std::string_view text) override;

  [[nodiscard]] std::optional<ConsoleLine> take(std::uint8_t byte);
  Result<void> send(std::string_view text);

  ByteStream& line_;
  ConsoleLine reading_{.client = kClient, .characters = {}, .error = {}};
  std::array<std::uint8_t, 64> received_{};
  std::size_t taken_ = 0;
  std::size_t count_ = 0;
};

}  // namespace armsig::hal
