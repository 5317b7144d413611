// SPDX-License-Identifier: MIT
// A serial line that records what is written and answers what it is told.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <vector>

#include "hal/byte_stream.hpp"

namespace armsig::test {

inline std::vector<std::uint8_t> bytes(const std::string& hex) {
  std::vector<std::uint8_t> result;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2) {
    result.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  }
  return result;
}

class ScriptedLine final : public hal::ByteStream {
 public:
  std::vector<std::vector<std::uint8_t>> written;
  std::vector<std::uint8_t> answer;  // arrives after each request
  bool down = false;

  void bring(const std::vector<std::uint8_t>& received) {
    waiting_.insert(waiting_.end(), received.begin(), received.end());
  }

 private:
  Result<void> do_write(std::span<const std::uint8_t> out) override {
    if (down) return std::unexpected(Error::kBusDown);
    written.emplace_back(out.begin(), out.end());
    bring(answer);
    return {};
  }
  Result<std::size_t> do_read(std::span<std::uint8_t> into) override {
    if (down) return std::unexpected(Error::kBusDown);
    const std::size_t count = std::min(into.size(), waiting_.size());
    for (std::size_t i = 0; i < count; ++i) {
      into[i] = waiting_.front();
      waiting_.pop_front();
    }
    return count;
  }

  std::deque<std::uint8_t> waiting_;
};

}  // namespace armsig::test
