// SPDX-License-Identifier: MIT
// Files of other software: measurements with columns of their own, joint logs and tracker's points,
// URDF, rows of Denavit-Hartenberg.
#include <array>
#include <cmath>

#include "firmware/formats/encoding.hpp"
#include "firmware/formats/foreign_columns.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/host_tool/imports/import.hpp"
#include "firmware/host_tool/joining/join.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

using namespace tool;  // NOLINT(google-build-using-namespace): its readers are the subject

const JointTypes kTypes{JointType::kRevolute, JointType::kRevolute};

// The bytes before the first line with nothing but "%%", and those after it.
std::pair<std::string_view, std::string_view> halves(std::string_view text) {
  constexpr std::string_view kBetween = "\n%%\n";
  const std::size_t at = text.find(kBetween);
  if (at == std::string_view::npos) return {text, {}};
  return {text.substr(0, at + 1), text.substr(at + kBetween.size())};
}

// "MAPPING\n%%\nFILE".
void fuzz_columns(Bytes bytes) {
  const auto [mapping, text] = halves(text_of(bytes));
  const File file(text);
  const auto mapped = map_measurements(file.path(), mapping.substr(0, mapping.find('\n')), kTypes);
  check_words(mapped);
  if (!mapped) return;
  (void)in_words(*mapped);
  // What was made of the file is a file of ours, or is refused in words.
  auto reader = MeasurementReader::over(mapped->text, "F", kTypes, mapped->first_line);
  check_words(reader);
  if (!reader) return;
  for (MeasurementRow row;;) {
    const auto more = reader->next(row);
    check_words(more);
    if (!more || !*more) return;
    FUZZ_CHECK(row.q.size() == 2 && std::isfinite(row.q[0]) && std::isfinite(row.q[1]));
  }
}

// "JOINT LOG\n%%\nPOINTS", both in whatever encoding.
void fuzz_join(Bytes bytes) {
  const auto [log, points] = halves(text_of(bytes));
  const File log_file(log);
  const File points_file(points);
  for (const StatedUnits& units : {StatedUnits{}, StatedUnits{.angle = "deg", .length = "mm"}}) {
    const auto poses = read_joint_log(log_file.path(), kTypes, units);
    check_words(poses);
    const auto tracked = read_tracked_points(points_file.path(), units);
    check_words(tracked);
    if (!poses || !tracked) continue;
    for (const JoinBy by : {JoinBy::kName, JoinBy::kOrder, JoinBy::kTime, JoinBy::kStandstill}) {
      JoinSettings settings;
      settings.by = by;
      auto joined = join(*poses, *tracked, settings, kTypes);
      check_words(joined);
      if (!joined) continue;
      FUZZ_CHECK(!joined->rows.empty() && joined->rows.size() <= tracked->points.size());
      const auto found = find_sweeps(joined->rows, kTypes);
      FUZZ_CHECK(found.size() >= kTypes.size());
      for (const MeasurementRow& row : joined->rows) {
        FUZZ_CHECK(row.q.size() == 2 && row.p_S && row.p_S->allFinite());
      }
    }
  }
}

void fuzz_encoding(Bytes bytes) {
  const auto text = in_utf8(text_of(bytes));
  if (text) FUZZ_CHECK(text->size() <= 2 * bytes.size());
}

void check_import(const Read<ImportedArm>& imported) {
  check_words(imported);
  if (!imported) return;
  const Arm& arm = imported->description.arm;
  FUZZ_CHECK(!arm.joints.empty() && arm.joints.size() <= kMaxJoints);
  const std::string written = arm_text(imported->description);
  const auto again = parse_arm(written, "F");
  // An import may hold what a drawing may not (a name without characters, limits of no arm): then
  // it says so.
  check_words(again);
  if (again) FUZZ_CHECK(arm_text(*again) == written);
}

void fuzz_urdf(Bytes bytes) {
  const File file(text_of(bytes));
  check_import(import_urdf(file.path(), "base_link", "last_link"));
}

void fuzz_dh(Bytes bytes) {
  const File file(text_of(bytes));
  check_import(import_dh(file.path()));
}

void fuzz_maker_yaml(Bytes bytes) {
  const File file(text_of(bytes));
  check_import(import_ur_yaml(file.path()));
  check_import(import_opw(file.path()));
}

constexpr std::array kTargets{Target{"columns", fuzz_columns},
                              Target{"join", fuzz_join},
                              Target{"encoding", fuzz_encoding},
                              Target{"urdf", fuzz_urdf},
                              Target{"dh", fuzz_dh},
                              Target{"maker_yaml", fuzz_maker_yaml}};

}  // namespace

std::span<const Target> foreign_targets() { return kTargets; }

}  // namespace armsig::fuzz
