// SPDX-License-Identifier: MIT
// An emulated CiA 402 servo drive in the position modes and in homing mode, as a device on any CAN
// bus: network management, SDO server, mapped PDOs, heartbeats both ways, the power state
// machine, motion with following error, and faults on command. Written from the standard's device
// side, apart from the master, so that each checks the other.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/canopen/protocol.hpp"
#include "hal/simulated/can_device.hpp"
#include "hal/simulated/drive_dictionary.hpp"
#include "hal/simulated/drive_homing.hpp"
#include "hal/simulated/drive_motion.hpp"
#include "hal/simulated/drive_power.hpp"
#include "hal/simulated/drive_profile.hpp"

namespace armsig::simulated {

struct DriveConfiguration {
  std::uint8_t node = 1;
  // Each axis of a device with several is one of these, on a port of its own: the first one says
  // what the node says.
  DeviceAxis axis{};
  std::uint32_t serial = 0;          // of the identity object; 0: not told
  std::uint32_t encoder_counts = 0;  // a motor revolution, of the factor group; 0: it has none
  MotionConfiguration motion{};
  hal::Duration boot_time = std::chrono::milliseconds(5);
  // SYNC periods that may be missing while enabled, before emergency 8700h; 0: not watched.
  unsigned sync_loss_periods = 5;
  bool tells_rest = false;       // statusword bit 10 in Quick stop active, once at rest
  hal::Duration answer_delay{};  // from SYNC to TPDO1, at least
  // Most that a TPDO1 comes later than that: anew at every SYNC, the same for the same node.
  hal::Duration answer_jitter{};
  // Objects that it has otherwise than the emulated drive; to outlive the drive.
  std::span<const ObjectEdit> edits{};
  double ramp_unit = 1;                 // counts/s^2 in a unit of 6085h
  bool shows_mode_late = false;         // 6061h follows 6060h in Operation enabled only
  bool boots_quietly = false;           // no boot-up message after a reset of the communication
  bool counts_anew = false;             // from zero after every power-up, until it has homed
  std::optional<double> home_switch{};  // where it homes, in counts of the motor
  double home_speed = 0;                // counts/s, of 6099h:1; 0: as the dictionary has it
};

// A drive as they are: honest_motion(), bit 10, an answer 200 us to 400 us after SYNC.
[[nodiscard]] DriveConfiguration honest_drive(std::uint8_t node, double counts_per_radian);
// Of a slide: honest_slide().
[[nodiscard]] DriveConfiguration honest_slide_drive(std::uint8_t node, double counts_per_metre);

// Lets it count from zero at every power-up, until it has homed: by method 17, at `speed`
// [counts/s], at a switch that stands where it would count zero.
void let_home(DriveConfiguration& drive, double speed);

// Faults on command.
enum class DriveFault : std::uint8_t {
  kNone,            // all well again, as far as the command caused it
  kEmergency,       // emergency with the code given, drive goes to Fault
  kSilent,          // sends and hears nothing, as with the cable pulled; the drive itself goes on
  kHeartbeatLost,   // only the heartbeats cease
  kFeedbackLost,    // only TPDO1 ceases
  kBlocked,         // the motor cannot turn
  kPowerRemoved,    // safe torque off: back to Switch on disabled without an emergency
  kReboot,          // power-up anew
  kDeaf,            // controlwords are ignored
  kPositionJump,    // the reported position is off by `code` counts from now on
  kPreOperational,  // leaves the NMT state Operational
  kSdoSilent,       // SDO requests are not answered
  kSyncLost,        // hears no SYNC
  kIgnoresTargets,  // stands still in Operation enabled, bit 12 clear
  kBitsClear,       // the bits in `code` are clear in every statusword
  kBitsSet,         // they are set
  kInformation,     // an emergency with `code` and no bit in its error register; nothing else
};

// Whether it befalls a device with all its axes.
[[nodiscard]] constexpr bool concerns_node(DriveFault fault) {
  return fault == DriveFault::kNone || fault == DriveFault::kSilent ||
         fault == DriveFault::kHeartbeatLost || fault == DriveFault::kReboot ||
         fault == DriveFault::kPreOperational || fault == DriveFault::kSdoSilent;
}

class Drive final : public CanDevice {
 public:
  // Powered up at `now`. `bus` must outlive the drive.
  Drive(const DriveConfiguration& configuration, hal::CanBus& bus, hal::Instant now = {});
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;

