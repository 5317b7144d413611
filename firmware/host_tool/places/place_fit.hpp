// SPDX-License-Identifier: MIT
// The fit of arm, tool and places to touches: maximum a posteriori by joint Gauss-Newton steps, a
// sigma of every instrument and the scales of the priors by the fixed points of the engine
// (docs/model.md, sections 8, 9 and 13). Nothing is frozen: a prior holds what the touches leave
// open, and the covariance says so. For a workstation: the matrix is dense.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "firmware/host_tool/places/place_rows.hpp"

namespace armsig::tool {

struct PlaceScales {
  calibration::Scales prior;          // of the arm
  std::vector<double> sigma_squared;  // of a number of every instrument [m^2]
};

class PlaceFit {
 public:
  // Starts at `start`, with `scales` where they are known. `task` is kept as a reference.
  PlaceFit(const PlaceTask& task, const PlaceState& start, const PlaceParts& parts,
           const PlaceScales* scales = nullptr);

  // What the touches that are named would tell, at the start and at its scales: covariance and
  // information alone.
  void foresee(const std::vector<std::size_t>& touches);
  // At most so many rounds; at its end all touches beyond six sigma are rejected.
  void run(int most_rounds);

  [[nodiscard]] const PlaceState& state() const { return state_; }
  [[nodiscard]] const PlaceColumns& columns() const { return columns_; }
  [[nodiscard]] const PlaceScales& scales() const { return scales_; }
  [[nodiscard]] const PlaceParts& parts() const { return parts_; }
  [[nodiscard]] bool converged() const { return converged_; }
  // Of every touch: 0 where it was rejected.
  [[nodiscard]] const std::vector<double>& weights() const { return weights_; }
  [[nodiscard]] std::size_t rejected() const;
  // After run(): rows there, their number's variance, information and covariance of the unknowns,
  // logarithm of the evidence, degrees of freedom left to the residuals.
  [[nodiscard]] const PlaceRows& rows() const { return rows_; }
  [[nodiscard]] const std::vector<PlaceScalar>& touches() const { return touches_; }
  [[nodiscard]] const std::vector<PlaceScalar>& lengths() const { return lengths_; }
  [[nodiscard]] double variance_of(const PlaceScalar& scalar) const;
  [[nodiscard]] const Eigen::MatrixXd& information() const { return information_; }
  [[nodiscard]] const Eigen::MatrixXd& covariance() const { return covariance_; }
  [[nodiscard]] double log_evidence() const { return log_evidence_; }
  [[nodiscard]] double freedom() const { return freedom_; }

  // Adds weight J^T J to the upper triangle.
  static void add_squares(const PlaceScalar& scalar, double weight, Eigen::MatrixXd& matrix);
  // J C J^T.
  static double variance_by(const PlaceScalar& scalar, const Eigen::MatrixXd& covariance);
  // Prior variance of an unknown that no map has.
  [[nodiscard]] double prior_variance(Eigen::Index column) const;
  // The same where the scales of the priors are one: of tool and deviations.
  [[nodiscard]] static double usual_variance(Eigen::Index column);

 private:
  void round();
  void linearise();
  void weigh();
  void descend();
  void invert();
  void update_scales();
  void update_sigmas();
  void conclude();
  [[nodiscard]] std::vector<double> robust_scales() const;
  [[nodiscard]] Eigen::MatrixXd information_there(double trust) const;
  [[nodiscard]] Eigen::VectorXd gradient() const;
  [[nodiscard]] double cost() const;
  [[nodiscard]] double prior_squares() const;
  [[nodiscard]] double log_prior_information() const;
  [[nodiscard]] double proximal_variance(Eigen::Index column) const;
  [[nodiscard]] std::size_t instrument_of(std::size_t touch) const {
    return task_.places[task_.touches[touch].place].instrument;
  }

  const PlaceTask& task_;
  PlaceState state_;
  PlaceParts parts_;
  PlaceColumns columns_;
  PlaceRows rows_;
  PlaceScales scales_;
  Eigen::VectorXd x_;  // the unknowns less what their priors are about
  std::vector<double> weights_;
  std::vector<PlaceScalar> touches_;
  std::vector<PlaceScalar> lengths_;
  Eigen::MatrixXd information_;
  Eigen::MatrixXd covariance_;
  std::vector<double> determined_;  // unknowns that each instrument's numbers took
  double trust_ = 1;
  double moved_ = 0;  // by a step, in sigma
  int rounds_ = 0;
  bool converged_ = false;
  double log_evidence_ = 0;
  double freedom_ = 0;
};

}  // namespace armsig::tool
