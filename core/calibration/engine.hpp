// SPDX-License-Identifier: MIT
// The estimator: geometry, gravity, reading maps and the corrections that were asked for, from
// measured positions and ranges, with priors whose scales are found from the same rows
// (docs/model.md, sections 5 to 9).
//
// Maximum a posteriori by Gauss-Newton steps. The unknowns are blocks: the geometry with gravity
// (base 6, target 3 each, 5 deviations a joint, corrections, gravity terms), the map of every
// joint, and the play of the joints where it is asked for (play_block.hpp). A round
// linearises all rows, improves the blocks in turn (symmetric block Gauss-Seidel), takes the step
// if it lowers the cost (a proximal term shortens it otherwise), and finds sigma and the scales of
// the priors anew: MacKay's and the EM fixed point mixed (MacKay, Bayesian interpolation, Neural
// Computation 4, 1992; Dempster, Laird and Rubin, 1977), block by block.
// What the data do not say stays where its prior has it, and the covariance says so. Of joints that
// stood still nothing is estimated (engine_still.cpp). No stated sigma is needed or believed. A
// range is a position of which one direction was measured: its precision has rank one.
#pragma once

#include <bitset>
#include <optional>
#include <span>

#include "core/base/error.hpp"
#include "core/calibration/agenda.hpp"
#include "core/calibration/engine_data.hpp"
#include "core/calibration/fit_row.hpp"
#include "core/calibration/model.hpp"
#include "core/calibration/play_block.hpp"
#include "core/calibration/standing_still.hpp"

namespace armsig::calibration {

class Engine {
 public:
  // `model` stands at its start, with the gravity terms that may be found. All are kept as
  // references; `cache`, as long as `rows` or empty, saves evaluating the chain anew in every pass;
  // `matrix` has matrix_size(columns()) numbers. Preconditions: rows went through group_poses(),
  // their targets exist, `work` is for as many joints.
  Engine(ArmModel& model, std::span<ModelTarget> targets, std::span<FitRow> rows,
         std::span<ChainFrames> cache, std::span<double> matrix, Workspace& work);

  [[nodiscard]] static std::size_t columns(const ArmModel& model, std::size_t targets) {
    return 6 + 3 * targets + kDeviations * model.joint_count() + model.further.size() +
           model.gravity.size();
  }

  // Where the mean of the variances stated for the rows is known; scales to begin with.
  void set_stated_variance(double variance) { stated_variance_ = variance; }
  void set_scales(const Scales& scales) { scales_ = scales; }
  // The model stands where a fit of most of these rows ended, whose scales were given.
  void start_near() { near_ = true; }
  // Where it is known from which sides the joints came to the rows: their play is found too, from
  // what `play` has of it. Kept as a pointer.
  void find_play(PlayBlock& play) { play_ = &play; }

  // Fits the rows that are not held out. Errors: kTooFewPoints (no row); kSingular.
  [[nodiscard]] Result<FitSummary> run(const ModelParts& parts);

  // The same a bounded step at a time, for those who have a tick to keep: begin(), then step()
  // until it returns false, then result(). Meanwhile rows, targets and model are the engine's. A
  // step does `work` multiplications, about, and what a row or a column takes beyond that: of six
  // joints and one target 4,000, of 128 columns 25,000. Where poses have several targets, all rows
  // of a pose are judged in one. What is found does not depend on the steps.
  void begin(const ModelParts& parts);
  bool step(std::size_t work);
  [[nodiscard]] Result<FitSummary> result() const;

  [[nodiscard]] const Scales& scales() const { return scales_; }
  // The length [m] of a residual beyond which rows were rejected at last.
  [[nodiscard]] double gate_m() const { return gate_; }

  // Covariance [m^2] of a measured position at `frames` of `target`: the row's own error, of the
  // covariance stated for it where one was, and that of the model. After run().
  struct Stated {
    Matrix3 row = Matrix3::Zero();
    Matrix3 model = Matrix3::Zero();
    std::array<double, kMaxJoints> maps{};  // what each joint's map has in the trace of `model`
  };
  [[nodiscard]] Stated covariance_at(const ChainFrames& frames, std::size_t target,
                                     const std::array<float, 6>& relative) const;
  // The same of what a row measured; of a range, what matters is along its way.
  [[nodiscard]] Stated covariance_of(const FitRow& row, const ChainFrames& frames) const;
  // Replaces b by the covariance of base, targets and deviations, gravity as found, times b.
  void times_covariance(std::array<double, kMaxGeometry>& b) const;
  // Residuals of all rows, those held out too, at the present model.
  void evaluate();
  // Residual of a row at `frames`, the model's there.
  void evaluate(FitRow& row, const ChainFrames& frames) const;

  // Derivatives of what a row measured by the geometry block, at `frames`.
  void fill(const FitRow& row, const ChainFrames& frames, GeometryColumns& columns) const;
  // By how much play has moved the row's target.
  [[nodiscard]] Vector3 behind(const FitRow& row, const ChainFrames& frames) const;
  // Of an unknown of the geometry block before any row is seen.
  [[nodiscard]] double prior_variance(std::size_t column) const;

