// SPDX-License-Identifier: MIT
#include "hal/simulated/range_node.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "hal/canopen/range_sensor.hpp"

namespace armsig::simulated {
namespace {

using canopen::NmtCommand;
using canopen::NmtState;

constexpr std::uint32_t kPdoStep = 0x100;

std::uint32_t nanoseconds(double flight_s) {
  return static_cast<std::uint32_t>(std::clamp(std::round(flight_s * 1e9), 0.0, 4294967295.0));
}

}  // namespace

RangeNode::RangeNode(std::uint8_t node, hal::CanBus& bus, hal::Instant now, hal::Duration heartbeat)
    : node_(node), bus_(&bus), heartbeat_(heartbeat), next_heartbeat_(now) {}

void RangeNode::send(const hal::CanFrame& frame) {
  if (!silent_) (void)bus_->send(frame);  // a full queue loses the frame, as in a real device
}

void RangeNode::publish(const hal::RangeReading& reading) {
  ARMSIG_CHECK(reading.receivers.size() <= canopen::kMaxCanReceivers);
  if (nmt_ != NmtState::kOperational) return;
  hal::CanFrame opening{.id = canopen::kTransmitPdo1Id + node_, .length = 4};
  for (std::size_t j = 0; j < reading.receivers.size(); ++j) {
    if (reading.receivers[j].valid) {
      opening.data[0] = static_cast<std::uint8_t>(opening.data[0] | (1U << j));
    }
  }
  opening.data[1] = static_cast<std::uint8_t>(reading.sequence & 0xFF);
  const auto decidegrees =
      static_cast<std::int16_t>(std::lround(std::clamp(10 * reading.air_celsius, -32e3, 32e3)));
  canopen::store(opening, 2, static_cast<std::uint16_t>(decidegrees));
  FixedVector<std::uint32_t, canopen::kMaxCanReceivers> flights_ns;
  for (const hal::ReceiverReading& receiver : reading.receivers) {
    flights_ns.push_back(nanoseconds(receiver.flight_s));
  }
  canopen::store(opening, opening.length,
                 canopen::reading_crc(opening, {flights_ns.data(), flights_ns.size()}));
  opening.length = static_cast<std::uint8_t>(opening.length + sizeof(std::uint32_t));
  send(opening);
  for (std::size_t first = 0; first < reading.receivers.size(); first += 2) {
    hal::CanFrame flights{.id = canopen::kTransmitPdo2Id + node_ +
                                kPdoStep * static_cast<std::uint32_t>(first / 2)};
    for (std::size_t j = first; j < std::min(first + 2, reading.receivers.size()); ++j) {
      canopen::store(flights, flights.length, flights_ns[j]);
      flights.length = static_cast<std::uint8_t>(flights.length + 4);
    }
    send(flights);
  }
}

void RangeNode::do_advance(hal::Instant until) {
  if (until < next_heartbeat_) return;
  next_heartbeat_ = until + heartbeat_;
  send(canopen::heartbeat_frame(node_, nmt_));  // the first one is the boot-up message
  if (nmt_ == NmtState::kBootUp) nmt_ = NmtState::kPreOperational;
}

void RangeNode::do_take(const hal::ReceivedCanFrame& received) {
  const hal::CanFrame& frame = received.frame;
  if (frame.extended || frame.remote || frame.id != canopen::kNmtId || frame.length != 2) return;
  if (frame.data[1] != 0 && frame.data[1] != node_) return;
  switch (static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::kStart:
      nmt_ = NmtState::kOperational;
      break;
    case NmtCommand::kStop:
      nmt_ = NmtState::kStopped;
      break;
    case NmtCommand::kEnterPreOperational:
      nmt_ = NmtState::kPreOperational;
      break;
    case NmtCommand::kResetNode:
    case NmtCommand::kResetCommunication:
      nmt_ = NmtState::kBootUp;
      break;
  }
}

}  // namespace armsig::simulated
