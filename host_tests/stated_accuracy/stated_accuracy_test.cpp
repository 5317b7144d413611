// SPDX-License-Identifier: MIT
// A stated accuracy is the accuracy, by the command: over arms that sag, whose readings are wrong
// many times a turn, that have play, seen by sensors whose noise is not normal, with the sigma of
// the sensor stated rightly, wrongly by three either way, and not at all.
//
// A sample by default; ARMSIG_STATED=200 takes so many arms. Prints a table.
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

#include "firmware/formats/arm_file.hpp"
#include "host_tests/cli/files.hpp"
#include "host_tests/support/calibration_case.hpp"

namespace armsig {
namespace {

using cli::Folder;
using test::Cell;
using test::Random;

constexpr int kPoses = 120;
constexpr int kJudged = 100;

struct Row {
  JointVector q;
  Vector3 p_S = Vector3::Zero();
};

// One arm that is not as the model says, in front of a sensor.
class HonestArm {
 public:
  explicit HonestArm(std::uint64_t seed) : random_(seed), cell_(test::puma_cell(random_)) {
    sigma_m_ = std::pow(10, random_.uniform(-5, -3.7));
    misbehaviour_ = {.wave_rad = radians(random_.uniform(0, 0.02)),
                     .sag_rad_m = random_.uniform(0, 1e-3),
                     .phase = random_.uniform(0, 6)};
    play_rad_ = radians(random_.uniform(0, 0.005));
  }

  std::vector<Row> measure(int poses) {
    std::vector<Row> rows;
    for (int k = 0; k < poses; ++k) {
      Row row{.q = random_.configuration(cell_.arm)};
      JointVector within = row.q;  // the play, by whichever side the joint came from
      for (double& q : within) q += random_.uniform(0, 1) < 0.5 ? -play_rad_ : play_rad_;
      // One row in ten is three times as noisy.
      const double sigma = random_.uniform(0, 1) < 0.1 ? 3 * sigma_m_ : sigma_m_;
      row.p_S =
          test::misbehaving_point(cell_, within, misbehaviour_) + random_.normal_vector(sigma);
      rows.push_back(row);
    }
    return rows;
  }
  [[nodiscard]] double sigma_m() const { return sigma_m_; }

