// SPDX-License-Identifier: MIT
// armsig_r5f_reference IMAGE: identifies the emulated arm of the R5F in the host's virtual cabinet,
// with the same configuration and seed, and compares the signature with the one in IMAGE, what the
// board's memory held: prints the largest distance of predicted tool positions in metres.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "core/base/low_discrepancy.hpp"
#include "firmware/arm_r5f/world.hpp"
#include "firmware/cabinet_r5f/configuration.hpp"
#include "firmware/controller/model.hpp"
#include "firmware/virtual_cabinet/virtual_cabinet.hpp"
#include "hal/simulated/flash.hpp"
#include "host_tests/support/line_console.hpp"
#include "host_tests/support/ram_memory.hpp"

namespace armsig {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr double kLongest_s = 3600;

struct Run {
  test::LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  test::RamMemory memory;
  cabinet::World world{.arm = arm_r5f::arm(),
                       .start = arm_r5f::start(),
                       .drive = simulated::DriveConfiguration{},
                       .bent = {},
                       .limbs = {},
                       .sensor = arm_r5f::field(kSeed),
                       .ping_period = std::chrono::milliseconds(20),
                       .seed = kSeed};
  controller::Configuration configuration = cabinet::controller_configuration();
  cabinet::VirtualCabinet cabinet{configuration, cabinet::drive_configuration(), world, memory,
                                  consoles};

  bool wait_for(controller::Mode mode, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
      if (cabinet.state().snapshot().mode == mode) return true;
      cabinet.step();
    }
    return false;
  }
  bool ask(const char* request) {
    const std::size_t before = console.replies.size();
    console.requests.emplace_back(request);
    for (int i = 0; i < 1000 && console.replies.size() == before; ++i) cabinet.step();
    return console.replies.size() > before && console.replies.back() == "ok";
  }
  bool identify() {
    using enum controller::Mode;
    return wait_for(kIdle, 10) && ask("enable") && wait_for(kHolding, 10) && ask("identify") &&
           wait_for(kSweeping, 1) && wait_for(kHolding, kLongest_s) && ask("accept");
  }
};

double compare(const Arm& drawing, const Signature& a, const Signature& b) {
  const controller::Model model_a = controller::model_of(a, drawing);
  const controller::Model model_b = controller::model_of(b, drawing);
  double worst = 0;
  for (int k = 1; k <= 100; ++k) {
    const JointVector q = evenly_spread_configuration(a.types, drawing.limits, k);
    worst = std::max(worst, (tool_pose(model_a, q)->p - tool_pose(model_b, q)->p).norm());
  }
  return worst;
}

int run(const char* path) {
  std::ifstream file(path, std::ios::binary);
  // As the bank of the board is laid out (hal/r5f/bank_memory.hpp).
  simulated::Flash stored({.layout = {.page_bytes = 128, .pages_per_sector = 4, .sectors = 28}});
  const std::vector<std::uint8_t> image(std::istreambuf_iterator<char>(file), {});
  if (image.size() != stored.layout().bytes()) {
    std::fprintf(stderr, "%s: not %zu bytes\n", path, stored.layout().bytes());
    return 2;
  }
  const std::size_t page_bytes = stored.layout().page_bytes;
  for (std::size_t at = 0; at < image.size(); at += page_bytes) {
    (void)stored.program_page(at, std::span(image).subspan(at, page_bytes));
  }
  Run reference;
  if (!reference.identify()) {
    std::fprintf(stderr, "the host simulation did not identify: %s\n",
                 reference.console.told.empty() ? "" : reference.console.told.back().c_str());
    return 1;
  }
  controller::SignatureRecord record;
  controller::SignatureStore store(stored);
  if (!store.load(reference.configuration.drawing, record)) {
    std::fprintf(stderr, "%s: holds no signature\n", path);
    return 1;
  }
  const double worst_m = compare(reference.configuration.drawing, record.signature,
                                 reference.cabinet.state().active()->signature);
  std::printf("worst_m=%.3g\n", worst_m);
  return worst_m < 1e-9 ? 0 : 1;
}

}  // namespace
}  // namespace armsig

int main(int argc, char** argv) {
  if (argc == 2) return armsig::run(argv[1]);
  std::fprintf(stderr, "usage: armsig_r5f_reference IMAGE\n");
  return 2;
}
