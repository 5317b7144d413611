// SPDX-License-Identifier: MIT
// Uses the installed core: half a metre of arm, turned by a quarter, and the servo's kinematics of
// a six-joint arm, whose types must be those of the library whatever this is built with.
#include <cmath>
#include <cstdio>

#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/analysis/layout.hpp"
#include "firmware/analysis/postures/cold_start.hpp"

namespace {

using namespace armsig;  // NOLINT(google-build-using-namespace): as a user's program would

bool same_layout() {
  const auto library = library_layout();
  bool same = library.size() == kLayout.size();
  for (std::size_t i = 0; same && i < kLayout.size(); ++i) {
    if (library[i] == kLayout[i]) continue;
    std::printf("%s: %zu bytes here, %zu in the library\n", kLayout[i].name.data(), kLayout[i].size,
                library[i].size);
    same = false;
  }
  return same;
}

DhRows puma() {
  using enum JointType;
  return {{kRevolute, 0, 0, 0, -kPi / 2},    {kRevolute, 0, 0, 0.4318, 0},
          {kRevolute, 0, 0.149, 0, kPi / 2}, {kRevolute, 0, 0.4331, 0, -kPi / 2},
          {kRevolute, 0, 0, 0, kPi / 2},     {kRevolute, 0, 0.0563, 0, 0}};
}

// What the library makes of a chain that has passed through this program's hands.
bool servo() {
  const kinematics::Chain made = kinematics::make_chain(puma());
  kinematics::Chain chain;
  chain = made;
  const JointVector q{0.2, -0.8, 0.9, 0.3, 0.7, -0.4};
  JointVector seed = q;
  for (double& reading : seed) reading += 0.01;
  const auto X = kinematics::forward(chain, q);
  const auto at = kinematics::forward_with_jacobian(chain, q);
  if (!X || !at) return false;
  const auto solution = kinematics::inverse(chain, *X, seed);
  if (!solution || solution->verdict != kinematics::Verdict::kConverged) return false;
  const bool good = std::abs(solution->q[4] - q[4]) < 1e-9 && (at->X_0n.p - X->p).norm() < 1e-12 &&
                    std::abs(at->J(5, 0) - 1) < 1e-12 &&
                    (X->R.transpose() * X->R).isIdentity(1e-12);
  const auto solutions = kinematics::cold_start(chain, kinematics::closed_form(chain), *X);
  return good && solutions && solutions->size() == 8;
}

}  // namespace

int main() {
  Arm arm;
  arm.joints.push_back({JointType::kRevolute, 0, 0, 0.5, 0});
  arm.limits.push_back({-kPi, kPi});
  JointVector q;
  q.push_back(0);
  const Signature signature = signature_of(arm, q, Pose{}, {});
  q[0] = kPi / 2;
  const Vector3 p = kinematics::link_pose(signature, q, 1).p;
  const Vector3 single =
      kinematics::link_pose(kinematics::chain_of<float>(signature), q, 1).p.cast<double>();
  std::printf("%.3f %.3f %.3f\n", p.x(), p.y(), p.z());
  if (!same_layout()) return 1;
  return servo() && (single - p).norm() < 1e-5 ? 0 : 2;
}
