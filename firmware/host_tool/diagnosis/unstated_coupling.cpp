// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/unstated_coupling.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "firmware/host_tool/diagnosis/unchanging_arm.hpp"

namespace armsig::tool {
namespace {

constexpr int kRatioSteps = 4;
constexpr double kSettledRatio = 2e-4;  // of the ratio, in a step

struct PairOfJoints {
  std::size_t joint = 0;
  std::size_t from = 0;
  double ratio = 0;
  double gain = 0;  // of weighted squares
};

std::vector<PairOfJoints> pairs_of(const Evidence& evidence) {
  std::vector<PairOfJoints> pairs;
  const auto& joints = evidence.arm.joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (i == j || joints[i].type != joints[j].type) continue;
      if (has_moved(evidence, i) && has_moved(evidence, j))
        pairs.push_back({.joint = j, .from = i});
    }
  }
  return pairs;
}

// To first order: what each pair would be, all that an unchanging arm can do taken out.
void measure(const Evidence& evidence, const NearestArm& nearest,
             std::vector<PairOfJoints>& pairs) {
  const UnchangingArm arm(evidence, nearest.chain, nearest.fit.residuals_S);
  const auto count = static_cast<Eigen::Index>(pairs.size());
  Eigen::MatrixXd across = Eigen::MatrixXd::Zero(arm.size(), count);
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd score = Eigen::VectorXd::Zero(count);
  Eigen::Matrix3Xd moved(3, count);
  for (std::size_t k = 0; k < arm.rows(); ++k) {
    const Eigen::Matrix3Xd motions = nearest.chain.motions(evidence.rows[k]);
    for (Eigen::Index p = 0; p < count; ++p) {
      const PairOfJoints& pair = pairs[static_cast<std::size_t>(p)];
      moved.col(p) =
          evidence.rows[k].q[pair.from] * motions.col(static_cast<Eigen::Index>(pair.joint));
    }
    across.noalias() += arm.weight(k) * (arm.derivatives(k).transpose() * moved);
    squares += arm.weight(k) * moved.colwise().squaredNorm().transpose();
    score.noalias() += arm.weight(k) * (moved.transpose() * nearest.fit.residuals_S[k]);
  }
  score -= across.transpose() * arm.step();
  const Eigen::MatrixXd taken = arm.inverse() * across;
  for (Eigen::Index p = 0; p < count; ++p) {
    const double left = 1 + squares[p] - across.col(p).dot(taken.col(p));
    PairOfJoints& pair = pairs[static_cast<std::size_t>(p)];
    pair.ratio = score[p] / left;
    pair.gain = score[p] * pair.ratio;
  }
}

}  // namespace

std::optional<UnstatedCoupling> find_unstated_coupling(const Evidence& evidence,
                                                       const ArmLimits& limits) {
  std::vector<PairOfJoints> pairs = pairs_of(evidence);
  if (pairs.empty()) return std::nullopt;
  UnstatedCoupling found{.undone = evidence};
  auto nearest = nearest_arm(found.undone, limits);
  for (int step = 0; step < kRatioSteps && nearest; ++step) {
    measure(found.undone, *nearest, pairs);
    const auto best = std::ranges::max_element(pairs, {}, &PairOfJoints::gain);
    // The first step chooses the pair, the others find its ratio.
    if (step == 0) pairs = {PairOfJoints(*best)};
    const PairOfJoints& pair = pairs.front();
    found.joint = pair.joint;
    found.from = pair.from;
    found.ratio += pair.ratio;
    for (EvidenceRow& row : found.undone.rows) row.q[pair.joint] += pair.ratio * row.q[pair.from];
    nearest = nearest_arm(found.undone, limits);
    if (std::abs(pair.ratio) < kSettledRatio) break;
  }
  if (!nearest) return std::nullopt;
  found.fit = std::move(nearest->fit);
  return found;
}

}  // namespace armsig::tool
