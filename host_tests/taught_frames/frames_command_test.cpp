// SPDX-License-Identifier: MIT
// armsig frames as a person meets it: a simulated arm, identified, that taught a tool and a table.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/calibration/chain.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/host_tool/taught_frames/taught_frames.hpp"
#include "firmware/library/compensation.hpp"
#include "firmware/library/estimate.hpp"
#include "host_tests/cli/run_tool.hpp"
#include "host_tests/taught_frames/taught_session.hpp"

namespace armsig::cli {
namespace {

using nlohmann::json;
using taught::TrueFrames;
using tool::SignatureRecord;

constexpr double kTeach_m = 0.05e-3;
constexpr const char* kFrames = "frames --signature s.yaml --points taught.csv ";

// Where the session is taught.
JointVector seed_readings() {
  JointVector q;
  for (const double reading : {20.0, -80.0, 90.0, -70.0, -80.0, 15.0})
    q.push_back(radians(reading));
  return q;
}

SignatureRecord record_of(const Folder& folder, const std::string& file) {
  auto record = tool::read_signature_file((folder / file).string());
  EXPECT_TRUE(record);
  return *std::move(record);
}

// The readings at which the arm of `truth` has the poses of a session, as a table.
std::string table_of(const SignatureRecord& truth, const taught::TaughtSession& session) {
  const tool::Compensation models(truth, truth.nominal);
  std::string text = "frame,point,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n";
  const auto task = session.task();
  for (std::size_t k = 0; k < task.rows.size(); ++k) {
    const auto found = models.real().inverse(session.poses()[k], seed_readings());
    EXPECT_TRUE(found && tool::is_solved(found->verdict)) << "row " << k;
    text += fmt::format("{},{}", task.rows[k].frame, task.rows[k].point->name);
    for (const double reading : found->readings) text += fmt::format(",{:.6f}", degrees(reading));
    text += '\n';
  }
  return text;
}

// A tool and a table near where the arm stands at the seed.
TrueFrames frames_at(const SignatureRecord& truth) {
  const tool::Compensation models(truth, truth.nominal);
  const Pose X_CE = *models.real().forward(seed_readings());
  TrueFrames of;
  of.tip_C = X_CE * of.X_ET.p;
  of.X_CW = {taught::by_abc(30, 5, -3), of.tip_C + Vector3(0.02, -0.1, -0.03)};
  of.R0_CE = X_CE.R;
  return of;
}

// Simulates and identifies an arm, which then teaches; returns what is true of its frames.
TrueFrames taught_by(const Folder& folder, unsigned seed, const std::string& further = "") {
  const Outcome simulated = run_tool(
      folder, fmt::format("simulate --arm ur10e --tolerances 1 --sigma-mm 0.1 --free-poses 60 "
                          "--flange-target-mm 80,30,120 --seed {} --out m.csv --truth-out "
                          "truth.yaml {}",
                          seed, further));
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  const Outcome identified =
      run_tool(folder, "identify --arm ur10e --measurements m.csv --out s.yaml");
  EXPECT_EQ(identified.status, 0) << identified.err;
  const SignatureRecord truth = record_of(folder, "truth.yaml");
  const TrueFrames of = frames_at(truth);
  std::mt19937 random(seed);
  write_file(folder / "taught.csv", table_of(truth, taught::session_of(of, [&] {
                                               return taught::any_vector(random, kTeach_m);
                                             })));
  return of;
}

json frames_of(const Folder& folder, const std::string& options = "") {
  const Outcome run = run_tool(folder, kFrames + options + " --json");
  EXPECT_EQ(run.status, 0) << run.err;
  return json::parse(run.out);
}

Vector3 vector_of(const json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

Pose pose_of(const json& frame) {
  const auto& q = frame["q_wxyz"];
  return {Eigen::Quaterniond(q[0].get<double>(), q[1].get<double>(), q[2].get<double>(),
                             q[3].get<double>())
              .toRotationMatrix(),
          vector_of(frame["p_m"])};
}

// Sums over frames and arms.
struct Accuracy {
  double squares_m2 = 0;
  double nominal_m2 = 0;
  double stated_m2 = 0;
  double turn_rad2 = 0;
  double nominal_rad2 = 0;
  double stated_rad2 = 0;

  void add(const json& frame, const Pose& truth) {
    const Pose found = pose_of(frame["found"]);
    const Pose nominal = pose_of(frame["nominal"]);
    squares_m2 += (found.p - truth.p).squaredNorm();
    nominal_m2 += (nominal.p - truth.p).squaredNorm();
    stated_m2 += vector_of(frame["sigma_m"]).squaredNorm();
    turn_rad2 += std::pow(angle_between(found.R, truth.R), 2);
    nominal_rad2 += std::pow(angle_between(nominal.R, truth.R), 2);
    stated_rad2 += vector_of(frame["sigma_rad"]).squaredNorm();
  }
};

void expect_as_stated(const Accuracy& tool, const Accuracy& table) {
  for (const Accuracy* of : {&tool, &table}) {
    const double ratio = std::sqrt(of->squares_m2 / of->stated_m2);
    const double turn_ratio = std::sqrt(of->turn_rad2 / of->stated_rad2);
    const std::string name = of == &tool ? "tool_" : "table_";
    testing::Test::RecordProperty(name + "observed_over_stated", std::to_string(ratio));
    testing::Test::RecordProperty(name + "turn_observed_over_stated", std::to_string(turn_ratio));
    testing::Test::RecordProperty(name + "nominal_over_found",
                                  std::to_string(std::sqrt(of->nominal_m2 / of->squares_m2)));
    EXPECT_GT(ratio, 0.7);
    EXPECT_LT(ratio, 1.3);
    EXPECT_GT(turn_ratio, 0.7);
    EXPECT_LT(turn_ratio, 1.3);
    EXPECT_GT(of->nominal_m2, 100 * of->squares_m2);
    EXPECT_GT(of->nominal_rad2, 64 * of->turn_rad2);
  }
}

constexpr unsigned kArms = 20;

TEST(FramesCommand, is_as_accurate_as_stated_and_ten_times_the_nominal_model) {
  const Folder folder;
  Accuracy tool;
  Accuracy table;
  for (unsigned seed = 1; seed <= kArms; ++seed) {
    const TrueFrames of = taught_by(folder, seed);
    const json result = frames_of(folder);
    tool.add(result["frames"][0], of.X_ET);
    table.add(result["frames"][1], of.X_CW);
  }
  expect_as_stated(tool, table);
}

TEST(FramesCommand, knows_gravity_and_joint_error_maps) {
  const Folder folder;
  Accuracy tool;
  Accuracy table;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const TrueFrames of = taught_by(folder, seed, "--maps-deg 0.03 --deflection-mm 2");
    const json result = frames_of(folder);
    tool.add(result["frames"][0], of.X_ET);
    table.add(result["frames"][1], of.X_CW);
  }
  for (const Accuracy& of : {tool, table}) {
    const double ratio = std::sqrt(of.squares_m2 / of.stated_m2);
    EXPECT_GT(ratio, 0.5);
    EXPECT_LT(ratio, 1.5);
    EXPECT_GT(of.nominal_m2, 25 * of.squares_m2);
  }
}

// Arms drawn from the covariance of one signature, which teach without noise.
class DrawnArms {
 public:
  explicit DrawnArms(const Folder& folder)
      : record_(record_of(folder, "s.yaml")),
        estimate_(*tool::estimate_of(record_, "s.yaml")),
        controller_{.nominal = record_.nominal, .X_0C = {}, .X_nE = {}} {
    auto table =
        tool::read_taught_points((folder / "taught.csv").string(), "", record_.signature.types);
    for (const auto& row : table->rows) readings_.push_back(row.q);
    task_ = *tool::taught_task(std::move(table->rows), "taught.csv");
    task_.tip.frame = 0;
  }

