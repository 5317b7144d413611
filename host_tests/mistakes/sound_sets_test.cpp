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

// RMS over poses that follow. Where the base is in the sensor frame is the user's choice for a
// sensor that errs: of what went `wrong` the mean is taken off.
double observed_m(const Folder& folder, other::Measurement& set, const other::Wrong* wrong) {
  const auto later = set.later(kJudged, wrong == nullptr ? other::Wrong{} : *wrong);
  cli::write_file(folder / "q.csv", later.poses);
  const Outcome predicted =
      cli::run_tool(folder, "predict --signature s.yaml --joints q.csv --target 1 --out p.csv");
  EXPECT_EQ(predicted.status, 0) << predicted.err;
  if (predicted.status != 0) return 0;
  const cli::Csv points = cli::Csv::read(folder / "p.csv");
  constexpr double kShare = 1 / static_cast<double>(kJudged);
  double squares = 0;
  Vec mean{0, 0, 0};
  for (std::size_t k = 0; k < later.points.size(); ++k) {
    const Vec p{points.number(k, "x_m"), points.number(k, "y_m"), points.number(k, "z_m")};
    const Vec off = other::sum(p, later.points[k], -1);
    squares += kShare * other::dot(off, off);
    mean = other::sum(mean, off, kShare);
  }
  return std::sqrt(wrong == nullptr ? squares : squares - other::dot(mean, mean));
}

Verdict judge(other::Measurement& set, const other::Wrong* wrong = nullptr) {
  const Folder folder;
  cli::write_file(folder / "arm.yaml", set.arm_text());
  cli::write_file(folder / "m.csv", set.rows_text(wrong == nullptr ? other::Wrong{} : *wrong));
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
  // Of poses anywhere within the joint limits, as those that follow are.
  verdict.stated_m =
      json.value("predicted_over_limits_m", json["predicted_tool_error_m"].get<double>());
  verdict.region = json["predicted_region"];
  if (json.contains("refinement")) verdict.rejected = json["refinement"].value("rows_rejected", 0);
  verdict.observed_m = observed_m(folder, set, wrong);
  return verdict;
}

bool says(const Verdict& verdict, const std::vector<std::string>& words) {
  return std::ranges::any_of(words,
                             [&](const std::string& word) { return verdict.words.contains(word); });
}

// Causes that no sound set has. What its machines do is named by other words, also where it is one
// of two that nothing tells apart.
bool is_accused(Verdict verdict) {
  const std::string either = "joints have backlash, or something changed";
  if (const std::size_t at = verdict.words.find(either); at != std::string::npos) {
    verdict.words.erase(at, either.size());
  }
  return says(verdict, {"something changed", "another place", "one target number", "of one scale",
                        "warning: all lengths seen are", "follows joint", "thrown out",
                        "contradict each other: the nearest"});
}

void print(std::size_t number, const std::string& name, const other::Measurement& set,
           const Verdict& verdict) {
  fmt::print(
      "{} | {} | {} | status {} | rejected {} | {} | stated {:.3f} | observed {:.3f} | "
      "ratio {:.2f} | {}\n",
      number, name, set.traits().words(), verdict.status, verdict.rejected, verdict.region,
      1e3 * verdict.stated_m, 1e3 * verdict.observed_m, verdict.ratio(),
      verdict.words.empty() ? "" : verdict.words.substr(0, verdict.words.size() - 1));
  std::fflush(stdout);
}

Verdict judged_sound(std::size_t number) {
  other::Measurement set(number);
  const Verdict verdict = judge(set);
  print(number, set.machine().name, set, verdict);
  EXPECT_EQ(verdict.status, 0) << number << ": " << verdict.words;
  EXPECT_LT(verdict.ratio(), 2) << number << ": " << verdict.words;
  return verdict;
}

TEST(SoundSets, of_other_machines_are_neither_refused_nor_accused) {
  const std::size_t from = asked("ARMSIG_SOUND_FROM", 0);
  const std::size_t count = asked("ARMSIG_SOUND", 16);
  std::size_t accused = 0;
  std::vector<double> ratios;
  for (std::size_t k = from; k < from + count; ++k) {
    const Verdict verdict = judged_sound(k);
    accused += is_accused(verdict) ? 1U : 0U;
    if (verdict.status == 0) ratios.push_back(verdict.ratio());
  }
  ASSERT_FALSE(ratios.empty());
  std::ranges::nth_element(ratios, ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2));
  const double median = ratios[ratios.size() / 2];
  fmt::print("{} sets, {} accused, observed over stated {:.2f} in the middle\n", count, accused,
             median);
  EXPECT_LE(accused, count / 100);
  EXPECT_GT(median, 0.8);
  EXPECT_LT(median, 1.25);
}

