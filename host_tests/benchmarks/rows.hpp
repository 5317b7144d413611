// SPDX-License-Identifier: MIT
// The rows of the benchmark: one path of the software, done by one implementation.
//
// A row is added by a static object in any *_benchmark.cpp of this folder:
//   const benchmarks::Row kRow("forward", "armsig", [] {
//     return [data = prepare()](std::size_t calls) { for (...) benchmarks::keep(work(data)); };
//   });
// Rows of one path do the same work; the report gives peers as multiples of "armsig".
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace armsig::benchmarks {

// Does its work `calls` times, in its own loop.
using Work = std::function<void(std::size_t calls)>;

struct Row {
  std::string path;
  std::string who;
  std::function<Work()> prepare;
  std::size_t calls;  // in which the work comes round once

  // Adds itself to rows().
  Row(std::string path, std::string who, std::function<Work()> prepare, std::size_t calls = 256);
};

std::vector<Row>& rows();

// Makes the compiler believe that `value` is used.
template <typename T>
inline void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

}  // namespace armsig::benchmarks
