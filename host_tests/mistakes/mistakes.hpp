// SPDX-License-Identifier: MIT
// What people get wrong.
#pragma once

#include "host_tests/mistakes/mistakes_of_measuring.hpp"
#include "host_tests/mistakes/mistakes_of_the_arm.hpp"

namespace armsig::mistakes {

inline std::vector<Mistake> all_mistakes() {
  std::vector<Mistake> all;
  for (const auto& some :
       {mistakes_of_positions(), mistakes_of_order(), mistakes_of_readings(), mistakes_of_arm()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace armsig::mistakes
