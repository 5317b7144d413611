// SPDX-License-Identifier: MIT
// A halt at any tick of any move: the targets that the drives are sent keep the limits of every
// joint and motor, stay on the path, and stand in bounded time. The bounds are worked out here from
// the limits alone.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/bent_model.hpp"
#include "host_tests/support/servo_bench.hpp"
#include "host_tests/support/table_3_run.hpp"
#include "host_tests/support/target_differences.hpp"

namespace armsig::controller {
namespace {

using test::kTargetRounding;
using test::Random;
using test::TargetDifferences;

constexpr double kPeriod_s = 0.002;

// Of the tick in which the move was taken up, at which the halt is said, and all until it stands.
struct Halted {
  std::vector<JointVector> targets;
  std::size_t ticks = 0;          // from the halt on, until the arm is told to stand
  std::size_t ticks_of_plan = 0;  // that were left then

  [[nodiscard]] TargetDifferences differences(const JointVector& at_rest) const {
    TargetDifferences all(at_rest, kPeriod_s);
    for (const JointVector& q : targets) all.add(q);
    for (int i = 0; i < 4; ++i) all.add(targets.back());
    return all;
  }
};

// Takes `move` up from where the arm stands, halts it after `part` of its duration.
Halted halted(const Configuration& configuration, const Model& model, const Move& move,
              double part) {
  ServoBench bench;
  bench.configuration = configuration;
  bench.link.models[0] = model;
  bench.drives.actual = move.from;
  bench.hold();
  Command command;
  command.kind = CommandKind::kMove;
  command.move = move;
  Halted run;
  EXPECT_EQ(bench.send(command), std::nullopt);
  run.targets.push_back(bench.drives.targets);
  while (move.duration_s - bench.link.snapshot.read().left_s < part * move.duration_s) {
    bench.follow();
    run.targets.push_back(bench.drives.targets);
  }
  run.ticks_of_plan =
      static_cast<std::size_t>(std::ceil(bench.link.snapshot.read().left_s / kPeriod_s - 1e-6));
  bench.drives.actual = bench.drives.targets;
  EXPECT_EQ(bench.send(CommandKind::kHalt), std::nullopt);
  run.targets.push_back(bench.drives.targets);
  while (bench.link.snapshot.read().moving && run.ticks < 100'000) {
    ++run.ticks;
    bench.follow();
    run.targets.push_back(bench.drives.targets);
  }
  EXPECT_EQ(bench.link.snapshot.read().mode, Mode::kHolding);
  bench.follow();
  EXPECT_EQ(largest_change(run.targets.back(), bench.drives.targets), 0) << "it stands";
  return run;
}

Halted halted(const Configuration& configuration, const Move& move, double part) {
  return halted(configuration, model_of(configuration.drawing), move, part);
}

// Of the whole of each move, and those of the worst that was measured before.
const std::vector<double> kPhases{0,    0.001, 0.01, 0.03, 0.07, 0.1,  0.15, 0.2,  0.25,
                                  0.3,  0.35,  0.4,  0.45, 0.5,  0.55, 0.6,  0.65, 0.7,
                                  0.75, 0.79,  0.85, 0.9,  0.93, 0.96, 0.98, 0.99, 0.997};

// Limits that differ by joint, so that the one that has least left is not always the same.
Configuration with_unlike_joints() {
  Configuration configuration = test::puma_controller();
  configuration.limits.speed = {1.0, 0.5, 2.0, 1.5, 0.8, 3.0};
  configuration.limits.acceleration = {3.0, 2.0, 0.8, 9.0, 4.0, 6.0};
  for (double& error : configuration.supervision.following_error) error = 1;
  return configuration;
}

const JointVector kBent{radians(0), radians(-90), radians(10), radians(30), radians(40), 0.0};

JointVector moved(const JointVector& by) {
  JointVector to = kBent;
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += by[i];
  return to;
}

struct JointMoves {
  Configuration configuration = with_unlike_joints();
  std::vector<Move> moves;

