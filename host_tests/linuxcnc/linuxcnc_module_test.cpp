// SPDX-License-Identifier: MIT
// armsigkins as LinuxCNC loads it: its parameters, pins and messages, and its time beside that of
// LinuxCNC's own genserkins.
#include <algorithm>
#include <chrono>

#include "host_tests/exports/exported_arm.hpp"
#include "host_tests/exports/linuxcnc_hal.hpp"

namespace armsig::cli {
namespace {

using linuxcnc::EmcPose;
using linuxcnc::Module;

const linuxcnc::Pin& pin(const std::string& name) { return *linuxcnc::hal().pins.at(name); }
bool is_set(const std::string& name) { return (pin(name).whole & 1) != 0; }

// A copy of the module: the loader gives the same one twice otherwise, with what it knows.
Module load(const Folder& folder, const std::string& kins) {
  const auto copy = folder / "armsigkins.so";
  if (!std::filesystem::exists(copy)) std::filesystem::copy_file(ARMSIG_KINS_MODULE, copy);
  linuxcnc::hal().printed.clear();
  return linuxcnc::load_module(copy.string(), {{"signature", kins.c_str()}});
}

std::string export_kins(const Folder& folder) {
  const Outcome exported =
      run_tool(folder, "export --signature truth.yaml --format linuxcnc-kins --out arm.kins");
  EXPECT_EQ(exported.status, 0) << exported.err;
  return (folder / "arm.kins").string();
}

TEST(ArmsigKins, refuses_a_file_that_is_not_one_by_its_name_and_line) {
  const Folder folder;
  write_file(folder / "no.kins", "armsig linuxcnc-kins/1\n");
  const std::string file = (folder / "no.kins").string();
  const Module module = load(folder, file);
  EXPECT_NE(module.started, 0);
  EXPECT_EQ(linuxcnc::hal().printed,
            "armsigkins: signature=" + file +
                ", line 0: its last line is not the crc32 of the others: changed, damaged, or "
                "another file\n");
}

TEST(ArmsigKins, tells_by_its_pins_that_a_pose_is_refused_or_near_a_singularity) {
  const Folder folder;
  make_individual(folder, kPuma560, "");
  const std::string file = export_kins(folder);
  const Module module = load(folder, file);
  ASSERT_EQ(module.started, 0) << linuxcnc::hal().printed;
  const std::array<double, 9> away{20, -70, 40, 35, 40, 25};
  EmcPose world{};
  ASSERT_EQ(module.forward(away.data(), &world, nullptr, nullptr), 0);
  std::array<double, 9> joints = away;
  ASSERT_EQ(module.inverse(&world, joints.data(), nullptr, nullptr), 0);
  EXPECT_FALSE(is_set("armsigkins.error"));
  EXPECT_FALSE(is_set("armsigkins.slow"));
  EXPECT_EQ(pin("armsigkins.feed").number, 1);
  EXPECT_GT(pin("armsigkins.regularity").number, 0.05);

  std::array<double, 9> straight = away;
  straight[4] = 0;
  ASSERT_EQ(module.forward(straight.data(), &world, nullptr, nullptr), 0);
  joints = straight;
  ASSERT_EQ(module.inverse(&world, joints.data(), nullptr, nullptr), 0);
  EXPECT_TRUE(is_set("armsigkins.slow"));
  EXPECT_LT(pin("armsigkins.regularity").number, 1e-9);
  EXPECT_EQ(pin("armsigkins.feed").number, 0.01);

  world.x += 5000;
  linuxcnc::hal().printed.clear();
  EXPECT_NE(module.inverse(&world, joints.data(), nullptr, nullptr), 0);
  EXPECT_NE(module.inverse(&world, joints.data(), nullptr, nullptr), 0);
  EXPECT_TRUE(is_set("armsigkins.error"));
  const std::string said = linuxcnc::hal().printed;
  EXPECT_TRUE(said.starts_with("armsigkins: ")) << said;
  EXPECT_EQ(std::ranges::count(said, '\n'), 1) << "once, not at every period: " << said;
  EXPECT_EQ(joints, straight);
}

// Of the same poses, one after the other, a millimetre apart.
double median_ns(const Module& module, const EmcPose& start, std::array<double, 9> joints) {
  std::vector<double> times_ns;
  EmcPose world = start;
  for (int step = 0; step < 400; ++step) {
    world.x += step < 200 ? 0.1 : -0.1;
    const auto before = std::chrono::steady_clock::now();
    if (module.inverse(&world, joints.data(), nullptr, nullptr) != 0) return -1;
    const auto after = std::chrono::steady_clock::now();
    times_ns.push_back(std::chrono::duration<double, std::nano>(after - before).count());
  }
  std::ranges::nth_element(times_ns, times_ns.begin() + 200);
  return times_ns[200];
}

TEST(ArmsigKins, finds_an_inverse_sooner_than_genserkins) {
  const Module& theirs = linuxcnc::genserkins();
  if (theirs.inverse == nullptr) GTEST_SKIP() << "no genserkins module; toolchain/setup gets it";
  const Folder folder;
  make_individual(folder, kPuma560);
  const std::string file = export_kins(folder);
  const Module ours = load(folder, file);
  ASSERT_EQ(ours.started, 0) << linuxcnc::hal().printed;
  ASSERT_EQ(export_as(folder, "linuxcnc").status, 0);
  for (const std::string& line : split(read_file(folder / "export.out"), '\n')) {
    if (!line.starts_with("setp genserkins.")) continue;
    const Fields words = split(line, ' ');
    linuxcnc::hal().pins.at(words[1])->number = std::stod(words[2]);
  }
  const std::array<double, 9> away{20, -70, 40, 35, 40, 25};
  EmcPose at_ours{};
  EmcPose at_theirs{};
  std::array<double, 64> flags{};
  ASSERT_EQ(ours.forward(away.data(), &at_ours, nullptr, nullptr), 0);
  ASSERT_EQ(theirs.forward(away.data(), &at_theirs, flags.data(), flags.data()), 0);
  const double ours_ns = median_ns(ours, at_ours, away);
  const double theirs_ns = median_ns(theirs, at_theirs, away);
  ASSERT_GT(ours_ns, 0);
  ASSERT_GT(theirs_ns, 0);
  std::printf("median of an inverse: armsigkins %.2f us, genserkins %.2f us\n", 1e-3 * ours_ns,
              1e-3 * theirs_ns);
  EXPECT_LT(ours_ns, theirs_ns);
}

}  // namespace
}  // namespace armsig::cli
