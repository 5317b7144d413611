// SPDX-License-Identifier: MIT
// The noise that sweeps show: of rows that err along one direction far more than along the others,
// as positions from three ranges do, it is what they err by.
#include <gtest/gtest.h>

#include "firmware/host_tool/diagnosis/evidence.hpp"
#include "host_tests/support/random.hpp"

namespace armsig::tool {
namespace {

constexpr int kSweeps = 6;
constexpr int kRows = 60;

// Sweeps of a revolute joint, 0.5 m from its axis, of errors with `factor` times the sigma stated.
// Row by row they grow twice as large, and lean over.
Evidence swept(const Vector3& sigma_m, double factor, test::Random& random) {
  Evidence evidence;
  evidence.arm.joints.push_back({});
  for (int s = 0; s < kSweeps; ++s) {
    for (int k = 0; k < kRows; ++k) {
      const double share = static_cast<double>(k) / (kRows - 1);
      const double q = 4 * share - 2;
      const Matrix3 R = rotation_z(share) * rotation_x(0.4);
      const Vector3 own_m = (1 + share) * sigma_m;
      const Vector3 error_m =
          R * Vector3(random.normal(own_m.x()), random.normal(own_m.y()), random.normal(own_m.z()));
      EvidenceRow row{.sweep = 1, .target = s, .q = {q}};
      row.p_S = Vector3(0.5 * std::cos(q), 0.5 * std::sin(q), 0.1 * s) + factor * error_m;
      row.covariance_m2 = R * own_m.cwiseAbs2().asDiagonal() * R.transpose();
      evidence.rows.push_back(row);
    }
  }
  return evidence;
}

// What RowNoise tells of the rows' mean square error, over what that is by construction; over many
// arms.
double told_over_true(const Vector3& sigma_m, double factor) {
  constexpr int kArms = 40;
  double told = 0;
  double so = 0;
  for (int seed = 1; seed <= kArms; ++seed) {
    test::Random random(static_cast<std::uint64_t>(seed));
    const Evidence evidence = swept(sigma_m, factor, random);
    const RowNoise noise(evidence);
    for (const EvidenceRow& row : evidence.rows) {
      told += noise.mean_square(row);
      so += factor * factor * row.covariance_m2.trace();
    }
  }
  return told / so;
}

// Within 6 % of the sigma: of each sweep the smaller of two estimates is taken, each of sixty rows.
TEST(RowNoise, of_errors_alike_in_all_directions_is_told) {
  EXPECT_NEAR(told_over_true({1e-4, 1e-4, 1e-4}, 1), 1, 0.12);
}

TEST(RowNoise, of_errors_along_one_direction_is_told) {
  EXPECT_NEAR(told_over_true({2e-5, 2e-5, 2e-4}, 1), 1, 0.12);
  EXPECT_NEAR(told_over_true({2e-4, 2e-5, 5e-5}, 1), 1, 0.12);
}

TEST(RowNoise, that_is_more_than_the_rows_state_is_told) {
  EXPECT_NEAR(told_over_true({2e-5, 2e-5, 2e-4}, 2), 1, 0.12);
}

}  // namespace
}  // namespace armsig::tool
