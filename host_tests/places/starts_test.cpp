// SPDX-License-Identifier: MIT
// No place is known, the tool is 100 mm from where it is said to be, and zeros are 2 degrees wrong:
// a fit from there ends where one that starts at the truth does.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "host_tests/places/true_state.hpp"
#include "host_tests/places/unknown_places.hpp"

namespace armsig::tool {
namespace {

using touching::Instruments;

struct Start {
  const char* name;
  touching::Drawing (*drawing)();
  Instruments instruments;
  unsigned hard_seed;  // at which a start from nothing or one at the truth once ended elsewhere
};

void PrintTo(const Start& start, std::ostream* out) { *out << start.name; }

// Another basin is off by a multiple.
constexpr double kAsFromTheTruth = 1.5;

constexpr int kRounds = 25;

// Whether the start from nothing is as good as the other, by the arm or by the evidence.
void expect_right(const Start& start, unsigned seed) {
  touching::Session session =
      touching::with_unknown_places(start.drawing(), start.instruments, seed);
  const PlaceTask task = task_of(session);
  const auto found = fit_without_maps(task);
  PlaceFit from_truth(task, true_state(session, task), {.maps = false});
  from_truth.run(kRounds);
  const double expected_m = error_m(session, from_truth.state());
  EXPECT_LT(error_m(session, found->state()), kAsFromTheTruth * expected_m) << "seed " << seed;
  if (found->rejected() != from_truth.rejected()) return;
  // A fit that starts at the truth stays at a lesser optimum now and then, but by little.
  EXPECT_LT(std::abs(found->log_evidence() - from_truth.log_evidence()), 20) << "seed " << seed;
}

class Starts : public testing::TestWithParam<Start> {};

TEST_P(Starts, from_nothing_end_where_those_from_the_truth_do) {
  const char* asked = std::getenv("ARMSIG_PLACES");
  const unsigned count = asked != nullptr ? static_cast<unsigned>(std::atoi(asked)) : 2;
  for (unsigned seed = 1; seed <= count; ++seed) expect_right(GetParam(), seed);
  if (GetParam().hard_seed > count) expect_right(GetParam(), GetParam().hard_seed);
}

INSTANTIATE_TEST_SUITE_P(
    UnknownPlaces, Starts,
    testing::Values(Start{"ur5_sockets", touching::ur5, Instruments::kSockets, 3},
                    Start{"ur5_planes", touching::ur5, Instruments::kPlanes, 101},
                    Start{"ur5_wires", touching::ur5, Instruments::kWires, 104},
                    Start{"ur5_mixture", touching::ur5, Instruments::kMixture, 3},
                    Start{"puma_sockets", touching::puma560, Instruments::kSockets, 84},
                    Start{"puma_planes", touching::puma560, Instruments::kPlanes, 6},
                    Start{"puma_wires", touching::puma560, Instruments::kWires, 3},
                    Start{"puma_mixture", touching::puma560, Instruments::kMixture, 54},
                    Start{"iiwa_sockets", touching::iiwa, Instruments::kSockets, 18},
                    Start{"iiwa_planes", touching::iiwa, Instruments::kPlanes, 175},
                    Start{"iiwa_wires", touching::iiwa, Instruments::kWires, 3},
                    Start{"iiwa_mixture", touching::iiwa, Instruments::kMixture, 3}),
    [](const testing::TestParamInfo<Start>& named) { return std::string(named.param.name); });

}  // namespace
}  // namespace armsig::tool
