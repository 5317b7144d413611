// SPDX-License-Identifier: MIT
// The file of LinuxCNC's kinematics module: any lines, rightly sealed, are refused in words or give
// an arm that can be asked for any pose.
#include <cmath>

#include "core/base/crc32.hpp"
#include "firmware/linuxcnc/kins.hpp"
#include "firmware/linuxcnc/kins_file.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

void fuzz_kins(Bytes bytes) {
  std::string text(text_of(bytes).substr(0, linuxcnc::kLargestKinsFile));
  std::array<char, 32> seal{};
  std::snprintf(seal.data(), seal.size(), "crc32 0x%08X\n",
                crc32(std::as_bytes(std::span(text.data(), text.size()))));
  text += seal.data();
  const auto model = linuxcnc::parse_kins(text);
  if (!model) {
    FUZZ_CHECK(!model.error().what.empty());
    return;
  }
  const linuxcnc::Kins kins(*model, model->X_nL.p);
  std::array<double, kMaxJoints> joints{};
  for (std::size_t i = 0; i < kins.joint_count(); ++i) joints[i] = 10.0 * static_cast<double>(i);
  linuxcnc::WorldPose world;
  if (!kins.forward(joints, world)) return;
  FUZZ_CHECK(world.p_mm.allFinite() && world.abc_deg.allFinite());
  world.p_mm.x() += 1;
  (void)kins.inverse(world, joints);
  for (const double joint : joints) FUZZ_CHECK(std::isfinite(joint));
}

constexpr std::array kTargets{Target{"linuxcnc_kins", fuzz_kins}};

}  // namespace

std::span<const Target> linuxcnc_targets() { return kTargets; }

}  // namespace armsig::fuzz
