// SPDX-License-Identifier: MIT
// What an emulated drive makes of its dictionary.
#include "hal/simulated/drive.hpp"

namespace armsig::simulated {
namespace {

ProfileObjects profile_objects(const DriveDictionary& dictionary) {
  return {.speed = static_cast<double>(dictionary.get(0x6081)),
          .acceleration = static_cast<double>(dictionary.get(0x6083)),
          .deceleration = static_cast<double>(dictionary.get(0x6084))};
}

HomingObjects homing_objects(const DriveDictionary& dictionary) {
  return {.offset = static_cast<std::int32_t>(dictionary.get(0x607C)),
          .method = static_cast<std::int8_t>(dictionary.get(0x6098)),
          .fast = static_cast<double>(dictionary.get(0x6099, 1)),
          .slow = static_cast<double>(dictionary.get(0x6099, 2))};
}

}  // namespace

void Drive::restore_dictionary() {
  dictionary_.restore();
  const auto ramp = static_cast<std::uint32_t>(configuration_.motion.stop_deceleration);
  dictionary_.set(0x6081, 0, static_cast<std::uint32_t>(configuration_.motion.largest_speed));
  dictionary_.set(0x6083, 0, ramp);
  dictionary_.set(0x6084, 0, ramp);
  dictionary_.set(0x6085, 0, static_cast<std::uint32_t>(ramp / configuration_.ramp_unit));
  if (configuration_.home_speed > 0) {
    constexpr std::uint32_t kNegativeLimitSwitch = 17;
    constexpr double kToTheEdge = 0.1;  // of the speed to the switch
    const double speed = configuration_.home_speed;
    dictionary_.set(0x6098, 0, kNegativeLimitSwitch);
    dictionary_.set(0x6099, 1, static_cast<std::uint32_t>(speed));
    dictionary_.set(0x6099, 2, static_cast<std::uint32_t>(kToTheEdge * speed));
  }
  if (set_) dictionary_.set(set_->index, set_->subindex, set_->value);
  read_settings();
}

void Drive::read_settings() {
  using std::chrono::milliseconds;
  constexpr std::uint32_t kLastSynchronousType = 240;
  const auto on_sync = [&](std::uint16_t parameter) {
    const std::uint32_t type = dictionary_.get(parameter, 2);
    return type > 0 && type <= kLastSynchronousType;
  };
  const std::uint32_t consumer = dictionary_.get(0x1016, 1);
  // Few drives have these.
  const auto value = [&](std::uint16_t index, std::uint8_t subindex) {
    return dictionary_.has(index, subindex) ? dictionary_.get(index, subindex) : 0;
  };
  const std::uint32_t life_ms = value(0x100C, 0) * value(0x100D, 0);
  hal::Duration unit = std::chrono::seconds(1);
  for (auto exponent = static_cast<std::int8_t>(dictionary_.get(0x60C2, 2)); exponent < 0;
       ++exponent) {
    unit /= 10;
  }
  settings_ = {.receive_pdo = dictionary_.get(0x1400, 1),
               .transmit_pdo = dictionary_.get(0x1800, 1),
               .receives_on_sync = on_sync(0x1400),
               .transmits_on_sync = on_sync(0x1800),
               .master = static_cast<std::uint8_t>((consumer >> 16) & 0x7F),
               .master_timeout = milliseconds(consumer & 0xFFFF),
               .command_timeout = milliseconds(value(0x1400, 5)),
               .life_time = milliseconds(life_ms),
               .heartbeat = milliseconds(dictionary_.get(0x1017)),
               .stops = {.quick_stop = static_cast<std::uint16_t>(dictionary_.get(0x605A)),
                         .shutdown = static_cast<std::uint16_t>(dictionary_.get(0x605B)),
                         .disable_operation = static_cast<std::uint16_t>(dictionary_.get(0x605C)),
                         .fault_reaction = static_cast<std::uint16_t>(dictionary_.get(0x605E)),
                         .deceleration = static_cast<double>(dictionary_.get(0x6084)),
                         .quick_deceleration = configuration_.ramp_unit * dictionary_.get(0x6085)},
               .following_window = dictionary_.get(0x6065),
               .following_timeout = milliseconds(dictionary_.get(0x6066)),
               .period = unit * dictionary_.get(0x60C2, 1),
               .offset = static_cast<std::int32_t>(dictionary_.get(0x60B0)),
               .mode = static_cast<std::uint8_t>(dictionary_.get(0x6060)),
               .homing = homing_objects(dictionary_),
               .profile = profile_objects(dictionary_)};
}

}  // namespace armsig::simulated
