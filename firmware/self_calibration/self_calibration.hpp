// SPDX-License-Identifier: MIT
// The refinement that a controller does by itself: geometry, gravity and joint error maps
// (firmware/calibration), from the points of the sweeps and of further poses that it chooses, until
// the accuracy that was asked for is reached, by poses that were never fitted; or until time or
// memory is over.
//
// One pose in kHeldOutEvery is held out of every fit. What the model leaves open is predicted over
// poses that were not measured, times the factor by which the held-out ones, and each fitted one by
// a fit without it, are worse than stated.
// In the end geometry alone is fitted too, and kept where it predicts the held-out poses as well.
// After the first fit, and once more before the end, a dozen of the first half of the points are
// measured again (repeats.hpp): where something changed meanwhile it is named, and no model kept.
#pragma once

#include <array>
#include <optional>

#include "core/calibration/approach_direction.hpp"
#include "core/calibration/engine.hpp"
#include "core/calibration/gravity_choice.hpp"
#include "core/frames/alignment.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/refinement.hpp"
#include "firmware/controller/workspace.hpp"
#include "firmware/self_calibration/findings.hpp"
#include "firmware/self_calibration/point_journal.hpp"
#include "firmware/self_calibration/repeats.hpp"

namespace armsig::controller {

// Of an arm of so many joints, with one target, that of the hand.
[[nodiscard]] constexpr std::size_t self_columns(std::size_t joints) {
  return 6 + 3 + calibration::kDeviations * joints + calibration::most_gravity_terms(joints);
}
static_assert(self_columns(kMaxJoints) <= calibration::kMaxGeometry);

// What the fit needs beside the points, for arms of up to kJoints joints.
template <std::size_t kJoints>
struct FitMemory {
  std::array<double, calibration::matrix_size(self_columns(kJoints))> matrix{};
  calibration::WorkspaceFor<kJoints> work;
};
static_assert(sizeof(FitMemory<6>) <= 57'000);

// As large as the points that are to be kept, 1.8 kB each, and the fit's. A program whose arm is
// known needs no more than that arm's.
template <std::size_t kPoints, std::size_t kJoints = kMaxJoints>
struct SelfCalibrationMemory {
  std::array<calibration::FitRow, kPoints> rows;
  std::array<calibration::ChainFrames, kPoints> cache;
  std::array<LogEntry, kPoints> log;
  FitMemory<kJoints> fit;
};

class SelfCalibration final : public Refinement {
 public:
  struct Memory {
    std::span<calibration::FitRow> rows;
    std::span<calibration::ChainFrames> cache;
    std::span<LogEntry> log;
    std::span<double> matrix;
    calibration::Workspace* work = nullptr;
  };

  // All outlive it. Without a journal nothing is kept across halts and restarts. Precondition:
  // `memory` is for as many joints as the drawing has.
  template <std::size_t kPoints, std::size_t kJoints>
  SelfCalibration(const Configuration& configuration,
                  SelfCalibrationMemory<kPoints, kJoints>& memory, PointJournal* journal = nullptr)
      : SelfCalibration(
            configuration,
            Memory{memory.rows, memory.cache, memory.log, memory.fit.matrix, &memory.fit.work},
            journal) {}
  SelfCalibration(const Configuration& configuration, const Memory& memory,
                  PointJournal* journal = nullptr)
      : configuration_(configuration), memory_(memory), journal_(journal) {}
  SelfCalibration(const SelfCalibration&) = delete;
  SelfCalibration& operator=(const SelfCalibration&) = delete;

 private:
  enum class Stage : std::uint8_t {
    kIdle,
    kAligning,  // the drawing is laid over the axes that the sweeps gave
    kWeighing,  // the terms of gravity that it can tell apart
    kChoosing,
    kVisiting,
    kFitting,
    kPlay,        // its estimate
    kJudging,     // by the held-out poses
    kPredicting,  // over poses that were not measured
    kTelling,     // how far it is
    kRepeating,   // what is measured again is chosen
    kMeasuringAgain,
    kConcluding,
    kPlayTelling,
    kBudgetTelling,
    kAdvising,
    kDone
  };
  enum class Outcome : std::uint8_t {
    kNone,
    kReached,
    kTimeOver,
    kMemoryFull,
    kPlay,
    kRefused,
    kChanged
  };
  static constexpr std::size_t kHeldOutEvery = 5;

  std::span<LogEntry> do_further_log() override { return memory_.log; }
  Result<std::size_t> do_begin(const Aim& aim, const Machine& machine) override;
  std::optional<KeptPoint> do_recall(std::size_t sweep, const JointVector& wanted) override;
  Result<void> do_keep(const KeptPoint& kept) override;
  Result<void> do_forget() override;
  void do_take(std::size_t sweep, const JointVector& readings, const MeasuredPoint& point) override;
  void do_lose() override;
  void do_refine(const Signature& signature) override;
  Next do_step(hal::Instant now) override;
  [[nodiscard]] const Visit& do_visit() const override { return visit_; }
  void do_tell(Line& line) const override { (this->*telling_)(line); }
  void do_tell_state(Line& line) const override;
  [[nodiscard]] std::size_t do_planned() const override { return planned_; }
  Result<void> do_write(SignatureRecord& record) const override;

  void note_way(std::size_t sweep, const JointVector& readings);
  void work();
  void begin_model();
  void begin_visits();
  void choose(hal::Instant now);
  [[nodiscard]] WayLook::Says look_at_offer(const JointVector& pose);
  void take_offer(const JointVector& pose);
  [[nodiscard]] std::optional<Outcome> end_of_visits(hal::Instant now) const;
  // How long a visit takes; empty before the first one.
  [[nodiscard]] std::optional<hal::Duration> each_visit() const;
  void begin_fit(const calibration::ModelParts& parts);
  void finish_fit();
  void play_step();
  void judge_step();
  void predict_step();
  void note_findings();
  [[nodiscard]] std::optional<Outcome> end_of_run() const;
  void decide();
  void plan_more();
  // repeating.cpp
  void begin_repeats();
  void choose_again();
  void take_again(const MeasuredPoint& point);
  void finish_repeats();
  [[nodiscard]] double pull_at(std::size_t row) const;
  void compare();
  void refuse(Error error);
  [[nodiscard]] bool is_believable() const;
  [[nodiscard]] std::span<calibration::FitRow> rows() const { return memory_.rows.first(count_); }
  [[nodiscard]] JointVector encoder_readings(const JointVector& effective) const {
    return readings_for(configuration_.drawing.couplings, effective);
  }
  void evaluate(const JointVector& effective, calibration::ChainFrames& frames) const;
  // words.cpp
  void tell_progress(Line& line) const;
  void tell_halving(Line& line, const Findings& found) const;
  void tell_outcome(Line& line) const;
  void tell_play(Line& line) const;
  void tell_budget(Line& line) const;
  void tell_advice(Line& line) const;
  void tell_help(Line& line, const Findings& findings) const;

  const Configuration& configuration_;
  Memory memory_;
  PointJournal* journal_;

  Stage stage_ = Stage::kIdle;
  Outcome outcome_ = Outcome::kNone;
  void (SelfCalibration::*telling_)(Line&) const = &SelfCalibration::tell_progress;
  std::optional<Error> refused_;
  Aim aim_;
  hal::Instant now_;
  std::optional<hal::Instant> visiting_since_;
  Signature signature_;  // that the features gave
  std::optional<frames::Aligning> aligning_;
  std::optional<calibration::GravityChoice> weighing_;
  std::size_t count_ = 0;     // rows
  double reference_m2_ = 0;   // of the rows' relative covariances
  std::size_t visited_ = 0;   // of the rows, the poses
  std::size_t recalled_ = 0;  // of those, the ones that an earlier run had been at
  std::size_t wanted_ = 0;    // after which it is fitted again
  std::size_t planned_ = 0;

  std::size_t offered_ = 0;
  std::size_t passed_over_ = 0;  // of the offers, as they are not clear
  WayLook look_;                 // at the next offer
  std::size_t sampled_ = 0;      // poses that were thought of for the prediction
  std::size_t looked_at_ = 0;    // of the offers to one visit
  double best_m2_ = 0;
  JointVector best_;
  Visit visit_;
  calibration::ApproachDirection approach_;
  bool recalls_ = false;  // the last point was one that had been kept

  calibration::ArmModel model_;
  std::array<calibration::ModelTarget, 1> target_;
  calibration::Scales scales_;
  calibration::PlayBlock play_;
  std::optional<calibration::Engine> engine_;
  bool knows_ = false;  // the engine has a covariance
  calibration::ModelParts parts_;
  std::size_t index_ = 0;  // in the pass under way
  Repeats repeats_;
  std::size_t again_ = 0;            // row that is measured again
  std::optional<Vector3> differed_;  // that row, when it was measured again for the first time
  std::size_t repeated_ = 0;         // poses measured when the repeats were
  Repeats::Change change_;
  double squares_m2_ = 0;
  std::size_t kept_ = 0;
  HeldOutJudge judge_;
  Covered covered_;
  Prediction prediction_;
  Findings findings_;

  struct Found {
    calibration::ArmModel model;
    Vector3 p_L = Vector3::Zero();
    Matrix3 tool_m2 = Matrix3::Zero();  // covariance of the tool at the signature configuration
    Findings findings;
  };
  std::optional<Found> whole_;  // with gravity and maps
  std::optional<Found> geometry_;
  [[nodiscard]] const Found* best() const;
  [[nodiscard]] bool whole_is_better() const;
};

}  // namespace armsig::controller
