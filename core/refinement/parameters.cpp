// SPDX-License-Identifier: MIT
#include "core/refinement/parameters.hpp"

namespace armsig::refinement {

namespace {

// Appends `count` unknowns of one kind; counts on beyond the capacity, so that the error can say
// how many there would be.
class Appender {
 public:
  explicit Appender(Layout& layout) : layout_(layout) {}

  std::size_t append(ParameterKind kind, std::size_t index, std::size_t count) {
    const std::size_t first = count_;
    for (std::size_t i = 0; i < count; ++i, ++count_) {
      if (layout_.parameters.full()) continue;
      layout_.parameters.push_back(
          {kind, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(i)});
    }
    return first;
  }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  Layout& layout_;
  std::size_t count_ = 0;
};

}  // namespace

Judged<Layout> make_layout(const Signature& signature,
                           const std::array<bool, kMaxTargets>& observed,
                           const ParameterRequest& request, std::size_t receiver_count) {
  Layout layout;
  Appender appender(layout);
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    const bool revolute = signature.types[i] == JointType::kRevolute;
    layout.axis[i] = appender.append(ParameterKind::kAxisDirection, i, 2);
    if (revolute) appender.append(ParameterKind::kAxisPosition, i, 2);
    const ReadingTerms terms = request.readings.empty() ? ReadingTerms{} : request.readings[i];
    layout.gain[i] = terms.gain ? appender.append(ParameterKind::kReadingGain, i, 1) : kNoColumn;
    layout.first[i] =
        terms.first && revolute ? appender.append(ParameterKind::kReadingFirst, i, 2) : kNoColumn;
    layout.second[i] =
        terms.second && revolute ? appender.append(ParameterKind::kReadingSecond, i, 2) : kNoColumn;
  }
  for (std::size_t t = 0; t < kMaxTargets; ++t) {
    layout.target[t] = observed[t] ? appender.append(ParameterKind::kTarget, t, 3) : kNoColumn;
  }
  if (request.receiver_offsets && receiver_count > 0) {
    layout.receiver_offsets = appender.count();
    for (std::size_t r = 0; r < receiver_count; ++r) {
      appender.append(ParameterKind::kReceiverOffset, r, 1);
    }
  }
  if (request.scale) layout.scale = appender.append(ParameterKind::kScale, 0, 1);
  if (appender.count() > kMaxParameters) {
    return std::unexpected(Refusal{Error::kCapacityExceeded, static_cast<double>(appender.count()),
                                   static_cast<double>(kMaxParameters)});
  }
  return layout;
}

}  // namespace armsig::refinement
