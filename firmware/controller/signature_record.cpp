// SPDX-License-Identifier: MIT
#include "firmware/controller/signature_record.hpp"

#include <algorithm>

#include "core/base/crc32.hpp"
#include "core/identification.hpp"
#include "firmware/controller/little_endian.hpp"

namespace armsig::controller {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'A', 'S', 'I', 'G'};
constexpr std::uint16_t kVersion = 4;

using calibration::GravityTerm;
using calibration::kMaxGravityTerms;
using calibration::PackedDeflections;
using calibration::PackedMap;

void write_vector(PartWriter& out, const Vector3& v) {
  for (Eigen::Index i = 0; i < 3; ++i) out.real(v(i));
}

Vector3 read_vector(LittleEndianReader& in) {
  Vector3 v;
  for (Eigen::Index i = 0; i < 3; ++i) v(i) = in.real();
  return v;
}

// Beside the sense of the joint: how far its axis is beyond the first of the drive.
constexpr unsigned kAxisBit = 8;

std::uint32_t further_axes(const hal::DriveIdentity& drive) {
  return hal::kSmallImage ? 0 : drive.axis - 1U;
}

void read_sense_and_axis(LittleEndianReader& in, hal::DriveIdentity& drive) {
  const auto both = static_cast<std::uint32_t>(in.integer(4));
  if constexpr (hal::kSmallImage) {
    drive.reversed = both == 1;
  } else {
    drive.reversed = (both & 1U) != 0;
    drive.axis = static_cast<std::uint8_t>((both >> kAxisBit) + 1);
  }
}

void write_drives(PartWriter& out, const Machine& machine) {
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    const hal::DriveIdentity drive =
        i < machine.drives.size() ? machine.drives[i] : hal::DriveIdentity{};
    for (const std::uint32_t number : drive.device) out.integer(number, 4);
    out.real(drive.counts_per_revolution);
    out.real(drive.gear_ratio);
    out.real(drive.lead_m);
    out.integer(static_cast<std::uint32_t>(drive.zero_counts), 4);
    out.integer((drive.reversed ? 1U : 0U) | further_axes(drive) << kAxisBit, 4);
  }
}

void read_drives(LittleEndianReader& in, std::size_t joints, Machine& machine) {
  machine.drives.clear();
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    hal::DriveIdentity drive;
    for (std::uint32_t& number : drive.device) number = static_cast<std::uint32_t>(in.integer(4));
    drive.counts_per_revolution = in.real();
    drive.gear_ratio = in.real();
    drive.lead_m = in.real();
    drive.zero_counts = static_cast<std::int32_t>(static_cast<std::uint32_t>(in.integer(4)));
    read_sense_and_axis(in, drive);
    if (i < joints) machine.drives.push_back(drive);
  }
}

// Four doubles, and the steps of all knots.
constexpr std::size_t kBytesOfMap = std::size_t{4} * 8 + std::size_t{2} * calibration::kKnots;

void write_deflections(PartWriter& out, const PackedDeflections& deflections) {
  out.integer(deflections.empty() ? 0 : 1, 4);
  out.integer(deflections.gravity.size(), 4);
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    const bool used = i < deflections.maps.size();
    if (!used) {
      for (std::size_t k = 0; k < kBytesOfMap / 8; ++k) out.integer(0, 8);
      continue;
    }
    const PackedMap& map = deflections.maps[i];
    out.real(map.domain.origin);
    out.real(map.domain.per_length);
    out.real(map.step);
    out.real(deflections.drawn_zero[i]);
    for (const std::int16_t step : map.steps) out.integer(static_cast<std::uint16_t>(step), 2);
  }
  for (std::size_t k = 0; k < kMaxGravityTerms; ++k) {
    const GravityTerm term =
        k < deflections.gravity.size() ? deflections.gravity[k] : GravityTerm{};
    out.integer(term.joint, 1);
    out.integer(term.origin, 3);
    out.real(term.coefficient);
  }
  write_vector(out, deflections.empty() ? Vector3(Vector3::Zero()) : deflections.up_0);
}

