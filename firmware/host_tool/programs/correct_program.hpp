// SPDX-License-Identifier: MIT
// A robot program whose targets make the real arm arrive: every target replaced in its place, all
// else byte for byte as it was.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/host_tool/programs/program.hpp"
#include "firmware/library/compensation.hpp"

namespace armsig::tool {

// The controller as a program meets it.
struct ControllerView {
  const Compensation* compensation = nullptr;
  const Arm* nominal = nullptr;  // the model that the controller computes with
  Pose X_0C;                     // the controller's base in frame 0 of that model
  Pose X_nE;                     // the controller's flange in its last frame
  JointVector start;             // readings where the program begins; empty: not known
  ProgramFrames frames;
};

struct CorrectedTarget {
  int line = 0;
  std::string name;
  Correction correction;
  std::string words;  // of the configuration, where they had to change: "S 2, T 10 for S 2, T 2"
};

struct CorrectedProgram {
  std::string text;
  std::vector<CorrectedTarget> targets;  // with those that Correction refuses
  std::size_t tried = 0;         // targets, with those that the nominal model does not reach
  std::vector<LeftAsItIs> left;  // by line
};

[[nodiscard]] CorrectedProgram corrected_program(std::string_view text, const Language& language,
                                                 const ControllerView& controller);

// Where the tool of the real arm goes when the controller runs the program: one for each target of
// it that the nominal model reaches.
struct Arrival {
  int line = 0;
  std::string name;
  Pose X_CT;  // the program's target, in the controller's base
  Pose X_CA;  // where the tool arrives there
};
struct Arrivals {
  std::vector<Arrival> arrivals;
  std::vector<LeftAsItIs> left;
};
[[nodiscard]] Arrivals arrivals_of(std::string_view text, const Language& language,
                                   const ControllerView& controller);

}  // namespace armsig::tool
