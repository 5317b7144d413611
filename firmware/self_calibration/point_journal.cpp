// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/point_journal.hpp"

#include <algorithm>
#include <cmath>

#include "core/measurement/ping_median.hpp"
#include "firmware/controller/little_endian.hpp"
#include "firmware/controller/store_ledger.hpp"

namespace armsig::controller {
namespace {

constexpr std::array<std::uint8_t, 4> kJournalMagic{'A', 'S', 'C', 'P'};
constexpr std::uint16_t kJournalVersion = 1;
constexpr std::size_t kHeaderCrcOffset = 24;
constexpr std::size_t kPointCrcOffset = 208;
// Rad or m: the same pose, computed anew.
constexpr double kSamePose = 1e-9;

std::uint32_t crc_of(std::span<const std::uint8_t> page, std::size_t until) {
  return crc32(std::as_bytes(page.first(until)));
}

// A CRC of numbers.
class Fingerprint {
 public:
  void real(double value) {
    std::array<std::uint8_t, 8> bytes{};
    LittleEndianWriter(bytes).real(value);
    crc_ = crc32(std::as_bytes(std::span(bytes)), crc_);
  }
  void reals(const auto& values) {
    for (const double value : values) real(value);
  }
  [[nodiscard]] std::uint32_t crc() const { return crc_; }

 private:
  std::uint32_t crc_ = 0;
};

std::uint32_t crc_of(const Machine& machine) {
  Fingerprint print;
  print.real(machine.drawing_crc);
  for (const hal::DriveIdentity& drive : machine.drives) {
    print.reals(drive.device);
    print.reals(std::array{drive.counts_per_revolution, drive.gear_ratio, drive.lead_m,
                           static_cast<double>(drive.zero_counts), drive.reversed ? 1.0 : 0.0,
                           static_cast<double>(drive.axis)});
  }
  return print.crc();
}

// Of everything that says where a run goes, and what is measured there.
std::uint32_t crc_of(const Configuration& configuration) {
  Fingerprint print;
  print.real(drawing_crc(configuration.drawing));
  for (const auto& [lower, upper] : configuration.drawing.limits) {
    print.reals(std::array{lower, upper});
  }
  const SweepPlan& sweeps = configuration.sweeps;
  print.reals(sweeps.configuration);
  print.reals(std::array{sweeps.arc_rad, sweeps.axis_sigma_rad, sweeps.point_sigma_m,
                         sweeps.validation_reach, static_cast<double>(sweeps.points),
                         static_cast<double>(sweeps.most_points),
                         static_cast<double>(sweeps.target)});
#ifndef ARMSIG_RANGES_ALONE
  if (configuration.sensor.measures == Measures::kPoints) {
    print.real(configuration.sensor.point_sigma_m);
  }
  print.real(configuration.sensor.settings_crc);
#endif
  const measurement::ReceiverArray& receivers = configuration.sensor.receivers;
  for (const Vector3& p_S : receivers.p_S) print.reals(p_S);
  print.reals(receivers.facing_S);
  print.real(receivers.range_sigma_m);
  print.reals(sweeps.arcs_rad);
  for (const auto& [lower, upper] : sweeps.free) print.reals(std::array{lower, upper});
  const clearance::Surroundings& around = configuration.around;
  for (const clearance::HalfSpace& plane : around.planes) {
    print.reals(plane.normal_B);
    print.real(plane.offset_m);
  }
  print.reals(around.lower_B);
  print.reals(around.upper_B);
  print.reals(around.foot_B);
  print.reals(std::array{around.link_radius_m, around.hand_m});
  return print.crc();
}

void put(LittleEndianWriter& out, const JointVector& q) {
  for (std::size_t i = 0; i < kMaxJoints; ++i) out.real(i < q.size() ? q[i] : 0);
}

JointVector joints_in(LittleEndianReader& in, std::size_t joints) {
  JointVector q;
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    const double value = in.real();
    if (i < joints) q.push_back(value);
  }
  return q;
}

constexpr std::array<std::array<Eigen::Index, 2>, 6> kUpper{
    {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

bool is_near(const JointVector& a, const JointVector& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return std::abs(x - y) <= kSamePose; });
}

}  // namespace

PointJournal::PointJournal(hal::NonvolatileMemory& memory) : memory_(memory) {
  ARMSIG_CHECK(memory.layout().page_bytes == kPageBytes);
}

Result<PointJournal::Page> PointJournal::read(std::size_t page) const {
  Page bytes{};
  if (auto done = memory_.read(page * kPageBytes, bytes); !done)
    return std::unexpected(done.error());
  return bytes;
}

// Sets the CRC, and goes on to the page behind.
Result<void> PointJournal::write(Page& page, std::size_t crc_at) {
  const std::uint32_t crc = crc_of(page, crc_at);
  LittleEndianWriter(std::span(page).subspan(crc_at)).integer(crc, 4);
  if (begins_sector()) {
    const std::size_t sector = at_ / memory_.layout().pages_per_sector;
    if (auto erased = memory_.erase_sector(sector); !erased) return erased;
  }
  if (auto done = memory_.program_page(at_ * kPageBytes, page); !done) return done;
  before_ = crc;
  ++at_;
  return {};
}

