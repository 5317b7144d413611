// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/program.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/programs/program_text.hpp"
#include "firmware/linuxcnc/roll_pitch_yaw.hpp"

namespace armsig::tool {
namespace {

constexpr double kQuaternionLength = 1e-3;

std::optional<Matrix3> rotation_in(const std::vector<double>& n, const Writing& writing) {
  const double unit = writing.radians;
  switch (writing.angles) {
    case Angles::kRotationVector: {
      const Vector3 turn = unit * Vector3(n[3], n[4], n[5]);
      const double angle = turn.norm();
      return angle > 0 ? rotation_about(turn / angle, angle) : Matrix3(Matrix3::Identity());
    }
    case Angles::kAbc:
      return rotation_of({unit * n[5], unit * n[4], unit * n[3]});
    case Angles::kRpy:
      return rotation_of({unit * n[3], unit * n[4], unit * n[5]});
    case Angles::kQuaternion:
      break;
  }
  const Eigen::Quaterniond q(n[3], n[4], n[5], n[6]);
  if (!(std::abs(q.coeffs().stableNorm() - 1) <= kQuaternionLength)) return std::nullopt;
  return q.normalized().toRotationMatrix();
}

constexpr const char* kFrameForms =
    "x,y,z in mm and rotations about z,y,x in degrees; x,y,z in mm and a quaternion; or "
    "p[x,y,z,rx,ry,rz] in m and rad";

std::optional<std::vector<double>> numbers_in(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto number = parse_number(trimmed(text.substr(0, comma)));
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    if (comma == text.size()) return numbers;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace

std::optional<Pose> pose_of(const std::vector<double>& numbers, const Writing& writing) {
  const auto R = rotation_in(numbers, writing);
  if (!R) return std::nullopt;
  return Pose{*R, writing.metres * Vector3(numbers[0], numbers[1], numbers[2])};
}

std::vector<double> numbers_of(const Pose& X, const Writing& writing) {
  const Vector3 p = X.p / writing.metres;
  std::vector<double> numbers{p.x(), p.y(), p.z()};
  if (writing.angles == Angles::kQuaternion) {
    Eigen::Quaterniond q(X.R);
    if (q.w() < 0) q.coeffs() *= -1;
    numbers.insert(numbers.end(), {q.w(), q.x(), q.y(), q.z()});
    return numbers;
  }
  Vector3 angles = rotation_vector(X.R);
  if (writing.angles != Angles::kRotationVector) {
    const RollPitchYaw rpy = roll_pitch_yaw(X.R);
    angles = {rpy.roll_rad, rpy.pitch_rad, rpy.yaw_rad};
    if (writing.angles == Angles::kAbc) angles.reverseInPlace();
  }
  angles /= writing.radians;
  numbers.insert(numbers.end(), {angles.x(), angles.y(), angles.z()});
  return numbers;
}

Read<Pose> parse_frame(std::string_view option, std::string_view text) {
  text = trimmed(text);
  Writing writing{.angles = Angles::kAbc, .radians = radians(1.0)};
  std::string_view list = text;
  if (text.starts_with("p[") && text.ends_with(']')) {
    list = text.substr(2, text.size() - 3);
    writing = {.angles = Angles::kRotationVector, .metres = 1};
  }
  const auto numbers = numbers_in(list);
  if (numbers && numbers->size() == 7 && list == text) writing.angles = Angles::kQuaternion;
  if (numbers && numbers->size() == writing.pose_numbers()) {
    if (const auto X = pose_of(*numbers, writing)) return *X;
  }
  return std::unexpected(Problem{std::string(option), 0, 0,
                                 fmt::format("{} is no pose", in_quotes(text)), kFrameForms});
}

Read<void> GivenFrames::add(std::string_view option, std::string_view text) {
  const std::size_t equals = text.find('=');
  const bool named = equals != std::string_view::npos;
  ARMSIG_TRY(X, parse_frame(option, named ? text.substr(equals + 1) : text));
  frames_.push_back({named ? in_capitals(trimmed(text.substr(0, equals))) : std::string(), X});
  return {};
}

Read<void> GivenFrames::add(std::string_view option, std::string_view text,
                            const std::vector<NamedPose>& of_file) {
  const std::size_t behind = text.find('=') + 1;  // 0 where there is no name
  const std::string_view value = trimmed(text.substr(behind));
  const auto named = std::ranges::find(of_file, value, &NamedPose::name);
  if (named != of_file.end()) {
    const std::string_view name = behind == 0 ? "" : trimmed(text.substr(0, behind - 1));
    frames_.push_back({in_capitals(name), named->X});
    return {};
  }
  auto added = add(option, text);
  if (!added && !of_file.empty()) {
    std::vector<std::string> names;
    for (const NamedPose& frame : of_file) names.push_back(frame.name);
    const std::string near = nearest(value, names);
    added.error().expected =
        fmt::format("{} of the file of --frames, or {}", near.empty() ? "a name" : in_quotes(near),
                    added.error().expected);
  }
  return added;
}

void GivenFrames::add_all(const std::vector<NamedPose>& of_file) {
  for (const NamedPose& frame : of_file) frames_.push_back({in_capitals(frame.name), frame.X});
}

const Pose* GivenFrames::find(std::string_view name) const {
  const auto named = std::ranges::find(frames_, in_capitals(name), &NamedFrame::name);
  if (named != frames_.end()) return &named->X;
  const auto unnamed = std::ranges::find(frames_, std::string_view(), &NamedFrame::name);
  return unnamed != frames_.end() ? &unnamed->X : nullptr;
}

}  // namespace armsig::tool