  // From now on the work object was touched by the first target of the signature.
  void touch_by_target() {
    task_.tip.frame.reset();
    target_ = 0;
  }

  // The mean of e^T C^-1 e / 6 of frame `f` over arms.
  [[nodiscard]] double normalized_error(std::size_t f) {
    constexpr int kTrials = 400;
    const auto derivatives = tool::pose_derivatives(*estimate_, controller_, readings_, target_);
    const tool::SolvedFrame found = frame_by(estimate_->signature, f);
    const Eigen::MatrixXd covariance =
        derivatives.covariance_of(found.by_rows, target_ ? found.by_tip : ByTip(ByTip::Zero()));
    const Eigen::MatrixXd half = derivatives.covariance.llt().matrixL();
    std::mt19937 random(9);
    std::normal_distribution<double> normal;
    double sum = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      const Eigen::VectorXd step =
          half * Eigen::VectorXd::NullaryExpr(half.rows(), [&] { return normal(random); });
      const Pose X = frame_by(moved(step), f).X;
      Eigen::Vector<double, 6> e;
      e << X.p - found.X.p, rotation_vector(found.X.R.transpose() * X.R);
      sum += e.dot(covariance.ldlt().solve(e)) / 6 / kTrials;
    }
    return sum;
  }

 private:
  using ByTip = Eigen::Matrix<double, 6, 3>;