// Whether it is the header of a run that was interrupted; takes over its number.
Result<bool> PointJournal::look_at_header(const Page& header) {
  number_ = crc_of(header, kPageBytes);  // of no run: one that is hardly another's
  if (is_erased(header)) return false;
  LittleEndianReader in(header, 4);
  const bool whole =
      std::ranges::equal(std::span(header).first(4), kJournalMagic) &&
      in.integer(2) == kJournalVersion &&
      LittleEndianReader(header, kHeaderCrcOffset).integer(4) == crc_of(header, kHeaderCrcOffset);
  if (!whole) return std::unexpected(Error::kRecordCorrupt);
  const std::uint64_t joints = in.integer(2);
  const std::uint64_t machine = in.integer(4);
  const std::uint64_t set_up = in.integer(4);
  number_ = static_cast<std::uint32_t>(in.integer(4));
  if (in.integer(4) == 0) return false;
  if (machine != machine_) return std::unexpected(Error::kRecordOtherMachine);
  if (set_up != set_up_ || joints != joints_) return std::unexpected(Error::kRecordUnsuitable);
  return true;
}

// The header of the next run, or of none.
Result<void> PointJournal::write_header(bool of_a_run) {
  Page header{};
  LittleEndianWriter out(header);
  for (const std::uint8_t byte : kJournalMagic) out.integer(byte, 1);
  out.integer(kJournalVersion, 2);
  out.integer(joints_, 2);
  out.integer(machine_, 4);
  out.integer(set_up_, 4);
  out.integer(++number_, 4);
  out.integer(of_a_run ? 1 : 0, 4);
  at_ = 0;
  return write(header, kHeaderCrcOffset);
}

Result<std::size_t> PointJournal::begin(const Configuration& configuration, const Machine& machine,
                                        bool anew) {
  keeps_ = false;
  machine_ = crc_of(machine);
  set_up_ = crc_of(configuration);
  joints_ = configuration.drawing.joints.size();
  ARMSIG_TRY(header, read(0));
  const Result<bool> interrupted = look_at_header(header);
  if (anew || !interrupted.value_or(false)) {
    if (const auto begun = write_header(true); !begun) return std::unexpected(begun.error());
    keeps_ = true;
    if (!anew && !interrupted) return std::unexpected(interrupted.error());
    return std::size_t{0};
  }
  keeps_ = true;
  const auto rewind = [&] {
    at_ = 1;
    before_ = crc_of(header, kHeaderCrcOffset);
  };
  rewind();
  std::size_t points = 0;
  for (; find(); ++points) {
    before_ = found_;
    ++at_;
  }
  rewind();
  return points;
}

std::optional<KeptPoint> PointJournal::point_in(const Page& page) {
  found_ = crc_of(page, kPointCrcOffset);
  if (LittleEndianReader(page, kPointCrcOffset).integer(4) != found_) return std::nullopt;
  LittleEndianReader in(page);
  if (in.integer(4) != before_) return std::nullopt;
  KeptPoint kept;
  kept.sweep = static_cast<std::size_t>(in.integer(1));
  const std::uint64_t joints = in.integer(1);
  const auto pings = static_cast<std::size_t>(in.integer(1));
  const bool is_point = in.integer(1) != 0;
  if (joints != joints_ || kept.sweep > joints_) return std::nullopt;
  kept.wanted = joints_in(in, joints_);
  kept.readings = joints_in(in, joints_);
  MeasuredPoint point{.pings = pings};
  for (double& coordinate : point.p_S) coordinate = in.real();
  for (const auto [row, column] : kUpper) {
    point.covariance_m2(row, column) = point.covariance_m2(column, row) = in.real();
  }
  if (!in.all_finite()) return std::nullopt;
  if (is_point) kept.point = point;
  return kept;
}

std::optional<KeptPoint> PointJournal::find() {
  while (at_ < pages()) {
    const auto page = read(at_);
    if (!page) return std::nullopt;
    if (const auto kept = point_in(*page)) return kept;
    // At the beginning of a sector it is of an earlier run.
    if (is_erased(*page) || begins_sector()) return std::nullopt;
    to_next_sector();
  }
  return std::nullopt;
}

std::optional<KeptPoint> PointJournal::next(std::size_t sweep, const JointVector& wanted) {
  if (!keeps_) return std::nullopt;
  while (const auto kept = find()) {
    if (kept->sweep == sweep && is_near(kept->wanted, wanted)) {
      before_ = found_;
      ++at_;
      return kept;
    }
    to_next_sector();
  }
  return std::nullopt;
}

Result<void> PointJournal::keep(const KeptPoint& kept) {
  if (!keeps_) return {};
  Page page{};
  LittleEndianWriter out(page);
  out.integer(before_, 4);
  out.integer(kept.sweep, 1);
  out.integer(joints_, 1);
  const MeasuredPoint point = kept.point.value_or(MeasuredPoint());
  out.integer(point.pings, 1);
  out.integer(kept.point ? 1 : 0, 1);
  put(out, kept.wanted);
  put(out, kept.readings);
  for (const double coordinate : point.p_S) out.real(coordinate);
  for (const auto [row, column] : kUpper) out.real(point.covariance_m2(row, column));
  auto written = at_ < pages() ? write(page, kPointCrcOffset)
                               : Result<void>(std::unexpected(Error::kStorageFull));
  keeps_ = written.has_value();
  return written;
}

Result<void> PointJournal::forget() {
  keeps_ = false;
  return write_header(false);
}

}  // namespace armsig::controller
