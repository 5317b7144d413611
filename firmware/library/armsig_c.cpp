// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <optional>

#include "core/base/error.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/library/armsig.h"
#include "firmware/library/compensation.hpp"
#include "firmware/library/estimate.hpp"
#include "firmware/library/joint_frames.hpp"

using armsig::Error;
using armsig::JointVector;
using armsig::Pose;
using armsig::Result;
using armsig::tool::Compensation;
using armsig::tool::Correction;
using armsig::tool::EncoderArm;
using armsig::tool::Uncorrected;

static_assert(ARMSIG_MAX_JOINTS == armsig::kMaxJoints);
static_assert(ARMSIG_MAX_SOLUTIONS == armsig::kinematics::kMaxSolutions);

struct armsig_arm {
  armsig_arm(armsig::tool::SignatureRecord of, const armsig::Arm& nominal_model)
      : record(std::move(of)), nominal(nominal_model), compensation(record, nominal) {}

  armsig::tool::SignatureRecord record;
  armsig::Arm nominal;
  Compensation compensation;
  std::unique_ptr<armsig::calibration::Refined> estimate;  // null: no uncertainty
};

namespace armsig::tool {
namespace {

void say_problem(char* problem, std::size_t size, std::string_view words) {
  if (problem == nullptr || size == 0) return;
  const std::size_t length = std::min(words.size(), size - 1);
  std::memcpy(problem, words.data(), length);
  problem[length] = '\0';
}

Read<std::unique_ptr<armsig_arm>> loaded(const char* path, const char* nominal_model) {
  ARMSIG_TRY(record, read_signature_file(path));
  Arm nominal = record.nominal;
  if (nominal_model != nullptr) {
    ARMSIG_TRY(model, read_arm_file(nominal_model));
    if (!std::ranges::equal(types_of(model.arm.joints), record.signature.types)) {
      return std::unexpected(Problem{nominal_model, 0, 0,
                                     "its joints are not of the types of the signature's",
                                     "the nominal model of the same arm"});
    }
    nominal = model.arm;
  }
  auto arm = std::make_unique<armsig_arm>(std::move(record), nominal);
  if (auto estimate = estimate_of(arm->record, path)) arm->estimate = std::move(*estimate);
  return arm;
}

JointVector vector_of(const armsig_arm* arm, const double* readings) {
  JointVector q(arm->record.signature.joint_count());
  std::copy_n(readings, q.size(), q.begin());
  return q;
}

// Nothing of numbers that are no pose.
std::optional<Pose> pose_of_seven(const double* numbers) {
  if (numbers == nullptr) return Pose{};
  constexpr double kTolerance = 1e-3;
  const Eigen::Quaterniond q(numbers[3], numbers[4], numbers[5], numbers[6]);
  const double length = q.coeffs().stableNorm();
  const Vector3 p(numbers[0], numbers[1], numbers[2]);
  if (!p.allFinite() || !(std::abs(length - 1) <= kTolerance)) return std::nullopt;
  return Pose{q.normalized().toRotationMatrix(), p};
}

void write_seven(const Pose& X, double* numbers) {
  const Eigen::Quaterniond q(X.R);
  const std::array<double, ARMSIG_POSE> all{X.p.x(), X.p.y(), X.p.z(), q.w(), q.x(), q.y(), q.z()};
  std::ranges::copy(all, numbers);
}

armsig_status status_of(Error error) {
  return error == Error::kOutOfReach ? ARMSIG_OUT_OF_REACH : ARMSIG_NOT_FINITE;
}

armsig_status status_of(kinematics::Verdict verdict) {
  using kinematics::Verdict;
  if (verdict == Verdict::kConverged) return ARMSIG_OK;
  if (verdict == Verdict::kDegraded) return ARMSIG_SINGULAR;
  return verdict == Verdict::kJointLimit ? ARMSIG_JOINT_LIMIT : ARMSIG_OUT_OF_REACH;
}

armsig_status status_of(const Correction& correction) {
  switch (correction.why) {
    case Uncorrected::kNone:
      return correction.singular ? ARMSIG_SINGULAR : ARMSIG_OK;
    case Uncorrected::kJointLimit:
      return ARMSIG_JOINT_LIMIT;
    case Uncorrected::kConfiguration:
      return ARMSIG_CONFIGURATION;
    case Uncorrected::kTooLarge:
      return ARMSIG_TOO_LARGE;
    case Uncorrected::kNominalReach:
    case Uncorrected::kRealReach:
      break;
  }
  return ARMSIG_OUT_OF_REACH;
}

armsig_status tool_pose(const EncoderArm& model, const JointVector& q, const double* tool,
                        double* pose) {
  const auto X_FT = pose_of_seven(tool);
  const auto X_BF = model.forward(q);
  if (!X_FT || !X_BF) return ARMSIG_NOT_FINITE;
  write_seven(*X_BF * *X_FT, pose);
  return ARMSIG_OK;
}

// `answer(row, width numbers)` for each row: how many there were.
template <typename Answer>
std::size_t all_rows(std::size_t count, std::size_t width, double* answers, armsig_status* statuses,
                     const Answer& answer) {
  std::size_t answered = 0;
  for (std::size_t row = 0; row < count; ++row) {
    double* const numbers = answers + row * width;
    const armsig_status status = answer(row, numbers);
    if (status == ARMSIG_OK || status == ARMSIG_SINGULAR) {
      ++answered;
    } else {
      std::fill_n(numbers, width, std::numeric_limits<double>::quiet_NaN());
    }
    if (statuses != nullptr) statuses[row] = status;
  }
  return answered;
}

}  // namespace
}  // namespace armsig::tool

