// SPDX-License-Identifier: MIT
// The same recursive least squares by dlib: an update leaves the coefficients, as ours does with
// solve().
#include <dlib/svm/rls.h>

#include <vector>

#include "host_tests/benchmarks/estimators_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {
namespace {

const Row kRls(kRlsPath, "dlib", [] {
  using Column = dlib::matrix<double, 3, 1>;
  std::vector<Column> regressors;
  for (const Vector3& x : rls_work().regressors) {
    Column column;
    column = x[0], x[1], x[2];
    regressors.push_back(column);
  }
  return [&w = rls_work(), regressors, rls = dlib::rls(1.0, 1e6)](std::size_t calls) mutable {
    for (std::size_t k = 0; k < calls; ++k) {
      const std::size_t i = k % kRlsRows;
      rls.train(regressors[i], w.measured[i]);
      keep(rls);
    }
  };
});

}  // namespace
}  // namespace armsig::benchmarks
