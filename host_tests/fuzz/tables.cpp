// SPDX-License-Identifier: MIT
// Tables of ours: measurements, joint poses, tool poses. What is accepted is written, and read back
// as the same numbers: degrees and millimetres are rounded once each way.
#include <array>
#include <cmath>
#include <vector>

#include "firmware/formats/measurement_writer.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/poses.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

using namespace tool;  // NOLINT(google-build-using-namespace): its readers are the subject

const JointTypes kTypes{JointType::kRevolute, JointType::kPrismatic};

bool is_same(double a, double b) {
  return std::fabs(a - b) <= 1e-15 * std::fmax(std::fabs(a), std::fabs(b));
}

bool is_same(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || is_same(*a, *b));
}

bool is_same(const Vector3& a, const Vector3& b) {
  return is_same(a.x(), b.x()) && is_same(a.y(), b.y()) && is_same(a.z(), b.z());
}

bool is_same(const JointVector& a, const JointVector& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!is_same(a[i], b[i])) return false;
  }
  return true;
}

void check_row(const MeasurementRow& row) {
  FUZZ_CHECK(row.q.size() == kTypes.size());
  for (const double q : row.q) FUZZ_CHECK(std::isfinite(q));
  FUZZ_CHECK(!row.p_S || row.p_S->allFinite());
  FUZZ_CHECK(row.sweep <= kTypes.size());
  for (const auto& range : row.ranges_m) FUZZ_CHECK(!range || std::isfinite(*range));
}

struct Table {
  MeasurementLayout layout;
  std::vector<MeasurementRow> rows;
};

std::optional<Table> read_all(std::string_view text) {
  auto reader = MeasurementReader::over(text, "F", kTypes);
  check_words(reader);
  if (!reader) return std::nullopt;
  Table table;
  for (MeasurementRow row;;) {
    const auto more = reader->next(row);
    check_words(more);
    if (!more) return std::nullopt;
    if (!*more) break;
    check_row(row);
    table.rows.push_back(row);
  }
  FUZZ_CHECK(!table.rows.empty());
  table.layout = {.types = kTypes,
                  .receivers = reader->receiver_count(),
                  .air = reader->has_air(),
                  .sigma = reader->has_sigma()};
  return table;
}

std::string written(const Table& table) {
  const Scratch file;
  auto writer = MeasurementWriter::create(file.path(), table.layout);
  FUZZ_CHECK(writer);
  for (const MeasurementRow& row : table.rows) writer->write(row);
  // A number at the very end of the range of a double may have no millimetres.
  if (!writer->commit()) return {};
  return file.content();
}

void fuzz_measurements(Bytes bytes) {
  const auto table = read_all(text_of(bytes));
  if (!table) return;
  const std::string text = written(*table);
  if (text.empty()) return;
  const auto again = read_all(text);
  FUZZ_CHECK(again && again->rows.size() == table->rows.size());
  for (std::size_t i = 0; i < table->rows.size(); ++i) {
    const MeasurementRow& before = table->rows[i];
    const MeasurementRow& after = again->rows[i];
    FUZZ_CHECK(after.sweep == before.sweep && after.target == before.target);
    FUZZ_CHECK(is_same(after.q, before.q));
    FUZZ_CHECK(after.p_S.has_value() == before.p_S.has_value());
    FUZZ_CHECK(!after.p_S || is_same(*after.p_S, *before.p_S));
    FUZZ_CHECK(is_same(after.air_c, before.air_c) && is_same(after.sigma_m, before.sigma_m));
    FUZZ_CHECK(after.ranges_m.size() == before.ranges_m.size());
    for (std::size_t k = 0; k < after.ranges_m.size(); ++k) {
      FUZZ_CHECK(is_same(after.ranges_m[k], before.ranges_m[k]));
    }
  }
}

void fuzz_joint_poses(Bytes bytes) {
  const auto poses = parse_joint_poses(text_of(bytes), "F", kTypes);
  check_words(poses);
  if (!poses) return;
  const Scratch file;
  if (!write_joint_poses(file.path(), kTypes, *poses))
    return;  // no degrees at the end of the range
  const auto again = parse_joint_poses(file.content(), "F", kTypes);
  check_words(again);
  FUZZ_CHECK(again && again->size() == poses->size());
  for (std::size_t i = 0; i < poses->size(); ++i) FUZZ_CHECK(is_same((*again)[i], (*poses)[i]));
}

void fuzz_tool_poses(Bytes bytes) {
  const auto poses = parse_tool_poses(text_of(bytes), "F");
  check_words(poses);
  if (!poses) return;
  for (const Pose& X : *poses) {
    FUZZ_CHECK(X.p.allFinite());
    FUZZ_CHECK((X.R * X.R.transpose() - Matrix3::Identity()).norm() < 1e-12);
  }
  const Scratch file;
  FUZZ_CHECK(write_tool_poses(file.path(), *poses));
  const auto again = parse_tool_poses(file.content(), "F");
  check_words(again);
  FUZZ_CHECK(again && again->size() == poses->size());
  for (std::size_t i = 0; i < poses->size(); ++i) {
    FUZZ_CHECK(is_same((*again)[i].p, (*poses)[i].p));
    FUZZ_CHECK(((*again)[i].R - (*poses)[i].R).norm() < 1e-14);
  }
}

constexpr std::array kTargets{Target{"measurements", fuzz_measurements},
                              Target{"joint_poses", fuzz_joint_poses},
                              Target{"tool_poses", fuzz_tool_poses}};

}  // namespace

std::span<const Target> table_targets() { return kTargets; }

}  // namespace armsig::fuzz
