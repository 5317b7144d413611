// SPDX-License-Identifier: MIT
// One look at every device of a CAN bus before anything is written: who is there, and what its
// objects hold. It sends SDO uploads and nothing else.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "hal/can_bus.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/canopen/protocol.hpp"
#include "hal/canopen/sdo_client.hpp"

namespace armsig::daemon {

using ObjectKey = std::pair<std::uint16_t, std::uint8_t>;  // index and sub-index

// What is read of each axis of a device, in this order; by the numbers of its objects.
[[nodiscard]] std::vector<ObjectKey> objects_of_scan(
    const canopen::CheckedConfiguration& configuration, std::uint8_t axis);

// Of one axis of a device.
struct NodeReading {
  canopen::NodeId node = 0;
  std::string interface;  // that it is on; empty where there is one
  std::uint8_t axis = 1;
  bool one_of_several = false;       // the node has other axes
  bool is_guess = false;             // whether it is there is still to be seen
  std::optional<std::size_t> joint;  // from 0; empty: it is not configured as a drive
  unsigned answers = 0;              // to the first request: more than one of two devices
  std::string name;                  // 1008h
  std::map<ObjectKey, cia402::ObjectOutcome> objects;

  // As the device answered; a time-out where it was not asked. By the number of the object, and by
  // its number in the first axis.
  [[nodiscard]] cia402::ObjectOutcome read(std::uint16_t index, std::uint8_t subindex) const;
  [[nodiscard]] cia402::ObjectOutcome at(std::uint16_t index, std::uint8_t subindex = 0) const {
    return read(cia402::object_of_axis(axis, index), subindex);
  }
};

// A text object, in as many segments as it takes (CiA 301, 7.2.4.3.5).
class TextUpload {
 public:
  static constexpr std::size_t kLongest = 64;
  static constexpr std::size_t kMostParts = 64;  // of which some may hold nothing that is printed

  TextUpload(canopen::NodeId node, std::uint16_t index, hal::Duration timeout)
      : node_(node), index_(index), timeout_(timeout) {}

  void take(const hal::CanFrame& frame);
  // The frame to send now, if there is one.
  [[nodiscard]] std::optional<hal::CanFrame> poll(hal::Instant now);
  // Nothing more comes: the text is whole, cut, or was refused.
  [[nodiscard]] bool is_over() const { return over_; }
  // Its printable characters.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void add(const hal::CanFrame& frame, std::size_t first, std::size_t unused);

  canopen::NodeId node_;
  std::uint16_t index_;
  hal::Duration timeout_;
  std::string text_;
  std::size_t parts_ = 0;
  std::optional<hal::Instant> sent_at_;
  bool asks_ = true;  // a request is to be sent
  bool in_segments_ = false;
  bool toggle_ = false;
  bool over_ = false;
};

class DriveScan {
 public:
  // Both must outlive it. `number`: of the bus; `interface`: its name, where there are two.
  DriveScan(const canopen::CheckedConfiguration& configuration, hal::CanBus& bus,
            std::uint8_t number = 0, std::string_view interface = {});

  // One step, to be called about once a millisecond. False when the look is over.
  bool step(hal::Instant now);

  // By rising node and axis: those that are configured, and those that answer besides.
  [[nodiscard]] const std::vector<NodeReading>& nodes() const { return nodes_; }
  // The bus took no frame for so long that the look was given up: nobody acknowledges frames.
  [[nodiscard]] bool is_stuck() const { return stuck_; }
  // Frames were heard that only a master sends.
  [[nodiscard]] bool heard_master() const { return heard_master_; }
  [[nodiscard]] const std::string& interface() const { return interface_; }

 private:
  enum class Part : std::uint8_t { kListen, kCall, kHear, kRead, kOver };

  void take(const hal::CanFrame& frame);
  void call(hal::Instant now);
  void begin_reading();
  void begin_node();
  void guess_next_axis();
  void read(hal::Instant now);
  void read_name(NodeReading& node, hal::Instant now);
  void next_node();

  const canopen::CheckedConfiguration& configuration_;
  hal::CanBus& bus_;
  std::uint8_t number_;
  std::string interface_;
  std::vector<ObjectKey> keys_;
  std::vector<NodeReading> nodes_;
  Part part_ = Part::kListen;
  std::optional<hal::Instant> since_;  // of the part
  bool heard_master_ = false;
  bool stuck_ = false;
  canopen::NodeId called_ = 0;
  std::map<canopen::NodeId, unsigned> answers_;
  std::size_t at_node_ = 0;
  std::size_t at_key_ = 0;
  std::optional<canopen::SdoTransfer> transfer_;
  std::optional<TextUpload> name_;
};

}  // namespace armsig::daemon
