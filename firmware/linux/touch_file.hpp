// SPDX-License-Identifier: MIT
// The file of the touches that a person makes (docs/formats.md), and what is left of a plan. Both
// files are read anew each time: a person may put others in their places meanwhile.
#pragma once

#include <cstddef>
#include <expected>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "firmware/formats/touches.hpp"

namespace armsig::daemon {

using tool::is_place_name;
using tool::kLongestPlace;
using tool::kPlaceExpected;

struct TouchFiles {
  std::string file;  // empty: no touches are taken
  std::string plan;  // of `armsig plan --instrument`; empty: there is none
};

inline constexpr std::size_t kMostTouches = 1000;  // of one file; a plan has 200 at most
inline constexpr std::size_t kMostPlaces = 32;     // so that a reply names them all

struct TouchRefusal {
  Error error = Error::kStorageFault;
  std::string why;  // without double quotes
};
// Values of a reply: ` touches=13 left=67 next=B2`.
using Told = std::expected<std::string, TouchRefusal>;

// For a thread that may wait for a disk. A change is on the disk, whole, or it was not made.
class TouchFile {
 public:
  TouchFile(TouchFiles files, const JointTypes& types) : files_(std::move(files)), types_(types) {}

  // Appends a touch. `readings` are the encoders': couplings not applied. The file is made where it
  // is not there. Errors: kOutOfRange (no name of a place, or none of the plan), kCapacityExceeded,
  // kStorageFault (also of a file that is not of this arm).
  [[nodiscard]] Told add(std::string_view place, const JointVector& readings) const;
  // Takes the last one out. Errors: kWrongMode (there is none), kStorageFault.
  [[nodiscard]] Told drop() const;
  // How many there are by place, and of how many: ` touches=13 places=A1:3/10,A2:10/10`. Errors:
  // kCapacityExceeded, kStorageFault.
  [[nodiscard]] Told tell() const;

 private:
  TouchFiles files_;
  JointTypes types_;
};

}  // namespace armsig::daemon
