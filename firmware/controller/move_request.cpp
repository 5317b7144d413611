// SPDX-License-Identifier: MIT
// `move`: readings of some joints (q2_deg, q2_rad, q2_mm, q2_m), the others stay; dq2_deg and the
// like are relative to where the joint is commanded to be; or a straight
// line of the tool to x, y, z (_mm, _m) and, where given, the unit quaternion qw, qx, qy, qz; dx,
// dy, dz (_mm, _m) instead are relative to where the tool is. `pace` slows the limits down. What is
// told twice, in two units or to and by, is refused.
#include <array>
#include <cmath>

#include "firmware/controller/verbs.hpp"

namespace armsig::controller {
namespace {

std::optional<double> unit_factor(std::string_view unit) {
  if (unit == "deg") return kPi / 180;
  if (unit == "rad" || unit == "m") return 1.0;
  if (unit == "mm") return 1e-3;
  return std::nullopt;
}

struct Key {
  std::string_view name;
  std::string_view unit;
};

Key split(std::string_view key) {
  const std::size_t underscore = key.find('_');
  if (underscore == std::string_view::npos) return {key, {}};
  return {head(key, underscore), tail(key, underscore + 1)};
}

bool is_relative(std::string_view name) { return !name.empty() && name[0] == 'd'; }

// q1 ... q8, dq1 ... dq8: the joint from 0.
std::optional<std::size_t> joint_of(std::string_view name) {
  if (is_relative(name)) name = tail(name, 1);
  if (name.size() != 2 || name[0] != 'q' || name[1] < '1' || name[1] > '8') return std::nullopt;
  return static_cast<std::size_t>(name[1] - '1');
}

std::optional<Eigen::Index> letter(std::string_view name, std::string_view letters) {
  const std::size_t at = name.size() == 1 ? letters.find(name[0]) : std::string_view::npos;
  if (at == std::string_view::npos) return std::nullopt;
  return static_cast<Eigen::Index>(at);
}

// Where the tool shall go from readings `from`. Errors: kUnknownRequest, kContradiction,
// kOutOfRange, kNotFinite.
// Apart from move_tool(), so that its poses do not stand on the stack below the planning.
[[gnu::noinline]] Result<Pose> goal_of(const Request& request, const Model& model,
                                       const JointVector& from, Line& out) {
  ARMSIG_TRY(X_RT, tool_pose(model, from));
  Pose goal = X_RT;
  Eigen::Vector4d wxyz = Eigen::Vector4d::Zero();
  std::array<bool, 3> told{};
  int places = 0;
  int parts = 0;
  for (const auto& [key, value] : request.arguments) {
    if (key == "pace") continue;
    const auto [name, unit] = split(key);
    const bool relative = name.size() == 2 && is_relative(name);
    const auto axis = letter(relative ? tail(name, 1) : name, "xyz");
    const bool is_quaternion = name.size() == 2 && name[0] == 'q' && unit.empty();
    const auto part = is_quaternion ? letter(tail(name, 1), "wxyz") : std::nullopt;
    if (!part && !(axis && (unit == "mm" || unit == "m"))) {
      return std::unexpected(Error::kUnknownRequest);
    }
    ARMSIG_TRY(number, needed_number(key, value, out));
    if (part) {
      wxyz(*part) = number;
      ++parts;
    } else {
      if (told[static_cast<std::size_t>(*axis)]) return std::unexpected(Error::kContradiction);
      told[static_cast<std::size_t>(*axis)] = true;
      const double length = *unit_factor(unit) * number;
      goal.p(*axis) = relative ? X_RT.p(*axis) + length : length;
      ++places;
    }
  }
  if (places + parts == 0) return std::unexpected(Error::kUnknownRequest);
  if (parts > 0) {
    constexpr double kUnit = 1e-3;
    if (parts != 4 || std::abs(wxyz.norm() - 1) > kUnit) {
      return std::unexpected(Error::kOutOfRange);
    }
    wxyz.normalize();
    goal.R = Eigen::Quaterniond(wxyz(0), wxyz(1), wxyz(2), wxyz(3)).toRotationMatrix();
  }
  return goal;
}

// The readings that `request` asks for, the others as in `from`. Errors: kUnknownRequest,
// kContradiction, kOutOfRange.
Result<JointVector> readings_of(const Request& request, const Arm& drawing, const JointVector& from,
                                Line& out) {
  JointVector to = from;
  std::array<bool, kMaxJoints> told{};
  for (const auto& [key, value] : request.arguments) {
    if (key == "pace") continue;
    const auto [name, unit] = split(key);
    const auto joint = joint_of(name);
    const auto factor = unit_factor(unit);
    if (!joint || *joint >= to.size() || !factor) return std::unexpected(Error::kUnknownRequest);
    const bool angle = unit == "deg" || unit == "rad";
    const bool turns = drawing.joints[*joint].type == JointType::kRevolute;
    if (angle != turns) return std::unexpected(Error::kUnknownRequest);
    ARMSIG_TRY(number, needed_number(key, value, out));
    if (told[*joint]) return std::unexpected(Error::kContradiction);
    told[*joint] = true;
    to[*joint] = *factor * number + (is_relative(name) ? from[*joint] : 0);
  }
  return to;
}

// An arm that may be elsewhere than its readings goes slowly, and not far without being looked at.
Result<void> allow_jog(const Controls& controls, const JointVector& from, const JointVector& to,
                       double pace, Line& out) {
  if (referenced(controls, out)) return {};
  bool near = pace <= References::kJogPace;
  for (std::size_t i = 0; i < to.size(); ++i) {
    const bool turns = controls.configuration.drawing.joints[i].type == JointType::kRevolute;
    near = near && std::abs(to[i] - from[i]) <= (turns ? References::kJog_rad : References::kJog_m);
  }
  if (near) {
    out.clear();
    return {};
  }
  out.text(" at_most_deg=").number(degrees(References::kJog_rad), 0);
  out.text(" at_most_mm=").number(1e3 * References::kJog_m, 0);
  out.text(" pace=").number(References::kJogPace, 1);
  return std::unexpected(Error::kUnreferenced);
}

Result<Answer> move_joints(Controls& controls, const Request& request, double pace, Line& out) {
  const JointVector& from = controls.mover.now().commanded;
  ARMSIG_TRY(to, readings_of(request, controls.configuration.drawing, from, out));
  if (auto allowed = allow_jog(controls, from, to, pace, out); !allowed) {
    return std::unexpected(allowed.error());
  }
  const auto planned = plan_joint_move(controls.configuration, from, to, pace);
  if (!planned) {
    if (planned.error().joint) out.text(" joint=").integer(*planned.error().joint + 1);
    return std::unexpected(planned.error().error);
  }
  if (!kMayBound || controls.configuration.around.are_empty()) {
    return when_taken(controls.mover.send(*planned));
  }
  controls.looking.emplace(controls.configuration, *planned);
  return Answer{Answer::When::kPlanned};
}

Result<Answer> move_tool(Controls& controls, const Request& request, double pace, Line& out) {
  if (auto sure = referenced(controls, out); !sure) return std::unexpected(sure.error());
  if (controls.custody.needs_acknowledgement()) {
    return std::unexpected(Error::kDrawingUnacknowledged);
  }
  const Snapshot& now = controls.mover.now();
  const Model& model = controls.link.models[now.model];
  ARMSIG_TRY(goal, goal_of(request, model, now.commanded, out));
  controls.planning.emplace(controls.configuration, model, now.commanded, goal, pace);
  return Answer{Answer::When::kPlanned};
}

}  // namespace

Result<void> referenced(const Controls& controls, Line& out) {
  const std::uint8_t joints = controls.references.unreferenced();
  if (joints == 0) return {};
  out.text(" joints=").numbers(joints);
  return std::unexpected(Error::kUnreferenced);
}

// `confirm`: readings at which a person sees some joints, as in `move`.
Result<Answer> confirm(Controls& controls, const Request& request, Line& out) {
  const JointVector& now = controls.mover.now().positions;
  ARMSIG_TRY(seen, readings_of(request, controls.configuration.drawing, now, out));
  for (const auto& [key, value] : request.arguments) {
    const auto [name, unit] = split(key);
    const auto joint = joint_of(name);
    if (!joint || is_relative(name)) return std::unexpected(Error::kUnknownRequest);
    if (auto confirmed = controls.references.confirm(*joint, seen[*joint]); !confirmed) {
      out.text(" joint=").integer(*joint + 1);
      return std::unexpected(confirmed.error());
    }
  }
  if (request.arguments.empty()) return std::unexpected(Error::kUnknownRequest);
  if (const auto joints = controls.references.unreferenced(); joints != 0) {
    out.text(" unreferenced=").numbers(joints);
  }
  return Answer();
}

Result<Answer> move(Controls& controls, const Request& request, Line& out) {
  double pace = 1;
  bool joints = false;
  for (const auto& [key, value] : request.arguments) {
    if (key == "pace") {
      ARMSIG_TRY(told, needed_number(key, value, out));
      if (!is_pace(told)) return std::unexpected(Error::kOutOfRange);
      pace = told;
    } else if (joint_of(split(key).name)) {
      joints = true;
    }
  }
  return joints ? move_joints(controls, request, pace, out)
                : move_tool(controls, request, pace, out);
}

}  // namespace armsig::controller
