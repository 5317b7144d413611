// SPDX-License-Identifier: MIT
// No mistake passes with exit status 0 and a figure that is not so; no sound arm is refused.
//
// Quick by default. ARMSIG_MISTAKES=all takes every mistake on every arm by every method,
// ARMSIG_SOUND=500 so many sound arms; each prints what it saw.
#include "host_tests/mistakes/mistakes.hpp"

#include <cstdlib>

#include <Eigen/SVD>
#include <nlohmann/json.hpp>

namespace armsig::mistakes {
namespace {

using cli::Folder;
using cli::Outcome;

constexpr std::array<const char*, 3> kMethods{"paper", "encoder", "refined"};

struct Case {
  std::string name;
  std::string drawing;  // the description
  std::string made;     // options of `simulate` that make the individual
};

std::vector<Case> cases() {
  std::vector<Case> all{{"Puma 560", cli::kPuma560, "--tolerances 1"}};
  const std::filesystem::path arms = std::string(ARMSIG_SHARED_DATA) + "/arms";
  if (!std::filesystem::exists(arms)) return all;
  const auto drawing = [&](const char* file) { return cli::read_file(arms / file); };
  all.push_back({"UR10e", drawing("ur10e.yaml"),
                 "--truth '" + (arms / "ur10e-individual-a.yaml").string() + "'"});
  all.push_back({"Cobra 600", drawing("cobra600.yaml"), "--tolerances 1"});
  all.push_back({"Stanford", drawing("stanford.yaml"), "--tolerances 1"});
  all.push_back({"iiwa 7", drawing("iiwa7.yaml"), "--tolerances 1"});
  return all;
}

std::size_t asked(const char* variable, std::size_t otherwise) {
  const char* value = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? otherwise : std::strtoul(value, nullptr, 10);
}
bool asked_for_all() {
  return std::getenv("ARMSIG_MISTAKES") != nullptr;  // NOLINT(concurrency-mt-unsafe)
}

// RMS distance of two point sets, the first moved rigidly onto the second: where base and sensor
// frame are is the user's choice.
double aligned_rms(const std::vector<Vector3>& points, const std::vector<Vector3>& onto) {
  const auto n = static_cast<double>(points.size());
  Vector3 mean_p = Vector3::Zero();
  Vector3 mean_o = Vector3::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    mean_p += points[k] / n;
    mean_o += onto[k] / n;
  }
  Matrix3 H = Matrix3::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) {
    H += (points[k] - mean_p) * (onto[k] - mean_o).transpose();
  }
  const Eigen::JacobiSVD<Matrix3> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sense = (svd.matrixV() * svd.matrixU().transpose()).determinant() < 0 ? -1 : 1;
  const Matrix3 R = svd.matrixV() * Vector3(1, 1, sense).asDiagonal() * svd.matrixU().transpose();
  double squares = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    squares += (R * (points[k] - mean_p) - (onto[k] - mean_o)).squaredNorm();
  }
  return std::sqrt(squares / n);
}

struct Answer {
  Outcome outcome;
  double predicted_m = 0;  // what the command says of itself
  double error_m = 0;      // what it really is, over poses held out
};

class Bench {
 public:
  Bench(const Folder& folder, const Case& arm, const std::string& sensor = "--sigma-mm 0.1",
        const std::string& seed = "7", std::size_t poses = 40)
      : folder_(folder) {
    cli::write_file(folder_ / "drawing.yaml", arm.drawing);
    const auto simulate = [&](const std::string& options) {
      const Outcome outcome =
          cli::run_tool(folder_, "simulate --arm drawing.yaml --arc 120 --points 20 " + options);
      EXPECT_EQ(outcome.status, 0) << outcome.err;
    };
    simulate(fmt::format("{} --free-poses {} --out good.csv --truth-out truth.yaml --seed {} {}",
                         sensor, poses, seed, arm.made));
    simulate("--sigma-mm 0.0001 --free-poses 40 --out held.csv --truth truth.yaml --seed 99");
    sound_ = read_set(folder_ / "drawing.yaml", folder_ / "good.csv");
    held_ = read_set(folder_ / "drawing.yaml", folder_ / "held.csv");
    std::erase_if(held_.rows, [](const Row& row) { return row.sweep != 0; });
  }

  void drop_sweeps() {
    std::erase_if(sound_.rows, [](const Row& row) { return row.sweep != 0; });
  }