  [[nodiscard]] std::size_t columns() const { return columns_; }
  [[nodiscard]] std::size_t target_column(std::size_t target) const { return 6 + 3 * target; }
  [[nodiscard]] std::size_t joint_column(std::size_t joint) const {
    return 6 + 3 * targets_.size() + kDeviations * joint;
  }
  [[nodiscard]] std::size_t further_column() const { return joint_column(model_.joint_count()); }
  [[nodiscard]] std::size_t gravity_column() const {
    return further_column() + model_.further.size();
  }

 private:
  const ChainFrames& frames_of(std::size_t row);
  [[nodiscard]] bool has_map(std::size_t joint) const {
    return maps_on_ && (without_map_ >> joint & 1U) == 0;
  }
  template <typename Visit>
  void for_columns(const ChainFrames& frames, std::size_t target, Visit visit) const;
  template <typename Visit>
  void for_columns(const FitRow& row, const ChainFrames& frames, Visit visit) const;
  void fill(const ChainFrames& frames, std::size_t target, GeometryColumns& columns) const;
  [[nodiscard]] Stated stated(GeometryColumns& J, const ChainFrames& frames, std::size_t target,
                              const Matrix3& row) const;
  [[nodiscard]] Matrix3 row_covariance(const std::array<float, 6>& relative) const;
  [[nodiscard]] Matrix3 precision(const FitRow& row) const;
  // Of all measured rows that it stands for, and of one of them, the mean.
  [[nodiscard]] double whitened_squares(const FitRow& row) const;
  [[nodiscard]] double mean_squares(const FitRow& row) const {
    if constexpr (kMergesRows) return whitened_squares(row) / row.merged.count;
    return whitened_squares(row);
  }

  // engine.cpp
  void evaluate_rows(Units rows);
  void move(double fraction);
  [[nodiscard]] double cost() const;
  // engine_sequence.cpp
  void count_rows(Units rows);
  void note_rows();
  void note_still();
  void note_start();
  void begin_round();
  void choose_weights();
  void end_round();
  void begin_last();
  void conclude();
  void begin_descent();
  void put_assembly();
  void note_before();
  void begin_try();
  void take_step();
  void note_expected();
  void judge_try();
  void shorten();
  void begin_improvement();
  void clear_steps();
  void improve_geometry();
  void improve_maps();
  void improve_next_map();
  void add_costs(Units rows);
  void add_motions(Units rows);
  // engine_blocks.cpp
  void begin_assembly();
  void assemble(Units rows);
  void assemble_maps(const FitRow& row, const ChainFrames& frames, const GeometryColumns& J,
                     const GeometryColumns& WJ);
  void factorise_geometry(Units columns);
  void begin_geometry();
  void pull_geometry(Units rows);
  void solve_geometry();
  void follow_geometry(Units rows);
  [[nodiscard]] double proximal_variance(std::size_t column) const;
  [[nodiscard]] double deviation(std::size_t column) const;
  [[nodiscard]] double prior_squares() const;
  void solve_lower(std::array<double, kMaxGeometry>& b, std::size_t first) const;
  void solve_upper(std::array<double, kMaxGeometry>& b) const;
  // engine_still.cpp
  [[nodiscard]] bool is_held(std::size_t column) const { return holding_ && held_[column]; }
  [[nodiscard]] bool stands_still(std::size_t joint) const {
    return turned_[joint].is_jitter(model_.joints[joint].type);
  }
  void count_turns(const FitRow& row);
  void note_held();
  bool drop_gravity();
  bool reset_held();
  // engine_maps.cpp
  void begin_map();
  void pull_map(Units rows);
  void solve_map();
  void follow_map(Units rows);
  template <typename Visit>
  void for_rows_of_map(Units rows, Visit visit);
  // engine_play.cpp
  using PlayColumns = std::array<Vector3, kMaxJoints>;
  bool fill(const FitRow& row, const ChainFrames& frames, PlayColumns& columns) const;
  [[nodiscard]] double play_variance(std::size_t joint) const;
  [[nodiscard]] double play_squares() const;
  void assemble_play(const FitRow& row, const ChainFrames& frames, const Matrix3& W);
  void factorise_play();
  void improve_play();
  void begin_play();
  void add_pull(Units rows, double* of_joints);  // J^T W r of the plays
  void pull_play(Units rows);
  void solve_play();
  void follow_play(Units rows);
  [[nodiscard]] PriorGroup play_group();
  void cover_play();
  void probe_next_play();
  void lay_play(Units rows);
  void add_left_of_play(Units rows);
  void end_probe();
  [[nodiscard]] Matrix3 play_covariance(const FitRow& row, const ChainFrames& frames) const;
  // engine_scales.cpp
  void begin_scales();
  void add_variances(Units columns);
  void conclude_geometry_scales();
  void scale_play();
  void begin_map_scales();
  void scale_next_map();
  void invert_map();
  void conclude_map_scale();
  void add_errors(Units rows);
  void conclude_sigma();
  void begin_covariance();
  void cover_next_map();
  void leave_map_open();
  void note_map_variance();
  // outliers.cpp
  void add_lengths(Units rows);
  void conclude_lengths();
  void add_squares(Units rows);
  void conclude_coarse();
  void begin_soft_weights();
  void weigh_softly(Units rows);
  void begin_rejection();
  void judge_poses(Units rows);
  void count_kept(Units rows);
  void keep_targets(Units rows);
  void judge_pose(std::span<FitRow> pose);
  [[nodiscard]] Vector3 common_residual(std::span<const FitRow> pose) const;

