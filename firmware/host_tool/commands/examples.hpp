// SPDX-License-Identifier: MIT
// An example of every command, which its --help shows and a test runs, in this order, in a copy of
// docs/examples.
#pragma once

#include <array>
#include <string_view>

namespace armsig::tool {

struct Example {
  std::string_view command;
  std::string_view line;
};

inline constexpr std::array<Example, 33> kExamples{{
    {"demo", "armsig demo --out demo"},
    {"arms", "armsig arms --show ur10e"},
    {"simulate",
     "armsig simulate --arm ur10e --tolerances 1 --sigma-mm 0.1 --out practice.csv --truth-out "
     "truth.yaml"},
    {"plan", "armsig plan --arm arm.yaml --points 12 --format krl --out sweeps.src"},
    {"plan",
     "armsig plan --arm arm.yaml --configuration 0,-60,60,0,30,0 --box-mm -900,-900,0,900,900,1200 "
     "--out to-measure.csv"},
    {"plan",
     "armsig plan --arm sockets/arm.yaml --instrument sockets/instrument.yaml --out plan.csv "
     "--drawing places.svg"},
    {"identify", "armsig identify --arm arm.yaml --measurements sweeps.csv --out signature.yaml"},
    {"identify",
     "armsig identify --arm ur10e --measurements practice.csv --method refined --out "
     "practice.yaml"},
    {"join",
     "armsig join --arm arm.yaml --joints joint-log.csv --points tracker-points.txt --units deg,mm "
     "--out later.csv"},
    {"check", "armsig check --signature signature.yaml --measurements later.csv"},
    {"report",
     "armsig report --signature signature.yaml --measurements sweeps.csv --out report.html"},
    {"suggest", "armsig suggest --signature signature.yaml --count 10 --out poses.csv"},
    {"predict",
     "armsig predict --signature signature.yaml --joints poses.csv --target 1 --sigma --out "
     "where.csv"},
    {"solve",
     "armsig solve --signature signature.yaml --poses where.csv --target 1 --seed poses.csv --out "
     "readings.csv"},
    {"compensate",
     "armsig compensate --signature signature.yaml --into part.script --out corrected.script "
     "--check"},
    {"compensate",
     "armsig compensate --signature signature.yaml --poses part.csv --tool 0,0,120,0,0,0 --out "
     "corrected.csv"},
    {"frames", "armsig frames --signature signature.yaml --points taught.csv"},
    {"evaluate",
     "armsig evaluate --arm demo/puma560.yaml --signature demo/robot1-encoder.yaml --truth "
     "demo/robot1-truth.yaml"},
    {"export", "armsig export --signature signature.yaml --format urdf --out arm.urdf"},
    {"export", "armsig export --signature signature.yaml --format linuxcnc --out arm.hal"},
    {"export",
     "armsig export --signature signature.yaml --into robot.urdf --base base_link --tip tool0 "
     "--out corrected.urdf"},
    {"import",
     "armsig import --urdf arm.urdf --base base_link --tip last_link --name \"my arm\" --out "
     "arm-again.yaml"},
    {"connect", "armsigd --virtual --console console --store store cabinet.yaml &"},
    {"connect", "armsig connect console"},
    {"connect", "armsig connect console wait timeout_s=60"},
    {"connect", "armsig connect console status"},
    {"connect", "armsig connect console enable --wait"},
    {"connect", "armsig connect console move q1_deg=5 --wait"},
    {"connect", "echo status | armsig connect console"},
    {"connect", "armsig connect console --web"},
    {"connect", "armsig connect console fetch arm.yaml --what nominal"},
    {"connect", "armsig connect console send demo/robot1-encoder.yaml"},
    {"connect", "armsig connect console stop"},
}};

}  // namespace armsig::tool
