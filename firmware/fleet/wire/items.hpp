// SPDX-License-Identifier: MIT
// What a cabinet reports: every quantity with its name, its number (the alias of Sparkplug and the
// name in the journal) and its type. Names follow the tree of OPC 40010-1, so that a gateway to OPC
// UA has nothing to invent. A number is never given to another quantity.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "core/base/fixed_vector.hpp"

namespace armsig::fleet {

// As the specification of Sparkplug numbers them.
enum class Datatype : std::uint8_t {
  kInt64 = 4,
  kUInt32 = 7,
  kUInt64 = 8,
  kDouble = 10,
  kBoolean = 11,
  kString = 12,
  kDateTime = 13,
};

enum class Item : std::uint8_t {
  kJournal = 1,  // of the row
  kNumber = 2,
  kPrevious = 3,  // number of the row before it that there is; 0: none
  kDropped = 4,   // rows that went before they were acknowledged
  kArm = 5,       // its name in the configuration of the controller
  kSerial = 6,
  kFirmware = 7,
  kMode = 8,
  kFault = 9,  // in words; empty: none
  kModel = 10,
  kSignatureHash = 11,
  kSignatureDate = 12,
  kPredicted = 13,   // predicted tool error of the signature, RMS over its region, mm
  kValidation = 14,  // RMS on its validation poses, mm
  kVerdict = 15,
  kResidualX = 16,
  kResidualY = 17,
  kResidualZ = 18,
  kCheckSigma = 19,
  kCheckPoses = 20,
  kAir = 21,  // in which the signature was identified
  kLateness50 = 22,
  kLateness99 = 23,
  kLatenessMax = 24,
  kSensor = 25,
  // A signature's document, in parts of at most Text::kLongest bytes.
  kDocumentHash = 26,  // of the whole
  kDocumentPart = 27,  // from 1
  kDocumentParts = 28,
  kDocumentText = 29,
  kSignatureNumber = 30,  // in the store of its controller
  kPredictedRegion = 31,
  kValidationPoses = 32,
  kCheckSignature = 33,  // number of the signature that a check is of
};

struct ItemInfo {
  Item item;
  std::string_view name;
  Datatype type;
};

inline constexpr std::array kItems{
    ItemInfo{Item::kJournal, "Journal/Name", Datatype::kUInt64},
    ItemInfo{Item::kNumber, "Journal/Row", Datatype::kUInt64},
    ItemInfo{Item::kPrevious, "Journal/Previous Row", Datatype::kUInt64},
    ItemInfo{Item::kDropped, "Journal/Dropped", Datatype::kUInt64},
    ItemInfo{Item::kArm, "MotionDeviceSystem/MotionDevice/AssetId", Datatype::kString},
    ItemInfo{Item::kSerial, "MotionDeviceSystem/MotionDevice/SerialNumber", Datatype::kString},
    ItemInfo{Item::kFirmware, "MotionDeviceSystem/Controller/Software/SoftwareRevision",
             Datatype::kString},
    ItemInfo{Item::kMode, "MotionDeviceSystem/Controller/Mode", Datatype::kString},
    ItemInfo{Item::kFault, "MotionDeviceSystem/Controller/Fault", Datatype::kString},
    ItemInfo{Item::kModel, "MotionDeviceSystem/MotionDevice/Kinematics/Model", Datatype::kString},
    ItemInfo{Item::kSignatureHash, "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Hash",
             Datatype::kString},
    ItemInfo{Item::kSignatureDate, "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Date",
             Datatype::kDateTime},
    ItemInfo{Item::kPredicted,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Predicted Tool Error mm",
             Datatype::kDouble},
    ItemInfo{Item::kValidation,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Validation RMS mm",
             Datatype::kDouble},
    ItemInfo{Item::kVerdict, "MotionDeviceSystem/MotionDevice/Check/Verdict", Datatype::kString},
    ItemInfo{Item::kResidualX, "MotionDeviceSystem/MotionDevice/Check/Residual X mm",
             Datatype::kDouble},
    ItemInfo{Item::kResidualY, "MotionDeviceSystem/MotionDevice/Check/Residual Y mm",
             Datatype::kDouble},
    ItemInfo{Item::kResidualZ, "MotionDeviceSystem/MotionDevice/Check/Residual Z mm",
             Datatype::kDouble},
    ItemInfo{Item::kCheckSigma, "MotionDeviceSystem/MotionDevice/Check/Sigma mm",
             Datatype::kDouble},
    ItemInfo{Item::kCheckPoses, "MotionDeviceSystem/MotionDevice/Check/Poses", Datatype::kUInt32},
    ItemInfo{Item::kAir, "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Air Temperature C",
             Datatype::kDouble},
    ItemInfo{Item::kLateness50, "MotionDeviceSystem/Controller/Tick Lateness P50 us",
             Datatype::kDouble},
    ItemInfo{Item::kLateness99, "MotionDeviceSystem/Controller/Tick Lateness P99 us",
             Datatype::kDouble},
    ItemInfo{Item::kLatenessMax, "MotionDeviceSystem/Controller/Tick Lateness Max us",
             Datatype::kDouble},
    ItemInfo{Item::kSensor, "MotionDeviceSystem/Controller/Range Sensor", Datatype::kString},
    ItemInfo{Item::kDocumentHash,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Document/Hash",
             Datatype::kString},
    ItemInfo{Item::kDocumentPart,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Document/Part",
             Datatype::kUInt32},
    ItemInfo{Item::kDocumentParts,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Document/Parts",
             Datatype::kUInt32},
    ItemInfo{Item::kDocumentText,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Document/Text",
             Datatype::kString},
    ItemInfo{Item::kSignatureNumber, "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Number",
             Datatype::kUInt32},
    ItemInfo{Item::kPredictedRegion,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Predicted Region",
             Datatype::kString},
    ItemInfo{Item::kValidationPoses,
             "MotionDeviceSystem/MotionDevice/Kinematics/Signature/Validation Poses",
             Datatype::kUInt32},
    ItemInfo{Item::kCheckSignature, "MotionDeviceSystem/MotionDevice/Check/Signature Number",
             Datatype::kUInt32},
};
static_assert([] {
  for (std::size_t i = 0; i < kItems.size(); ++i) {
    if (static_cast<std::size_t>(kItems[i].item) != i + 1) return false;
  }
  return true;
}());

[[nodiscard]] constexpr const ItemInfo& info(Item item) {
  return kItems[static_cast<std::size_t>(item) - 1];
}

// The item of that number, and of that name; none: no such one.
[[nodiscard]] constexpr std::optional<Item> item_of(std::uint64_t alias) {
  if (alias == 0 || alias > kItems.size()) return std::nullopt;
  return kItems[alias - 1].item;
}
[[nodiscard]] constexpr std::optional<Item> item_of(std::string_view name) {
  for (const ItemInfo& known : kItems) {
    if (known.name == name) return known.item;
  }
  return std::nullopt;
}

// What is known of a signature: figures that hold for the hash in the same row alone.
inline constexpr std::array kOfSignature{
    Item::kSignatureHash,   Item::kSignatureNumber, Item::kSignatureDate,   Item::kPredicted,
    Item::kPredictedRegion, Item::kValidation,      Item::kValidationPoses, Item::kAir};
[[nodiscard]] constexpr bool is_of_signature(Item item) {
  for (const Item known : kOfSignature) {
    if (known == item) return true;
  }
  return false;
}

// A text of bounded length; what is longer is cut, between characters of UTF-8.
class Text {
 public:
  static constexpr std::size_t kLongest = 96;

  Text() = default;
  explicit Text(std::string_view text) {
    std::size_t size = text.size();
    if (size > kLongest) {
      size = kLongest;
      while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) --size;
    }
    for (const char c : text.substr(0, size)) bytes_.push_back(c == '\0' ? ' ' : c);
  }
  [[nodiscard]] std::string_view view() const { return {bytes_.data(), bytes_.size()}; }
  friend bool operator==(const Text& a, const Text& b) { return a.view() == b.view(); }

 private:
  FixedVector<char, kLongest> bytes_;
};

// No value; UInt32, UInt64, DateTime, Int64; Double; Boolean; String.
using Value = std::variant<std::monostate, std::uint64_t, double, bool, Text>;

struct Reading {
  Item item = Item::kJournal;
  Value value;
  friend bool operator==(const Reading&, const Reading&) = default;
};
using Readings = FixedVector<Reading, kItems.size()>;

// Whether `value` is of the type that the item has.
[[nodiscard]] bool suits(Item item, const Value& value);

}  // namespace armsig::fleet