  // Motor position in counts, exact where the encoder rounds.
  [[nodiscard]] double position() const { return motion_.state().position; }
  [[nodiscard]] double velocity() const { return motion_.state().velocity; }
  // Where the joint is beyond the play, in counts of the motor.
  [[nodiscard]] double joint_position() const { return motion_.state().joint; }
  [[nodiscard]] bool has_torque() const { return motion_.state().mode != Drivetrain::kBraked; }
  [[nodiscard]] cia402::State state() const { return power_.state(); }
  [[nodiscard]] canopen::NmtState nmt_state() const { return nmt_; }
  [[nodiscard]] const DriveDictionary& dictionary() const { return dictionary_; }

  void inject(DriveFault fault, std::int32_t code = 0);
  // What another tool stored in the drive: its value now, and after every reset.
  void set_object(std::uint16_t index, std::uint8_t subindex, std::uint32_t value) {
    set_ = SetObject{index, subindex, value};
    dictionary_.set(index, subindex, value);
  }
  // counts/s^2 that pull at the motor in the pose that the arm has now.
  void set_gravity(double gravity) { motion_.set_gravity(gravity); }
  // Somebody leans on the joint.
  void push(double counts) { motion_.push(counts); }

 private:
  void do_advance(hal::Instant until) override;
  void do_take(const hal::ReceivedCanFrame& received) override;

  // What the drive needs of its dictionary in every cycle, taken from it after each SDO.
  struct Settings {
    std::uint32_t receive_pdo = 0;  // 1400h:01
    std::uint32_t transmit_pdo = 0;
    bool receives_on_sync = false;  // by 1400h:02
    bool transmits_on_sync = false;
    std::uint8_t master = 0;  // 1016h:01
    hal::Duration master_timeout{};
    hal::Duration command_timeout{};  // 1400h:05
    hal::Duration life_time{};        // 100Ch times 100Dh
    hal::Duration heartbeat{};        // 1017h
    StopObjects stops;
    std::uint32_t following_window = 0;
    hal::Duration following_timeout{};
    hal::Duration period{};   // 60C2h
    std::int32_t offset = 0;  // 60B0h
    std::uint8_t mode = 0;    // 6060h
    HomingObjects homing;
    ProfileObjects profile;
  };

  struct SetObject {
    std::uint16_t index = 0;
    std::uint8_t subindex = 0;
    std::uint32_t value = 0;
  };

  void restore_dictionary();
  void read_settings();
  [[nodiscard]] std::uint16_t status_word() const;
  void answer_sync();
  void send(const hal::CanFrame& frame);
  [[nodiscard]] bool speaks_for_node() const { return configuration_.axis.is_first(); }
  void send_emergency(std::uint16_t code);
  void send_emergency(std::uint16_t code, std::uint8_t error_register);
  void fail(std::uint16_t code);
  void reset(bool whole_device);
  void enter(canopen::NmtState state);
  void take_nmt(const hal::CanFrame& frame);
  void take_sync();
  void take_receive_pdo(const hal::CanFrame& frame);
  void apply_receive_pdo();
  void step_homing();
  void step_profile();
  void follow(double target);
  [[nodiscard]] bool interpolates() const;
  [[nodiscard]] bool is_in(std::uint8_t mode) const {
    return settings_.mode == mode && power_.state() == cia402::State::kOperationEnabled;
  }
  void take_masters_heartbeat(std::uint8_t node);
  void supervise();
  void miss_master(std::uint16_t code);
  void take_guarding();
  void supervise_following();
  void publish();
  [[nodiscard]] bool operational() const { return nmt_ == canopen::NmtState::kOperational; }

  DriveConfiguration configuration_;
  hal::CanBus* bus_;
  DriveDictionary dictionary_;
  Settings settings_;
  DriveMotion motion_;
  DrivePower power_;
  DriveHoming homing_;
  DriveProfile profile_;
  double origin_ = 0;  // where it counts zero, in counts of the motor
  canopen::NmtState nmt_ = canopen::NmtState::kBootUp;
  hal::Instant now_;
  hal::Instant boot_at_;
  bool tells_boot_up_ = true;
  hal::Instant next_heartbeat_;
  std::optional<hal::Instant> master_heard_;
  std::optional<hal::Instant> commanded_at_;
  std::optional<hal::Instant> guarded_at_;
  bool guard_toggle_ = false;
  std::optional<hal::Instant> sync_at_;
  std::optional<hal::Instant> error_since_;  // following error beyond its window
  std::optional<hal::CanFrame> pending_pdo_;
  std::optional<hal::Instant> answer_at_;
  DriveFault fault_ = DriveFault::kNone;
  std::optional<SetObject> set_;
  std::int32_t jump_ = 0;
  std::uint32_t jitter_ = 0;  // last number drawn for answer_jitter
  std::uint16_t bits_ = 0;    // of kBitsClear and kBitsSet
};

}  // namespace armsig::simulated
