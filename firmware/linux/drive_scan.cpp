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

cia402::ObjectOutcome NodeReading::at(std::uint16_t index, std::uint8_t subindex) const {
  const auto found = objects.find({index, subindex});
  if (found != objects.end()) return found->second;
  return std::unexpected(cia402::ObjectFailure{.error = Error::kSdoTimeout, .abort_code = 0});
}

std::vector<ObjectKey> objects_of_scan(const canopen::CheckedConfiguration& configuration) {
  std::vector<ObjectKey> keys;
  const auto add = [&](std::uint16_t index, std::uint8_t subindex) {
    const ObjectKey key{index, subindex};
    if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
  };
  for (std::size_t axis = 0; axis < configuration->axes.size(); ++axis) {
    for (const auto& step : canopen::drive_setup(configuration, axis)) {
      add(step.request.index, step.request.subindex);
    }
  }
  for (const ObjectWords& words : object_words()) add(words.index, words.subindex);
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

DriveScan::DriveScan(const canopen::CheckedConfiguration& configuration, hal::CanBus& bus)
    : configuration_(configuration), bus_(bus), keys_(objects_of_scan(configuration)) {}

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
    NodeReading reading;
    reading.node = configuration_->axes[joint].node;
    reading.joint = joint;
    nodes_.push_back(reading);
  }
  for (const auto& [node, count] : answers_) {
    auto found = std::ranges::find(nodes_, node, &NodeReading::node);
    if (found == nodes_.end()) {
      NodeReading reading;
      reading.node = node;
      found = nodes_.insert(found, reading);
    }
    found->answers = count;
  }
  std::ranges::sort(nodes_, std::ranges::less{}, &NodeReading::node);
  part_ = Part::kRead;
}

void DriveScan::next_node() {
  ++at_node_;
  at_key_ = 0;
  transfer_.reset();
  name_.reset();
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
  next_node();
}

}  // namespace armsig::daemon
