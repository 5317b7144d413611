// SPDX-License-Identifier: MIT
// What more unknowns would explain beside those of a fit, to first order: a score test (Rao, 1948)
// on the residuals of the model that was found, everything taken out that its geometry, gravity and
// gears could do about them. Nothing is fitted again; joint error maps only make it say less.
#pragma once

#include <array>
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

// A vertical that explains more than the one of the fit.
struct SuspectedVertical {
  Vector3 up_0 = Vector3::UnitZ();
  double nats = 0;   // logarithm of the ratio of likelihoods beside the fit's own vertical
  double share = 1;  // of the RMS that is left with the fit's own
};

class Beside {
 public:
  enum class Asked : std::uint8_t { kPlayAndPairs, kVertical };

  // `rows` as the fit had them, which ended at `at` with half of each joint's play `half`.
  Beside(const CalibrationLog& log, std::vector<calibration::FitRow> rows, FitStart at,
         const calibration::PlayBlock::Numbers& half, Asked asked = Asked::kPlayAndPairs);

  // Logarithm of the ratio of likelihoods, for play in the joints; 0 where rows are too few.
  [[nodiscard]] double nats_of_play() const;
  // The likelier side of every joint in the rows before it first moved: bit j set where its reading
  // grew.
  [[nodiscard]] std::uint8_t first_sides() const;
  // Of all pairs of joints of one type that both moved, those with the most first.
  [[nodiscard]] std::vector<SuspectedPair> pairs() const;
  // What fewer rows have of a load or a slip is easily a pair of joints.
  [[nodiscard]] bool tells_pairs_apart() const;
  // The vertical along which weights at the link origins explain the rows best; that of the fit
  // where rows are too few. Precondition: this was asked for.
  [[nodiscard]] SuspectedVertical vertical() const;

 private:
  // kFirst: what a joint is off by in the rows before it first moved, of which nobody knows the
  // side. kWeight: how far a joint gives way to a weight at a link origin, along one axis of the
  // base frame: three unknowns for each term of `weights_`.
  enum class Of : std::uint8_t { kGain, kPlay, kFirst, kCoupling, kWeight };
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
  // Of some columns, those before them taken out: ½ x' own x - score' x + ½ left is to be least.
  struct Reduced {
    Eigen::MatrixXd own;
    Eigen::VectorXd score;
    double left = 0;  // square sum of the residuals without them
    double freedom = 1;
  };
  struct Worth {
    Eigen::VectorXd size;
    Eigen::VectorXd sigma;
    double nats = 0;
  };

  [[nodiscard]] static double factor_of(Of of, const calibration::FitRow& row,
                                        const calibration::ChainFrames& frames, std::size_t joint,
                                        std::size_t from);
  void choose_unknowns(const Arm& arm, const std::vector<calibration::FitRow>& rows);
  void choose_weights(const Arm& arm);
  void add_beside(const calibration::FitRow& row, const calibration::ChainFrames& frames,
                  const FitStart& at, Columns& J);
  [[nodiscard]] std::array<calibration::GravityLevers, 3> levers_along_axes(
      const JointVector& effective);
  class Batch;
  template <typename Fill>
  void sum(const std::vector<calibration::FitRow>& rows, Fill fill);
  [[nodiscard]] Reduced reduced(const Sums& sums, Eigen::Index first, Eigen::Index count,
                                Eigen::Index before) const;
  [[nodiscard]] Worth worth(const Sums& sums, Eigen::Index first, Eigen::Index count,
                            Eigen::Index before) const;
  [[nodiscard]] Worth worth_of_play() const;
  [[nodiscard]] Eigen::Index weights_told() const;
  [[nodiscard]] Eigen::Index first_of(Of of) const;
  // Whether there are numbers enough for so many columns.
  [[nodiscard]] bool tells(Eigen::Index columns) const;

  std::vector<Unknown> unknowns_;
  calibration::ArmModel weights_;  // of the fit, with every gravity term that there may be
  Vector3 at_up_0_ = Vector3::UnitZ();
  Eigen::VectorXd prior_;   // of the fit's columns: how firmly they are held
  std::vector<Sums> sums_;  // by a fine and a coarse scale of what is a blunder
};

}  // namespace armsig::tool