  [[nodiscard]] Signature moved(const Eigen::VectorXd& step) const {
    calibration::StateVector x{};
    for (Eigen::Index k = 0; k < step.size(); ++k) x.at(static_cast<std::size_t>(k)) = step[k];
    Signature signature = estimate_->signature;
    calibration::ReadingModel readings = estimate_->readings;
    calibration::apply_corrections(estimate_->layout, x, 1.0, signature, readings);
    return signature;
  }

  [[nodiscard]] tool::SolvedFrame frame_by(const Signature& signature, std::size_t f) {
    const tool::FoundFlange flange(signature, estimate_->readings, controller_);
    if (target_) task_.tip.t_E = flange.target_E(signature.targets[*target_]);
    std::vector<Pose> poses;
    for (const JointVector& q : readings_) poses.push_back(flange.pose(q));
    return (*tool::solved_frames(task_, poses))[f];
  }

  SignatureRecord record_;
  std::unique_ptr<calibration::Refined> estimate_;
  tool::ControllerFrames controller_;
  std::vector<JointVector> readings_;
  tool::TaughtTask task_;
  std::optional<std::size_t> target_;
};

TEST(FramesCommand, states_what_the_covariance_of_the_signature_makes_of_a_frame) {
  const Folder folder;
  (void)taught_by(folder, 3);
  DrawnArms arms(folder);
  EXPECT_NEAR(arms.normalized_error(0), 1, 0.12);
  EXPECT_NEAR(arms.normalized_error(1), 1, 0.12);
  arms.touch_by_target();
  EXPECT_NEAR(arms.normalized_error(1), 1, 0.12);
}

TEST(FramesCommand, has_the_arm_where_compensate_has_it) {
  const Folder folder;
  (void)taught_by(folder, 4, "--maps-deg 0.03 --deflection-mm 2");
  const SignatureRecord record = record_of(folder, "s.yaml");
  const tool::Compensation models(record, record.nominal);
  const tool::FoundFlange flange(record.signature, record.readings(),
                                 {.nominal = record.nominal, .X_0C = {}, .X_nE = {}});
  const Pose X = flange.pose(seed_readings());
  const auto X_CE = models.real().forward(seed_readings());
  ASSERT_TRUE(X_CE);
  EXPECT_LT((X.p - X_CE->p).norm(), 1e-9);
  EXPECT_LT(angle_between(X.R, X_CE->R), 1e-9);
}

// With the frames entered and used alike, the real tool is where the program has it.
TEST(FramesCommand, gives_frames_by_which_a_corrected_program_arrives) {
  const Folder folder;
  const TrueFrames of = taught_by(folder, 5);
  const json frames = frames_of(folder)["frames"];
  const Pose tool = pose_of(frames[0]["found"]);
  const Pose table = pose_of(frames[1]["found"]);
  const Vector3 p_W(0.1, 0.08, 0);
  write_file(folder / "p.csv",
             fmt::format("x_m,y_m,z_m,qw,qx,qy,qz\n{},{},{},0,1,0,0\n", p_W.x(), p_W.y(), p_W.z()));
  const auto quaternion = [](const Pose& X) {
    const Eigen::Quaterniond q(X.R);
    return fmt::format("{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}", 1e3 * X.p.x(),
                       1e3 * X.p.y(), 1e3 * X.p.z(), q.w(), q.x(), q.y(), q.z());
  };
  write_file(folder / "seed.csv",
             "q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n20,-80,90,-70,-80,15\n");
  const Outcome corrected = run_tool(
      folder, fmt::format("compensate --signature s.yaml --poses p.csv --seed seed.csv --tool={} "
                          "--frame={} --out c.csv --json",
                          quaternion(tool), quaternion(table)));
  ASSERT_EQ(corrected.status, 0) << corrected.err;
  const auto readings = json::parse(corrected.out)["targets"][0]["readings"];
  JointVector q;
  for (const double reading : readings) q.push_back(reading);
  const SignatureRecord truth = record_of(folder, "truth.yaml");
  const auto X_CE = tool::Compensation(truth, truth.nominal).real().forward(q);
  ASSERT_TRUE(X_CE);
  // The true tip over the true table.
  EXPECT_LT((*X_CE * of.X_ET.p - of.X_CW * p_W).norm(), 0.25e-3);
}

// --- What is said and what is refused ---------------------------------------------------------

bool says(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

// One identified arm for all of them.
class FramesWords : public testing::Test {
 protected:
  Folder folder_;
  TrueFrames of_ = taught_by(folder_, 1);

  void expect_refused(const std::string& options, int status, const std::string& words) {
    const Outcome run = run_tool(folder_, kFrames + options);
    EXPECT_EQ(run.status, status) << run.out;
    EXPECT_TRUE(says(run.err, words)) << run.err;
    EXPECT_TRUE(run.out.empty()) << run.out;
  }
  // The rows of taught.csv whose text has none of the words.
  void keep_without(std::initializer_list<const char*> words) {
    std::string kept;
    std::string line;
    for (const char c : read_file(folder_ / "taught.csv")) {
      line += c;
      if (c != '\n') continue;
      const bool named = std::ranges::any_of(words, [&](const char* w) { return says(line, w); });
      if (!named) kept += line;
      line.clear();
    }
    write_file(folder_ / "taught.csv", kept);
  }
};

TEST_F(FramesWords, are_those_of_both_models_with_their_uncertainty) {
  const Outcome run = run_tool(folder_, kFrames);
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* words :
       {"Tool torch: 4 points of one tip, 2 directions",
        "Work object table: 4 points, touched by tool torch", "found model", "nominal model",
        "1 sigma of x, y, z: 0.0", "teaching by the nominal model costs ", "miss one tip by 0.0",
        "to enter:\n  {X ", "A point was taught to 0.0", "7 degrees of freedom",
        "The uncertainty of the signature is part of every"}) {
    EXPECT_TRUE(says(run.out, words)) << words << "\n" << run.out;
  }
}

TEST_F(FramesWords, fit_a_terminal) {
  for (const char* language : {"krl", "rapid", "urscript", "fanuc", "jbi", "gcode"}) {
    const std::string shown =
        shown_on_terminal(folder_, std::string(kFrames) + "--language " + language, 80);
    std::size_t width = 0;
    for (const char c : shown) {
      if (c == '\n') {
        EXPECT_LE(width, 80U) << language << "\n" << shown;
        width = 0;
      } else if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) {
        ++width;
      }
    }
  }
}

