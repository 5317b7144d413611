// SPDX-License-Identifier: MIT
// Every seed of every target once, without the fuzzer: replay CORPUS. Ends with the first promise
// that is broken.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "host_tests/fuzz/fuzz.hpp"

namespace {

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 2) return 2;
  int targets = 0;
  int seeds = 0;
  for (const std::span<const armsig::fuzz::Target> group : armsig::fuzz::all_targets()) {
    for (const armsig::fuzz::Target& target : group) {
      ++targets;
      const std::filesystem::path folder = std::filesystem::path(arguments[1]) / target.name;
      if (!std::filesystem::is_directory(folder)) {
        (void)std::fprintf(stderr, "no seeds: %s\n", folder.c_str());
        return 1;
      }
      for (const auto& seed : std::filesystem::directory_iterator(folder)) {
        (void)std::fprintf(stderr, "%s\n", seed.path().c_str());
        target.run(bytes_of(seed.path()));
        ++seeds;
      }
    }
  }
  (void)std::printf("%d targets, %d seeds\n", targets, seeds);
  return seeds > 2 * targets ? 0 : 1;
}
