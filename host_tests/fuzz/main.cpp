// SPDX-License-Identifier: MIT
// The fuzzer: fuzz --target=NAME [FOLDER OF A CORPUS] [-max_total_time=SECONDS ...], as libFuzzer
// takes it; fuzz --targets lists the names.
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <span>

#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

void (*chosen)(Bytes bytes) = nullptr;

void list() {
  for (const std::span<const Target> group : all_targets()) {
    for (const Target& target : group) (void)std::puts(std::string(target.name).c_str());
  }
}

void choose(std::string_view name) {
  for (const std::span<const Target> group : all_targets()) {
    for (const Target& target : group) {
      if (target.name == name) chosen = target.run;
    }
  }
}

}  // namespace
}  // namespace armsig::fuzz

extern "C" {

// The names are libFuzzer's.
int LLVMFuzzerInitialize(int* count, char*** arguments);
int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size);

int LLVMFuzzerInitialize(int* count, char*** arguments) {
  constexpr std::string_view kOption = "--target=";
  for (const std::string_view word : std::span(*arguments, static_cast<std::size_t>(*count))) {
    if (word == "--targets") {
      armsig::fuzz::list();
      std::exit(0);
    }
    if (word.starts_with(kOption)) armsig::fuzz::choose(word.substr(kOption.size()));
  }
  if (armsig::fuzz::chosen != nullptr) return 0;
  (void)std::fprintf(stderr, "fuzz: --target=NAME, one of --targets\n");
  std::exit(2);
}

int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  armsig::fuzz::chosen({bytes, size});
  return 0;
}
}