TEST_F(FramesWords, have_the_orientation_of_the_controllers_language) {
  const json krl = frames_of(folder_);
  const std::string tool = krl["frames"][0]["found"]["entered"];
  EXPECT_TRUE(tool.starts_with("{X 1") && says(tool, ", A ")) << tool;
  const json ur = frames_of(folder_, "--language urscript");
  const std::string pose = ur["frames"][0]["found"]["entered"];
  EXPECT_TRUE(pose.starts_with("p[0.01")) << pose;
  const json rapid = frames_of(folder_, "--language rapid");
  const std::string quaternion = rapid["frames"][0]["found"]["entered"];
  EXPECT_TRUE(quaternion.starts_with("[[1") && says(quaternion, "],[")) << quaternion;
  const json fanuc = frames_of(folder_, "--language fanuc");
  EXPECT_TRUE(says(fanuc["frames"][0]["found"]["entered"], ", W ")) << fanuc;
  EXPECT_EQ(krl["frames"][0]["found"]["p_m"], rapid["frames"][0]["found"]["p_m"]);
}

TEST_F(FramesWords, are_of_the_same_frames_for_programs) {
  const json result = frames_of(folder_);
  EXPECT_EQ(result["schema"], "armsig-result/1");
  EXPECT_EQ(result["touched_by"], "tool torch");
  EXPECT_EQ(result["teach_sigma_from"], "residuals");
  EXPECT_EQ(result["frames"][1]["kind"], "work object");
  EXPECT_EQ(result["frames"][0]["points"].size(), 6U);
  EXPECT_GT(result["frames"][0]["nominal_missed_rms_m"],
            3 * result["frames"][0]["missed_rms_m"].get<double>());
  EXPECT_EQ(frames_of(folder_, "--teach-sigma-mm 0.5")["teach_sigma_from"], "stated");
}

