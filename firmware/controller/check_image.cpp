// SPDX-License-Identifier: MIT
#include "firmware/controller/check_image.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "firmware/controller/little_endian.hpp"

namespace armsig::controller {
namespace {

constexpr std::array<std::uint8_t, 4> kCheckMagic{'A', 'C', 'H', 'K'};
constexpr std::uint16_t kCheckVersion = 1;
constexpr std::size_t kCheckCrcOffset = kCheckImageBytes - 4;
// Far beyond what any arm leaves, and what a million checks sum up to.
constexpr float kLargestSum_m = 1e6F;
constexpr double kLargestSum = 1e9;

class CheckWriter : public LittleEndianWriter {
 public:
  using LittleEndianWriter::LittleEndianWriter;
  void vector(const CheckState::Small& v) {
    for (const float x : v) integer(std::bit_cast<std::uint32_t>(x), 4);
  }
  void means(std::span<const CheckState::Mean> means) {
    for (const CheckState::Mean& mean : means) {
      vector(mean.sum);
      integer(mean.count, 2);
      integer(0, 2);
    }
  }
};

class CheckReader : public LittleEndianReader {
 public:
  using LittleEndianReader::LittleEndianReader;
  CheckState::Small vector() {
    CheckState::Small v;
    for (float& x : v) {
      x = std::bit_cast<float>(static_cast<std::uint32_t>(integer(4)));
      sound_ = sound_ && std::abs(x) <= kLargestSum_m;  // no number is not, either
    }
    return v;
  }
  void means(std::span<CheckState::Mean> means) {
    for (CheckState::Mean& mean : means) {
      mean.sum = vector();
      mean.count = static_cast<std::uint16_t>(integer(2));
      sound_ = sound_ && integer(2) == 0 && (mean.count > 0 || mean.sum.isZero(0));
    }
  }
  int count(int most) {
    const std::uint64_t value = integer(4);
    sound_ = sound_ && value <= static_cast<std::uint64_t>(most);
    return sound_ ? static_cast<int>(value) : 0;
  }
  [[nodiscard]] bool is_sound() const { return sound_ && all_finite(); }

 private:
  bool sound_ = true;
};

std::uint32_t check_crc(const CheckImage& image) {
  return crc32(std::as_bytes(std::span(image).first(kCheckCrcOffset)));
}

// A pose is in the reference no more often than checks were, and there is no sum before that is
// whole.
bool checks_may_leave(const CheckState& state) {
  const auto most = std::ranges::max(state.reference, {}, &CheckState::Mean::count).count;
  return most <= state.learnt && (most > 0) == (state.learnt > 0) &&
         state.sum.since <= state.sum.checks && state.sum.sum.norm() <= kLargestSum &&
         (state.learnt == kCheckBaseline || state.sum.checks == 0) &&
         state.means.size() == static_cast<std::size_t>(std::min(state.sum.checks, kCheckBaseline));
}

CheckState read_check_state(CheckReader& in) {
  constexpr int kMostChecks = 1 << 30;
  CheckState state;
  state.sequence = static_cast<std::uint32_t>(in.integer(4));
  state.identified_at_s = static_cast<std::int64_t>(in.integer(8));
  state.learnt = in.count(kCheckBaseline);
  for (double& x : state.sum.sum) x = in.real();
  state.sum.checks = in.count(kMostChecks);
  state.sum.since = in.count(kMostChecks);
  state.sum.named = in.count(1) == 1;
  in.means(state.reference);
  in.means(state.since);
  const int means = in.count(kCheckBaseline);
  for (int i = 0; i < means; ++i) state.means.push_back(in.vector());
  return state;
}

}  // namespace

CheckImage encode(const CheckSubject& subject, const CheckState& state) {
  CheckImage image{};
  std::ranges::copy(kCheckMagic, image.begin());
  CheckWriter out{std::span<std::uint8_t>(image).subspan(kCheckMagic.size())};
  out.integer(kCheckVersion, 2);
  out.integer(kCheckImageBytes, 2);
  out.integer(subject.record_crc, 4);
  out.integer(subject.poses_crc, 4);
  out.integer(state.sequence, 4);
  out.integer(static_cast<std::uint64_t>(state.identified_at_s), 8);
  out.integer(static_cast<std::uint64_t>(state.learnt), 4);
  for (const double x : state.sum.sum) out.real(x);
  out.integer(static_cast<std::uint64_t>(state.sum.checks), 4);
  out.integer(static_cast<std::uint64_t>(state.sum.since), 4);
  out.integer(state.sum.named ? 1 : 0, 4);
  out.means(state.reference);
  out.means(state.since);
  out.integer(state.means.size(), 4);
  for (const CheckState::Small& mean : state.means) out.vector(mean);
  CheckWriter(std::span<std::uint8_t>(image).subspan(kCheckCrcOffset)).integer(check_crc(image), 4);
  return image;
}

Result<Recalled> decode(const CheckImage& image, const CheckSubject& subject, CheckState& state) {
  const auto corrupt = std::unexpected(Error::kRecordCorrupt);
  if (!std::ranges::equal(std::span(image).first(kCheckMagic.size()), kCheckMagic)) return corrupt;
  if (CheckReader(image, kCheckCrcOffset).integer(4) != check_crc(image)) return corrupt;
  CheckReader in(image, kCheckMagic.size());
  if (in.integer(2) != kCheckVersion || in.integer(2) != kCheckImageBytes) return corrupt;
  const CheckSubject kept{.record_crc = static_cast<std::uint32_t>(in.integer(4)),
                          .poses_crc = static_cast<std::uint32_t>(in.integer(4))};
  const CheckState read = read_check_state(in);
  if (!in.is_sound() || !checks_may_leave(read)) return corrupt;
  if (kept.record_crc != subject.record_crc || read.sequence != state.sequence ||
      read.identified_at_s != state.identified_at_s) {
    return Recalled::kOtherSignature;
  }
  if (kept.poses_crc != subject.poses_crc) return Recalled::kOtherPoses;
  state = read;
  return Recalled::kEverything;
}

}  // namespace armsig::controller
