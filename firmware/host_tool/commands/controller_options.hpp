// SPDX-License-Identifier: MIT
// What a command is told of the controller that the arm has: its nominal model, base and flange.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

struct ControllerOptions {
  std::string model, base, flange;

  // The nominal model that the controller computes with.
  [[nodiscard]] Read<Arm> nominal_model(const SignatureRecord& record) const;
  // Its base in frame 0 of that model.
  [[nodiscard]] Read<Pose> base_in_frame_0() const;
  // Its flange in the last frame of that model.
  [[nodiscard]] Read<Pose> flange_in_last_frame() const;
};

// --controller-model, --base and --flange.
void add_controller_options(CLI::App& command, ControllerOptions& options);

}  // namespace armsig::tool