// False where what is read is not to be servoed with.
bool read_deflections(LittleEndianReader& in, const Arm& nominal, std::size_t joints,
                      PackedDeflections& deflections) {
  deflections.maps.clear();
  deflections.gravity.clear();
  deflections.drawn_zero.fill(0);
  deflections.up_0 = Vector3::UnitZ();
  const std::uint64_t there = in.integer(4);
  const std::uint64_t terms = in.integer(4);
  if (there > 1 || terms > (there == 1 ? kMaxGravityTerms : 0)) return false;
  if (there == 0) return true;
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    PackedMap map;
    map.domain.origin = in.real();
    map.domain.per_length = in.real();
    map.step = in.real();
    deflections.drawn_zero[i] = in.real();
    for (std::int16_t& step : map.steps) {
      step = static_cast<std::int16_t>(static_cast<std::uint16_t>(in.integer(2)));
    }
    if (i < joints) deflections.maps.push_back(map);
  }
  for (std::size_t k = 0; k < kMaxGravityTerms; ++k) {
    GravityTerm term;
    term.joint = static_cast<std::uint8_t>(in.integer(1));
    term.origin = static_cast<std::uint8_t>(in.integer(3));
    term.coefficient = in.real();
    if (k < terms) deflections.gravity.push_back(term);
  }
  deflections.up_0 = read_vector(in);
  return nominal.joints.size() != joints || check(deflections, nominal).has_value();
}

const Target* hand_target(const Signature& signature) {
  const auto* found = std::ranges::find_if(signature.targets, [&](const Target& target) {
    return target.link == signature.joint_count();
  });
  return found == signature.targets.end() ? nullptr : found;
}

bool is_rotation(const Matrix3& R) {
  return (R * R.transpose() - Matrix3::Identity()).norm() < 1e-9 && R.determinant() > 0;
}

// Without the CRC; none where the image says another length than records have.
std::span<const std::uint8_t> content_of(const RecordImage& image) {
  const std::uint64_t length = LittleEndianReader(image, 8).integer(4);
  if (length != kRecordBytes) return {};
  return std::span(image).first(static_cast<std::size_t>(length) - 4);
}

void write(PartWriter& out, const SignatureRecord& record, std::uint32_t sequence) {
  const Signature& signature = record.signature;
  const std::size_t n = signature.joint_count();
  for (const std::uint8_t byte : kMagic) out.integer(byte, 1);
  out.integer(kVersion, 2);
  out.integer(n, 1);
  out.integer(static_cast<std::uint64_t>(record.method), 1);
  out.integer(kRecordBytes, 4);
  out.integer(sequence, 4);
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    out.integer(i < n && signature.types[i] == JointType::kPrismatic ? 1 : 0, 1);
  }
  for (std::size_t i = 0; i < kMaxJoints; ++i) out.real(i < n ? signature.configuration[i] : 0);
  for (std::size_t k = 0; k < kMaxFrames; ++k) {
    const Pose X_SL = k <= n ? signature.X_SL[k] : Pose{};
    for (Eigen::Index row = 0; row < 3; ++row) write_vector(out, X_SL.R.row(row).transpose());
    write_vector(out, X_SL.p);
  }
  const Target* target = hand_target(signature);
  out.integer(target != nullptr ? static_cast<std::uint32_t>(target->number) : 0, 4);
  out.integer(target != nullptr ? 1 : 0, 4);
  write_vector(out, target != nullptr ? target->p_S : Vector3::Zero());
  out.real(record.air_celsius);
  const auto validated = record.accuracy.validated.value_or(ToolAccuracy::Validated{});
  const auto predicted = record.accuracy.predicted.value_or(ToolAccuracy::Predicted{});
  out.real(validated.rms_m);
  out.integer(static_cast<std::uint64_t>(record.identified_at_s), 8);
  out.real(predicted.rms_m);
  out.integer(record.machine.drawing_crc, 4);
  out.integer(static_cast<std::uint64_t>(predicted.region), 2);
  out.integer(validated.poses, 2);
  write_drives(out, record.machine);
  write_deflections(out, record.deflections);
  out.integer(out.crc(), 4);
}

