// SPDX-License-Identifier: MIT
// A simulated Puma, identified, and held-out poses of it.
#pragma once

#include <string>

#include "host_tests/cli/predictions.hpp"

namespace armsig::cli {

// A signature s.yaml from sweeps and poses, and held-out poses of the same arm.
inline Csv identified(const Folder& folder, const std::string& method = "refined") {
  write_file(folder / "arm.yaml", kPuma560);
  const std::string simulate =
      "simulate --arm arm.yaml --flange-target-mm 80,30,120 --sigma-mm 0.2 ";
  EXPECT_EQ(run_tool(folder, simulate + "--tolerances 1 --arc 120 --points 20 --free-poses 20 "
                                        "--seed 3 --out m.csv --truth-out truth.yaml")
                .status,
            0);
  EXPECT_EQ(run_tool(folder, simulate + "--truth truth.yaml --points 4 --free-poses 30 --seed 4 "
                                        "--out held.csv")
                .status,
            0);
  const Outcome outcome = run_tool(
      folder, "identify --arm arm.yaml --measurements m.csv --out s.yaml --method " + method);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  Csv held = Csv::read(folder / "held.csv");
  std::erase_if(held.rows, [&](const Fields& row) { return row[held.column("sweep")] != "0"; });
  held.write(folder / "held.csv");
  return held;
}

}  // namespace armsig::cli
