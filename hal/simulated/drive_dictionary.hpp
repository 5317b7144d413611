// SPDX-License-Identifier: MIT
// The object dictionary of an emulated CiA 402 drive, and its expedited SDO server.
#pragma once

#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <span>

#include "core/base/fixed_vector.hpp"
#include "hal/can_bus.hpp"

namespace armsig::simulated {

// Whether the object may be written, and mapped into a PDO; kAbsent: nobody outside sees it.
enum class Access : std::uint8_t { kReadOnly, kReadWrite, kMapsOut, kMapsIn, kAbsent };

struct Object {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint8_t bytes = 0;
  Access access = Access::kReadOnly;
  std::uint32_t value = 0;

  [[nodiscard]] constexpr std::uint32_t key() const {
    return (static_cast<std::uint32_t>(index) << 8) | subindex;
  }
};

// Where a drive differs from the one that is emulated: an object that it has besides, has
// otherwise, or lacks.
struct ObjectEdit {
  // In place of a sub-index: all that there are.
  static constexpr std::uint8_t kWhole = 0xFF;

  Object object;
  // What may be written, unsigned.
  std::uint32_t lowest = 0;
  std::uint32_t highest = 0xFFFFFFFF;
};

// One axis of a device, and which ones are emulated. The first of these is the device: it answers
// for what is of all. Another one hears what is said to the device, and answers for its own objects
// alone.
struct DeviceAxis {
  std::uint8_t number = 1;
  std::uint8_t emulated = 1;  // a bit an axis

  [[nodiscard]] constexpr bool is_emulated(int other) const {
    return (emulated >> (other - 1) & 1) != 0;
  }
  [[nodiscard]] constexpr bool is_first() const {
    return (emulated & ((1U << (number - 1U)) - 1U)) == 0;
  }
  [[nodiscard]] constexpr bool has_others() const { return emulated >> 1 != 0; }
};

// An SDO abort code (CiA 301, 7.2.4.3.17), 0 for none.
using AbortCode = std::uint32_t;

class DriveDictionary {
 public:
  static constexpr std::size_t kMaxObjects = 120;
  static constexpr std::size_t kMaxEntries = 3;  // of a PDO mapping

  // `encoder_counts` a motor revolution, told by the factor group; 0: the drive has none. `edits`
  // must outlive it.
  DriveDictionary(std::uint8_t node, std::uint32_t serial, std::uint32_t encoder_counts = 0,
                  std::span<const ObjectEdit> edits = {}, DeviceAxis axis = {})
      : node_(node), axis_(axis), serial_(serial), encoder_counts_(encoder_counts), edits_(edits) {
    restore();
  }

  // Power-up values of the communication objects (1000h to 1FFFh) and of the profile's.
  void restore();

  // By number, for the device itself: the object must exist, but may be kAbsent. Every axis has its
  // objects under the numbers of the first one here.
  [[nodiscard]] bool has(std::uint16_t index, std::uint8_t subindex) const {
    return find(index, subindex) != nullptr;
  }
  [[nodiscard]] std::uint32_t get(std::uint16_t index, std::uint8_t subindex = 0) const;
  void set(std::uint16_t index, std::uint8_t subindex, std::uint32_t value);

  // What an SDO request frame to this node is answered; empty if it needs no answer, or another
  // axis answers it.
  [[nodiscard]] std::optional<hal::CanFrame> serve(const hal::CanFrame& request);

  // The bytes of the PDO with mapping object `mapping`, read from, or written into the dictionary.
  [[nodiscard]] std::uint8_t pdo_bytes(std::uint16_t mapping) const;
  [[nodiscard]] hal::CanFrame pack(std::uint16_t mapping, std::uint32_t id) const;
  void unpack(std::uint16_t mapping, const hal::CanFrame& frame);

 private:
  void add(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes, Access access,
           std::uint32_t value);
  void edit(const Object& object);
  [[nodiscard]] bool is_in_range(const Object& object, std::uint32_t value) const;
  void add_identity();
  void add_pdos();
  void add_profile();
  void add_modes();
  void add_quotient(std::uint16_t index, std::uint32_t over);
  [[nodiscard]] std::uint8_t entries(std::uint16_t mapping) const;  // kMaxEntries at most
  [[nodiscard]] Object* find(std::uint16_t index, std::uint8_t subindex);
  [[nodiscard]] const Object* find(std::uint16_t index, std::uint8_t subindex) const;
  [[nodiscard]] AbortCode absent(std::uint16_t index) const;
  [[nodiscard]] std::optional<std::uint16_t> own(std::uint16_t index) const;
  [[nodiscard]] const Object* find_mapped(std::uint32_t entry) const;
  [[nodiscard]] AbortCode answer(const hal::CanFrame& request, std::uint16_t index,
                                 hal::CanFrame& answer);
  [[nodiscard]] AbortCode write(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
                                std::uint32_t value);
  [[nodiscard]] AbortCode check_mapping(const Object& object, std::uint32_t value) const;

  std::uint8_t node_;
  DeviceAxis axis_;
  std::uint32_t serial_;
  std::uint32_t encoder_counts_;
  std::span<const ObjectEdit> edits_;
  FixedVector<Object, kMaxObjects> objects_;  // by rising key
};

}  // namespace armsig::simulated
