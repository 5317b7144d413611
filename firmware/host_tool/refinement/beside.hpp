// SPDX-License-Identifier: MIT
// What more unknowns would explain beside those of a fit, to first order: a score test (Rao, 1948)
// on the residuals of the model that was found, everything taken out that its geometry, gravity and
// gears could do about them. Nothing is fitted again; joint error maps only make it say less.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/calibration/play_block.hpp"
#include "firmware/host_tool/refinement/fitting.hpp"

namespace armsig::tool {

// A coupling that the arm description lacks, or the change of one that it has.
struct SuspectedPair {
  JointCoupling coupling;
  double sigma = 0;  // of its ratio
  double nats = 0;   // logarithm of the ratio of likelihoods, the number tried counted
};

class Beside {
 public:
  // `rows` as the fit had them, which ended at `at` with half of each joint's play `half`.
  Beside(const CalibrationLog& log, std::vector<calibration::FitRow> rows, FitStart at,
         const calibration::PlayBlock::Numbers& half);

  // Logarithm of the ratio of likelihoods, for play in the joints; 0 where rows are too few.
  [[nodiscard]] double nats_of_play() const;
  // The likelier side of every joint in the rows before it first moved: bit j set where its reading
  // grew.
  [[nodiscard]] std::uint8_t first_sides() const;
  // Of all pairs of joints of one type that both moved, those with the most first.
  [[nodiscard]] std::vector<SuspectedPair> pairs() const;

 private:
  // kFirst: what a joint is off by in the rows before it first moved, of which nobody knows the
  // side.
  enum class Of : std::uint8_t { kGain, kPlay, kFirst, kCoupling };
  struct Unknown {
    Of of;
    std::uint8_t joint;
    std::uint8_t from;
  };
  using Columns = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  // Weighted sums over the rows, of all columns: the fit's, then the unknowns beside them.
  struct Sums {
    Eigen::MatrixXd squares;
    Eigen::VectorXd pull;
    double residuals = 0;
    double numbers = 0;
  };
  // Of some columns, those before `beside` taken out.
  struct Worth {
    Eigen::VectorXd size;
    Eigen::VectorXd sigma;
    double nats = 0;
  };

  [[nodiscard]] static double factor_of(Of of, const calibration::FitRow& row,
                                        const calibration::ChainFrames& frames, std::size_t joint,
                                        std::size_t from);
  void choose_unknowns(const Arm& arm, const std::vector<calibration::FitRow>& rows);
  void add_beside(const calibration::FitRow& row, const calibration::ChainFrames& frames,
                  const FitStart& at, Columns& J) const;
  void sum(const std::vector<calibration::FitRow>& rows, const std::vector<Columns>& all);
  [[nodiscard]] Worth worth(const Sums& sums, Eigen::Index first, Eigen::Index count,
                            Eigen::Index before) const;
  [[nodiscard]] Worth worth_of_play() const;
  [[nodiscard]] Eigen::Index first_of(Of of) const;
  [[nodiscard]] bool tells() const;

  std::vector<Unknown> unknowns_;
  Eigen::VectorXd prior_;   // of the fit's columns: how firmly they are held
  std::vector<Sums> sums_;  // by a fine and a coarse scale of what is a blunder
};

}  // namespace armsig::tool
