// SPDX-License-Identifier: MIT
#include "firmware/controller/custody.hpp"

namespace armsig::controller {

void Custody::load() {
  unused_ = acknowledged_ = false;
  difference_.reset();
  if (!active_) active_.emplace();
  const auto loaded = store_.load(drawing_, *active_);
  trouble_ = store_.trouble();
  if (loaded) {
    reject_other_machine();
    return;
  }
  active_.reset();
  if (loaded.error() == Error::kNoSignature) return;
  trouble_ = loaded.error();
  unused_ = true;
}

void Custody::compare(const Machine& found) {
  machine_ = found;
  reject_other_machine();
}

void Custody::reject_other_machine() {
  if (!active_ || !machine_) return;
  difference_ = difference(active_->machine, *machine_, Amplifiers::kIgnored);
  if (!difference_) return;
  active_.reset();
  trouble_ = Error::kRecordOtherMachine;
  unused_ = true;
}

void Custody::tell_trouble(const Announcer& announcer) const {
  if (!trouble_) return;
  Line line;
  line.text(unused_ ? "# signature unused" : "# signature store").reason(*trouble_);
  if (difference_) tell(*difference_, line);
  if (unused_) line.text(" go by the nominal model with acknowledge");
  announcer.say(line);
}

}  // namespace armsig::controller
