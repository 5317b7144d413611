// SPDX-License-Identifier: MIT
// The set-up of one drive as it goes, without any bus: what is to be asked next, what the answer
// means, and what the drive goes without in the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/fixed_vector.hpp"
#include "hal/cia402/factors.hpp"
#include "hal/cia402/setup.hpp"
#include "hal/device_object.hpp"

namespace armsig::cia402 {

// Why a drive is not set up.
struct SetupRefusal {
  Error error = Error::kSdoTimeout;
  std::uint32_t code = 0;  // the drive's own: an abort code, or the value found
  hal::DeviceObject object;
};

// What a drive that passed has otherwise than wanted.
struct SetupReport {
  static constexpr std::size_t kMostGaps = hal::kOtherModes ? 16 : 14;

  FixedVector<hal::DeviceObject, kMostGaps> gaps;  // found is empty where it lacks the object
  // Its master: by heartbeat (1016h), RPDO time-out (1400h:5), or being guarded by it (100Ch).
  bool watches = false;
  bool guarded = false;     // it says that it is there only where it is asked to
  bool stops = false;       // where it misses it (6007h)
  bool hides_mode = false;  // does not show yet the mode that it was told (6061h)

  // Its torque goes when its master is gone.
  [[nodiscard]] bool is_supervised() const { return watches && stops; }
};

class SetupRun {
 public:
  // From the first step on. `settings` must outlive the run.
  void begin(const Setup& setup, const DriveSettings& settings);
  // What to ask or tell the drive now; empty: the set-up is over.
  [[nodiscard]] std::optional<ObjectRequest> request() const;
  // The answer to that; why the drive is refused, if it is. Errors: as judge(), kScaleInvalid,
  // kPositionOverflow.
  [[nodiscard]] std::optional<SetupRefusal> take(const ObjectOutcome& outcome);
  [[nodiscard]] const SetupReport& report() const { return report_; }

 private:
  enum class Stage : std::uint8_t { kRead, kWrite, kVerify };

  [[nodiscard]] bool reads_first() const;
  std::optional<SetupRefusal> take_setting(const SetupStep& step, const ObjectOutcome& outcome);
  std::optional<SetupRefusal> settle(const SetupStep& step);
  void note(std::uint16_t index);
  std::optional<SetupRefusal> pass();
  std::optional<SetupRefusal> prepare();
  [[nodiscard]] SetupRefusal refusal(Error error, std::uint32_t code) const;

  Setup setup_;
  const DriveSettings* settings_ = nullptr;
  std::size_t at_ = 0;
  Stage stage_ = Stage::kRead;
  std::optional<std::uint32_t> found_;  // by the setting under way
  std::uint32_t abort_ = 0;             // of its write
  bool has_guard_time_ = false;
  bool weighed_ = false;  // the factors were, against what is configured
  DriveFactors factors_;
  SetupReport report_;
};

}  // namespace armsig::cia402
