// SPDX-License-Identifier: MIT
#include "core/calibration/parameters.hpp"

namespace armsig::calibration {

Judged<Layout> make_layout(const Signature& signature,
                           const std::array<bool, kMaxTargets>& observed,
                           const ParameterRequest& request, std::size_t receiver_count) {
  Layout layout;
  // Counts on beyond the capacity, so that the error can say how many there would be.
  std::size_t count = 0;
  const auto append = [&](ParameterKind kind, std::size_t index, std::size_t components) {
    const std::size_t first = count;
    for (std::size_t i = 0; i < components; ++i, ++count) {
      if (layout.parameters.full()) continue;
      layout.parameters.push_back(
          {kind, static_cast<std::uint8_t>(index), static_cast<std::uint8_t>(i)});
    }
    return first;
  };
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    const bool revolute = signature.types[i] == JointType::kRevolute;
    layout.axis[i] = append(ParameterKind::kAxisDirection, i, 2);
    if (revolute) append(ParameterKind::kAxisPosition, i, 2);
    const ReadingTerms terms = request.readings.empty() ? ReadingTerms{} : request.readings[i];
    layout.gain[i] = terms.gain ? append(ParameterKind::kReadingGain, i, 1) : kNoColumn;
    layout.first[i] =
        terms.first && revolute ? append(ParameterKind::kReadingFirst, i, 2) : kNoColumn;
    layout.second[i] =
        terms.second && revolute ? append(ParameterKind::kReadingSecond, i, 2) : kNoColumn;
  }
  for (std::size_t t = 0; t < kMaxTargets; ++t) {
    layout.target[t] = observed[t] ? append(ParameterKind::kTarget, t, 3) : kNoColumn;
  }
  if (request.receiver_offsets && receiver_count > 0) {
    layout.receiver_offsets = count;
    for (std::size_t r = 0; r < receiver_count; ++r) {
      append(ParameterKind::kReceiverOffset, r, 1);
    }
  }
  if (request.scale) layout.scale = append(ParameterKind::kScale, 0, 1);
  if (count > kMaxParameters) {
    return std::unexpected(Refusal{Error::kCapacityExceeded, static_cast<double>(count),
                                   static_cast<double>(kMaxParameters)});
  }
  return layout;
}

}  // namespace armsig::calibration
