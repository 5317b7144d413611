// SPDX-License-Identifier: MIT
// What the interfaces check before any backend is asked.
#include <array>
#include <cstdint>
#include <span>

#include <gtest/gtest.h>

#include "hal/nonvolatile_memory.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::hal {
namespace {

class CountingMemory final : public NonvolatileMemory {
 public:
  int calls = 0;

 private:
  MemoryLayout do_layout() const override { return {4, 2, 2}; }
  Result<void> do_read(std::size_t, std::span<std::uint8_t>) override { return count(); }
  Result<void> do_erase_sector(std::size_t) override { return count(); }
  Result<void> do_program_page(std::size_t, std::span<const std::uint8_t>) override {
    return count();
  }
  Result<void> count() {
    ++calls;
    return {};
  }
};

TEST(NonvolatileMemory, passes_on_what_is_inside_it) {
  CountingMemory memory;
  std::array<std::uint8_t, 16> bytes{};
  EXPECT_TRUE(memory.read(0, bytes));
  EXPECT_TRUE(memory.read(16, std::span<std::uint8_t>()));
  EXPECT_TRUE(memory.erase_sector(1));
  EXPECT_TRUE(memory.program_page(12, std::span(bytes).first(4)));
  EXPECT_EQ(memory.calls, 4);
}

TEST(NonvolatileMemory, refuses_what_is_outside_it_or_not_a_page) {
  CountingMemory memory;
  std::array<std::uint8_t, 17> bytes{};
  EXPECT_EQ(test::failure_of(memory.read(0, bytes)), Error::kAddressOutOfRange);
  EXPECT_EQ(test::failure_of(memory.read(15, std::span(bytes).first(2))),
            Error::kAddressOutOfRange);
  EXPECT_EQ(test::failure_of(memory.read(SIZE_MAX, std::span(bytes).first(2))),
            Error::kAddressOutOfRange);
  EXPECT_EQ(test::failure_of(memory.erase_sector(2)), Error::kAddressOutOfRange);
  EXPECT_EQ(test::failure_of(memory.program_page(2, std::span(bytes).first(4))),
            Error::kAddressOutOfRange);
  EXPECT_EQ(test::failure_of(memory.program_page(16, std::span(bytes).first(4))),
            Error::kAddressOutOfRange);
  EXPECT_EQ(test::failure_of(memory.program_page(4, std::span(bytes).first(3))),
            Error::kAddressOutOfRange);
  EXPECT_EQ(memory.calls, 0);
}

TEST(CanBus, traps_on_an_identifier_or_a_length_that_does_not_exist) {
  test::ScriptedCanBus bus;
  EXPECT_DEATH((void)bus.send({.id = 0x800}), "");
  EXPECT_DEATH((void)bus.send({.id = 0, .length = 9}), "");
}

}  // namespace
}  // namespace armsig::hal
