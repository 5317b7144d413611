// SPDX-License-Identifier: MIT
#include "firmware/analysis/uncertainty/feature_information.hpp"

#include <span>

#include <Eigen/Cholesky>

#include "firmware/analysis/starts/determination.hpp"

namespace armsig::uncertainty {

using calibration::kNoColumn;
using calibration::Layout;
using calibration::Refined;
using calibration::RowBlock;
using features::JointFeature;

namespace {

// A target counts as the one that a sweep has seen when it lies this near to the sweep's circle.
constexpr double kSameTarget_m = 5e-3;

using Matrix7 = Eigen::Matrix<double, 7, 7>;

// Some unknowns with their joint covariance: axis direction x, y, position x, y, target x, y, z.
struct Block {
  std::array<std::size_t, 7> columns{};
  int size = 0;
  Matrix7 by_feature = Matrix7::Zero();  // row k: unknown k by (point, rotation, radius)

  void add(std::size_t column, const Vector3& by_point, const Vector3& by_rotation,
           double by_radius) {
    by_feature.row(size) << by_point.transpose(), by_rotation.transpose(), by_radius;
    columns[static_cast<std::size_t>(size++)] = column;
  }
};

Block block_of(const Layout& layout, const Signature& signature, std::size_t joint,
               const Target* target) {
  const JointFeature& feature = signature.features[joint];
  const Pose& X = signature.X_SL[joint];
  const Vector3 x = X.R.col(0);
  const Vector3 y = X.R.col(1);
  Block block;
  block.add(layout.axis[joint], Vector3::Zero(), x, 0);
  block.add(layout.axis[joint] + 1, Vector3::Zero(), y, 0);
  // A point r away from the feature's point moves by w x r; component x of it is (r x x) . w.
  const Vector3 r = X.p - feature.point_S;
  if (feature.type == JointType::kRevolute) {
    block.add(layout.axis[joint] + 2, x, r.cross(x), 0);
    block.add(layout.axis[joint] + 3, y, r.cross(y), 0);
  }
  if (target == nullptr) return block;
  const std::size_t column =
      layout.target[static_cast<std::size_t>(target - signature.targets.data())];
  const Vector3 to_target = target->p_S - feature.point_S;
  Vector3 radial = to_target - to_target.dot(feature.axis_S) * feature.axis_S;
  radial.normalize();  // on the axis it stays nought
  if (feature.type == JointType::kPrismatic) radial.setZero();
  for (int c = 0; c < 3; ++c) {
    const Vector3 unit = Vector3::Unit(c);
    block.add(column + static_cast<std::size_t>(c), unit, to_target.cross(unit), radial[c]);
  }
  return block;
}

// Takes in what is known of some unknowns by their covariance: rows W with W^T W its inverse, the
// inverse of its Cholesky factor. kSingular where it is not positive definite.
template <int kSize>
Result<void> absorb(const Eigen::Matrix<double, kSize, kSize>& covariance,
                    std::span<const std::size_t> columns, Refined& estimate) {
  const Eigen::LLT<Eigen::Matrix<double, kSize, kSize>> cholesky(covariance);
  if (cholesky.info() != Eigen::Success) return std::unexpected(Error::kSingular);
  Eigen::Matrix<double, kSize, kSize> W;
  for (int k = 0; k < kSize; ++k) {
    const auto unit = Eigen::Matrix<double, kSize, 1>::Unit(k).eval();
    W.col(k) = cholesky.matrixL().solve(unit);
  }
  for (std::size_t row = 0; row < columns.size(); ++row) {
    RowBlock<1> rows;
    rows.clear(estimate.layout.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
      rows.rows[0][columns[k]] = W(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k));
    }
    estimate.information.absorb(rows);
  }
  return {};
}

Result<void> absorb(const Block& block, const JointFeature& feature, Refined& estimate) {
  // Unused rows are independent unknowns of unit variance that are dropped again.
  Matrix7 covariance = block.by_feature * feature.covariance * block.by_feature.transpose();
  for (int k = block.size; k < 7; ++k) covariance(k, k) = 1;
  return absorb<7>(covariance, std::span(block.columns).first(static_cast<std::size_t>(block.size)),
                   estimate);
}

const Target* seen_by(const Signature& signature, std::size_t joint) {
  const JointFeature& feature = signature.features[joint];
  for (const Target& target : signature.targets) {
    if (target.link != joint + 1) continue;
    const Vector3 expected = feature.target_at(signature.configuration[joint]);
    if ((expected - target.p_S).norm() < kSameTarget_m) return &target;
  }
  return nullptr;
}

}  // namespace

Result<void> from_features(const Signature& signature, Refined& estimate) {
  const std::size_t n = signature.joint_count();
  ARMSIG_CHECK(signature.features.size() == n && signature.X_SL.size() == n + 1);
  estimate = {};
  estimate.signature = signature;
  std::array<bool, kMaxTargets> observed{};
  for (std::size_t t = 0; t < signature.targets.size(); ++t) observed[t] = true;
  const auto layout = calibration::make_layout(signature, observed, {}, 0);
  if (!layout) return std::unexpected(layout.error().error);
  estimate.layout = *layout;
  calibration::set_wide_priors(*layout, estimate.information);
  std::array<bool, kMaxTargets> joined{};
  for (std::size_t joint = 0; joint < n; ++joint) {
    const Target* seen = seen_by(signature, joint);
    if (seen != nullptr) joined[static_cast<std::size_t>(seen - signature.targets.data())] = true;
    const Block block = block_of(*layout, signature, joint, seen);
    const Result<void> taken = absorb(block, signature.features[joint], estimate);
    if (!taken) return taken;
  }
  const auto columns_of = [&](std::size_t target) {
    const std::size_t first = layout->target[target];
    return std::array<std::size_t, 3>{first, first + 1, first + 2};
  };
  for (std::size_t t = 0; t < signature.targets.size(); ++t) {
    if (joined[t]) continue;
    // A target that no feature is joined with knows its own uncertainty, or nothing.
    static_cast<void>(absorb<3>(signature.targets[t].covariance_m2, columns_of(t), estimate));
  }
  for (std::size_t t = 0; t < signature.targets.size(); ++t) {
    RowBlock<3> of_target;
    of_target.clear(layout->size());
    for (std::size_t c = 0; c < 3; ++c) of_target.rows[c][columns_of(t)[c]] = 1;
    estimate.signature.targets[t].covariance_m2 = estimate.information.covariance(of_target);
  }
  return {};
}

}  // namespace armsig::uncertainty
