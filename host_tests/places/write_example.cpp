// SPDX-License-Identifier: MIT
// Writes docs/examples/sockets: 100 touches of four bars by a simulated UR5. Argument: the folder.
#include <filesystem>

#include "host_tests/support/touching_arm.hpp"

int main(int argc, char** argv) {
  using armsig::touching::Session;
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  Session session(armsig::touching::ur5(), 1);
  session.add_bars(4, 0.3, 0.02e-3);
  session.touch_sockets(100);
  std::ofstream(folder / "arm.yaml") << session.arm_yaml();
  std::ofstream(folder / "instrument.yaml") << session.instrument_yaml();
  std::ofstream(folder / "touches.csv") << session.csv();
}
