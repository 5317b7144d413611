// SPDX-License-Identifier: MIT
// The library's interface for C: any file is an arm or a problem in words, and what an arm answers
// are numbers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "firmware/formats/canonical.hpp"
#include "firmware/library/armsig.h"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

using Readings = std::array<double, ARMSIG_MAX_JOINTS>;
using SevenNumbers = std::array<double, ARMSIG_POSE>;

bool is_answer(armsig_status status) { return status == ARMSIG_OK || status == ARMSIG_SINGULAR; }

template <typename Numbers>
bool are_finite(const Numbers& numbers) {
  return std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); });
}

void ask(const armsig_arm* arm) {
  const std::size_t joints = armsig_joint_count(arm);
  FUZZ_CHECK(joints >= 1 && joints <= ARMSIG_MAX_JOINTS);
  const Readings q{0.1, -0.8, 0.9, 0.3, 0.6, -0.2, 0.1, 0.2};
  SevenNumbers pose{};
  if (!is_answer(armsig_forward(arm, q.data(), nullptr, pose.data()))) return;
  FUZZ_CHECK(are_finite(pose));
  SevenNumbers again{};
  FUZZ_CHECK(armsig_forward_rows(arm, 1, q.data(), nullptr, again.data(), nullptr) == 1);
  FUZZ_CHECK(again == pose);

  Readings back{};
  if (is_answer(armsig_inverse(arm, pose.data(), nullptr, q.data(), back.data()))) {
    FUZZ_CHECK(are_finite(back));
  }
  SevenNumbers told{};
  if (is_answer(armsig_compensate(arm, pose.data(), nullptr, q.data(), told.data(), nullptr))) {
    FUZZ_CHECK(are_finite(told));
  }
  std::array<double, std::size_t{ARMSIG_MAX_SOLUTIONS} * ARMSIG_MAX_JOINTS> all{};
  std::size_t count = 0;
  (void)armsig_solutions(arm, pose.data(), nullptr, all.data(), 2, &count);
  FUZZ_CHECK(count <= 2);
  FUZZ_CHECK(std::ranges::all_of(all.begin() + static_cast<std::ptrdiff_t>(2 * joints), all.end(),
                                 [](double x) { return x == 0; }));
  std::array<double, 3> sigma_m{};
  if (is_answer(armsig_sigma(arm, q.data(), 1, sigma_m.data()))) {
    for (const double sigma : sigma_m) FUZZ_CHECK(std::isfinite(sigma) && sigma >= 0);
  }
}

// Behind the seal: whoever edits a signature may compute a CRC.
void fuzz_library(Bytes bytes) {
  std::string body(text_of(bytes));
  const std::size_t seal = body.rfind("\ncrc32:");
  if (seal != std::string::npos) body.resize(seal + 1);
  const auto text = tool::sealed(body);
  const File file(text ? *text : body);
  std::array<char, 64> problem{};
  armsig_arm* const arm = armsig_load(file.path().c_str(), nullptr, problem.data(), problem.size());
  if (arm == nullptr) {
    FUZZ_CHECK(problem.front() != '\0');
    FUZZ_CHECK(std::memchr(problem.data(), '\0', problem.size()) != nullptr);
    return;
  }
  ask(arm);
  armsig_free(arm);
}

constexpr std::array kTargets{Target{"library", fuzz_library}};

}  // namespace

std::span<const Target> library_targets() { return kTargets; }

}  // namespace armsig::fuzz