using namespace armsig::tool;  // NOLINT(google-build-using-namespace): the functions below are C's

extern "C" {

armsig_arm* armsig_load(const char* path, const char* nominal_model, char* problem, size_t size) {
  try {
    auto arm = loaded(path, nominal_model);
    if (arm) return arm->release();
    say_problem(problem, size, render(arm.error()));
  } catch (const std::exception& error) {
    say_problem(problem, size, error.what());
  }
  return nullptr;
}

void armsig_free(armsig_arm* arm) { delete arm; }  // NOLINT(cppcoreguidelines-owning-memory)

size_t armsig_joint_count(const armsig_arm* arm) { return arm->record.signature.joint_count(); }

const char* armsig_words(armsig_status status) {
  switch (status) {
    case ARMSIG_OK:
      return "done";
    case ARMSIG_SINGULAR:
      return "near a singularity";
    case ARMSIG_OUT_OF_REACH:
      return "the pose is out of reach";
    case ARMSIG_JOINT_LIMIT:
      return "a joint limit is in the way";
    case ARMSIG_CONFIGURATION:
      return "the real arm reaches it in another configuration only";
    case ARMSIG_NOT_FINITE:
      return "a number is not finite, or the quaternion is not of length 1";
    case ARMSIG_NO_UNCERTAINTY:
      return "the signature has no uncertainty, or no such target";
    case ARMSIG_NO_ROOM:
      return "the buffer is too small";
    case ARMSIG_TOO_LARGE:
      return "the correction is larger than 20 mm";
  }
  return "not a status";
}

armsig_status armsig_forward(const armsig_arm* arm, const double* readings, const double* tool,
                             double* pose) {
  return tool_pose(arm->compensation.real(), vector_of(arm, readings), tool, pose);
}

armsig_status armsig_nominal_forward(const armsig_arm* arm, const double* readings,
                                     const double* tool, double* pose) {
  return tool_pose(arm->compensation.nominal(), vector_of(arm, readings), tool, pose);
}

armsig_status armsig_inverse(const armsig_arm* arm, const double* pose, const double* tool,
                             const double* seed, double* readings) {
  const auto X_BT = pose_of_seven(pose);
  const auto X_FT = pose_of_seven(tool);
  if (!X_BT || !X_FT) return ARMSIG_NOT_FINITE;
  const auto found =
      arm->compensation.real().inverse(*X_BT * X_FT->inverse(), vector_of(arm, seed), X_FT->p);
  if (!found) return status_of(found.error());
  std::ranges::copy(found->readings, readings);
  return status_of(found->verdict);
}

armsig_status armsig_solutions(const armsig_arm* arm, const double* pose, const double* tool,
                               double* readings, size_t capacity, size_t* count) {
  *count = 0;
  const auto X_BT = pose_of_seven(pose);
  const auto X_FT = pose_of_seven(tool);
  if (!X_BT || !X_FT) return ARMSIG_NOT_FINITE;
  const auto all = arm->compensation.real().solutions(*X_BT * X_FT->inverse(), {}, X_FT->p);
  if (!all) return status_of(all.error());
  const std::size_t joints = armsig_joint_count(arm);
  for (const FoundReadings& found : *all) {
    if (!is_solved(found.verdict)) continue;
    if (*count == capacity) return ARMSIG_NO_ROOM;
    std::ranges::copy(found.readings, readings + *count * joints);
    ++*count;
  }
  return *count > 0 ? ARMSIG_OK : ARMSIG_OUT_OF_REACH;
}

armsig_status armsig_compensate(const armsig_arm* arm, const double* pose, const double* tool,
                                const double* seed, double* corrected, double* readings) {
  const auto X_BT = pose_of_seven(pose);
  const auto X_FT = pose_of_seven(tool);
  if (!X_BT || !X_FT) return ARMSIG_NOT_FINITE;
  const Pose X_BF = *X_BT * X_FT->inverse();
  const auto at = arm->compensation.nominal().inverse(X_BF, vector_of(arm, seed), X_FT->p);
  if (!at) return status_of(at.error());
  if (!is_solved(at->verdict)) return status_of(at->verdict);
  const Correction correction = arm->compensation.pose(X_BF, at->readings, *X_FT);
  if (correction.why != Uncorrected::kNone) return status_of(correction);
  write_seven(correction.X_BF * *X_FT, corrected);
  if (readings != nullptr) std::ranges::copy(correction.readings, readings);
  return status_of(correction);
}

armsig_status armsig_sigma(const armsig_arm* arm, const double* readings, int target,
                           double* sigma_m) {
  const auto& targets = arm->record.signature.targets;
  const auto* const found = std::ranges::find(targets, target, &armsig::Target::number);
  if (arm->estimate == nullptr || found == targets.end()) return ARMSIG_NO_UNCERTAINTY;
  const JointVector q = vector_of(arm, readings);
  if (!arm->compensation.real().forward(q)) return ARMSIG_NOT_FINITE;
  const armsig::Vector3 sigma =
      armsig::uncertainty::tool_covariance(*arm->estimate, q,
                                           static_cast<std::size_t>(found - targets.begin()))
          .diagonal()
          .cwiseSqrt();
  std::copy_n(sigma.data(), 3, sigma_m);
  return ARMSIG_OK;
}

size_t armsig_forward_rows(const armsig_arm* arm, size_t count, const double* readings,
                           const double* tool, double* poses, armsig_status* statuses) {
  const std::size_t joints = armsig_joint_count(arm);
  return all_rows(count, ARMSIG_POSE, poses, statuses, [&](std::size_t row, double* pose) {
    return armsig_forward(arm, readings + row * joints, tool, pose);
  });
}

size_t armsig_nominal_forward_rows(const armsig_arm* arm, size_t count, const double* readings,
                                   const double* tool, double* poses, armsig_status* statuses) {
  const std::size_t joints = armsig_joint_count(arm);
  return all_rows(count, ARMSIG_POSE, poses, statuses, [&](std::size_t row, double* pose) {
    return armsig_nominal_forward(arm, readings + row * joints, tool, pose);
  });
}

size_t armsig_inverse_rows(const armsig_arm* arm, size_t count, const double* poses,
                           const double* tool, const double* seeds, double* readings,
                           armsig_status* statuses) {
  const std::size_t joints = armsig_joint_count(arm);
  return all_rows(count, joints, readings, statuses, [&](std::size_t row, double* q) {
    return armsig_inverse(arm, poses + row * ARMSIG_POSE, tool, seeds + row * joints, q);
  });
}

size_t armsig_compensate_rows(const armsig_arm* arm, size_t count, const double* poses,
                              const double* tool, const double* seeds, double* corrected,
                              armsig_status* statuses) {
  const std::size_t joints = armsig_joint_count(arm);
  return all_rows(count, ARMSIG_POSE, corrected, statuses, [&](std::size_t row, double* pose) {
    return armsig_compensate(arm, poses + row * ARMSIG_POSE, tool, seeds + row * joints, pose,
                             nullptr);
  });
}

size_t armsig_sigma_rows(const armsig_arm* arm, size_t count, const double* readings, int target,
                         double* sigma_m, armsig_status* statuses) {
  const std::size_t joints = armsig_joint_count(arm);
  return all_rows(count, 3, sigma_m, statuses, [&](std::size_t row, double* sigma) {
    return armsig_sigma(arm, readings + row * joints, target, sigma);
  });
}

void armsig_base_in_sensor(const armsig_arm* arm, double* pose) {
  write_seven(joint_frames(arm->record.signature, arm->nominal).X_SB, pose);
}

void armsig_last_link_on_flange(const armsig_arm* arm, double* pose) {
  const armsig::DhJoint& last = arm->nominal.joints.back();
  const Pose X_KF{armsig::rotation_x(last.alpha_rad), armsig::Vector3(last.a_m, 0, 0)};
  write_seven(X_KF.inverse() * joint_frames(arm->record.signature, arm->nominal).X_KL, pose);
}

}  // extern "C"
