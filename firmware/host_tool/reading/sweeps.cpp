// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/sweeps.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

// A joint held by its drive wanders by a count or so; more than this moves a target at arm's length
// by 1 mm. Where the features are but a start, from which a fit to the readings themselves goes on,
// by 3 mm.
constexpr double kHeldTolerance_rad = 1e-3;
constexpr double kHeldTolerance_m = 1e-4;
constexpr double kOfAStart = 3;

}  // namespace

SweepSet::SweepSet(const Arm& nominal, std::string file, features::Method method, bool start_alone)
    : nominal_(nominal),
      file_(std::move(file)),
      method_(method),
      share_(start_alone ? kOfAStart : 1) {}

double SweepSet::held_tolerance(JointType type) const {
  return share_ * (type == JointType::kRevolute ? kHeldTolerance_rad : kHeldTolerance_m);
}

Problem SweepSet::at(std::size_t line, std::string what, std::string expected) const {
  return {file_, static_cast<int>(line), 0, std::move(what), std::move(expected)};
}

std::string SweepSet::reading(std::size_t joint, double value) const {
  return reading_in_words(nominal_.joints[joint].type, value);
}

std::optional<Problem> SweepSet::add(const LocatedRow& row) {
  if (row.sweep == 0) {
    ++mixed_rows_;
    mixed_targets_.insert(row.target);
    return std::nullopt;
  }
  const std::size_t swept = row.sweep - 1;
  const bool first_row = !sweeps_.contains(swept);
  Sweep& sweep = sweeps_[swept];
  if (first_row) {
    for (const double q : row.q) sweep.held.push_back({q, row.line});
  }
  for (std::size_t j = 0; j < row.q.size(); ++j) {
    if (j == swept) continue;
    const Held& held = sweep.held[j];
    if (std::abs(row.q[j] - held.reading) > held_tolerance(nominal_.joints[j].type)) {
      if (hangs_on(j, swept)) {
        sweep.carried = std::min(j, sweep.carried.value_or(j));
        continue;
      }
      return at(row.line,
                fmt::format("sweep {} moves joint {} as well: {} here, {} in line {}", row.sweep,
                            j + 1, reading(j, row.q[j]), reading(j, held.reading), held.line),
                "every joint but the swept one to be held; or sweep 0, any pose, and --method "
                "refined");
    }
  }
  const auto estimator =
      sweep.targets
          .try_emplace(row.target,
                       features::SweepConfig{
                           .type = nominal_.joints[swept].type, .limits = {}, .method = method_})
          .first;
  const auto added = estimator->second.add(row.q[swept], row.p_S, row.covariance_m2);
  if (!added) return at(row.line, std::string(describe(added.error())), "finite numbers");
  return std::nullopt;
}

bool SweepSet::hangs_on(std::size_t joint, std::size_t from) const {
  return std::ranges::any_of(nominal_.couplings, [&](const JointCoupling& coupling) {
    return coupling.joint == joint && coupling.from == from;
  });
}

Read<void> SweepSet::check_carried() const {
  std::map<int, std::size_t> link_of;
  for (const auto& [swept, sweep] : sweeps_) {
    for (const auto& [target, estimator] : sweep.targets) link_of[target] = swept + 1;
  }
  for (const int target : mixed_targets_) link_of[target] = nominal_.joints.size();
  for (const auto& [swept, sweep] : sweeps_) {
    if (!sweep.carried) continue;
    for (const auto& [target, estimator] : sweep.targets) {
      if (link_of[target] <= *sweep.carried) continue;
      return std::unexpected(
          at(0,
             fmt::format("sweep {} carries joint {} along, because their readings are coupled: "
                         "target {} follows no circle about axis {}",
                         swept + 1, *sweep.carried + 1, target, swept + 1),
             fmt::format("--method refined, which takes such a sweep; or a target on link {}",
                         swept + 1)));
    }
  }
  return {};
}

// Per joint, the reading that the sweeps of the joints beyond it hold it at; the last joint, which
// none holds for a purpose, stays where the other sweeps have it or at its own first reading.
Read<JointVector> SweepSet::configuration() const {
  JointVector configuration;
  for (std::size_t j = 0; j < nominal_.joints.size(); ++j) {
    std::optional<std::pair<std::size_t, Held>> holder;
    for (const auto& [swept, sweep] : sweeps_) {
      if (swept <= j) continue;
      const Held& held = sweep.held[j];
      if (!holder) {
        holder = {swept, held};
      } else if (std::abs(held.reading - holder->second.reading) >
                 held_tolerance(nominal_.joints[j].type)) {
        return std::unexpected(
            at(held.line,
               fmt::format("sweep {} holds joint {} at {}, sweep {} at {} (line {})", swept + 1,
                           j + 1, reading(j, held.reading), holder->first + 1,
                           reading(j, holder->second.reading), holder->second.line),
               "all sweeps of joints beyond it to hold it at its signature configuration"));
      }
    }
    if (!holder) holder = {j, sweeps_.begin()->second.held[j]};
    configuration.push_back(holder->second.reading);
  }
  return configuration;
}