TEST_F(FramesWords, take_the_tool_that_is_given) {
  keep_without({"torch"});
  expect_refused("", 2, "it does not say which tool touched the work objects; expected --tool");
  const Vector3 t_mm = 1e3 * of_.X_ET.p;
  const std::string tool = fmt::format("--tool={},{},{},0,0,0", t_mm.x(), t_mm.y(), t_mm.z());
  const json result = frames_of(folder_, tool);
  EXPECT_EQ(result["teach_sigma_from"], "assumed");
  EXPECT_LT((pose_of(result["frames"][0]["found"]).p - of_.X_CW.p).norm(), 0.3e-3);
  expect_refused("--tool torch", 2, "\"torch\" is no pose");
  expect_refused("--target 9", 2, "there is no target 9");
  EXPECT_EQ(frames_of(folder_, "--target 1")["touched_by"], "target 1");
}

TEST_F(FramesWords, ask_which_of_two_tools_touched_a_table) {
  std::string text = read_file(folder_ / "taught.csv");
  std::string other;
  for (std::size_t at = 0, end = 0; (end = text.find('\n', at)) != std::string::npos;
       at = end + 1) {
    const std::string line = text.substr(at, end - at + 1);
    if (line.starts_with("torch,tip")) other += "probe" + line.substr(5);
  }
  write_file(folder_ / "taught.csv", text + other);
  expect_refused("", 2, "expected --tool with torch or probe");
  expect_refused("--tool torhc", 2, "expected torch or probe, or x,y,z in mm");
  EXPECT_EQ(frames_of(folder_, "--tool probe")["touched_by"], "tool probe");
}

