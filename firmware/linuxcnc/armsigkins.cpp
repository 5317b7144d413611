// SPDX-License-Identifier: MIT
// armsigkins: a kinematics module of LinuxCNC 2.9 that moves an individual arm by its signature.
//
//   [KINS]KINEMATICS = armsigkins signature=FILE [tool=N]
//
// FILE: of `armsig export --format linuxcnc-kins`. N: a target of the signature on the last link,
// whose place the poses are then of; without, they are of the last link's frame. Built against
// LinuxCNC's headers, which are under the GNU General Public License, version 2: so is the module.
#include <emcpos.h>

#include <algorithm>
#include <optional>

#include "firmware/linuxcnc/kins.hpp"
#include "firmware/linuxcnc/kins_file.hpp"

extern "C" {
#include <rtapi.h>
// After rtapi.h.
#include <hal.h>
#include <kinematics.h>
#include <rtapi_app.h>
}

using armsig::linuxcnc::Kins;
using armsig::linuxcnc::KinsAnswer;
using armsig::linuxcnc::WorldPose;

namespace {

// A unit joint rate moves the tool slower than this part of what it does at best: from there on
// `slow` is set, and `feed` falls with it, down to the least.
constexpr double kSlowBelow = 0.01;
constexpr double kLeastFeed = 0.01;

struct Pins {
  hal_bit_t* error;         // out: the pose last asked for is not met
  hal_bit_t* slow;          // out: near a singularity, joints turn fast for little motion
  hal_float_t* regularity;  // out: KinsAnswer
  hal_float_t* missed;      // out: orientation missed by fewer than six joints [deg]
  hal_float_t* feed;        // out: for motion.adaptive-feed
  hal_float_t* slow_below;  // in: the regularity that `slow` and `feed` go by
};

Pins* pins = nullptr;
std::optional<Kins> kins;
int component = -1;

WorldPose world_of(const EmcPose& pose) {
  return {{pose.tran.x, pose.tran.y, pose.tran.z}, {pose.a, pose.b, pose.c}};
}

void tell(const KinsAnswer& answer) {
  const bool failed = !answer.refusal.empty();
  if (failed && !*pins->error) {
    rtapi_print_msg(RTAPI_MSG_ERR, "armsigkins: %.*s\n", static_cast<int>(answer.refusal.size()),
                    answer.refusal.data());
  }
  *pins->error = failed;
  *pins->regularity = answer.regularity;
  *pins->missed = armsig::degrees(answer.missed_rad);
  const double below = *pins->slow_below;
  *pins->slow = answer.regularity < below;
  *pins->feed = *pins->slow ? std::max(answer.regularity / below, kLeastFeed) : 1;
}

int add_pins() {
  pins = static_cast<Pins*>(hal_malloc(sizeof(Pins)));
  if (pins == nullptr) return -1;
  *pins = {};
  const bool added =
      hal_pin_bit_newf(HAL_OUT, &pins->error, component, "armsigkins.error") == 0 &&
      hal_pin_bit_newf(HAL_OUT, &pins->slow, component, "armsigkins.slow") == 0 &&
      hal_pin_float_newf(HAL_OUT, &pins->regularity, component, "armsigkins.regularity") == 0 &&
      hal_pin_float_newf(HAL_OUT, &pins->missed, component, "armsigkins.orientation-missed") == 0 &&
      hal_pin_float_newf(HAL_OUT, &pins->feed, component, "armsigkins.feed") == 0 &&
      hal_pin_float_newf(HAL_IN, &pins->slow_below, component, "armsigkins.slow-below") == 0;
  if (!added) return -1;
  *pins->feed = 1;
  *pins->slow_below = kSlowBelow;
  return 0;
}

int refuse(const char* file, std::size_t line, std::string_view what) {
  rtapi_print_msg(RTAPI_MSG_ERR, "armsigkins: signature=%s, line %zu: %.*s\n", file, line,
                  static_cast<int>(what.size()), what.data());
  return -1;
}

}  // namespace

extern "C" {

// NOLINTBEGIN: names and types as LinuxCNC has them
static char* signature;
RTAPI_MP_STRING(signature, "file of armsig export in its format linuxcnc-kins");
static int tool;
RTAPI_MP_INT(tool, "number of a target on the last link; 0: the last link's frame");
MODULE_LICENSE("GPL");

EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsSwitchable);
EXPORT_SYMBOL(kinematicsSwitch);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);

KINEMATICS_TYPE kinematicsType(void) { return KINEMATICS_BOTH; }
int kinematicsSwitchable(void) { return 0; }
int kinematicsSwitch(int) { return -1; }

int kinematicsForward(const double* joint, EmcPose* world, const KINEMATICS_FORWARD_FLAGS*,
                      KINEMATICS_INVERSE_FLAGS*) {
  WorldPose pose;
  if (!kins->forward({joint, kins->joint_count()}, pose)) return -1;
  world->tran = {pose.p_mm.x(), pose.p_mm.y(), pose.p_mm.z()};
  world->a = pose.abc_deg.x();
  world->b = pose.abc_deg.y();
  world->c = pose.abc_deg.z();
  world->u = world->v = world->w = 0;
  return 0;
}

int kinematicsInverse(const EmcPose* world, double* joint, const KINEMATICS_INVERSE_FLAGS*,
                      KINEMATICS_FORWARD_FLAGS*) {
  const KinsAnswer answer = kins->inverse(world_of(*world), {joint, kins->joint_count()});
  tell(answer);
  return answer.refusal.empty() ? 0 : -1;
}

int rtapi_app_main(void) {
  if (signature == nullptr) return refuse("", 0, "armsigkins needs signature=FILE");
  const auto model = armsig::linuxcnc::read_kins(signature);
  if (!model) return refuse(signature, model.error().line, model.error().what);
  armsig::Vector3 p_nT = model->X_nL.p;
  if (tool != 0) {
    const auto* const point =
        std::ranges::find(model->tools, tool, &armsig::linuxcnc::ToolPoint::number);
    if (point == model->tools.end()) return refuse(signature, 0, "no tool of that number");
    p_nT = point->p_nT;
  }
  kins.emplace(*model, p_nT);
  component = hal_init("armsigkins");
  if (component < 0) return -1;
  if (add_pins() != 0) {
    hal_exit(component);
    return -1;
  }
  hal_ready(component);
  return 0;
}

void rtapi_app_exit(void) { hal_exit(component); }
// NOLINTEND

}  // extern "C"
