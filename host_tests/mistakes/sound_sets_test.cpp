// SPDX-License-Identifier: MIT
// Sound sets of machines that share no code with armsig: none is refused, none is warned of for a
// cause that is not there, and what is stated is so.
//
// Quick by default. ARMSIG_SOUND=500 takes so many sets, ARMSIG_SOUND_FROM=100 begins at another.
#include <algorithm>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "host_tests/cli/files.hpp"
#include "host_tests/mistakes/other_wrongs.hpp"

namespace armsig::mistakes {
namespace {

using cli::Folder;
using cli::Outcome;
using other::Vec;

constexpr std::size_t kJudged = 150;

std::size_t asked(const char* variable, std::size_t otherwise) {
  const char* value = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? otherwise : std::strtoul(value, nullptr, 10);
}

struct Verdict {
  int status = -1;
  double stated_m = 0;
  double observed_m = 0;
  std::size_t rejected = 0;
  std::string region;
  std::string words;  // of the refusal, or of all warnings

  [[nodiscard]] double ratio() const { return stated_m > 0 ? observed_m / stated_m : 0; }
};

double observed_m(const Folder& folder, other::Measurement& set) {
  const auto later = set.later(kJudged);
  cli::write_file(folder / "q.csv", later.poses);
  const Outcome predicted =
      cli::run_tool(folder, "predict --signature s.yaml --joints q.csv --target 1 --out p.csv");
  EXPECT_EQ(predicted.status, 0) << predicted.err;
  if (predicted.status != 0) return 0;
  const cli::Csv points = cli::Csv::read(folder / "p.csv");
  double squares = 0;
  for (std::size_t k = 0; k < later.points.size(); ++k) {
    const Vec p{points.number(k, "x_m"), points.number(k, "y_m"), points.number(k, "z_m")};
    const Vec off = other::sum(p, later.points[k], -1);
    squares += other::dot(off, off) / static_cast<double>(kJudged);
  }
  return std::sqrt(squares);
}

Verdict judge(other::Measurement& set, const other::Wrong& wrong = {}) {
  const Folder folder;
  cli::write_file(folder / "arm.yaml", set.arm_text());
  cli::write_file(folder / "m.csv", set.rows_text(wrong));
  std::string command = "identify --arm arm.yaml --measurements m.csv --out s.yaml --json";
  if (set.by_ranges()) {
    cli::write_file(folder / "sensor.yaml", set.sensor_text());
    command += " --sensor sensor.yaml";
  }
  const Outcome identified = cli::run_tool(folder, command);
  Verdict verdict;
  verdict.status = identified.status;
  verdict.words = identified.err;
  if (const char* keep = std::getenv("ARMSIG_KEEP")) {  // NOLINT(concurrency-mt-unsafe)
    std::filesystem::copy(folder.path(), keep,
                          std::filesystem::copy_options::recursive |
                              std::filesystem::copy_options::overwrite_existing);
  }
  if (verdict.status != 0) return verdict;
  const auto json = nlohmann::json::parse(identified.out);
  verdict.stated_m = json["predicted_tool_error_m"];
  verdict.region = json["predicted_region"];
  if (json.contains("refinement")) verdict.rejected = json["refinement"].value("rows_rejected", 0);
  verdict.observed_m = observed_m(folder, set);
  return verdict;
}

TEST(SoundSets, of_other_machines_are_neither_refused_nor_misjudged) {
  const std::size_t from = asked("ARMSIG_SOUND_FROM", 0);
  const std::size_t count = asked("ARMSIG_SOUND", 16);
  for (std::size_t k = from; k < from + count; ++k) {
    other::Measurement set(k);
    const Verdict verdict = judge(set);
    fmt::print(
        "{} | {} | {} | status {} | rejected {} | {} | stated {:.3f} | observed {:.3f} | "
        "ratio {:.2f} | {}\n",
        k, set.machine().name, set.traits().words(), verdict.status, verdict.rejected,
        verdict.region, 1e3 * verdict.stated_m, 1e3 * verdict.observed_m, verdict.ratio(),
        verdict.words.empty() ? "" : verdict.words.substr(0, verdict.words.size() - 1));
    std::fflush(stdout);
    EXPECT_EQ(verdict.status, 0) << k << ": " << verdict.words;
  }
}

bool says(const Verdict& verdict, const std::vector<std::string>& words) {
  return std::ranges::any_of(words,
                             [&](const std::string& word) { return verdict.words.contains(word); });
}

TEST(UnsoundSets, of_other_machines_are_named_and_never_pass_with_a_wrong_figure) {
  const std::size_t rounds = asked("ARMSIG_UNSOUND", 1);
  std::size_t named = 0;
  std::size_t tried = 0;
  for (std::size_t round = 0; round < rounds; ++round) {
    const std::size_t count = other::unsound().size();
    for (std::size_t k = 0; k < count; ++k) {
      const other::Unsound one = other::unsound()[k];
      other::Draw draw(1000 * round + k);
      other::Traits traits = other::drawn_traits(draw, k);
      constexpr std::array<std::size_t, 4> kOfSixJoints{0, 1, 2, 4};
      traits.drawing = kOfSixJoints[(k + round) % 4];
      traits.rows = (k + round) % 3 == 0 ? other::Rows::kSweepsAndPoses : other::Rows::kPoses;
      traits.seen = other::Seen::kPositions;
      traits.poses = traits.rows == other::Rows::kPoses ? 120 : 60;
      traits.gains = false;
      traits.coupled = false;
      other::Measurement set(1000 * round + k, traits);
      const Verdict verdict = judge(set, one.wrong);
      ++tried;
      named += says(verdict, one.says) ? 1U : 0U;
      fmt::print(
          "{} | {} | {} | {} | status {} | rejected {} | stated {:.3f} | observed {:.3f} | "
          "ratio {:.2f} | {} | {}\n",
          k, one.name, set.machine().name, set.traits().words(), verdict.status, verdict.rejected,
          1e3 * verdict.stated_m, 1e3 * verdict.observed_m, verdict.ratio(),
          says(verdict, one.says) ? "NAMED" : "-",
          verdict.words.empty() ? "" : verdict.words.substr(0, verdict.words.size() - 1));
      std::fflush(stdout);
    }
  }
  fmt::print("{} of {} named\n", named, tried);
}

}  // namespace
}  // namespace armsig::mistakes
