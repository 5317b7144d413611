// SPDX-License-Identifier: MIT
// A robot program as its reader hands it on: its targets, each with the bytes of its numbers, so
// that they can be replaced and nothing else; and what can't be corrected, by line.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "firmware/formats/frames_file.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/exports/urdf_places.hpp"

namespace armsig::tool {

// What the numbers after x, y, z are.
enum class Angles : std::uint8_t {
  kRotationVector,  // axis times angle
  kAbc,             // R = Rot(z, first) Rot(y, second) Rot(x, third)
  kRpy,             // R = Rot(z, third) Rot(y, second) Rot(x, first)
  kQuaternion,      // w, x, y, z
};

// How a language writes poses and readings.
struct Writing {
  Angles angles = Angles::kAbc;
  double metres = 1e-3;  // a unit of length
  double radians = 1;    // a unit of angle, of readings too
  int length_decimals = 6;
  int angle_decimals = 9;

  [[nodiscard]] std::size_t pose_numbers() const { return angles == Angles::kQuaternion ? 7 : 6; }
};

// Of as many numbers as pose_numbers(). Nothing of a quaternion whose length is not 1 within 1e-3.
[[nodiscard]] std::optional<Pose> pose_of(const std::vector<double>& numbers,
                                          const Writing& writing);
[[nodiscard]] std::vector<double> numbers_of(const Pose& X, const Writing& writing);

struct ProgramTarget {
  int line = 0;
  std::string name;     // as the program has it
  bool joints = false;  // readings of the joints, else a pose
  bool linear = false;  // the controller gets there on a path, and looks at no configuration
  std::vector<Bytes> numbers;
  std::vector<double> values;
  std::vector<Bytes> words;  // of the configuration; none where the language has none
  std::vector<long> configuration;
  std::vector<double> near;      // readings that the program wants its solution near; or empty
  std::vector<double> external;  // axes beside the arm's own, where it states them; 9e9 of none
  Pose X_BW;                     // frame of the program in the controller's base
  Pose X_FT;                     // its tool on the controller's flange
};

struct LeftAsItIs {
  int line = 0;
  std::string what;     // with the reason
  bool remark = false;  // no target is left by it: said of targets that are corrected
};

struct Program {
  std::vector<ProgramTarget> targets;  // in the order in which the program goes to them
  std::vector<LeftAsItIs> left;
};

// Tools and frames that a person gave, --tool and --frame: "2=0,0,100,0,0,0", or without a name for
// all that the program does not say itself.
struct NamedFrame {
  std::string name;  // in capitals, as the languages make no difference
  Pose X;
};
class GivenFrames {
 public:
  // Six numbers are x, y, z in mm and rotations about z, y, x in degrees; seven are x, y, z in mm
  // and a quaternion w, x, y, z; p[...] is x, y, z in metres and a rotation vector in radians.
  [[nodiscard]] Read<void> add(std::string_view option, std::string_view text);
  // That of a file, or by the name that one has in it: "2=torch". Those that come first are found.
  [[nodiscard]] Read<void> add(std::string_view option, std::string_view text,
                               const std::vector<NamedPose>& of_file);
  void add_all(const std::vector<NamedPose>& of_file);

  [[nodiscard]] const Pose* find(
      std::string_view name) const;  // the unnamed one where there is none
  [[nodiscard]] bool empty() const { return frames_.empty(); }

 private:
  std::vector<NamedFrame> frames_;
};
[[nodiscard]] Read<Pose> parse_frame(std::string_view option, std::string_view text);

struct ProgramFrames {
  GivenFrames tools;
  GivenFrames frames;
};

// Where joints 1 to 3 and 5 stand: the signs say the configuration. In metres and square metres.
struct Stance {
  double front = 0;  // the wrist's place along the forward direction of joint 1
  double ahead = 0;  // positive where the wrist is in front of the line of the lower arm
};

struct Language {
  std::string_view name;
  std::string_view suffixes;  // ".src .dat"
  Writing writing;
  // Every target of the text. Never fails: what it can't read is left, by line.
  Program (*read)(std::string_view text, const ProgramFrames& frames);
  // Does a configuration's words say these readings, within `tolerance` (rad, m or square m)? Null
  // where the language has no words.
  bool (*matches)(const std::vector<long>& words, const JointVector& q, const Stance& stance,
                  double tolerance);
  // Those of these readings, in place of `before`.
  std::vector<long> (*words_at)(const std::vector<long>& before, const JointVector& q,
                                const Stance& stance);
  // The words as a person writes them: "S 2, T 10".
  std::string (*in_words)(const std::vector<long>& words);
  // The language has words whose meaning depends on the arm: they are not read, and a target is
  // left where they could change.
  bool words_unread = false;
};

[[nodiscard]] const std::vector<Language>& languages();
// That of a file's suffix; null of none.
[[nodiscard]] const Language* language_of(std::string_view file);

}  // namespace armsig::tool
