// SPDX-License-Identifier: MIT
// Memory that runs out at any allocation of the command: it says so in words and ends, the file
// that it was to write is the old one or the new one, and nothing is left beside it.
#include <algorithm>
#include <cstdlib>

#include "host_tests/cli/files.hpp"

#if !defined(__SANITIZE_ADDRESS__)

namespace armsig::cli {
namespace {

struct Command {
  std::string words;
  std::string out;
};

class FailingMemory : public testing::TestWithParam<Command> {
 protected:
  void SetUp() override { ASSERT_EQ(measure_two_joints(folder_).status, 0); }
  // Runs the command, whose allocation `failing` fails; 0: none.
  Outcome run(long failing) {
    write_file(folder_ / GetParam().out, kOld);
    const std::string folder = folder_.path().string();
    const std::string command =
        "cd '" + folder + "' && LD_PRELOAD='" ARMSIG_FAILING_HEAP +
        "' ARMSIG_COUNTED_ALLOCATIONS=.count ARMSIG_FAILING_ALLOCATION=" + std::to_string(failing) +
        " '" ARMSIG_TOOL "' " + GetParam().words + " >.out 2>.err";
    // NOLINTNEXTLINE(cert-env33-c): our own command line
    const int status =
        std::system(("exec env -i PATH=/usr/bin:/bin sh -c \"" + command + "\"").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(folder_ / ".out"),
            read_file(folder_ / ".err")};
  }
  [[nodiscard]] bool is_old() const { return read_file(folder_ / GetParam().out) == kOld; }
  [[nodiscard]] std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_.path()), {}));
  }

  static constexpr const char* kOld = "what stood there before\n";
  Folder folder_;
};

// All of them on request (ARMSIG_EVERY_ALLOCATION=1), about 120 otherwise.
TEST_P(FailingMemory, ends_in_words_with_the_old_file_in_place) {
  const Outcome whole = run(0);
  ASSERT_EQ(whole.status, 0) << whole.err;
  const long allocations = std::stol(read_file(folder_ / ".count"));
  ASSERT_GT(allocations, 100) << "nothing was counted";
  const std::size_t new_size = read_file(folder_ / GetParam().out).size();
  const std::size_t beside = files();
  const long step =
      std::getenv("ARMSIG_EVERY_ALLOCATION") != nullptr ? 1 : std::max(1L, allocations / 120);
  int told = 0;
  for (long n = 1; n <= allocations; n += step) {
    const Outcome ended = run(n);
    ASSERT_EQ(files(), beside) << "allocation " << n << " of " << allocations;
    if (ended.status == 0) {
      ASSERT_EQ(read_file(folder_ / GetParam().out).size(), new_size) << "allocation " << n;
      continue;
    }
    ++told;
    // The shell answers 128 and more for a signal.
    ASSERT_TRUE(ended.status == 1 || ended.status == 2)
        << "allocation " << n << " of " << allocations << ": status " << ended.status << "\n"
        << ended.err;
    ASSERT_NE(ended.err.find("armsig: "), std::string::npos) << "allocation " << n;
    ASSERT_TRUE(is_old() || read_file(folder_ / GetParam().out).size() == new_size)
        << "allocation " << n;
  }
  EXPECT_GT(told, 50);
}

INSTANTIATE_TEST_SUITE_P(
    , FailingMemory,
    testing::Values(Command{"export --signature t.yaml --format urdf --out o.urdf", "o.urdf"},
                    Command{"identify --arm arm.yaml --measurements m.csv --out s.yaml", "s.yaml"}),
    [](const auto& work) { return work.index == 0 ? "of_export" : "of_identify"; });

}  // namespace
}  // namespace armsig::cli

#endif
