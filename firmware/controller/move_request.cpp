// SPDX-License-Identifier: MIT
// `move`: readings of some joints (q2_deg, q2_rad, q2_mm, q2_m), the others stay; or a straight
// line of the tool to x, y, z (_mm, _m) and, where given, the unit quaternion qw, qx, qy, qz; dx,
// dy, dz (_mm, _m) instead are relative to where the tool is. `pace` slows the limits down. What is
// told twice, in two units or to and by, is refused.
#include <array>
#include <cmath>

#include "firmware/controller/background.hpp"

namespace armsig::controller {
namespace {

// A joint of 60 deg/s then takes an hour and a half for a turn: slower is a slip of the pen.
constexpr double kLeastPace = 1e-3;

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

// q1 ... q8: the joint from 0.
std::optional<std::size_t> joint_of(std::string_view name) {
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
                                       const JointVector& from) {
  ARMSIG_TRY(X_RT, tool_pose(model, from));
  Pose goal = X_RT;
  Eigen::Vector4d wxyz = Eigen::Vector4d::Zero();
  std::array<bool, 3> told{};
  int places = 0;
  int parts = 0;
  for (const auto& [key, value] : request.arguments) {
    if (key == "pace") continue;
    const auto number = parse_number(value);
    const auto [name, unit] = split(key);
    const bool relative = name.size() == 2 && name[0] == 'd';
    const auto axis = letter(relative ? tail(name, 1) : name, "xyz");
    const bool is_quaternion = name.size() == 2 && name[0] == 'q' && unit.empty();
    const auto part = is_quaternion ? letter(tail(name, 1), "wxyz") : std::nullopt;
    if (!part && !(axis && (unit == "mm" || unit == "m"))) {
      return std::unexpected(Error::kUnknownRequest);
    }
    if (!number) return std::unexpected(Error::kOutOfRange);
    if (part) {
      wxyz(*part) = *number;
      ++parts;
    } else {
      if (told[static_cast<std::size_t>(*axis)]) return std::unexpected(Error::kContradiction);
      told[static_cast<std::size_t>(*axis)] = true;
      const double length = *unit_factor(unit) * *number;
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

}  // namespace

Background::Verdict Background::move(const Request& request) {
  if (mover_.now().mode != Mode::kHolding || is_busy()) return std::unexpected(Error::kWrongMode);
  double pace = 1;
  bool joints = false;
  for (const auto& [key, value] : request.arguments) {
    if (key == "pace") {
      const auto told = parse_number(value);
      if (!told || !(*told >= kLeastPace && *told <= 1)) return std::unexpected(Error::kOutOfRange);
      pace = *told;
    } else if (joint_of(split(key).name)) {
      joints = true;
    }
  }
  return joints ? move_joints(request, pace) : move_tool(request, pace);
}

Background::Verdict Background::move_joints(const Request& request, double pace) {
  JointVector to = mover_.now().commanded;
  std::array<bool, kMaxJoints> told{};
  for (const auto& [key, value] : request.arguments) {
    if (key == "pace") continue;
    const auto [name, unit] = split(key);
    const auto joint = joint_of(name);
    const auto factor = unit_factor(unit);
    const auto number = parse_number(value);
    if (!joint || *joint >= to.size() || !factor) return std::unexpected(Error::kUnknownRequest);
    const bool angle = unit == "deg" || unit == "rad";
    const bool turns = configuration_.drawing.joints[*joint].type == JointType::kRevolute;
    if (angle != turns) return std::unexpected(Error::kUnknownRequest);
    if (!number) return std::unexpected(Error::kOutOfRange);
    if (told[*joint]) return std::unexpected(Error::kContradiction);
    told[*joint] = true;
    to[*joint] = *factor * *number;
  }
  const auto planned = plan_joint_move(configuration_, mover_.now().commanded, to, pace);
  if (!planned) {
    if (planned.error().joint) out_.text(" joint=").integer(*planned.error().joint + 1);
    return std::unexpected(planned.error().error);
  }
  if (!mover_.send(*planned)) return std::unexpected(Error::kBusBusy);
  waits_ = true;
  return {};
}

Background::Verdict Background::move_tool(const Request& request, double pace) {
  const Model& model = link_.models[mover_.now().model];
  ARMSIG_TRY(goal, goal_of(request, model, mover_.now().commanded));
  const auto planned = plan_line(configuration_, model, mover_.now().commanded, goal, pace);
  if (!planned) return std::unexpected(planned.error().error);
  if (!mover_.send(*planned)) return std::unexpected(Error::kBusBusy);
  waits_ = true;
  return {};
}

}  // namespace armsig::controller