// Between two sweeps the joints turn back: backlash is a step there, of the reading or the target.
TEST(SoundSets, of_sweeps_with_backlash_are_not_accused_of_a_change) {
  for (const std::size_t k : {3U, 4U, 49U, 117U, 167U, 200U, 210U, 268U, 289U, 442U}) {
    const Verdict verdict = judged_sound(k);
    EXPECT_FALSE(is_accused(verdict)) << k << ": " << verdict.words;
  }
}

// Nobody knows from which side the joints came to it: it contradicts the others, and tells nothing.
TEST(SoundSets, of_poses_with_backlash_are_not_accused_by_their_first) {
  const Verdict verdict = judged_sound(263);
  EXPECT_FALSE(is_accused(verdict)) << verdict.words;
}

// The model errs beyond the sweeps, of a base that leans, more than the sweeps show.
TEST(SoundSets, of_poses_that_err_more_than_sweeps_are_not_refused_for_their_outliers) {
  const Verdict verdict = judged_sound(301);
  EXPECT_GT(verdict.rejected, 0);
  EXPECT_FALSE(is_accused(verdict)) << verdict.words;
}

TEST(SoundSets, of_a_prismatic_joint_with_another_lead_are_not_accused_of_a_scale) {
  for (const std::size_t k : {68U, 173U}) {
    const Verdict verdict = judged_sound(k);
    EXPECT_FALSE(is_accused(verdict)) << k << ": " << verdict.words;
  }
}

other::Traits unsound_traits(std::size_t kind, std::size_t round) {
  other::Draw draw(1000 * round + kind);
  other::Traits traits = other::drawn_traits(draw, kind);
  constexpr std::array<std::size_t, 4> kDrawingsOfSix{0, 1, 2, 4};
  traits.drawing = kDrawingsOfSix[(kind + round) % 4];
  const bool swept = (kind + round) % 3 == 0;
  traits.rows = swept ? other::Rows::kSweepsAndPoses : other::Rows::kPoses;
  traits.seen = other::Seen::kPositions;
  traits.poses = swept ? 60 : 120;
  traits.gains = false;
  traits.coupled = false;
  return traits;
}

struct Judged {
  Verdict verdict;
  bool named = false;
};

Judged judged_unsound(std::size_t kind, std::size_t round) {
  const other::Unsound one = other::unsound()[kind];
  other::Measurement set(1000 * round + kind, unsound_traits(kind, round));
  const Verdict verdict = judge(set, &one.wrong);
  const bool named = says(verdict, one.says);
  print(kind, one.name + ", " + set.machine().name + (named ? " | NAMED" : " | -"), set, verdict);
  EXPECT_LE(verdict.ratio(), 1.5) << one.name << ": " << verdict.words;
  if (one.of_arm) {
    EXPECT_FALSE(says(verdict, {"of one scale", "warning: all lengths seen", "m.csv: all lengths"}))
        << one.name << verdict.words;
  }
  return {verdict, named};
}

std::size_t kind_of(const std::string& name) {
  const std::vector<other::Unsound> all = other::unsound();
  return static_cast<std::size_t>(std::ranges::find(all, name, &other::Unsound::name) -
                                  all.begin());
}

TEST(UnsoundSets, of_other_machines_are_named_and_never_pass_with_a_wrong_figure) {
  const std::size_t rounds = asked("ARMSIG_UNSOUND", 0);
  const std::size_t kinds = other::unsound().size();
  EXPECT_GE(kinds, 40U);
  std::size_t named = 0;
  std::size_t tried = 0;
  for (std::size_t round = 0; round < std::max<std::size_t>(1, rounds); ++round) {
    for (std::size_t kind = 0; kind < kinds; ++kind) {
      if (rounds == 0 && kind % 4 != 1) continue;
      ++tried;
      named += judged_unsound(kind, round).named ? 1U : 0U;
    }
  }
  fmt::print("{} of {} unsound sets are named\n", named, tried);
  EXPECT_GE(10 * named, 9 * tried);
}

// Poses that would be rejected weigh little: the change that they show is named all the same.
TEST(UnsoundSets, whose_poses_are_rejected_name_the_change) {
  for (const char* name : {"target reseated 5 mm", "z 3000 ppm long"}) {
    const Judged judged = judged_unsound(kind_of(name), 0);
    EXPECT_EQ(judged.verdict.status, 1);
    EXPECT_TRUE(judged.named) << judged.verdict.words;
  }
}

}  // namespace
}  // namespace armsig::mistakes
