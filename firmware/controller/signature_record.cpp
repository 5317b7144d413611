// SPDX-License-Identifier: MIT
#include "firmware/controller/signature_record.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/base/crc32.hpp"
#include "core/identification.hpp"

namespace armsig::controller {
namespace {

constexpr std::array<std::uint8_t, 4> kMagic{'A', 'S', 'I', 'G'};
constexpr std::uint16_t kVersion = 1;
constexpr std::size_t kCrcOffset = kRecordBytes - 4;

class Writer {
 public:
  explicit Writer(RecordImage& image) : image_(image) {}
  void integer(std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) {
      image_[at_++] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  }
  void real(double value) { integer(std::bit_cast<std::uint64_t>(value), 8); }
  void vector(const Vector3& v) {
    for (Eigen::Index i = 0; i < 3; ++i) real(v(i));
  }

 private:
  RecordImage& image_;
  std::size_t at_ = 0;
};

class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> image, std::size_t at = 0)
      : image_(image), at_(at) {}
  std::uint64_t integer(std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) {
      value |= static_cast<std::uint64_t>(image_[at_++]) << (8 * i);
    }
    return value;
  }
  double real() {
    const auto value = std::bit_cast<double>(integer(8));
    finite_ = finite_ && std::isfinite(value);
    return value;
  }
  Vector3 vector() {
    Vector3 v;
    for (Eigen::Index i = 0; i < 3; ++i) v(i) = real();
    return v;
  }
  [[nodiscard]] bool all_finite() const { return finite_; }

 private:
  std::span<const std::uint8_t> image_;
  std::size_t at_;
  bool finite_ = true;
};

const Target* hand_target(const Signature& signature) {
  const auto* found = std::ranges::find_if(signature.targets, [&](const Target& target) {
    return target.link == signature.joint_count();
  });
  return found == signature.targets.end() ? nullptr : found;
}

bool is_rotation(const Matrix3& R) {
  return (R * R.transpose() - Matrix3::Identity()).norm() < 1e-9 && R.determinant() > 0;
}

std::uint32_t crc_of(std::span<const std::uint8_t> image) {
  return crc32(std::as_bytes(image.first(kCrcOffset)));
}

}  // namespace

RecordImage encode(const SignatureRecord& record, std::uint32_t sequence) {
  const Signature& signature = record.signature;
  const std::size_t n = signature.joint_count();
  RecordImage image{};
  Writer out(image);
  for (const std::uint8_t byte : kMagic) out.integer(byte, 1);
  out.integer(kVersion, 2);
  out.integer(n, 2);
  out.integer(kRecordBytes, 4);
  out.integer(sequence, 4);
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    out.integer(i < n && signature.types[i] == JointType::kPrismatic ? 1 : 0, 1);
  }
  for (std::size_t i = 0; i < kMaxJoints; ++i) out.real(i < n ? signature.configuration[i] : 0);
  for (std::size_t k = 0; k < kMaxFrames; ++k) {
    const Pose X_SL = k <= n ? signature.X_SL[k] : Pose{};
    for (Eigen::Index row = 0; row < 3; ++row) out.vector(X_SL.R.row(row).transpose());
    out.vector(X_SL.p);
  }
  const Target* target = hand_target(signature);
  out.integer(target != nullptr ? static_cast<std::uint32_t>(target->number) : 0, 4);
  out.integer(target != nullptr ? 1 : 0, 4);
  out.vector(target != nullptr ? target->p_S : Vector3::Zero());
  out.real(record.air_celsius);
  out.real(record.held_out_rms_m);
  out.integer(crc_of(image), 4);
  return image;
}

Result<void> decode(std::span<const std::uint8_t> image, const Arm& drawing,
                    SignatureRecord& record) {
  if (image.size() != kRecordBytes || !std::ranges::equal(image.first(4), kMagic) ||
      Reader(image, kCrcOffset).integer(4) != crc_of(image)) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  Reader in(image, 4);
  const std::uint64_t version = in.integer(2);
  const auto n = static_cast<std::size_t>(in.integer(2));
  const std::uint64_t length = in.integer(4);
  if (version != kVersion || length != kRecordBytes || n == 0 || n > kMaxJoints) {
    return std::unexpected(Error::kRecordCorrupt);
  }
  record.sequence = static_cast<std::uint32_t>(in.integer(4));
  Signature& signature = record.signature;
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
    for (Eigen::Index row = 0; row < 3; ++row) X_SL.R.row(row) = in.vector().transpose();
    X_SL.p = in.vector();
    rotations = rotations && is_rotation(X_SL.R);
    if (k <= n) signature.X_SL.push_back(X_SL);
  }
  Target target{.number = static_cast<int>(in.integer(4)), .link = n};
  const bool has_target = in.integer(4) == 1;
  target.p_S = in.vector();
  if (has_target) signature.targets.push_back(target);
  record.air_celsius = in.real();
  record.held_out_rms_m = in.real();
  if (!in.all_finite() || !rotations) return std::unexpected(Error::kRecordCorrupt);
  if (n != drawing.joints.size()) return std::unexpected(Error::kRecordUnsuitable);
  for (std::size_t i = 0; i < n; ++i) {
    if (signature.types[i] != drawing.joints[i].type) {
      return std::unexpected(Error::kRecordUnsuitable);
    }
  }
  derive_parameters(signature, drawing);
  return {};
}

}  // namespace armsig::controller
