// SPDX-License-Identifier: MIT
// A person's own URDF, corrected: the origins of its moving joints put where the signature has the
// axes, and every other byte left as it is.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/problem.hpp"
#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

struct CorrectedJoint {
  std::string name;    // whose origin was changed
  double moved_m = 0;  // the origin
  double turned_rad = 0;
  std::string origin;  // <origin .../>
};

struct CorrectedUrdf {
  std::string text;
  std::vector<CorrectedJoint> joints;  // base to tip
  std::string base, tip;               // links
  Pose X_SB;                           // the base link in the sensor frame
  Pose X_TL;  // the frame that `armsig predict` answers for, in the tip link
  // The file is what xacro made of this one, for which the origins are to be pasted; or empty.
  std::string made_by_xacro_from;
};

// Between which links the arm is; both empty: as the names of the record's joints say.
struct UrdfEnds {
  std::string base, tip;
};

// Each joint's frame is moved onto the axis that the signature has by the shortest way, so that
// meshes, and limits, keep their meaning; fixed joints between and beyond stay as they are.
// Readings of the file are those of the signature: the file must have the zeros and senses of the
// drawing. A coupled joint whose file has no mimic is told the angle between its links.
//
// Refuses what import_urdf() refuses; xacro that is not expanded; another count or other types of
// joints; a joint whose axis is farther from the signature's than arms are from their drawings.
[[nodiscard]] Read<CorrectedUrdf> corrected_urdf(std::string_view text, const UrdfEnds& ends,
                                                 const SignatureRecord& record);

}  // namespace armsig::tool