TEST_F(FramesWords, refuse_a_tool_for_no_work_object) {
  keep_without({"table"});
  EXPECT_EQ(frames_of(folder_)["frames"].size(), 1U);
  expect_refused("--tool torch", 2, "no work object is taught in it");
}

TEST_F(FramesWords, refuse_what_does_not_determine_a_frame) {
  keep_without({"torch,x-", "torch,z+"});
  const std::string all = read_file(folder_ / "taught.csv");
  EXPECT_TRUE(says(run_tool(folder_, kFrames).out, "no direction: it has the axes of the flange"));
  keep_without({"table,xy"});
  expect_refused("", 1, "work object \"table\": no point beside its axis x");
}

TEST_F(FramesWords, refuse_rows_by_their_line) {
  const std::string good = read_file(folder_ / "taught.csv");
  const std::string last = good.substr(good.rfind('\n', good.size() - 2) + 1);
  write_file(folder_ / "taught.csv", good + last);
  expect_refused("", 2, "taught.csv:12: \"table\": the readings are those of line 11");
  write_file(folder_ / "taught.csv", good + "table,tip,1,2,3,4,5,6\n");
  expect_refused("", 2, "taught.csv:12: \"table\": \"tip\" is a point of a tool");
  write_file(folder_ / "taught.csv", good + "table,corner,1,2,3,4,5,6\n");
  expect_refused("", 2, "unknown point \"corner\"; expected tip, x+");
  write_file(folder_ / "taught.csv", good + "table,x,1,2,3000,4,5,6\n");
  expect_refused("", 1, "taught.csv:12: joint 3 reads 3000.000°, its limits are ");
}

TEST_F(FramesWords, warn_of_readings_beyond_the_limits) {
  std::string text = read_file(folder_ / "taught.csv");
  write_file(folder_ / "taught.csv", text +
                                         "far,origin,1,2,3,4,5,6\nfar,x,1,20,3,4,5,370\n"
                                         "far,xy,40,2,3,4,5,6\n");
  const Outcome run = run_tool(folder_, kFrames);
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_TRUE(says(run.err, "1 row beyond the joint limits, farthest line 13: joint 6")) << run.err;
}

TEST_F(FramesWords, take_tables_of_other_software) {
  std::string text = read_file(folder_ / "taught.csv");
  std::ranges::replace(text, ',', ';');
  text.replace(0, text.find('\n'),
               "Frame;Point;A1 [deg];A2 [deg];A3 [deg];A4 [deg];A5 [deg];A6 "
               "[deg]");
  write_file(folder_ / "other.csv", "Teach pendant\n" + text);
  const Outcome run =
      run_tool(folder_, "frames --signature s.yaml --points other.csv --columns auto --json");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["frames"][0]["found"], frames_of(folder_)["frames"][0]["found"]);
  EXPECT_TRUE(says(run.err, "frame      from  Frame")) << run.err;
}

// Another base and flange of the controller are another frame of the same places.
TEST_F(FramesWords, are_in_the_controllers_base_and_on_its_flange) {
  const json plain = frames_of(folder_);
  const json moved = frames_of(folder_, "--base 0,0,100,90,0,0 --flange 0,0,20,0,0,180");
  const Pose X_0C{rotation_z(kPi / 2), Vector3(0, 0, 0.1)};
  const Pose X_nE{rotation_x(kPi), Vector3(0, 0, 0.02)};
  const auto expect_same = [](const Pose& X, const Pose& expected) {
    EXPECT_LT((X.p - expected.p).norm(), 1e-9);
    EXPECT_LT(angle_between(X.R, expected.R), 1e-9);
  };
  for (const char* model : {"found", "nominal"}) {
    expect_same(X_nE * pose_of(moved["frames"][0][model]), pose_of(plain["frames"][0][model]));
    expect_same(X_0C * pose_of(moved["frames"][1][model]), pose_of(plain["frames"][1][model]));
  }
}

}  // namespace
}  // namespace armsig::cli