  JointMoves() {
    for (const double pace : {1.0, 0.3}) {
      for (const JointVector& by :
           {JointVector{1.5, 0, 0, 0, 0, 0}, JointVector{0, -1.0, 0, 0, 0, 0},
            JointVector{0.02, 0, 0, 0, 0, 0}, JointVector{0, 0, 3e-4, 0, 0, 0},
            JointVector{-1.2, 0.8, 0.5, -1.0, 0.4, 2.0}, JointVector{0, 0, 0.2, 0, 0, -2.5},
            JointVector{0, 0, 0, 0, 0, 0}}) {
        moves.push_back(*plan_joint_move(configuration, kBent, moved(by), pace));
      }
    }
  }
};

TEST(HaltOfAJointMove, keeps_speed_acceleration_and_jerk_wherever_it_comes) {
  const JointMoves all;
  const MotionLimits& limits = all.configuration.limits;
  for (const Move& move : all.moves) {
    for (const double part : kPhases) {
      const TargetDifferences asked = halted(all.configuration, move, part).differences(move.from);
      asked.expect_within(limits, kTargetRounding);
      // At the pace that the joints allow, whatever it was told to be.
      const double duration_s = plan_joint_move(all.configuration, move.from, move.to)->duration_s;
      for (std::size_t i = 0; i < 6; ++i) {
        const double of_moves = 60 * std::abs(move.to[i] - move.from[i]) / std::pow(duration_s, 3);
        const double of_full_speed =
            27.0 / 8 * std::pow(limits.acceleration[i], 2) / limits.speed[i];
        EXPECT_LE(asked.jerk(i), std::max(of_moves, of_full_speed) * (1 + 1e-9) +
                                     asked.uncertainty(3, kTargetRounding))
            << "joint " << i << " at " << part << " of " << move.duration_s;
      }
    }
  }
}

TEST(HaltOfAJointMove, stays_on_the_path_and_never_turns_back) {
  const JointMoves all;
  for (const Move& move : all.moves) {
    for (const double part : kPhases) {
      double before = 0;
      for (const JointVector& q : halted(all.configuration, move, part).targets) {
        double along = 0;
        double length = 0;
        for (std::size_t i = 0; i < 6; ++i) {
          along += (q[i] - move.from[i]) * (move.to[i] - move.from[i]);
          length += std::pow(move.to[i] - move.from[i], 2);
        }
        const double s = length > 0 ? along / length : 0;
        for (std::size_t i = 0; i < 6; ++i) {
          ASSERT_NEAR(q[i], move.from[i] + s * (move.to[i] - move.from[i]), 1e-13);
        }
        ASSERT_GE(s, before - 1e-12);
        ASSERT_LE(s, 1 + 1e-12);
        before = s;
      }
    }
  }
}

// What speeds up loses that in the time that its jerk needs; then it brakes. Full acceleration is
// reached in 8/27 of v/a by the jerk of the move that reaches speed and acceleration both.
TEST(HaltOfAJointMove, stands_within_the_time_that_the_limits_give) {
  const JointMoves all;
  double longest_s = 0;
  for (std::size_t i = 0; i < 6; ++i) {
    longest_s = std::max(
        longest_s, all.configuration.limits.speed[i] / all.configuration.limits.acceleration[i]);
  }
  const double most_s = longest_s * (1 + 2 * 8.0 / 27);
  for (const Move& move : all.moves) {
    for (const double part : kPhases) {
      const Halted run = halted(all.configuration, move, part);
      EXPECT_LE(static_cast<double>(run.ticks), most_s / kPeriod_s + 3) << part;
      EXPECT_LE(run.ticks, run.ticks_of_plan) << "no later than the plan" << part;
    }
  }
}

// At its fastest a move does not speed up: v / a, and the time in which the jerk reaches a.
TEST(HaltOfAJointMove, brakes_as_sharply_as_the_joint_may) {
  const Configuration configuration = test::puma_controller();
  const Move move = *plan_joint_move(configuration, kBent, moved({1.5, 0, 0, 0, 0, 0}));
  const Halted run = halted(configuration, move, 0.5);
  EXPECT_NEAR(static_cast<double>(run.ticks) * kPeriod_s, 1.0 / 3 * (1 + 8.0 / 27), 2 * kPeriod_s);
  EXPECT_GT(run.differences(move.from).acceleration(0), 0.999 * 3.0);
}

TEST(HaltOfAJointMove, keeps_the_limits_of_coupled_motors) {
  Configuration configuration = with_unlike_joints();
  configuration.drawing.couplings.push_back({.joint = 5, .from = 4, .ratio = 2});
  configuration.drawing.couplings.push_back({.joint = 3, .from = 2, .ratio = 0.5});
  const Move move = *plan_joint_move(configuration, kBent, moved({0, 0.5, -0.2, 0, -0.9, 1.0}));
  for (const double part : kPhases) {
    TargetDifferences motors(readings_for(configuration.drawing.couplings, move.from), kPeriod_s);
    for (const JointVector& q : halted(configuration, move, part).targets) {
      motors.add(readings_for(configuration.drawing.couplings, q));
    }
    motors.expect_within(configuration.limits, 4 * kTargetRounding);
  }
}

// Straight on, round the elbow, past the wrist's singularity, turning alone, and both.
struct Lines {
  Configuration configuration = with_unlike_joints();
  Model model;
  std::vector<Move> moves;