  Answer answer(const Mistake& mistake, const std::string& method) {
    Set set = sound_;
    mistake.make(set);
    write_set(set, folder_ / "arm.yaml", folder_ / "m.csv");
    std::filesystem::remove(folder_ / "s.yaml");
    Answer answer{
        .outcome = cli::run_tool(folder_,
                                 "identify --arm arm.yaml --measurements m.csv --out s.yaml --json "
                                 "--method " +
                                     method)};
    if (answer.outcome.status != 0) return answer;
    const auto json = nlohmann::json::parse(answer.outcome.out);
    answer.predicted_m = json.value("predicted_tool_error_m", 0.0);
    Set held = held_;
    if (mistake.lasts) mistake.make(held);
    cli::write_file(folder_ / "q.csv", poses_text(held));
    const Outcome predicted = cli::run_tool(
        folder_, fmt::format("predict --signature s.yaml --joints q.csv --out p.csv --target {}",
                             set.rows.back().target));
    EXPECT_EQ(predicted.status, 0) << predicted.err;
    const cli::Csv points = cli::Csv::read(folder_ / "p.csv");
    std::vector<Vector3> put;
    std::vector<Vector3> true_m;
    for (std::size_t k = 0; k < points.rows.size(); ++k) {
      put.emplace_back(points.number(k, "x_m"), points.number(k, "y_m"), points.number(k, "z_m"));
      const Row& row = held_.rows[k];
      true_m.emplace_back(1e-3 * Vector3(row.p[0], row.p[1], row.p[2]));
    }
    answer.error_m = aligned_rms(put, true_m);
    return answer;
  }

 private:
  const Folder& folder_;
  Set sound_;
  Set held_;
};

Mistake none() {
  return {"no mistake", [](Set&) {}};
}

// Status 0 is right where the figure is: within 1.5 times what is predicted, or what the same arm
// measured without the mistake is given (one arm may be unlucky).
bool is_wrong(const Answer& answer, const Answer& sound) {
  if (answer.outcome.status != 0) return false;
  return answer.error_m > 1.5 * answer.predicted_m && answer.error_m > 1.5 * sound.error_m;
}

// Every `stride`-th mistake from `first` on; by every method, or by one in turn.
void run_mistakes(const Case& arm, bool every_method, std::size_t first = 0,
                  std::size_t stride = 1) {
  const Folder folder;
  Bench bench(folder, arm);
  std::array<Answer, 3> sound;
  for (std::size_t m = 0; m < kMethods.size(); ++m) {
    sound[m] = bench.answer(none(), kMethods[m]);
    EXPECT_EQ(sound[m].outcome.status, 0) << arm.name << kMethods[m] << sound[m].outcome.err;
  }
  const std::vector<Mistake> all = all_mistakes();
  std::size_t named = 0;
  std::size_t refused = 0;
  for (std::size_t k = first; k < all.size(); k += stride) {
    for (std::size_t m = 0; m < kMethods.size(); ++m) {
      if (!every_method && m != (k / stride) % kMethods.size()) continue;
      const Answer answer = bench.answer(all[k], kMethods[m]);
      const std::string what = arm.name + ", " + all[k].name + ", " + kMethods[m];
      EXPECT_TRUE(answer.outcome.status == 0 || answer.outcome.status == 1) << what;
      EXPECT_FALSE(is_wrong(answer, sound[m]))
          << what << ": predicted " << answer.predicted_m << ", true " << answer.error_m;
      if (answer.outcome.status == 1) ++refused;
      const bool says = answer.outcome.err.find(all[k].says) != std::string::npos;
      if (answer.outcome.status == 1 && !all[k].says.empty() && says) ++named;
      if (arm.name == "Puma 560" && !all[k].says.empty()) {
        EXPECT_TRUE(says) << what << ": " << answer.outcome.err;
      }
      if (asked_for_all()) {
        fmt::print("{}: status {}, predicted {:.3f} mm, true {:.3f} mm {}", what,
                   answer.outcome.status, 1e3 * answer.predicted_m, 1e3 * answer.error_m,
                   answer.outcome.err.empty() ? "\n" : answer.outcome.err);
      }
    }
  }
  fmt::print("{}: {} mistakes, {} refused, {} named as expected\n", arm.name, all.size(), refused,
             named);
}

TEST(Mistakes, are_at_least_forty) { EXPECT_GE(all_mistakes().size(), 40U); }

TEST(Mistakes, of_a_puma_never_pass_with_a_wrong_figure) {
  run_mistakes(cases()[0], asked_for_all());
}

TEST(Mistakes, of_other_arms_never_pass_with_a_wrong_figure) {
  const std::vector<Case> all = cases();
  for (std::size_t k = 1; k < all.size(); ++k) {
    if (asked_for_all()) {
      run_mistakes(all[k], true);
    } else {
      run_mistakes(all[k], false, k, 6);
    }
  }
}

