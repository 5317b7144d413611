// SPDX-License-Identifier: MIT
// What a closed controller must be given so that the tool arrives: the signature's file, from C++.
#include <armsig.hpp>
#include <cstdio>

int main(int count, char** files) {
  // guide: begin
  const auto arm = armsig::load(count > 1 ? files[1] : "signature.yaml");
  if (!arm) return std::fprintf(stderr, "%s\n", arm.error().data()), 1;
  const armsig::Readings q{0.2, -1.2, 1.0, 0.3, 0.9, -0.5};
  const auto target = arm->forward(q);  // where the tool really is at these readings
  if (!target) return 1;
  const auto back = arm->inverse(*target, q);     // and how to get there
  const auto told = arm->compensate(*target, q);  // what its own controller must be given instead
  if (!back || !told) return 1;
  std::printf("x %.3f mm, instead of %.3f mm\n", 1e3 * (*told)[0], 1e3 * (*target)[0]);
  // guide: end
  return 0;
}
