// SPDX-License-Identifier: MIT
// The drives of all joints of one arm, commanded and read together once a tick.
//
// The tick calls read() first and write() last. A request (enable, ...) is remembered and carried
// out over the following ticks; status() tells when it is done. If one drive faults while any is
// enabled, the backend itself takes all of them to quick stop: the controller learns of it, it need
// not be alive for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "hal/clock.hpp"
#include "hal/device_object.hpp"
#include "hal/drive_identity.hpp"

namespace armsig::hal {

// An image with little memory has no modes but cyclic synchronous position (nothing of homing,
// interpolated or profile position), hears no torque, does not wait for drives that are late, and
// has fewer words.
#ifdef ARMSIG_SMALL_IMAGE
inline constexpr bool kSmallImage = true;
#else
inline constexpr bool kSmallImage = false;
#endif
inline constexpr bool kOtherModes = !kSmallImage;
inline constexpr bool kMayHome = !kSmallImage;
inline constexpr bool kTellsTorque = !kSmallImage;

// What a motor gives, as a share of its rated torque; empty: its drive does not tell. An image that
// hears no torque keeps no memory for it.
struct UntoldTorque {
  constexpr explicit operator bool() const { return false; }
  constexpr double operator*() const { return 0; }
};
using Torque = std::conditional_t<kTellsTorque, std::optional<double>, UntoldTorque>;

enum class DriveCondition : std::uint8_t {
  kStarting,   // being found and set up
  kDisabled,   // set up, without torque
  kSwitching,  // on the way from one of the other conditions to another
  kEnabled,    // follows the targets
  kHoming,     // moves by itself, to find its reference
  kStopping,   // on its quick stop ramp, still moving
  kStopped,    // quick stop: at rest under torque, targets are ignored
  kFaulted,    // as `fault` says; left by reset_faults() only
};

struct DriveStatus {
  DriveCondition condition = DriveCondition::kStarting;
  std::optional<Error> fault;    // the first cause, kept until reset_faults()
  std::uint32_t fault_code = 0;  // the device's own: CANopen emergency or SDO abort code; 0: none
  DeviceObject fault_object;     // the object that was in the way, if one was
  // What fault_code means, by the device's protocol, or which bus fails; of static storage.
  std::string_view words;
  std::uint16_t status_word = 0;  // the device's own, for the log
  bool limit_active = false;      // the drive limits the motion by itself
  bool warning = false;           // the drive warns
  bool has_torque = false;        // as far as the device told last
  // It keeps its torque when its master is gone, as far as it told while it was set up.
  bool unsupervised = false;
  bool has_position = false;  // it has told its position since it was set up last
  bool homed = false;         // it has found its reference since it was set up last
  [[no_unique_address]] Torque torque = {};
  // Last emergency code that stopped nothing: it told no error, or came before the drive was
  // started; 0: none. And what it means, of static storage.
  std::uint32_t information = 0;
  std::string_view information_words = {};
  [[no_unique_address]] DeviceDetails fault_details = {};  // of the emergency of fault_code
  [[no_unique_address]] DeviceDetails information_details = {};
};

class JointDrives {
 public:
  [[nodiscard]] std::size_t count() const { return do_count(); }

  // Takes in what the drives said since the last tick, supervises them, starts a new cycle. Bounded
  // work, never blocks.
  // Errors: kBusDown, kBusOff; everything about one drive is in its status().
  Result<void> read(Instant now) { return do_read(now); }

  // Actual positions at the last cycle, radians or metres, one per joint; without meaning where the
  // status says that the drive has not told its position.
  [[nodiscard]] const JointVector& positions() const { return do_positions(); }
  [[nodiscard]] DriveStatus status(std::size_t joint) const;

  // Which drive it is, and how it counts; empty until it has told, while it is being set up.
  [[nodiscard]] std::optional<DriveIdentity> identity(std::size_t joint) const;

  // What a drive that was set up has otherwise than wanted and goes without, one after the other;
  // empty beyond the last.
  [[nodiscard]] std::optional<DeviceObject> gap(std::size_t joint, std::size_t number) const;

  // True if every drive has the condition.
  [[nodiscard]] bool all(DriveCondition condition) const;

  // Sends `targets` (count() values, radians or metres) to the drives once all are enabled. A drive
  // that is not enabled is sent its actual position, so that enabling never makes it jump; one that
  // is enabled before the others holds the position at which it was. After an error the former
  // targets are sent again, so that the cycle is kept.
  // Errors: kNotFinite, kJointLimit (outside the configured limits), kTargetStep, kBusDown,
  // kBusOff, kBusBusy.
  Result<void> write(const JointVector& targets, Instant now);

  // Errors: kDrivesNotReady (a drive is being set up, or faulted), kDriveUnsupervised (one would
  // keep its torque without its master, which the configuration does not know).
  Result<void> enable() { return do_enable(); }
  // Brings every drive to rest on its ramp; the torque goes when all positions stand, or when the
  // time that the ramps may take is over. No errors.
  void disable() { do_disable(); }
  // Stops every drive on its quick stop ramp and holds it there. No errors.
  void quick_stop() { do_quick_stop(); }
  // Lets one drive find its reference by its own homing, while the others hold their positions: its
  // condition is kHoming until it follows targets again, from where it then is. Its reading may
  // jump meanwhile. One that does not find it has the fault kHomingFailed.
  // Errors: kDrivesNotReady (not every drive is kEnabled), kUnsupported.
  Result<void> home(std::size_t joint);
  // Brings a drive that is homing to rest, to follow targets again. No errors.
  void stop_homing() { do_stop_homing(); }
  // Forgets faults, resets faulted drives and sets up those that were lost, as soon as all
  // positions stand (as for disable()); all end disabled. No errors: a fault that persists comes
  // back in status().
  void reset_faults() { do_reset_faults(); }

 protected:
  ~JointDrives() = default;

 private:
  [[nodiscard]] virtual std::size_t do_count() const = 0;
  virtual Result<void> do_read(Instant now) = 0;
  [[nodiscard]] virtual const JointVector& do_positions() const = 0;
  [[nodiscard]] virtual DriveStatus do_status(std::size_t joint) const = 0;
  // A backend that cannot tell its drives apart says nothing of them.
  [[nodiscard]] virtual std::optional<DriveIdentity> do_identity(std::size_t /*joint*/) const {
    return DriveIdentity{};
  }
  [[nodiscard]] virtual std::optional<DeviceObject> do_gap(std::size_t /*joint*/,
                                                           std::size_t /*number*/) const {
    return std::nullopt;
  }
  virtual Result<void> do_write(const JointVector& targets, Instant now) = 0;
  virtual Result<void> do_enable() = 0;
  virtual void do_disable() = 0;
  virtual void do_quick_stop() = 0;
  virtual void do_reset_faults() = 0;
  // A backend whose drives have no homing of their own does nothing.
  virtual Result<void> do_home(std::size_t /*joint*/) {
    return std::unexpected(Error::kUnsupported);
  }
  virtual void do_stop_homing() {}
};

}  // namespace armsig::hal
