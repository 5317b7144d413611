// SPDX-License-Identifier: MIT
#include "core/features/line_of_translation.hpp"

namespace armsig::features {

Result<LineOfTranslation> line_of_translation(const Geometry& geometry) {
  const Eigen::Matrix4d R = geometry.factor();
  int x = 0;
  R.bottomRightCorner<3, 3>().colwise().squaredNorm().maxCoeff(&x);
  const int y = (x + 1) % 3;
  const int z = (x + 2) % 3;
  SquareRootRls<2, 2> regression;
  for (int row = 0; row < 4; ++row)
    regression.update({R(row, 0), R(row, 1 + x)}, {R(row, 1 + y), R(row, 1 + z)});
  if (regression.rank() < 2) return std::unexpected(Error::kSingular);
  const Eigen::Matrix2d a = regression.solve();  // rows: constant, slope

  LineOfTranslation line;
  line.direction_S[x] = 1;
  line.direction_S[y] = a(1, 0);
  line.direction_S[z] = a(1, 1);
  line.direction_S.normalize();
  line.mean = R.block<1, 3>(0, 1).transpose() / R(0, 0);
  return line;
}

}  // namespace armsig::features
