// SPDX-License-Identifier: MIT
#include "firmware/selftest/report.hpp"

#include "firmware/controller/text.hpp"
#include "toolchain/boards/semihosting.hpp"
#include "toolchain/boards/stack.hpp"

namespace armsig::selftest {
namespace {

constexpr double kInstructionsPerTick = 1.25;
constexpr std::uint32_t kWrap = 0x00FF'FFFF;

volatile std::uint32_t& systick(std::uint32_t offset) {
  return *reinterpret_cast<volatile std::uint32_t*>(0xE000'E010 + offset);
}

}  // namespace

void Report::arms(std::size_t number, std::string_view origin) {
  controller::Line line;
  line.text("arms number=").integer(number).text(" origin=\"").text(origin).text("\"");
  board::say(line.view());
}

void Report::check(std::string_view name, double worst, double limit) {
  const bool good = worst <= limit;
  passed_ = passed_ && good;
  controller::Line line;
  line.text("check ").text(name).text(good ? " ok worst=" : " FAILED worst=").number(worst, 6);
  board::say(line.text(" limit=").number(limit, 6).view());
}

void Report::count(std::string_view name, double instructions) {
  controller::Line line;
  line.text("count ").text(name).text(" instructions=").number(instructions, 0);
  board::say(line.view());
}

void Report::stack() {
  controller::Line line;
  board::say(line.text("stack bytes=").integer(board::stack_used()).view());
  check("stack_guard", board::stack_guard_intact() ? 0 : 1, 0);
}

void start_counter() {
  constexpr std::uint32_t kEnableFromProcessorClock = 0b101;
  systick(4) = kWrap;  // reload value
  systick(8) = 0;      // clears the current one
  systick(0) = kEnableFromProcessorClock;
}

std::uint32_t counter() { return systick(8); }

double instructions_between(std::uint32_t begin, std::uint32_t end) {
  return kInstructionsPerTick * static_cast<double>((begin - end) & kWrap);  // counts down
}

}  // namespace armsig::selftest
