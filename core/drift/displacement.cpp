// SPDX-License-Identifier: MIT
#include "core/drift/displacement.hpp"

#include <cmath>

namespace armsig::drift {

using calibration::kMaxColumns;
using calibration::kMaxParameters;
using calibration::kNoColumn;
using calibration::Layout;
using calibration::Refined;
using calibration::RowBlock;
using calibration::SquareRootFactor;

namespace {

constexpr std::size_t kMotions = 6;  // rotation vector, shift
using MotionRow = Eigen::Matrix<double, 1, kMotions>;

// Row i: how unknown i changes with the displacement, G of x = x_0 + G xi.
using MotionMap = std::array<MotionRow, kMaxParameters>;

// Component of the displacement of a point r away from the centre along a direction.
MotionRow shift_of(const Vector3& r, const Vector3& along) {
  MotionRow row;
  row << r.cross(along).transpose(), along.transpose();
  return row;
}

MotionMap motion_map(const Refined& refined, std::size_t link) {
  MotionMap G;
  G.fill(MotionRow::Zero());
  const Layout& layout = refined.layout;
  const Signature& signature = refined.signature;
  const Vector3 centre = signature.X_SL[link].p;
  for (std::size_t j = link; j < signature.joint_count(); ++j) {
    const Pose& X = signature.X_SL[j];
    for (std::size_t c = 0; c < 2; ++c) {
      const Vector3 along = X.R.col(static_cast<Eigen::Index>(c));
      G[layout.axis[j] + c].head<3>() = along.transpose();
      if (signature.types[j] == JointType::kRevolute) {
        G[layout.axis[j] + 2 + c] = shift_of(X.p - centre, along);
      }
    }
  }
  for (std::size_t t = 0; t < signature.targets.size(); ++t) {
    if (layout.target[t] == kNoColumn || signature.targets[t].link < link) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      G[layout.target[t] + c] =
          shift_of(signature.targets[t].p_S - centre, Vector3::Unit(static_cast<Eigen::Index>(c)));
    }
  }
  return G;
}

}  // namespace

// Rows [xi / size] = 0 and R (x - G xi) = 0 over the unknowns (xi, x), xi eliminated: Givens
// rotations against six rows kept aside leave of every row of R one that speaks of x alone.
void displaced_prior(const Refined& refined, std::size_t link, double size,
                     SquareRootFactor& factor) {
  const std::size_t n = refined.layout.size();
  const MotionMap G = motion_map(refined, link);
  struct AsideRow {
    MotionRow motion = MotionRow::Zero();
    std::array<double, kMaxColumns> unknowns{};
  };
  std::array<AsideRow, kMotions> aside;
  for (std::size_t m = 0; m < kMotions; ++m) {
    aside[m].motion[static_cast<Eigen::Index>(m)] = 1 / size;
  }
  factor.reset(n);
  for (std::size_t i = 0; i < n; ++i) {
    RowBlock<1> block;
    block.clear(n);
    auto& row = block.rows[0];
    MotionRow motion = MotionRow::Zero();
    for (std::size_t c = i; c < n; ++c) {
      row[c] = refined.information.entry(i, c);
      motion -= row[c] * G[c];
    }
    for (std::size_t m = 0; m < kMotions; ++m) {
      const auto k = static_cast<Eigen::Index>(m);
      if (motion[k] == 0) continue;
      AsideRow& upper = aside[m];
      const double norm = std::hypot(upper.motion[k], motion[k]);
      const double c = upper.motion[k] / norm;
      const double s = motion[k] / norm;
      const MotionRow turned = c * upper.motion + s * motion;
      motion = c * motion - s * upper.motion;
      upper.motion = turned;
      for (std::size_t u = 0; u < n; ++u) {
        const double above = upper.unknowns[u];
        upper.unknowns[u] = c * above + s * row[u];
        row[u] = c * row[u] - s * above;
      }
    }
    factor.absorb(block);
  }
}

}  // namespace armsig::drift
