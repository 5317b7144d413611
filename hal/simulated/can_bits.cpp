// SPDX-License-Identifier: MIT
#include "hal/simulated/can_bits.hpp"

namespace armsig::simulated {
namespace {

constexpr std::uint32_t kCrcPolynomial = 0x4599;  // x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1
constexpr unsigned kCrcBits = 15;
constexpr unsigned kLowIdBits = 18;  // of an extended identifier, behind its first 11
// CRC delimiter, acknowledge slot and delimiter, end of frame, interframe space: never stuffed.
constexpr unsigned kTrailerBits = 1 + 2 + 7 + 3;

// Counts bits as they leave, keeping the CRC of all before it.
class Shifter {
 public:
  void put(std::uint32_t value, unsigned bits) {
    for (unsigned i = bits; i-- > 0;) put_bit((value >> i) & 1U);
  }
  [[nodiscard]] std::uint32_t crc() const { return crc_; }
  [[nodiscard]] unsigned count() const { return count_; }

 private:
  void put_bit(std::uint32_t bit) {
    const std::uint32_t feedback = bit ^ ((crc_ >> (kCrcBits - 1)) & 1U);
    crc_ = (crc_ << 1) & 0x7FFFU;
    if (feedback != 0) crc_ ^= kCrcPolynomial;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    ++count_;
    if (run_ == 5) {  // a stuff bit of the other value, which begins a run of its own
      ++count_;
      last_ = 1 - bit;
      run_ = 1;
    }
  }

  std::uint32_t crc_ = 0;
  std::uint32_t last_ = 2;  // neither value
  unsigned run_ = 0;
  unsigned count_ = 0;
};

}  // namespace

unsigned wire_bits(const hal::CanFrame& frame) {
  Shifter shifter;
  shifter.put(0, 1);  // start of frame
  shifter.put(frame.extended ? frame.id >> kLowIdBits : frame.id, 11);
  if (frame.extended) {
    shifter.put(3, 2);  // in the place of the remote bit, extended format
    shifter.put(frame.id, kLowIdBits);
  }
  shifter.put(frame.remote ? 1 : 0, 1);
  shifter.put(0, 2);  // base format or a reserved bit, reserved bit
  shifter.put(frame.length, 4);
  if (!frame.remote) {
    for (unsigned i = 0; i < frame.length; ++i) shifter.put(frame.data[i], 8);
  }
  const std::uint32_t crc = shifter.crc();
  shifter.put(crc, kCrcBits);
  return shifter.count() + kTrailerBits;
}

std::uint32_t precedence(const hal::CanFrame& frame) {
  const std::uint32_t id = frame.extended ? frame.id : frame.id << kLowIdBits;
  return id << 1U | (frame.extended ? 1U : 0U);
}

}  // namespace armsig::simulated