  explicit Lines(const JointCouplings& couplings = {}, bool bends = false, double tool_speed = 3) {
    configuration.limits.tool_speed = tool_speed;
    configuration.limits.tool_turn_rate = 6;
    configuration.drawing.couplings = couplings;
    model = model_of(configuration.drawing);
    if (bends) {
      Random random(7);
      const auto deflections = packed(test::bent_model(configuration.drawing, random));
      model.joints.set(deflections, configuration.drawing, kBent);
      model.chain =
          kinematics::make_chain(configuration.drawing.joints, model.joints.turned_limits());
    }
    const Pose here = *tool_pose(model, kBent);
    for (const Vector3& way :
         {Vector3(0.05, 0, -0.1), Vector3(-0.4, 0.3, 0.1), Vector3(0.1, 0.15, -0.2),
          Vector3(0.2, 0.5, -0.15), Vector3(0, -0.45, 0), Vector3(0, 0, 0)}) {
      for (const double turn : {0.0, 0.6}) {
        Pose to = here;
        to.p += way;
        to.R = to.R * rotation_about(Vector3(1, 2, -2) / 3, turn);
        for (const double pace : {1.0, 0.4}) {
          const Planned line = plan_line(configuration, model, kBent, to, pace);
          if (line) moves.push_back(*line);
        }
      }
    }
  }
};

// The inverse meets a pose within 1e-10 m and rad, a joint by as much over what it moves the tool.
constexpr double kInverse = 1e-9;

TEST(HaltOfALine, keeps_speed_and_acceleration_of_joints_and_motors_wherever_it_comes) {
  const JointCouplings coupled{{.joint = 5, .from = 4, .ratio = -1.5}};
  for (const Lines& all : {Lines(), Lines(coupled), Lines({}, true)}) {
    ASSERT_GE(all.moves.size(), 16U);
    const JointCouplings& couplings = all.configuration.drawing.couplings;
    for (const Move& move : all.moves) {
      for (const double part : kPhases) {
        const Halted run = halted(all.configuration, all.model, move, part);
        run.differences(move.from).expect_within(all.configuration.limits, kInverse);
        TargetDifferences motors(readings_for(couplings, move.from), kPeriod_s);
        for (const JointVector& q : run.targets) motors.add(readings_for(couplings, q));
        motors.expect_within(all.configuration.limits, 3 * kInverse);
        EXPECT_LE(run.ticks, run.ticks_of_plan) << "no later than the plan" << part;
      }
    }
  }
}

TEST(HaltOfALine, stays_on_the_line_and_never_turns_back) {
  const Lines all;
  for (const Move& move : all.moves) {
    const Vector3 way = move.X_RT_to.p - move.X_RT_from.p;
    const Vector3 turn = rotation_vector(move.X_RT_from.R.transpose() * move.X_RT_to.R);
    for (const double part : {0.02, 0.2, 0.5, 0.79, 0.9}) {
      double before = 0;
      for (const JointVector& q : halted(all.configuration, all.model, move, part).targets) {
        const Pose X_RT = *tool_pose(all.model, q);
        const Vector3 turned = rotation_vector(move.X_RT_from.R.transpose() * X_RT.R);
        const double along = (X_RT.p - move.X_RT_from.p).dot(way) + turned.dot(turn);
        const double length = way.squaredNorm() + turn.squaredNorm();
        const double s = length > 0 ? along / length : 0;
        ASSERT_LT((X_RT.p - move.X_RT_from.p - s * way).norm(), 1e-9);
        ASSERT_LT((turned - s * turn).norm(), 1e-8);
        ASSERT_GE(s, before - 1e-8);
        ASSERT_LE(s, 1 + 1e-8);
        before = s;
      }
    }
  }
}

// Where the tool's speed is what limits a line, the joints have more left than the plan asks for,
// which would come to rest in two fifths of its duration.
TEST(HaltOfALine, uses_what_the_joints_have_left) {
  const Lines all({}, false, 0.1);
  for (const Move& move : all.moves) {
    if (move.duration_s < 4) continue;
    for (const double part : {0.2, 0.5, 0.8}) {
      const Halted run = halted(all.configuration, all.model, move, part);
      const double stopped_s = static_cast<double>(run.ticks) * kPeriod_s;
      EXPECT_LT(stopped_s, 0.2 * move.duration_s) << move.duration_s << " at " << part;
    }
  }
}

// The whole controller: what its drives are sent in sequences that are halted at any time, and in
// the moves before it.
void expect_within_limits_when_halted(const Configuration& configuration, const std::string& verb,
                                      const std::vector<double>& after_s) {
  test::PumaCabinet puma(1, configuration);
  ASSERT_TRUE(puma.enable());
  TargetDifferences targets(puma.now().commanded, kPeriod_s);
  const auto run = [&](double seconds, const auto& until) {
    for (int i = 0; i < static_cast<int>(seconds / kPeriod_s) && !until(); ++i) {
      puma.cabinet->step();
      targets.add(puma.now().commanded);
    }
  };
  for (const double seconds : after_s) {
    puma.console.requests.push_back(verb);
    run(seconds, [] { return false; });
    EXPECT_EQ(puma.mode(), Mode::kSweeping) << verb << " after " << seconds;
    puma.console.requests.emplace_back("halt");
    run(0.01, [] { return false; });
    run(1, [&] { return puma.mode() == Mode::kHolding; });
    EXPECT_EQ(puma.mode(), Mode::kHolding) << verb << " after " << seconds;
  }
  targets.expect_within(configuration.limits, kTargetRounding);
}

std::vector<double> times_s() {
  std::vector<double> times;
  for (int k = 0; k < 40; ++k) times.push_back(0.05 + 0.0731 * k);
  return times;
}

TEST(HaltOfASequence, keeps_the_limits_in_sweeps) {
  expect_within_limits_when_halted(test::puma_controller(), "identify", times_s());
}

TEST(HaltOfASequence, keeps_the_limits_between_vertices_of_the_grid) {
  expect_within_limits_when_halted(test::puma_with_grid(), "touch-grid", times_s());
}

}  // namespace
}  // namespace armsig::controller
