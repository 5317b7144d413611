// SPDX-License-Identifier: MIT
// Link coordinate frames in the signature configuration: section 3.2.2 of the paper.
//
// Frame i - 1 has its z axis along joint i in the positive sense of the joint's reading; where it
// stands on that axis, and where its x axis points, is free in the S-Model.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/features/feature.hpp"

namespace armsig::frames {

// Link frames 0 ... n in the sensor frame, (15)-(17), from one feature a joint. Revolute joint i +
// 1: origin of frame i at the centre of rotation, x towards the target as all its positions
// put it at the reference reading (the paper: towards its first position). Prismatic:
// origin at the target when the joint is in the signature configuration, x any perpendicular. Frame
// n is frame n - 1. Preconditions: one reading a feature; finite features with axis_S of nonzero
// length.
[[nodiscard]] FixedVector<Pose, kMaxFrames> link_frames(
    const FixedVector<features::JointFeature, kMaxJoints>& features,
    const JointVector& configuration);

// Link frames of a known arm at given readings (effective ones: couplings applied), in the arm's
// base frame 0.
//
// A Denavit-Hartenberg origin can stand hundreds of metres along its axis; these frames stand where
// the axis passes closest to the frame before, so that positions keep their digits. Frame 0 is the
// base, frame n the arm's own Denavit-Hartenberg frame n. Denavit-Hartenberg frame k is
// X_0L[k] * Trans(0, 0, -along_m[k]).
struct KnownLinkFrames {
  FixedVector<Pose, kMaxFrames> X_0L;
  FixedVector<double, kMaxFrames> along_m;
};
[[nodiscard]] KnownLinkFrames link_frames(const DhRows& rows, const JointVector& readings);

}  // namespace armsig::frames
