// SPDX-License-Identifier: MIT
#include "firmware/linux/drive_scan.hpp"

#include <algorithm>
#include <chrono>

#include "firmware/linux/drive_words.hpp"
#include "hal/canopen/drive_setup.hpp"

namespace armsig::daemon {
namespace {

using canopen::NodeId;
using std::chrono::milliseconds;

// Long enough for a heartbeat of most devices and for every SYNC.
constexpr hal::Duration kListening = milliseconds(300);
constexpr hal::Duration kLongestAnswer = milliseconds(100);
// Without a frame sent: a queue of a busy bus goes on much sooner.
constexpr hal::Duration kLongestStuck = milliseconds(1000);

constexpr std::uint16_t kDeviceName = 0x1008;

// Bits of an SDO's first byte (CiA 301, 7.2.4.3).
constexpr std::uint8_t kUploadSegment = 0x60;
constexpr std::uint8_t kToggle = 0x10;
constexpr std::uint8_t kSpecifier = 0xE0;
constexpr std::uint8_t kUpload = 0x40;
constexpr std::uint8_t kExpedited = 0x02;

}  // namespace

cia402::ObjectOutcome NodeReading::read(std::uint16_t index, std::uint8_t subindex) const {
  const auto found = objects.find({index, subindex});
  if (found != objects.end()) return found->second;
  return std::unexpected(cia402::ObjectFailure{.error = Error::kSdoTimeout, .abort_code = 0});
}

std::vector<ObjectKey> objects_of_scan(const canopen::CheckedConfiguration& configuration,
                                       std::uint8_t axis) {
  std::vector<ObjectKey> keys;
  const auto add = [&](std::uint16_t index, std::uint8_t subindex) {
    const ObjectKey key{index, subindex};
    if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
  };
  const auto add_of_axis = [&](std::uint16_t index, std::uint8_t subindex) {
    add(cia402::object_of_axis(axis, cia402::object_of_first_axis(index)), subindex);
  };
  if (axis > 1) add_of_axis(cia402::kStatusWord, 0);  // which tells whether there is one
  for (std::size_t joint = 0; joint < configuration->axes.size(); ++joint) {
    for (const auto& step : canopen::drive_setup(configuration, joint)) {
      add_of_axis(step.request.index, step.request.subindex);
      // What another axis sets of the first one.
      if (configuration->axes[joint].axis == axis) add(step.request.index, step.request.subindex);
    }
  }
  for (const ObjectWords& words : object_words()) add_of_axis(words.index, words.subindex);
  return keys;
}

void TextUpload::add(const hal::CanFrame& frame, std::size_t first, std::size_t unused) {
  for (std::size_t i = first; i + unused < hal::kMaxCanData && text_.size() < kLongest; ++i) {
    const char c = static_cast<char>(frame.data[i]);
    if (c >= ' ' && c <= '~') text_ += c;
  }
  over_ = over_ || text_.size() == kLongest || ++parts_ == kMostParts;
}

void TextUpload::take(const hal::CanFrame& frame) {
  if (over_ || asks_ || frame.length != hal::kMaxCanData) return;
  const std::uint8_t command = frame.data[0];
  if (in_segments_) {
    const bool answers = (command & kSpecifier) == 0 && ((command & kToggle) != 0) == toggle_;
    over_ = !answers || (command & 1U) != 0;
    if (answers) add(frame, 1, command >> 1 & 7U);
    toggle_ = !toggle_;
  } else if ((command & kSpecifier) != kUpload) {
    over_ = true;
  } else if ((command & kExpedited) != 0) {
    add(frame, 4, command >> 2 & 3U);
    over_ = true;
  } else {
    in_segments_ = true;
  }
  asks_ = !over_;
}

std::optional<hal::CanFrame> TextUpload::poll(hal::Instant now) {
  if (!asks_ && sent_at_ && now - *sent_at_ > timeout_) over_ = true;
  if (over_ || !asks_) return std::nullopt;
  asks_ = false;
  sent_at_ = now;
  hal::CanFrame frame = canopen::encode_sdo(node_, {.index = index_});
  if (in_segments_) {
    frame.data.fill(0);
    frame.data[0] = static_cast<std::uint8_t>(kUploadSegment | (toggle_ ? kToggle : 0));
  }
  return frame;
}

DriveScan::DriveScan(const canopen::CheckedConfiguration& configuration, hal::CanBus& bus,
                     std::uint8_t number, std::string_view interface)
    : configuration_(configuration), bus_(bus), number_(number), interface_(interface) {}

bool DriveScan::step(hal::Instant now) {
  if (!since_) since_ = now;
  while (const auto received = bus_.receive()) take(received->frame);
  switch (part_) {
    case Part::kListen:
      if (now - *since_ < kListening) break;
      part_ = Part::kCall;
      since_ = now;
      break;
    case Part::kCall:
      call(now);
      break;
    case Part::kHear:
      if (now - *since_ >= kLongestAnswer) begin_reading();
      break;
    case Part::kRead:
      read(now);
      break;
    case Part::kOver:
      break;
  }
  return part_ != Part::kOver;
}

void DriveScan::take(const hal::CanFrame& frame) {
  if (frame.extended || frame.remote) return;
  const std::uint32_t function = frame.id & canopen::kFunctionMask;
  const auto node = static_cast<NodeId>(frame.id & canopen::kNodeMask);
  const bool is_masters =
      frame.id == canopen::kNmtId || frame.id == canopen::kSyncId ||
      (function == canopen::kHeartbeatId && node == configuration_->master_node);
  heard_master_ = heard_master_ || is_masters;
  if (function != canopen::kSdoResponseId) return;
  if (part_ == Part::kCall || part_ == Part::kHear) ++answers_[node];
  if (part_ != Part::kRead || nodes_[at_node_].node != node) return;
  if (transfer_) transfer_->take(frame);
  if (name_) name_->take(frame);
}

// Every number there can be is asked for its device type, once.
void DriveScan::call(hal::Instant now) {
  const auto next = static_cast<NodeId>(called_ + 1);
  const canopen::SdoRequest type{.index = cia402::kDeviceType};
  if (next != configuration_->master_node && !bus_.send(canopen::encode_sdo(next, type))) {
    stuck_ = now - *since_ >= kLongestStuck;
    if (stuck_) part_ = Part::kOver;
    return;
  }
  since_ = now;
  called_ = next;
  if (called_ < canopen::kLargestNode) return;
  part_ = Part::kHear;
}

void DriveScan::begin_reading() {
  for (std::size_t joint = 0; joint < configuration_->axes.size(); ++joint) {
    if (configuration_->axes[joint].bus != number_) continue;
    NodeReading reading;
    reading.node = configuration_->axes[joint].node;
    reading.axis = configuration_->axes[joint].axis;
    reading.joint = joint;
    nodes_.push_back(reading);
  }
  for (const auto& [node, count] : answers_) {
    const auto is_first_axis = [&](const NodeReading& reading) {
      return reading.node == node && reading.axis == 1;
    };
    if (std::ranges::none_of(nodes_, is_first_axis)) {
      NodeReading reading;
      reading.node = node;
      nodes_.push_back(reading);
    }
    for (NodeReading& reading : nodes_) {
      if (reading.node == node) reading.answers = count;
    }
  }
  std::ranges::sort(nodes_, std::ranges::less{}, [](const NodeReading& reading) {
    return std::pair(reading.node, reading.axis);
  });
  for (NodeReading& reading : nodes_) reading.interface = interface_;
  for (std::size_t i = 1; i < nodes_.size(); ++i) {
    if (nodes_[i].node != nodes_[i - 1].node) continue;
    nodes_[i].one_of_several = nodes_[i - 1].one_of_several = true;
  }
  part_ = Part::kRead;
  begin_node();
}

void DriveScan::begin_node() {
  at_key_ = 0;
  transfer_.reset();
  name_.reset();
  keys_.clear();
  if (at_node_ < nodes_.size()) keys_ = objects_of_scan(configuration_, nodes_[at_node_].axis);
}

void DriveScan::next_node() {
  ++at_node_;
  begin_node();
}

// A drive may have more axes than are configured.
void DriveScan::guess_next_axis() {
  constexpr std::uint32_t kProfile402 = 402;
  constexpr std::uint32_t kProfileMask = 0xFFFF;
  const NodeReading& last = nodes_[at_node_];
  const auto type = last.at(cia402::kDeviceType);
  const bool is_listed = at_node_ + 1 < nodes_.size() && nodes_[at_node_ + 1].node == last.node;
  if (is_listed || last.axis == cia402::kMostAxes) return;
  if (!type || (*type & kProfileMask) != kProfile402) return;
  NodeReading guess;
  guess.node = last.node;
  guess.interface = last.interface;
  guess.axis = static_cast<std::uint8_t>(last.axis + 1);
  guess.is_guess = true;
  guess.answers = last.answers;
  nodes_.insert(nodes_.begin() + static_cast<std::ptrdiff_t>(at_node_) + 1, guess);
}

void DriveScan::read(hal::Instant now) {
  while (at_node_ < nodes_.size() && nodes_[at_node_].answers == 0) next_node();
  if (at_node_ == nodes_.size()) {
    part_ = Part::kOver;
    return;
  }
  NodeReading& node = nodes_[at_node_];
  if (at_key_ == keys_.size()) {
    read_name(node, now);
    return;
  }
  if (transfer_ && transfer_->outcome()) {
    const cia402::ObjectOutcome outcome = *transfer_->outcome();
    if (node.is_guess && !outcome) {
      nodes_.erase(nodes_.begin() + static_cast<std::ptrdiff_t>(at_node_));
      begin_node();
      return;
    }
    if (node.is_guess) {
      node.is_guess = false;
      node.one_of_several = nodes_[at_node_ - 1].one_of_several = true;
    }
    node.objects.insert_or_assign(keys_[at_key_], outcome);
    ++at_key_;
    transfer_.reset();
    if (!outcome && outcome.error().error == Error::kSdoTimeout) next_node();  // it is gone
    return;
  }
  if (!transfer_) {
    const canopen::SdoRequest request{.index = keys_[at_key_].first,
                                      .subindex = keys_[at_key_].second};
    transfer_.emplace(node.node, request, configuration_->sdo_timeout,
                      configuration_->sdo_attempts);
  }
  if (const auto frame = transfer_->poll(now)) (void)bus_.send(*frame);
}

void DriveScan::read_name(NodeReading& node, hal::Instant now) {
  if (!name_) name_.emplace(node.node, kDeviceName, configuration_->sdo_timeout);
  if (const auto frame = name_->poll(now)) (void)bus_.send(*frame);
  if (!name_->is_over()) return;
  node.name = name_->text();
  guess_next_axis();
  next_node();
}

}  // namespace armsig::daemon
