// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/send.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <fmt/core.h>

#include "core/calibration/packed_deflections.hpp"
#include "firmware/controller/receiving.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/commands/next_step.hpp"
#include "firmware/host_tool/console/fetching.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

// Angles in rad and lengths in m: what a file loses by its decimals is far below, what a drawing
// differs by far above.
constexpr double kSame = 1e-9;

// The first row in which two drawings differ, in words; empty: they are one.
std::string difference(const Arm& file, const Arm& controller) {
  if (file.joints.size() != controller.joints.size()) {
    return fmt::format("{} joints, the controller has {}", file.joints.size(),
                       controller.joints.size());
  }
  for (std::size_t i = 0; i < file.joints.size(); ++i) {
    const DhJoint& a = file.joints[i];
    const DhJoint& b = controller.joints[i];
    if (a.type != b.type)
      return fmt::format("joint {} is revolute in one and prismatic in the other", i + 1);
    const auto off = [](double x, double y) { return std::abs(x - y) > kSame; };
    for (const auto& [name, x, y] :
         {std::tuple{"theta_rad", a.theta_rad, b.theta_rad}, std::tuple{"d_m", a.d_m, b.d_m},
          std::tuple{"a_m", a.a_m, b.a_m}, std::tuple{"alpha_rad", a.alpha_rad, b.alpha_rad}}) {
      if (off(x, y)) {
        return fmt::format("{} of joint {} of its nominal model is {}, the controller's {}", name,
                           i + 1, x, y);
      }
    }
  }
  return {};
}

}  // namespace

Read<controller::SignatureRecord> controller_record(const SignatureRecord& file, const Arm& drawing,
                                                    const std::string& path) {
  const auto refused = [&](std::string what, std::string expected) {
    return std::unexpected(Problem{path, 0, 0, std::move(what), std::move(expected)});
  };
  if (std::string other = difference(file.nominal, drawing); !other.empty()) {
    return refused(std::move(other),
                   "a signature of this controller's arm, found with the nominal model "
                   "that fetch --what nominal writes");
  }
  if (!file.nominal.couplings.empty()) {
    return refused("a signature with a coupling",
                   "one found from the controller's log: its readings are those of the joints");
  }
  if (!file.corrections.empty()) {
    return refused("a signature with corrections of the readings",
                   "one without (identify --correct none): a controller's record holds none");
  }
  const Signature& signature = file.signature;
  const auto hand = std::ranges::find(signature.targets, signature.joint_count(), &Target::link);
  if (hand == signature.targets.end()) {
    return refused("no target on the flange", "the target that the controller's sensor sees");
  }
  controller::SignatureRecord record;
  record.signature = signature;
  record.air_celsius = file.air_c.value_or(0);
  record.accuracy = file.accuracy;
  const auto* const method = std::ranges::find(controller::kMethods, file.method);
  record.method = static_cast<controller::Method>(method - controller::kMethods.begin());
  if (file.deflections != nullptr) {
    record.deflections = calibration::packed(*file.deflections);
    if (!calibration::check(record.deflections, drawing)) {
      return refused("maps or gravity by which a reading could jump",
                     "geometry alone (identify --method encoder)");
    }
  }
  record.machine.drawing_crc = controller::told_drawing_crc(drawing);
  return record;
}

int send(ConsoleClient& console, const FetchOptions& options) {
  const auto file = read_signature_file(options.file);
  if (!file) return fail(file.error(), kBadInput, options);
  Fetcher fetcher(console, options.console, options.longest);
  const auto drawing = fetcher.drawing();
  if (!drawing) return fail(drawing.error(), kNoAnswer, options);
  const auto record = controller_record(*file, *drawing, options.file);
  if (!record) return fail(record.error(), kBadInput, options);
  if (auto sent = fetcher.deliver(controller::encode(*record), options.by); !sent) {
    return fail(sent.error(), kNoAnswer, options);
  }
  if (options.json) {
    print_json({{"status", 0}, {"sent", options.file}, {"joints", drawing->joints.size()}});
  } else {
    say("Sent: {}, a candidate of {}; nothing is in use yet. The comparison moves the arm "
        "to\n"
        "validation poses; a candidate that is nearer to them can be accepted\n",
        options.file, counted(drawing->joints.size(), "joint"));
    say_next(TypedCommand("connect").file(options.console).word("compare").word("--wait"));
  }
  return kDone;
}

}  // namespace armsig::tool