// Poses alone, as a laser tracker gives them: by refinement only.
TEST(Mistakes, in_poses_without_sweeps_never_pass_with_a_wrong_figure) {
  const Folder folder;
  Bench bench(folder, cases()[0], "--sigma-mm 0.1", "7", 80);
  bench.drop_sweeps();
  const Answer sound = bench.answer(none(), "refined");
  ASSERT_EQ(sound.outcome.status, 0) << sound.outcome.err;
  const std::vector<Mistake> all = all_mistakes();
  for (std::size_t k = 0; k < all.size(); ++k) {
    const bool coupling = all[k].name == "a coupling is missing";
    if (!asked_for_all() && !coupling && k % 6 != 0) continue;
    const Answer answer = bench.answer(all[k], "refined");
    EXPECT_FALSE(is_wrong(answer, sound)) << all[k].name << ": predicted " << answer.predicted_m
                                          << ", true " << answer.error_m << answer.outcome.err;
    if (asked_for_all()) {
      fmt::print("poses, {}: status {}, predicted {:.3f} mm, true {:.3f} mm {}\n", all[k].name,
                 answer.outcome.status, 1e3 * answer.predicted_m, 1e3 * answer.error_m,
                 answer.outcome.err);
    }
    if (!coupling) continue;
    EXPECT_EQ(answer.outcome.status, 1);
    EXPECT_NE(answer.outcome.err.find("joint 2 seems to follow joint 1"), std::string::npos)
        << answer.outcome.err;
  }
}

// What everybody gets wrong, on every arm.
TEST(Mistakes, in_units_and_places_never_pass_on_any_arm) {
  const std::vector<Case> all = cases();
  std::size_t method = 0;
  for (std::size_t k = 1; k < all.size(); ++k) {
    const Folder folder;
    Bench bench(folder, all[k]);
    for (const Mistake& mistake : all_mistakes()) {
      if (mistake.name != "positions in metres" && mistake.name != "tracker moved between sweeps" &&
          mistake.name != "modified rows" && mistake.name != "x mirrored") {
        continue;
      }
      const char* by = kMethods[method++ % kMethods.size()];
      const Answer sound = bench.answer(none(), by);
      const Answer answer = bench.answer(mistake, by);
      EXPECT_FALSE(is_wrong(answer, sound)) << all[k].name << ", " << mistake.name << ", " << by;
    }
  }
}

TEST(DifferentArm, is_written_where_it_is_accepted_or_allowed) {
  const Folder folder;
  Bench bench(folder, cases()[0]);
  const Mistake mistyped{"a length mistyped", [](Set& set) { set.joints()[1].a_m += 0.09; }};
  const Answer refused = bench.answer(mistyped, "encoder");
  ASSERT_EQ(refused.outcome.status, 1);
  EXPECT_NE(refused.outcome.err.find("not the arm of the nominal model"), std::string::npos)
      << refused.outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "s.yaml"));
  const std::string identify = "identify --arm arm.yaml --measurements m.csv --out s.yaml";
  const Outcome accepted = cli::run_tool(folder, identify + " --accept-different-arm");
  EXPECT_EQ(accepted.status, 0) << accepted.err;
  EXPECT_NE(cli::read_file(folder / "s.yaml").find("accepted as a different arm"),
            std::string::npos);
  cli::write_file(folder / "arm.yaml", cli::read_file(folder / "arm.yaml") +
                                           "deviations: {shift_mm: 200, tilt_deg: 10}\n");
  const Outcome allowed = cli::run_tool(folder, identify);
  EXPECT_EQ(allowed.status, 0) << allowed.err;
}

TEST(SoundArms, are_never_refused) {
  const std::vector<Case> all = cases();
  const std::size_t count = asked("ARMSIG_SOUND", 15);
  constexpr std::array<double, 5> kSensors_mm{0.01, 0.03, 0.1, 0.3, 1};
  std::size_t refused = 0;
  for (std::size_t k = 0; k < count; ++k) {
    Case arm = all[k % all.size()];
    // Tolerances from none to twice the usual.
    if (k >= all.size()) arm.made = fmt::format("--tolerances {:.2f}", 2.0 * double(k % 11) / 10);
    const Folder folder;
    Bench bench(folder, arm, fmt::format("--sigma-mm {}", kSensors_mm[(k / 5) % 5]),
                std::to_string(1000 + k));
    const char* by = kMethods[k % kMethods.size()];
    const Answer answer = bench.answer(none(), by);
    if (answer.outcome.status != 0) ++refused;
    EXPECT_EQ(answer.outcome.status, 0) << arm.name << " " << arm.made << ", arm " << k << " by "
                                        << by << ": " << answer.outcome.err;
  }
  fmt::print("{} sound arms, {} refused\n", count, refused);
}

}  // namespace
}  // namespace armsig::mistakes
