// SPDX-License-Identifier: MIT
// What the tick does about drives that are not there yet, and what it tells of each drive.
#include "firmware/controller/servo.hpp"

namespace armsig::controller {
namespace {

bool is_of_bus(Error error) { return error == Error::kBusDown || error == Error::kBusOff; }

// Which of two buses it is that fails; empty where there is one.
std::string_view words_of_bus(const hal::JointDrives& drives) {
  for (std::size_t joint = 0; joint < drives.count(); ++joint) {
    const hal::DriveStatus status = drives.status(joint);
    const bool names_bus = !status.fault || is_of_bus(*status.fault);
    if (names_bus && !status.words.empty()) return status.words;
  }
  return {};
}

// Every drive of a bus has it, and it is none of theirs.
bool is_of_all(Error error) {
  return is_of_bus(error) || error == Error::kBusBusy || error == Error::kSecondMaster;
}

}  // namespace

// An interface that is late, or a drive that does not answer yet: nothing has torque by us, and the
// drives are looked for until they are there. Meanwhile the reason stands as the fault.
void Servo::wait_for_drives(const Result<void>& read) {
  std::optional<Fault> waits;
  bool bus_is_back = false;
  if (!read) waits = Fault{read.error(), {}, 0, words_of_bus(drives_)};
  for (std::size_t joint = 0; joint < drives_.count(); ++joint) {
    const std::optional<Error> fault = drives_.status(joint).fault;
    if (!fault) continue;
    if (is_of_bus(*fault)) {
      bus_is_back = read.has_value();
    } else if (*fault == Error::kDriveAbsent) {
      if (!waits) waits = Fault{*fault, joint, 0, {}};
    } else {
      supervise_drives();
      return;
    }
  }
  if (bus_is_back) drives_.reset_faults();
  fault_ = waits;
}

// What the drives tell beside numbers.
void Servo::publish_words() {
  auto& faults = link_.faults.writing();
  auto& information = link_.information.writing();
  faults.clear();
  information.clear();
  for (std::size_t joint = 0; joint < drives_.count() && !faults.full(); ++joint) {
    const hal::DriveStatus status = drives_.status(joint);
    if (status.fault && !is_of_all(*status.fault)) {
      faults.push_back({*status.fault, joint, status.fault_code, status.words, status.fault_object,
                        status.fault_details});
    }
    if (status.information != 0) {
      information.push_back({static_cast<std::uint8_t>(joint), status.information,
                             status.information_words, status.information_details});
    }
  }
  if (!information.empty()) link_.information.publish();
  if (faults.empty() && !faults_told_) return;
  faults_told_ = !faults.empty();
  link_.faults.publish();
}

}  // namespace armsig::controller
