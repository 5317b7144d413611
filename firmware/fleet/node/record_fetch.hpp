// SPDX-License-Identifier: MIT
// The record of the controller's signature, part by part, as `fetch` of its console tells it. Its
// layout is told in firmware/controller/signature_record.hpp and read here anew: what reports has
// nothing of the controller in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace armsig::fleet {

class RecordFetch {
 public:
  static constexpr std::size_t kRecordBytes = 3956;
  static constexpr std::size_t kPartBytes = 192;

  enum class State : std::uint8_t {
    kNone,   // nothing is asked for
    kAsks,   // part() is to be asked for
    kWhole,  // document() is there
    kOther,  // the record is of another signature, which became active meanwhile
  };

  // Of signature `number`, which was told with `rows`.
  void begin(std::string_view rows, std::uint64_t number);
  [[nodiscard]] State state() const { return state_; }
  // The part that is asked for, from 1.
  [[nodiscard]] std::size_t part() const { return part_; }
  // Takes a reply; false: it is none to `fetch`. A controller that has no record to tell, or tells
  // what is none, leaves the rows alone as the document.
  bool take(std::string_view line);
  [[nodiscard]] const std::string& document() const { return document_; }

 private:
  [[nodiscard]] bool add(std::string_view line);
  void finish();

  State state_ = State::kNone;
  std::size_t part_ = 1;
  std::uint64_t number_ = 0;
  std::array<std::uint8_t, kRecordBytes> image_{};
  std::string document_;
};

}  // namespace armsig::fleet