Read<features::JointFeature> SweepSet::joint_feature(std::size_t joint) const {
  std::optional<features::JointFeature> feature;
  for (const auto& [target, estimator] : sweeps_.at(joint).targets) {
    const auto estimated = estimator.estimate();
    if (!estimated) {
      const JointType type = nominal_.joints[joint].type;
      return std::unexpected(at(0,
                                fmt::format("sweep {}, target {}: {}", joint + 1, target,
                                            refusal_in_words(estimated.error(), type)),
                                remedy_in_words(estimated.error().error)));
    }
    feature = feature ? features::fuse(*feature, *estimated) : *estimated;
  }
  return *feature;
}

bool SweepSet::holds(std::size_t swept, const JointVector& configuration) const {
  for (std::size_t j = swept + 1; j < configuration.size(); ++j) {
    const double off = sweeps_.at(swept).held[j].reading - configuration[j];
    if (std::abs(off) > held_tolerance(nominal_.joints[j].type)) return false;
  }
  return true;
}

// Seen in the sweeps of inner joints only, a target may be on any link from theirs on. One target a
// link is what most people do; a target of several sweeps, or beside one that is further out, looks
// like one on the hand that the last sweeps have missed.
std::vector<std::string> SweepSet::doubtful_targets() const {
  std::map<int, std::set<std::size_t>> seen;
  for (const auto& [swept, sweep] : sweeps_) {
    for (const auto& [number, estimator] : sweep.targets) seen[number].insert(swept);
  }
  const std::size_t n = nominal_.joints.size();
  std::vector<std::string> doubts;
  for (const auto& [number, sweeps] : seen) {
    const std::size_t outermost = *sweeps.rbegin();
    if (outermost + 1 == n || mixed_targets_.contains(number)) continue;
    const bool beside = std::ranges::any_of(seen, [&](const auto& other) {
      return other.second.contains(outermost) && *other.second.rbegin() > outermost;
    });
    if (sweeps.size() < 2 && !beside) continue;
    doubts.push_back(fmt::format(
        "target {} is in no sweep beyond joint {}, and taken as fixed to link {}; if it is on the "
        "flange, a row of it in sweep {} or with sweep 0 says so",
        number, outermost + 1, outermost + 1, n));
  }
  return doubts;
}

// A target is fixed to the link beyond the swept joint; one seen in several sweeps to the outermost
// of them; one seen in mixed poses to the last link.
FixedVector<Target, kMaxTargets> SweepSet::targets(const JointVector& configuration) const {
  std::map<int, Target> by_number;
  for (const auto& [swept, sweep] : sweeps_) {
    for (const auto& [number, estimator] : sweep.targets) {
      const auto feature = estimator.estimate();
      if (!feature) continue;
      const bool on_hand = mixed_targets_.contains(number) && holds(swept, configuration);
      by_number[number] = {.number = number,
                           .link = on_hand ? configuration.size() : swept + 1,
                           .p_S = feature->target_at(configuration[swept]),
                           .covariance_m2 = feature->target_covariance_at(configuration[swept])};
    }
  }
  FixedVector<Target, kMaxTargets> targets;
  for (const auto& [number, target] : by_number) {
    if (!targets.full()) targets.push_back(target);
  }
  return targets;
}

Read<SweptArm> SweepSet::finish() const {
  for (std::size_t j = 0; j < nominal_.joints.size(); ++j) {
    if (!sweeps_.contains(j)) {
      return std::unexpected(
          at(0, fmt::format("joint {} is not swept", j + 1),
             fmt::format("a sweep of each of the {} joints", nominal_.joints.size())));
    }
  }
  if (auto circles = check_carried(); !circles) {
    return std::unexpected(std::move(circles).error());
  }
  SweptArm swept;
  auto signature_configuration = configuration();
  if (!signature_configuration) return std::unexpected(signature_configuration.error());
  swept.configuration = *signature_configuration;
  for (std::size_t j = 0; j < nominal_.joints.size(); ++j) {
    auto feature = joint_feature(j);
    if (!feature) return std::unexpected(feature.error());
    swept.features.push_back(*feature);
  }
  swept.targets = targets(swept.configuration);
  return swept;
}

}  // namespace armsig::tool
