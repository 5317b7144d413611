// SPDX-License-Identifier: MIT
#include "hal/simulated/drive_dictionary.hpp"

#include <algorithm>
#include <utility>

#include "core/base/check.hpp"
#include "hal/canopen/protocol.hpp"

namespace armsig::simulated {
namespace {

using canopen::kNoRemote;
using canopen::kPdoOff;
using canopen::load;
using canopen::store;

constexpr AbortCode kUnknownCommand = 0x05040001;
constexpr AbortCode kUnsupportedAccess = 0x06010000;
constexpr AbortCode kReadOnlyObject = 0x06010002;
constexpr AbortCode kNoSuchObject = 0x06020000;
constexpr AbortCode kNotMappable = 0x06040041;
constexpr AbortCode kMappingTooLong = 0x06040042;
constexpr AbortCode kWrongLength = 0x06070010;
constexpr AbortCode kNoSuchSubindex = 0x06090011;
constexpr AbortCode kInvalidValue = 0x06090030;

// Each further axis of a device has its objects so much further on (CiA 301, object 1000h).
constexpr std::uint16_t kProfileOfAxis = 0x800;
constexpr std::uint16_t kPdosOfAxis = 0x40;
constexpr std::uint32_t kSeveralDevices = 0xFFFF0000;  // upper half of 1000h

constexpr std::uint16_t kNowhere = 0xFFFF;  // an index that no axis has

constexpr bool is_of_pdos(std::uint16_t index) { return index >= 0x1400 && index < 0x1C00; }
constexpr bool is_pdo_parameter(std::uint16_t index) {
  return (index >= 0x1400 && index < 0x1410) || (index >= 0x1800 && index < 0x1810);
}
constexpr bool is_pdo_mapping(std::uint16_t index) {
  return (index >= 0x1600 && index < 0x1610) || (index >= 0x1A00 && index < 0x1A10);
}

}  // namespace

void DriveDictionary::add(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
                          Access access, std::uint32_t value) {
  objects_.push_back({index, subindex, bytes, access, value});
}

void DriveDictionary::restore() {
  objects_.clear();
  add_identity();
  add_pdos();
  add_profile();
  for (const ObjectEdit& differs : edits_) edit(differs.object);
  std::ranges::sort(objects_, std::ranges::less{}, &Object::key);
}

void DriveDictionary::edit(const Object& object) {
  bool found = false;
  for (Object& known : objects_) {
    const bool whole = object.subindex == ObjectEdit::kWhole;
    if (known.index != object.index || (!whole && known.subindex != object.subindex)) continue;
    found = true;
    known.access = object.access;
    known.value = object.value;
    if (object.bytes != 0) known.bytes = object.bytes;
  }
  if (!found && object.access != Access::kAbsent) objects_.push_back(object);
}

bool DriveDictionary::is_in_range(const Object& object, std::uint32_t value) const {
  return std::ranges::all_of(edits_, [&](const ObjectEdit& edit) {
    return edit.object.key() != object.key() || (value >= edit.lowest && value <= edit.highest);
  });
}

void DriveDictionary::add_identity() {
  using enum Access;
  constexpr std::uint32_t kServoDrive = 0x00020192;  // profile 402
  add(0x1000, 0, 4, kReadOnly, axis_.has_others() ? kSeveralDevices | 0x192 : kServoDrive);
  if (axis_.has_others()) add(0x67FF, 0, 4, kReadOnly, kServoDrive);  // of each axis
  add(0x1001, 0, 1, kReadOnly, 0);                                    // error register
  add(0x1006, 0, 4, kReadWrite, 0);  // communication cycle period, us
  add(0x1016, 0, 1, kReadOnly, 1);
  add(0x1016, 1, 4, kReadWrite, 0);  // heartbeat consumer
  add(0x1017, 0, 2, kReadWrite, 0);  // heartbeat producer
  add(0x1018, 0, 1, kReadOnly, 4);
  add(0x1018, 1, 4, kReadOnly, 0);  // vendor: none
  add(0x1018, 2, 4, kReadOnly, 402);
  add(0x1018, 3, 4, kReadOnly, 0x00010000);
  add(0x1018, 4, 4, kReadOnly, serial_);
}

void DriveDictionary::add_profile() {
  using enum Access;
  add(0x603F, 0, 2, kMapsOut, 0);             // error code
  add(0x6007, 0, 2, kReadWrite, 1);           // abort connection option: fault
  add(0x6040, 0, 2, kMapsIn, 0);              // controlword
  add(0x6041, 0, 2, kMapsOut, 0);             // statusword
  add(0x605A, 0, 2, kReadWrite, 2);           // quick stop option: ramp, then disabled
  add(0x605B, 0, 2, kReadWrite, 1);           // shutdown option: ramp first
  add(0x605C, 0, 2, kReadWrite, 1);           // disable operation option: ramp first
  add(0x605D, 0, 2, kReadWrite, 1);           // halt option: ramp, which CSP does not use
  add(0x605E, 0, 2, kReadWrite, 2);           // fault reaction option: quick stop ramp
  add(0x6060, 0, 1, kMapsIn, 0);              // mode of operation
  add(0x6061, 0, 1, kMapsOut, 0);             // its display
  add(0x6064, 0, 4, kMapsOut, 0);             // actual position
  add(0x6065, 0, 4, kReadWrite, 0xFFFFFFFF);  // following error window: off
  add(0x6066, 0, 2, kReadWrite, 10);          // following error time-out, ms
  add(0x6077, 0, 2, kMapsOut, 0);             // actual torque, per mille of the rated one
  add(0x607A, 0, 4, kMapsIn, 0);              // target position
  add(0x607C, 0, 4, kReadWrite, 0);           // home offset
  add(0x607E, 0, 1, kReadWrite, 0);           // polarity
  add(0x6081, 0, 4, kReadWrite, 0);           // profile speed, counts/s
  add(0x6083, 0, 4, kReadWrite, 0);           // profile acceleration, counts/s^2
  add(0x6084, 0, 4, kReadWrite, 0);           // profile deceleration
  add(0x6085, 0, 4, kReadWrite, 0);           // quick stop deceleration
  if (encoder_counts_ > 0) {
    add_quotient(0x608F, encoder_counts_);  // position encoder resolution
    add_quotient(0x6091, 1);                // gear ratio: the drive knows of none
    add_quotient(0x6092, encoder_counts_);  // feed constant
  }
  add_modes();
}

void DriveDictionary::add_modes() {
  using enum Access;
  add(0x6098, 0, 1, kReadWrite, 0);  // homing method: none
  add(0x6099, 0, 1, kReadOnly, 2);   // homing speeds, counts/s: to the switch, to its edge
  add(0x6099, 1, 4, kReadWrite, 2000);
  add(0x6099, 2, 4, kReadWrite, 200);
  add(0x60B0, 0, 4, kReadWrite, 0);  // position offset, added to the target
  add(0x60C0, 0, 2, kReadWrite, 0);  // interpolation: linear
  add(0x60C1, 0, 1, kReadOnly, 1);
  add(0x60C1, 1, 4, kMapsIn, 0);  // next position
  add(0x60C2, 0, 1, kReadOnly, 2);
  add(0x60C2, 1, 1, kReadWrite, 1);     // interpolation period
  add(0x60C2, 2, 1, kReadWrite, 0xFD);  // its exponent, -3
  // Supported modes: profile position, homing, interpolated and cyclic synchronous position.
  add(0x6502, 0, 4, kReadOnly, 1U << 0 | 1U << 5 | 1U << 6 | 1U << 7);
}

void DriveDictionary::add_quotient(std::uint16_t index, std::uint32_t over) {
  using enum Access;
  add(index, 0, 1, kReadOnly, 2);
  add(index, 1, 4, kReadWrite, over);
  add(index, 2, 4, kReadWrite, 1);
}

// Two PDOs each way exist, so that a master meets both kinds: PDO1 and PDO2 are on after power-up,
// PDO3 and PDO4 do not exist.
void DriveDictionary::add_pdos() {
  using enum Access;
  for (std::uint16_t pdo = 0; pdo < 2; ++pdo) {
    const std::uint32_t id = 0x100U * pdo + node_;
    for (const std::uint16_t base : {std::uint16_t{0x1400}, std::uint16_t{0x1800}}) {
      const auto parameter = static_cast<std::uint16_t>(base + pdo);
      const auto mapping = static_cast<std::uint16_t>(base + 0x200 + pdo);
      const bool out = base == 0x1800;
      add(parameter, 0, 1, kReadOnly, 2);
      // The predefined connection set keeps identifiers for the first axis alone.
      const std::uint32_t of_first = out ? kNoRemote | (0x180 + id) : 0x200 + id;
      add(parameter, 1, 4, kReadWrite, axis_.number == 1 ? of_first : kPdoOff);
      add(parameter, 2, 1, kReadWrite, 255);
      add(mapping, 0, 1, kReadWrite, 1);
      const auto further = static_cast<std::uint32_t>(kProfileOfAxis * (axis_.number - 1)) << 16;
      add(mapping, 1, 4, kReadWrite, (out ? 0x60410010 : 0x60400010) + further);
      for (std::uint8_t entry = 2; entry <= kMaxEntries; ++entry) {
        add(mapping, entry, 4, kReadWrite, 0);
      }
    }
  }
}

// The number here of what the device has at `index`, if this axis knows of it.
std::optional<std::uint16_t> DriveDictionary::own(std::uint16_t index) const {
  const bool of_pdos = is_of_pdos(index);
  if (index < 0x6000 && !of_pdos) return index;
  const std::uint16_t step = of_pdos ? kPdosOfAxis : kProfileOfAxis;
  const int within = of_pdos ? index % 0x200 : index - 0x6000;
  const int number = within / step + 1;
  if (number == axis_.number) return static_cast<std::uint16_t>(index - (number - 1) * step);
  if (axis_.is_emulated(number) || !axis_.is_first()) return std::nullopt;
  return kNowhere;
}

const Object* DriveDictionary::find_mapped(std::uint32_t entry) const {
  const auto index = own(static_cast<std::uint16_t>(entry >> 16));
  return index ? find(*index, static_cast<std::uint8_t>((entry >> 8) & 0xFF)) : nullptr;
}

const Object* DriveDictionary::find(std::uint16_t index, std::uint8_t subindex) const {
  const std::uint32_t key = Object{.index = index, .subindex = subindex}.key();
  const Object* object = std::ranges::lower_bound(objects_, key, std::ranges::less{}, &Object::key);
  return object != objects_.end() && object->key() == key ? object : nullptr;
}

Object* DriveDictionary::find(std::uint16_t index, std::uint8_t subindex) {
  return const_cast<Object*>(std::as_const(*this).find(index, subindex));
}

std::uint32_t DriveDictionary::get(std::uint16_t index, std::uint8_t subindex) const {
  const Object* object = find(index, subindex);
  ARMSIG_CHECK(object != nullptr);
  return object->value;
}

void DriveDictionary::set(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) {
  Object* object = find(index, subindex);
  ARMSIG_CHECK(object != nullptr);
  object->value = value;
}

AbortCode DriveDictionary::absent(std::uint16_t index) const {
  const Object* object = find(index, 0);
  return object == nullptr || object->access == Access::kAbsent ? kNoSuchObject : kNoSuchSubindex;
}

AbortCode DriveDictionary::write(std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
                                 std::uint32_t value) {
  Object* object = find(index, subindex);
  if (object == nullptr || object->access == Access::kAbsent) return absent(index);
  if (object->access == Access::kReadOnly || object->access == Access::kMapsOut) {
    return kReadOnlyObject;
  }
  if (bytes != object->bytes) return kWrongLength;
  if (!is_in_range(*object, value)) return kInvalidValue;
  if (is_pdo_mapping(index)) {
    if (const AbortCode abort = check_mapping(*object, value)) return abort;
  }
  // An identifier may only change while the PDO is off (CiA 301, 7.5.2.35).
  if (is_pdo_parameter(index) && subindex == 1 && (object->value & kPdoOff) == 0 &&
      (value & kPdoOff) == 0 && (value & 0x7FF) != (object->value & 0x7FF)) {
    return kInvalidValue;
  }
  if (index == 0x6060) {
    const bool known = value == 1 || (value >= 6 && value <= 8);
    if (!known || (get(0x6502) >> (value - 1) & 1U) == 0) return kInvalidValue;
    set(0x6061, 0, value);
  }
  object->value = value;
  return 0;
}

// The order of CiA 301, 7.5.2.36: entries change only while the PDO is off and their number is 0.
AbortCode DriveDictionary::check_mapping(const Object& object, std::uint32_t value) const {
  const auto parameter = static_cast<std::uint16_t>(object.index - 0x200);
  if ((get(parameter, 1) & kPdoOff) == 0) return kUnsupportedAccess;
  if (object.subindex == 0) {
    if (value > kMaxEntries) return kMappingTooLong;
    std::uint32_t bits = 0;
    for (unsigned entry = 1; entry <= value; ++entry) {
      bits += get(object.index, static_cast<std::uint8_t>(entry)) & 0xFF;
    }
    return bits > 64 ? kMappingTooLong : 0;
  }
  if (get(object.index, 0) != 0) return kUnsupportedAccess;
  const Object* mapped = find_mapped(value);
  const Access wanted = object.index >= 0x1A00 ? Access::kMapsOut : Access::kMapsIn;
  if (mapped == nullptr || mapped->access != wanted || (value & 0xFF) != 8U * mapped->bytes) {
    return kNotMappable;
  }
  return 0;
}

AbortCode DriveDictionary::answer(const hal::CanFrame& request, std::uint16_t index,
                                  hal::CanFrame& answer) {
  const std::uint8_t subindex = request.data[3];
  if (request.data[0] == 0x40) {
    const Object* object = find(index, subindex);
    if (object == nullptr || object->access == Access::kAbsent) return absent(index);
    answer.data[0] = static_cast<std::uint8_t>(0x43U | ((4U - object->bytes) << 2));
    store(answer, 4, object->value);
    return 0;
  }
  if ((request.data[0] & 0xE3U) != 0x23U) return kUnknownCommand;
  const auto bytes = static_cast<std::uint8_t>(4U - ((request.data[0] >> 2) & 3U));
  const std::uint32_t value = load<std::uint32_t>(request, 4) & (0xFFFFFFFFU >> (8 * (4 - bytes)));
  answer.data[0] = 0x60;
  return write(index, subindex, bytes, value);
}

std::optional<hal::CanFrame> DriveDictionary::serve(const hal::CanFrame& request) {
  if (request.length != 8 || (request.data[0] & 0xE0U) == 0x80U) return std::nullopt;
  const auto index = load<std::uint16_t>(request, 1);
  const auto here = own(index);
  if (!here) return std::nullopt;
  hal::CanFrame reply{.id = canopen::kSdoResponseId + node_, .length = 8};
  store(reply, 1, index);
  store(reply, 3, request.data[3]);
  const AbortCode abort = answer(request, *here, reply);
  if (abort != 0) {
    reply.data[0] = 0x80;
    store(reply, 4, abort);
  }
  const bool of_device = index < 0x6000 && !is_of_pdos(index);
  if (of_device && !axis_.is_first()) return std::nullopt;
  return reply;
}

std::uint8_t DriveDictionary::entries(std::uint16_t mapping) const {
  return static_cast<std::uint8_t>(get(mapping));
}

std::uint8_t DriveDictionary::pdo_bytes(std::uint16_t mapping) const {
  std::uint32_t bits = 0;
  for (std::uint8_t entry = 1; entry <= entries(mapping); ++entry)
    bits += get(mapping, entry) & 0xFF;
  return static_cast<std::uint8_t>(bits / 8);
}

hal::CanFrame DriveDictionary::pack(std::uint16_t mapping, std::uint32_t id) const {
  hal::CanFrame frame{.id = id & 0x7FFU};
  for (std::uint8_t entry = 1; entry <= entries(mapping); ++entry) {
    const std::uint32_t what = get(mapping, entry);
    const Object* object = find_mapped(what);
    const std::uint32_t value = object == nullptr ? 0 : object->value;
    for (unsigned byte = 0; byte < (what & 0xFF) / 8; ++byte) {
      frame.data[frame.length++] = static_cast<std::uint8_t>(value >> (8 * byte));
    }
  }
  return frame;
}

void DriveDictionary::unpack(std::uint16_t mapping, const hal::CanFrame& frame) {
  std::size_t at = 0;
  for (std::uint8_t entry = 1; entry <= entries(mapping); ++entry) {
    const std::uint32_t what = get(mapping, entry);
    std::uint32_t value = 0;
    for (unsigned byte = 0; byte < (what & 0xFF) / 8; ++byte) {
      value |= static_cast<std::uint32_t>(frame.data[at++]) << (8 * byte);
    }
    if (const Object* object = find_mapped(what)) set(object->index, object->subindex, value);
  }
}

}  // namespace armsig::simulated