 private:
  Random random_;
  Cell cell_;
  double sigma_m_ = 0;
  double play_rad_ = 0;
  test::Misbehaviour misbehaviour_;
};

std::string readings_of(const Row& row) {
  std::string text;
  for (const double q : row.q) text += fmt::format("{}{:.9f}", text.empty() ? "" : ",", degrees(q));
  return text;
}

constexpr const char* kReadings = "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg";

void write_rows(const std::vector<Row>& rows, const std::filesystem::path& path,
                std::optional<double> sigma_m) {
  std::string text =
      fmt::format("sweep,target,{},x_mm,y_mm,z_mm{}\n", kReadings, sigma_m ? ",sigma_mm" : "");
  for (const Row& row : rows) {
    text += fmt::format("0,1,{},{:.9f},{:.9f},{:.9f}", readings_of(row), 1e3 * row.p_S.x(),
                        1e3 * row.p_S.y(), 1e3 * row.p_S.z());
    text += sigma_m ? fmt::format(",{:.6f}\n", 1e3 * *sigma_m) : "\n";
  }
  cli::write_file(path, text);
}

struct Judgement {
  double ratio = 0;   // observed over stated, root mean square, of rows never seen
  double inside = 0;  // share of them in the region of 95 %
};

// The arm in `folder` identified with `sigma_m` stated, and judged by `others`.
std::optional<Judgement> judge(const Folder& folder, const std::vector<Row>& rows,
                               std::optional<double> sigma_m, const std::vector<Row>& others) {
  write_rows(rows, folder / "m.csv", sigma_m);
  const cli::Outcome identified = cli::run_tool(
      folder, "identify --arm arm.yaml --measurements m.csv --method refined --out s.yaml --json");
  EXPECT_EQ(identified.status, 0) << identified.err;
  if (identified.status != 0) return std::nullopt;
  const auto score = nlohmann::json::parse(identified.out)["cross_validation"];
  std::string poses = std::string(kReadings) + "\n";
  for (const Row& row : others) poses += readings_of(row) + "\n";
  cli::write_file(folder / "q.csv", poses);
  const cli::Outcome predicted =
      cli::run_tool(folder, "predict --signature s.yaml --joints q.csv --target 1 --out p.csv");
  EXPECT_EQ(predicted.status, 0) << predicted.err;
  if (predicted.status != 0) return std::nullopt;
  const cli::Csv points = cli::Csv::read(folder / "p.csv");
  const double stated_m = score["stated_rms_m"];
  // The covariance of a row before it is enlarged, taken as the same in all directions.
  const double plain_m = stated_m / score["enlarged_by"].get<double>() / std::sqrt(3.0);
  const double region_squares = score["region_squares"];
  Judgement judgement;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const Vector3 p(points.number(k, "x_m"), points.number(k, "y_m"), points.number(k, "z_m"));
    const double squares = (p - others[k].p_S).squaredNorm();
    judgement.ratio += squares / (kJudged * stated_m * stated_m);
    judgement.inside += squares <= region_squares * plain_m * plain_m ? 1.0 / kJudged : 0;
  }
  judgement.ratio = std::sqrt(judgement.ratio);
  return judgement;
}

std::size_t arms_asked_for() {
  const char* value = std::getenv("ARMSIG_STATED");  // NOLINT(concurrency-mt-unsafe): one thread
  return value == nullptr ? 6 : std::strtoul(value, nullptr, 10);
}

TEST(StatedAccuracy, is_the_accuracy_whatever_sigma_is_stated) {
  struct Statement {
    const char* name;
    double factor;  // 0: not stated
  };
  constexpr std::array<Statement, 4> kStatements{{{"rightly", 1},
                                                  {"three times too large", 3},
                                                  {"three times too small", 1.0 / 3},
                                                  {"not", 0}}};
  const std::size_t arms = arms_asked_for();
  const Folder folder;
  tool::ArmDescription drawing;
  drawing.arm = test::puma();
  drawing.name = "Puma 560";
  cli::write_file(folder / "arm.yaml", tool::arm_text(drawing));
  fmt::print("| sigma stated | arms | observed over stated | least | most | inside 95 % |\n");
  fmt::print("|---|--:|--:|--:|--:|--:|\n");
  for (const Statement& statement : kStatements) {
    double squares = 0;
    double inside = 0;
    double least = 1e9;
    double most = 0;
    for (std::size_t k = 0; k < arms; ++k) {
      HonestArm arm(1000 + k);
      const std::vector<Row> rows = arm.measure(kPoses);
      const std::vector<Row> others = arm.measure(kJudged);
      const auto sigma_m =
          statement.factor > 0 ? std::optional(statement.factor * arm.sigma_m()) : std::nullopt;
      const auto judgement = judge(folder, rows, sigma_m, others);
      if (!judgement) continue;
      squares += judgement->ratio * judgement->ratio / static_cast<double>(arms);
      inside += judgement->inside / static_cast<double>(arms);
      least = std::min(least, judgement->ratio);
      most = std::max(most, judgement->ratio);
    }
    const double ratio = std::sqrt(squares);
    fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.1f} % |\n", statement.name, arms, ratio,
               least, most, 100 * inside);
    EXPECT_GT(ratio, 0.8) << statement.name;
    EXPECT_LT(ratio, 1.25) << statement.name;
    EXPECT_GT(inside, 0.90) << statement.name;
    EXPECT_LT(inside, 0.98) << statement.name;
  }
}

}  // namespace
}  // namespace armsig
