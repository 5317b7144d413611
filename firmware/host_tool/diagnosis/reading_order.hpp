// SPDX-License-Identifier: MIT
// Whether rows are in the order of a joint's readings: what the joint does there then looks like
// something that changed with time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

class ReadingOrder {
 public:
  explicit ReadingOrder(const Evidence& evidence) {
    for (std::size_t j = 0; j < evidence.arm.joints.size(); ++j) add_joint(evidence.rows, j);
  }

  // Whether the readings of a joint alone tell the rows from `from` on from those before.
  // Precondition: there are some on either side.
  [[nodiscard]] bool parts_at(std::size_t from) const {
    return std::ranges::any_of(before_, [&](const std::vector<double>& sums) {
      const auto rows = static_cast<double>(sums.size() - 1);
      const auto early = static_cast<double>(from);
      // Of every pair across, by how many more the later reading is the larger; as a share.
      const double larger = 0.5 * rows * (rows + 1) - sums[from] -
                            0.5 * (rows - early) * (rows - early + 1) -
                            0.5 * early * (rows - early);
      return std::abs(larger) > 0.5 * kAlmostAll * early * (rows - early);
    });
  }

  // Whether a joint went from one end of its readings to the other, from the first row to the last.
  [[nodiscard]] bool runs() const { return runs_; }

 private:
  static constexpr double kAlmostAll = 0.95;

  void add_joint(const std::vector<EvidenceRow>& rows, std::size_t joint) {
    std::vector<double> sorted;
    for (const EvidenceRow& row : rows) sorted.push_back(row.q[joint]);
    std::ranges::sort(sorted);
    const double middle = 0.5 * static_cast<double>(rows.size() + 1);
    double across = 0;
    double own = 0;
    double of_rows = 0;
    std::vector<double> sums{0};
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto [first, last] = std::ranges::equal_range(sorted, rows[k].q[joint]);
      // From one; of equal ones the mean.
      const double rank =
          0.5 * static_cast<double>((first - sorted.begin()) + (last - sorted.begin()) + 1);
      const double place = static_cast<double>(k + 1) - middle;
      sums.push_back(sums.back() + rank);
      across += place * (rank - middle);
      own += (rank - middle) * (rank - middle);
      of_rows += place * place;
    }
    runs_ = runs_ || std::abs(across) > kAlmostAll * std::sqrt(own * of_rows);
    before_.push_back(std::move(sums));
  }

  std::vector<std::vector<double>> before_;  // sums of the ranks of each joint's readings
  bool runs_ = false;
};

}  // namespace armsig::tool
