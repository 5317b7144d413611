// SPDX-License-Identifier: MIT
// armsig_m7_reference: what the story of firmware/self_calibration_m7 finds on the host, as the
// image says it: a line a pose.
#include <cstdio>
#include <memory>

#include "firmware/self_calibration_m7/story.hpp"

int main() {
  using namespace armsig::story;
  const auto memory = std::make_unique<Memory>();
  const auto story = std::make_unique<Story>(*memory);
  if (!run(*story, [](auto&& work) { work(); }, [](const armsig::controller::Line&) {})) return 1;
  for (int k = 1; k <= kJudged; ++k) {
    const armsig::Vector3 p_um = 1e6 * story->answer(k).found;
    std::printf("answer_um %d %.6f %.6f %.6f\n", k, p_um.x(), p_um.y(), p_um.z());
  }
  return 0;
}
