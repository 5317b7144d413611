// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/read_rows.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/measurement/receivers.hpp"
#include "firmware/formats/canonical.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/host_tool/presentation/progress.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/words.hpp"
#include "firmware/host_tool/reading/beyond_limits.hpp"
#include "firmware/host_tool/reading/copied_rows.hpp"
#include "firmware/host_tool/reading/ranging.hpp"

namespace armsig::tool {
namespace {

Read<SensorDescription> checked(Read<SensorDescription> sensor, const std::string& path) {
  if (!sensor) return sensor;
  const auto usable = measurement::check(receivers_of(*sensor));
  if (usable) return sensor;
  return std::unexpected(
      Problem{path, 0, 0, std::string(describe(usable.error())), remedy_in_words(usable.error())});
}

}  // namespace

Read<SensorDescription> read_checked_sensor(const std::string& path) {
  return checked(read_sensor_file(path), path);
}

Read<OpenRows> open_rows(const RowSource& source, const Arm& drawing, const NamedJoints& joints) {
  OpenRows rows{.source = source,
                .drawing = drawing,
                .types = joints.types,
                .sensor = {},
                .sensor_crc32 = {},
                .mapped = {}};
  if (!source.sensor.empty()) {
    ARMSIG_TRY(text, read_text_file(source.sensor));
    ARMSIG_TRY(sensor, checked(parse_sensor(text, source.sensor), source.sensor));
    ARMSIG_TRY(document, in_file(source.sensor, parse_yaml(text)));
    rows.sensor = sensor;
    rows.sensor_crc32 = content_crc32(document);
  }
  if (!source.columns.empty()) {
    ARMSIG_TRY(mapped, map_measurements(source.measurements, source.columns, joints));
    say(stderr, "{}", in_words(mapped));
    rows.mapped = std::move(mapped);
  }
  return rows;
}

Read<MeasurementReader> open_reader(const OpenRows& rows) {
  const std::string& file = rows.source.measurements;
  if (!rows.mapped) return MeasurementReader::open(file, rows.types);
  auto reader =
      MeasurementReader::over(rows.mapped->text, file, rows.types, rows.mapped->first_line);
  if (!reader) reader.error().column = 0;  // of the mapped line, not of the file's
  return reader;
}

Read<RowsRead> read_rows(const OpenRows& rows, const RowReading& reading, const TakeRow& take) {
  const std::string& file = rows.source.measurements;
  ARMSIG_TRY(reader, open_reader(rows));
  constexpr std::size_t kSteps = 1000;
  std::optional<Progress> progress;
  if (reading.progress != nullptr) progress.emplace(reading.progress, kSteps);
  CopiedRows copies(reading.remembered);
  RowsRead read;
  std::size_t seen = 0;
  ImpossibleRows impossible;
  for (MeasurementRow row;;) {
    auto more = reader.next(row);
    if (!more && rows.mapped) more.error().column = 0;
    if (!more) return std::unexpected(std::move(more).error());
    if (!*more) break;
    ++seen;
    if (auto cannot = impossible_reading(rows.drawing, row.q)) {
      impossible.add(reader.problem_of_reading(cannot->joint, std::move(cannot->words)));
      continue;
    }
    if (const auto hash = row_hash(row, rows.types)) read.hashes.push_back(*hash);
    if (copies.is_copy(row)) continue;
    ARMSIG_TRY(scale, range_scale(row, rows.sensor, file));
    if (auto taken = in_file(file, take(row, scale)); !taken) {
      return std::unexpected(std::move(taken).error());
    }
    ++read.rows;
    if (const auto share = reader.progress(); progress && share) {
      progress->update(static_cast<std::size_t>(kSteps * *share));
    }
  }
  if (impossible.rows > 0) {
    Problem problem = impossible.problem(seen, "the header");
    if (rows.mapped) problem.column = 0;  // of the mapped line, not of the file's
    return std::unexpected(std::move(problem));
  }
  read.copies = copies.count();
  make_set(read.hashes);
  return read;
}

Origin origin_of(const OpenRows& rows, const RowsRead& read, std::vector<std::uint64_t> fitted) {
  Origin origin;
  origin.measurements = shown(rows.source.measurements);
  origin.columns = shown(rows.source.columns);
  origin.sensor = shown(rows.source.sensor);
  origin.sensor_crc32 = rows.sensor_crc32;
  origin.rows = read.hashes.size();
  origin.rows_crc32 = set_crc32(read.hashes);
  make_set(fitted);
  fitted.resize(std::min(fitted.size(), kMostRowHashes));
  origin.fitted = std::move(fitted);
  return origin;
}

OriginMatch match_of(const std::optional<Origin>& origin, const OpenRows& rows,
                     const RowsRead& read) {
  OriginMatch match{.rows = read.hashes.size()};
  if (!origin) return match;
  match.stated = true;
  match.same_rows =
      read.hashes.size() == origin->rows && set_crc32(read.hashes) == origin->rows_crc32;
  match.same_sensor = rows.sensor_crc32 == origin->sensor_crc32;
  for (const std::uint64_t hash : read.hashes) {
    if (!origin->tells_of(hash)) continue;
    ++match.told;
    match.fitted += origin->has_fitted(hash) ? 1 : 0;
  }
  return match;
}

std::string fitted_in_words(const OriginMatch& match) {
  return fmt::format("{} of the {} rows{}", match.fitted, match.told,
                     match.told < match.rows ? " of which this is known" : "");
}

}  // namespace armsig::tool
