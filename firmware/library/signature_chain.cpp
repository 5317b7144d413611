// SPDX-License-Identifier: MIT
#include "firmware/library/signature_chain.hpp"

#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/base/couplings.hpp"
#include "core/kinematics/forward.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {

Read<std::optional<Target>> find_target(const SignatureRecord& record, const std::string& file,
                                        std::optional<int> number) {
  if (!number) return std::nullopt;
  std::vector<std::string> known;
  for (const Target& target : record.signature.targets) {
    if (target.number == *number) return target;
    known.push_back(std::to_string(target.number));
  }
  return std::unexpected(
      Problem{file, 0, 0, fmt::format("there is no target {}", *number),
              known.empty() ? "a signature with targets" : "target " + any_of(known)});
}

kinematics::Chain chain_of_record(const SignatureRecord& record) {
  return kinematics::make_chain(record.signature.pseudo_dh, effective_limits(record.nominal));
}

Pose point_in_last_frame(const SignatureRecord& record, const kinematics::Chain& chain,
                         const std::optional<Target>& target) {
  const Signature& signature = record.signature;
  const auto X_0n = kinematics::forward(chain, signature.configuration);
  ARMSIG_CHECK(X_0n);  // a signature file holds finite numbers only
  Pose X_SP = signature.X_SL.back();
  if (target) X_SP.p = target->p_S;
  return (signature.X_SL[0] * *X_0n).inverse() * X_SP;
}

}  // namespace armsig::tool
