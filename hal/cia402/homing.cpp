// SPDX-License-Identifier: MIT
// A drive that finds its reference by itself: CiA 402-2, homing mode.
#include "hal/cia402/drive.hpp"

namespace armsig::cia402 {
namespace {

// A statusword that tells at once that the reference is found may still be about a search before.
// Methods that take the place where the drive stands need less than this.
constexpr hal::Duration kStaleStatus = std::chrono::milliseconds(200);

}  // namespace

void Drive::enter_homing(Homing stage, hal::Instant now) {
  s_.homing = stage;
  s_.progress_at = now;
  if (stage == Homing::kEntering) s_.homed = false;
}

void Drive::search(hal::Instant now) {
  s_.searched = false;
  enter_homing(Homing::kSearching, now);
}

void Drive::leave_homing(hal::Instant now) {
  if (s_.homing == Homing::kEntering || s_.homing == Homing::kSearching) {
    enter_homing(Homing::kLeaving, now);
  }
}

void Drive::end_homing(hal::Instant now) {
  enter_homing(Homing::kNone, now);
  s_.arrived = false;
  hide_mode();
}

// Found: bits 10 and 12 set; given up: bit 13 set.
void Drive::check_homing(const GroupSettings& settings, hal::Instant now) {
  if (s_.homing != Homing::kSearching || s_.state != State::kOperationEnabled) return;
  constexpr std::uint16_t kFound = kStatusHomingAttained | kStatusTargetReached;
  const bool says_found = (s_.status_word & kFound) == kFound;
  s_.searched = s_.searched || !says_found;
  const hal::Duration searching = now - s_.progress_at;
  const bool gave_up = (s_.status_word & kStatusHomingError) != 0 && searching > kStaleStatus;
  if (gave_up || searching > settings.homing_timeout) {
    latch(Error::kHomingFailed, s_.status_word);
  } else if (says_found && s_.stands && (s_.searched || searching > kStaleStatus)) {
    s_.homed = true;
    enter_homing(Homing::kLeaving, now);
  }
}

}  // namespace armsig::cia402
