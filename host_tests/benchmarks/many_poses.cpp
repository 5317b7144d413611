// SPDX-License-Identifier: MIT
// armsig_many_poses [SHARE]: the property tests of the inverse with as many poses as are promised,
// or a share of them (0.01: a hundredth). Prints a table; fails where a promise is broken.
#include <cstdio>
#include <cstdlib>

#include "host_tests/support/inverse_trials.hpp"
#include "host_tests/support/pose_trials.hpp"

namespace {

using armsig::test::KnownArm;

bool try_reachable(int poses, std::mt19937_64& random) {
  std::printf("Inverse from half a degree away, to 1e-9 m and 1e-9 rad:\n\n");
  std::printf("| arm | poses | missed |\n|---|--:|--:|\n");
  int missed = 0;
  for (const KnownArm& arm : armsig::test::six_joint_arms()) {
    const int of_arm = armsig::test::missed_poses(arm, poses, random);
    std::printf("| %s | %d | %d |\n", arm.name.c_str(), poses, of_arm);
    missed += of_arm;
  }
  const KnownArm unseen = armsig::test::perturbed_puma(random);
  const int of_unseen = armsig::test::missed_poses(unseen, poses, random);
  std::printf("| a Puma as built | %d | %d |\n", poses, of_unseen);
  return missed + of_unseen == 0;
}

bool try_cold_starts(int poses, std::mt19937_64& random) {
  std::printf("\nCold start of calibrated arms with three nearly parallel axes:\n\n");
  std::printf("| arm | poses | without a solution | without the one near the seed |\n");
  std::printf("|---|--:|--:|--:|\n");
  bool good = true;
  for (const KnownArm& arm :
       {armsig::test::ur10e_individual_a(), armsig::test::ur10e_individual_b()}) {
    const auto trial = armsig::test::try_cold_starts(arm, poses, random);
    std::printf("| %s | %d | %d | %d |\n", arm.name.c_str(), trial.poses, trial.none,
                trial.not_near);
    good = good && trial.none == 0 && trial.not_near == 0;
  }
  return good;
}

bool try_singular(int poses, std::mt19937_64& random) {
  std::printf("\nSeeds and targets at singularities, on the boundary of reach and beyond:\n\n");
  std::printf(
      "| arm | poses | faults | met | met, near a singularity | out of reach | joint limit |");
  std::printf(" step limit | iterations used up |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  bool good = true;
  for (const KnownArm& arm : armsig::test::six_joint_arms()) {
    armsig::test::SingularTrial trial;
    armsig::test::try_singular_poses(arm, poses, random, trial);
    std::printf("| %s | %d | %d |", arm.name.c_str(), trial.poses, trial.faults());
    for (const int count : trial.verdicts) std::printf(" %d |", count);
    std::printf("\n");
    good = good && trial.faults() == 0;
  }
  return good;
}

bool try_any_arm(long poses, std::mt19937_64& random) {
  const armsig::test::InverseTrial trial = armsig::test::try_inverses(poses, random);
  std::printf(
      "\nRandom arms of 1 to 8 joints, any of them prismatic, judged in extended precision:\n\n");
  std::printf("| inverses | more than 90 degrees off | faults | met | met, near a singularity |");
  std::printf(" out of reach | joint limit | step limit | iterations used up |\n");
  std::printf("|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n| %ld | %ld | %ld |", trial.tried,
              trial.beyond_quarter_turn, trial.faults());
  for (const long count : trial.verdicts) std::printf(" %ld |", count);
  std::printf("\n");
  return trial.faults() == 0 && 2 * trial.beyond_quarter_turn >= trial.tried;
}

}  // namespace

int main(int argc, char** argv) {
  const double share = argc > 1 ? std::strtod(argv[1], nullptr) : 1;
  std::mt19937_64 random(1);
  const bool reached = try_reachable(static_cast<int>(100'000 * share), random);
  const bool started = try_cold_starts(static_cast<int>(100'000 * share), random);
  const bool bounded = try_singular(static_cast<int>(125'000 * share), random);
  const bool truthful = try_any_arm(static_cast<long>(10'000'000 * share), random);
  return reached && started && bounded && truthful ? EXIT_SUCCESS : EXIT_FAILURE;
}