  using Tasks = Agenda<Engine, 32>;
  using Task = Tasks::Task;
  // Multiplications of a row, about, where it is only looked at, evaluated, differentiated by the
  // geometry, or by its columns squared.
  static constexpr std::size_t kLook = 60;
  [[nodiscard]] std::size_t evaluation_work() const { return 200 * (1 + model_.joint_count()); }
  [[nodiscard]] std::size_t frames_work() const {
    return kLook + (cache_.empty() ? evaluation_work() : 0);
  }
  // Of the block of the joints' play: of a row, and of its factor.
  static constexpr std::size_t kPlayRow = 20 * kMaxJoints;
  static constexpr std::size_t kPlayFactor = kMaxJoints * kMaxJoints * kMaxJoints;
  [[nodiscard]] std::size_t filling_work() const {
    return frames_work() + 30 * model_.joint_count() + 12 * columns_;
  }
  [[nodiscard]] std::size_t squaring_work() const {
    return filling_work() + 2 * columns_ * columns_ + (play_on_ ? 2 * kPlayRow : 0);
  }
  [[nodiscard]] Task of_rows(Task::Pass pass, std::size_t work) const {
    return {pass, rows_.size(), work};
  }
  [[nodiscard]] Task evaluation() const {
    return of_rows(&Engine::evaluate_rows, evaluation_work());
  }
  [[nodiscard]] Task costs() const { return of_rows(&Engine::add_costs, kLook); }
  [[nodiscard]] Task lengths() const { return of_rows(&Engine::add_lengths, kLook); }
  [[nodiscard]] Task factorisation() const {
    return {&Engine::factorise_geometry, columns_, columns_ * columns_ / 2};
  }

  double& upper(std::size_t i, std::size_t j) { return matrix_[i * (columns_ + 1) + j + 1]; }
  double& lower(std::size_t i, std::size_t j) { return matrix_[i * (columns_ + 1) + j]; }
  [[nodiscard]] double lower(std::size_t i, std::size_t j) const {
    return matrix_[i * (columns_ + 1) + j];
  }

  ArmModel& model_;
  std::span<ModelTarget> targets_;
  std::span<FitRow> rows_;
  std::span<ChainFrames> cache_;
  std::span<double> matrix_;  // above the diagonal J^T J; on and below it, its factor
  Workspace& work_;
  std::size_t columns_;
  std::array<double, 6> base_moved_{};
  Scales scales_;
  ModelParts parts_;
  PlayBlock* play_ = nullptr;
  bool near_ = false;
  bool maps_on_ = false;
  bool play_on_ = false;
  bool looked_up_ = false;                      // what the cache has that no step changes
  std::uint8_t without_map_ = 0;                // those asked for, and joints that stood still
  std::array<ReadingSpan, kMaxJoints> read_{};  // of the fitted rows
  // What turned below a target, in effective readings: a joint that no target is beyond did not.
  std::array<ReadingSpan, kMaxJoints> turned_{};
  std::bitset<kMaxGeometry> held_;  // columns of which nothing is estimated
  bool holding_ = false;            // in steps and scales; their doubt is in the covariance
  bool uniform_ = true;             // every row has the same relative covariance, a multiple of one
  double stated_variance_ = 0;
  double trust_ = 1;      // t of the proximal term
  double coarse_ = 0;     // scale of soft weights, from the first residuals down to their own
  double effective_ = 0;  // degrees that the unknowns take
  FitSummary summary_;
  ChainFrames scratch_;

  // Of the computation under way.
  Tasks agenda_;
  std::optional<Error> failed_;
  struct {
    double squares = 0;
    double weights = 0;
  } sums_;            // of a pass over the rows
  double scale_ = 0;  // of the residuals: robust
  double soft_scale_ = 0;
  double gate_ = 0;
  double sigma_squared_before_ = 0;
  double cost_before_ = 0;
  double cost_expected_ = 0;  // by the linear model
  double moved_ = 0;          // how far a step moves the predictions, rms
  int passes_ = 0;            // over the maps, in a step
  int passes_left_ = 0;
  int tries_ = 0;
  bool proximal_ = false;  // of the matrix that is factorised
  bool probes_ = false;    // it is about how the other unknowns follow a joint's play
  std::size_t joint_probed_ = 0;
  std::size_t joint_ = 0;  // whose map it is about
  std::size_t visit_ = 0;  // of the joints, there and back
  enum : std::size_t { kTurns, kShifts, kZeros, kReadings, kSags, kOpen, kGroups };
  std::array<PriorGroup, kGroups> groups_{};
  double maps_determined_ = 0;
};

}  // namespace armsig::calibration
