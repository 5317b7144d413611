// SPDX-License-Identifier: MIT
#include "firmware/controller/check_keeper.hpp"

#include "firmware/controller/little_endian.hpp"
#include "firmware/controller/pose_visit.hpp"

namespace armsig::controller {
namespace {

CheckSubject subject_of(const CheckMemory::Context& context) {
  PartWriter poses({}, 0);
  for (std::size_t i = 0; i < context.configuration.check.poses; ++i) {
    for (const double q : spread_pose(context.configuration, i)) poses.real(q);
  }
  return {.record_crc = context.record_crc, .poses_crc = poses.crc()};
}

}  // namespace

void CheckKeeper::recall_as(const Context& context, CheckState& state) {
  const auto recalled = read(subject_of(context), state);
  if (recalled && *recalled == Recalled::kNothing) return;
  Line line;
  line.text("# check history ");
  if (recalled && *recalled == Recalled::kEverything) {
    line.text("recalled learnt=").integer(static_cast<std::uint64_t>(state.learnt));
    context.announcer.say(line.text(" of=").integer(static_cast<std::uint64_t>(kCheckBaseline)));
    return;
  }
  line.text("unused");
  if (!recalled) {
    line.reason(recalled.error());
  } else {
    line.text(*recalled == Recalled::kOtherPoses ? " of=\"other poses\""
                                                 : " of=\"another signature\"");
  }
  context.announcer.say(line.text("; the reference is learnt anew"));
}

void CheckKeeper::keep_as(const Context& context, const CheckState& state) {
  if (const auto kept = write(subject_of(context), state); !kept) {
    context.announcer.say(Line().text("# check history not kept").reason(kept.error()));
  }
}

}  // namespace armsig::controller
