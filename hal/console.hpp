// SPDX-License-Identifier: MIT
// Lines of text to and from operators, several at once; never blocks the servo loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/fixed_vector.hpp"

namespace armsig::hal {

inline constexpr std::size_t kMaxConsoleLine = 512;

// Names one connected client; never reused while the backend lives.
using ConsoleClient = std::uint32_t;

struct ConsoleLine {
  ConsoleClient client = 0;
  FixedVector<char, kMaxConsoleLine> characters;  // printable ASCII or tab, without the line end
  std::optional<Error> error;  // kLineTooLong or kNotText: the line was thrown away, answer with it

  [[nodiscard]] std::string_view text() const { return {characters.data(), characters.size()}; }
};

class Console {
 public:
  // The oldest complete line of the client whose turn it is, so that one that floods does not keep
  // the others waiting. Takes a bounded number of steps, never blocks. No errors.
  [[nodiscard]] std::optional<ConsoleLine> read_line() { return do_read_line(); }

  // Sends `text` (no line end in it) as one line to `client`. A client that does not take its
  // replies is disconnected rather than waited for. Errors: kConsoleGone.
  Result<void> write_line(ConsoleClient client, std::string_view text) {
    return do_write_line(client, text);
  }

  // Sends `text` as one line to every client; one that cannot take it now misses it. No errors.
  void broadcast(std::string_view text) { do_broadcast(text); }

 protected:
  ~Console() = default;

 private:
  virtual std::optional<ConsoleLine> do_read_line() = 0;
  virtual Result<void> do_write_line(ConsoleClient client, std::string_view text) = 0;
  virtual void do_broadcast(std::string_view text) = 0;
};

}  // namespace armsig::hal