// Of n joints; false: a frame is no rotation.
bool read_signature(LittleEndianReader& in, std::size_t n, Signature& signature) {
  signature.types.clear();
  signature.configuration.clear();
  signature.X_SL.clear();
  signature.targets.clear();
  signature.features.clear();
  signature.description_matches = true;
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    const auto type = in.integer(1) == 0 ? JointType::kRevolute : JointType::kPrismatic;
    if (i < n) signature.types.push_back(type);
  }
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    const double reading = in.real();
    if (i < n) signature.configuration.push_back(reading);
  }
  bool rotations = true;
  for (std::size_t k = 0; k < kMaxFrames; ++k) {
    Pose X_SL;
    for (Eigen::Index row = 0; row < 3; ++row) X_SL.R.row(row) = read_vector(in).transpose();
    X_SL.p = read_vector(in);
    rotations = rotations && is_rotation(X_SL.R);
    if (k <= n) signature.X_SL.push_back(X_SL);
  }
  Target target{.number = static_cast<int>(in.integer(4)), .link = n};
  const bool has_target = in.integer(4) == 1;
  target.p_S = read_vector(in);
  if (has_target) signature.targets.push_back(target);
  return rotations;
}

// And when it was identified, and of which drawing. False: no accuracy, or of no region.
bool read_accuracy(LittleEndianReader& in, SignatureRecord& record) {
  ToolAccuracy::Validated validated{.rms_m = in.real()};
  record.identified_at_s = static_cast<std::int64_t>(in.integer(8));
  ToolAccuracy::Predicted predicted{.rms_m = in.real()};
  record.machine.drawing_crc = static_cast<std::uint32_t>(in.integer(4));
  const std::uint64_t region = in.integer(2);
  validated.poses = static_cast<std::uint32_t>(in.integer(2));
  if (region >= kPredictedRegions.size() || !(validated.rms_m >= 0 && predicted.rms_m >= 0)) {
    return false;
  }
  predicted.region = static_cast<PredictedRegion>(region);
  record.accuracy = {};
  if (validated.rms_m > 0) record.accuracy.validated = validated;
  if (predicted.rms_m > 0) record.accuracy.predicted = predicted;
  return true;
}

}  // namespace

std::uint32_t crc_of(const RecordImage& image) {
  const auto content = content_of(image);
  return content.empty()
             ? 0
             : static_cast<std::uint32_t>(LittleEndianReader(image, content.size()).integer(4));
}

bool is_whole(const RecordImage& image) {
  const auto content = content_of(image);
  return !content.empty() && crc_of(image) == crc32(std::as_bytes(content));
}

void encode(const SignatureRecord& record, std::uint32_t sequence, RecordImage& image) {
  PartWriter out(image, 0);
  write(out, record, sequence);
}

RecordImage encode(const SignatureRecord& record) {
  RecordImage image{};
  encode(record, record.sequence, image);
  return image;
}

void encode_part(const SignatureRecord& record, std::size_t begin, std::span<std::uint8_t> part) {
  PartWriter out(part, begin);
  write(out, record, record.sequence);
}

Result<void> decode(const RecordImage& image, const Arm& drawing, SignatureRecord& record) {
  if (!std::ranges::equal(std::span(image).first(4), kMagic) || !is_whole(image)) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  LittleEndianReader in(image, 4);
  const std::uint64_t version = in.integer(2);
  const auto n = static_cast<std::size_t>(in.integer(1));
  const std::uint64_t method = in.integer(1);
  const std::uint64_t length = in.integer(4);
  const bool known = version == kVersion && length == kRecordBytes;
  if (!known || n == 0 || n > kMaxJoints || method >= kMethods.size()) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  record.sequence = static_cast<std::uint32_t>(in.integer(4));
  const bool rotations = read_signature(in, n, record.signature);
  record.method = static_cast<Method>(method);
  record.air_celsius = in.real();
  const bool stated = read_accuracy(in, record);
  read_drives(in, n, record.machine);
  record.deflections.maps.clear();
  record.deflections.gravity.clear();
  const bool bounded = read_deflections(in, drawing, n, record.deflections);
  if (!in.all_finite() || !rotations || !bounded || !stated) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  if (n != drawing.joints.size()) return std::unexpected(Error::kRecordUnsuitable);
  for (std::size_t i = 0; i < n; ++i) {
    if (record.signature.types[i] != drawing.joints[i].type) {
      return std::unexpected(Error::kRecordUnsuitable);
    }
  }
  derive_parameters(record.signature, drawing);
  return {};
}

}  // namespace armsig::controller
