// SPDX-License-Identifier: MIT
// What the lead of each slide moves a row's point by: an arm on slides does by its leads what a
// sensor with axes of different scale does to what it sees, so that no row tells the two apart.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "firmware/host_tool/diagnosis/deviating_chain.hpp"

namespace armsig::tool {

class SlideLeads {
 public:
  // Of the slides that moved.
  explicit SlideLeads(const Evidence& evidence);

  [[nodiscard]] Eigen::Index count() const { return static_cast<Eigen::Index>(slides_.size()); }
  // Of unit shares of the readings, in the sensor frame; `J`: the chain's derivatives of the row.
  [[nodiscard]] Eigen::Matrix3Xd of(const EvidenceRow& row, const DeviatingChain& chain,
                                    const Eigen::Matrix3Xd& J) const;

 private:
  struct Slide {
    std::size_t joint = 0;
    Vector3 axis_L = Vector3::UnitZ();  // in the link beyond it
  };
  std::vector<Slide> slides_;
};

}  // namespace armsig::tool
