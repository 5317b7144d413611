// SPDX-License-Identifier: MIT
// The library that loads a signature: from C and C++, the same answers as the command.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/library/armsig.hpp"
#include "host_tests/support/allocation_guard.hpp"
#include "host_tests/support/bent_model.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig {
namespace {

const Readings kAt{0.3, -1.2, 1.1, 0.4, 0.7, -0.6};

// A Puma of the paper with gravity and maps, standing somewhere.
tool::SignatureRecord bent_puma() {
  tool::SignatureRecord record;
  record.nominal = tool::puma560();
  const Pose X_S0{rotation_z(0.4), Vector3(1, 2, 0.5)};
  record.signature = signature_of(tool::table2_robot(1), JointVector{0, -1.5, 1.5, 0.5, 0.5, 0},
                                  X_S0, std::array{KnownTarget{1, 6, Vector3(0.1, 0, 0.1)}});
  test::Random random(4);
  record.deflections =
      std::make_shared<const calibration::ArmModel>(test::bent_model(record.nominal, random));
  record.arm_name = "Puma";
  record.method = "exact";
  record.time = "2026-01-01T12:00:00Z";
  record.version = "test";
  return record;
}

class Library : public testing::Test {
 protected:
  Library()
      : path_(std::filesystem::temp_directory_path() /
              ("armsig-library-" + std::to_string(::getpid()) + ".yaml")) {
    const auto written = tool::write_signature_file(path_.string(), record_);
    EXPECT_TRUE(written) << (written ? "" : tool::render(written.error()));
  }
  ~Library() override { std::filesystem::remove(path_); }

  [[nodiscard]] LoadedArm arm() const {
    auto loaded = load(path_.c_str());
    EXPECT_TRUE(loaded) << (loaded ? "" : loaded.error().data());
    return std::move(*loaded);
  }

  tool::SignatureRecord record_ = bent_puma();
  std::filesystem::path path_;
};

Pose pose_of_numbers(const ToolPose& n) {
  return {Eigen::Quaterniond(n[3], n[4], n[5], n[6]).toRotationMatrix(), Vector3(n[0], n[1], n[2])};
}

double largest_difference(const ToolPose& one, const ToolPose& other) {
  const Pose X = pose_of_numbers(one).inverse() * pose_of_numbers(other);
  return std::max(X.p.norm(), rotation_vector(X.R).norm());
}

// The axes themselves, by another way than the library's rows.
TEST_F(Library, has_the_tool_where_predict_has_it) {
  const LoadedArm loaded = arm();
  const auto tool = loaded.forward(kAt);
  ASSERT_TRUE(tool);
  ToolPose base{};
  ToolPose link{};
  armsig_base_in_sensor(loaded.c(), base.data());
  armsig_last_link_on_flange(loaded.c(), link.data());
  const Pose X_SL = pose_of_numbers(base) * pose_of_numbers(*tool) * pose_of_numbers(link);
  const JointVector q{0.3, -1.2, 1.1, 0.4, 0.7, -0.6};
  const Pose expected = kinematics::link_pose(
      record_.signature,
      calibration::true_readings(record_.readings(), record_.signature.configuration, q), 6);
  EXPECT_LT((X_SL.p - expected.p).norm(), 1e-11);
  EXPECT_LT(angle_between(X_SL.R, expected.R), 1e-11);
}

TEST_F(Library, finds_readings_near_a_seed_and_all_of_them) {
  const LoadedArm loaded = arm();
  const auto tool = loaded.forward(kAt);
  Readings seed = kAt;
  for (std::size_t i = 0; i < 6; ++i) seed[i] += 0.02;
  const auto back = loaded.inverse(*tool, seed);
  ASSERT_TRUE(back);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((*back)[i], kAt[i], 1e-8);
  const auto all = loaded.solutions(*tool);
  ASSERT_TRUE(all);
  EXPECT_GT(all->count, 1U);
  for (std::size_t k = 0; k < all->count; ++k) {
    EXPECT_LT(largest_difference(*loaded.forward(all->readings[k]), *tool), 1e-8);
  }
}

TEST_F(Library, makes_the_nominal_model_arrive) {
  const LoadedArm loaded = arm();
  const ToolPose hand{0.02, 0, 0.15, 1, 0, 0, 0};
  const auto target = loaded.forward(kAt, hand);
  const auto told = loaded.compensate(*target, kAt, hand);
  ASSERT_TRUE(told);
  EXPECT_GT(largest_difference(*told, *target), 1e-4);
  ToolPose nominal{};
  ASSERT_EQ(armsig_nominal_forward(loaded.c(), kAt.data(), hand.data(), nominal.data()), ARMSIG_OK);
  EXPECT_LT(largest_difference(*told, nominal), 1e-8);
}

TEST_F(Library, allocates_in_load_alone) {
  const LoadedArm loaded = arm();
  const auto tool = loaded.forward(kAt);
  const test::AllocationGuard guard;
  const bool answered = loaded.inverse(*tool, kAt) && loaded.solutions(*tool) &&
                        loaded.compensate(*tool, kAt) && loaded.forward(kAt);
  const std::uint64_t allocations = guard.count();
  EXPECT_TRUE(answered);
  EXPECT_EQ(allocations, 0U);
}

TEST_F(Library, is_read_by_two_threads) {
  const LoadedArm loaded = arm();
  const auto tool = loaded.forward(kAt);
  const auto work = [&] {
    for (int k = 0; k < 200; ++k)
      EXPECT_EQ(*loaded.inverse(*tool, kAt), *loaded.inverse(*tool, kAt));
  };
  std::thread other(work);
  work();
  other.join();
}

TEST_F(Library, names_what_it_refuses) {
  const LoadedArm loaded = arm();
  const ToolPose far{9, 0, 0, 1, 0, 0, 0};
  const ToolPose none{0.5, 0, 0, 1, 1, 0, 0};
  EXPECT_EQ(test::failure_of(loaded.inverse(far, kAt)), ARMSIG_OUT_OF_REACH);
  EXPECT_EQ(test::failure_of(loaded.compensate(none, kAt)), ARMSIG_NOT_FINITE);
  EXPECT_EQ(test::failure_of(loaded.sigma(kAt, 1)), ARMSIG_NO_UNCERTAINTY);
  const auto tool = loaded.forward(kAt);
  std::size_t count = 0;
  Readings one{};
  EXPECT_EQ(armsig_solutions(loaded.c(), tool->data(), nullptr, one.data(), 1, &count),
            ARMSIG_NO_ROOM);
  EXPECT_EQ(count, 1U);
}

TEST(Load, says_why_a_file_is_no_signature) {
  const auto none = load("/nowhere/s.yaml");
  const std::array<char, 512> problem = test::failure_of(none);
  EXPECT_NE(std::string(problem.data()).find("/nowhere/s.yaml"), std::string::npos);
}

TEST(Load, ends_a_long_problem_where_the_buffer_ends) {
  std::array<char, 8> problem{};
  EXPECT_EQ(armsig_load("/nowhere/s.yaml", nullptr, problem.data(), problem.size()), nullptr);
  EXPECT_EQ(problem.back(), '\0');
  EXPECT_EQ(armsig_load("/nowhere/s.yaml", nullptr, nullptr, 0), nullptr);
}

}  // namespace
}  // namespace armsig
