// SPDX-License-Identifier: MIT
// Without arguments of ours: Google Benchmark over all rows. `--list` names them; `--count
// ROW` does the work of one row once round inside armsig_counted, for callgrind, and prints the
// number of calls and the heap calls a call.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <benchmark/benchmark.h>

#include "hal/linux/heap_calls.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {

std::vector<Row>& rows() {
  static std::vector<Row> all;
  return all;
}

Row::Row(std::string path_of, std::string who_does, std::function<Work()> prepare_work,
         std::size_t calls_round)
    : path(std::move(path_of)),
      who(std::move(who_does)),
      prepare(std::move(prepare_work)),
      calls(calls_round) {
  rows().push_back(*this);
}

}  // namespace armsig::benchmarks

namespace {

using armsig::benchmarks::Row;
using armsig::benchmarks::Work;

std::string name(const Row& row) { return row.path + "/" + row.who; }

int count(const char* wanted);

}  // namespace

// Callgrind collects inside this function only (--toggle-collect).
extern "C" [[gnu::noinline]] void armsig_counted(const Work& work, std::size_t calls) {
  work(calls);
}

namespace {

int count(const char* wanted) {
  for (const Row& row : armsig::benchmarks::rows()) {
    if (name(row) != wanted) continue;
    const Work work = row.prepare();
    work(1);
    const std::uint64_t before = armsig::linux_hal::heap_calls();
    armsig_counted(work, row.calls);
    const std::uint64_t used = armsig::linux_hal::heap_calls() - before;
    std::printf("%zu %.0f\n", row.calls,
                static_cast<double>(used) / static_cast<double>(row.calls));
    return EXIT_SUCCESS;
  }
  std::fprintf(stderr, "no row %s\n", wanted);
  return EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "--list") == 0) {
    for (const Row& row : armsig::benchmarks::rows()) std::printf("%s\n", name(row).c_str());
    return EXIT_SUCCESS;
  }
  if (argc == 3 && std::strcmp(argv[1], "--count") == 0) return count(argv[2]);
  for (const Row& row : armsig::benchmarks::rows()) {
    benchmark::RegisterBenchmark(name(row).c_str(), [row](benchmark::State& state) {
      const Work work = row.prepare();
      const auto batch = static_cast<std::int64_t>(row.calls);
      while (state.KeepRunningBatch(batch)) work(row.calls);
    });
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return EXIT_FAILURE;
  benchmark::RunSpecifiedBenchmarks();
  return EXIT_SUCCESS;
}
