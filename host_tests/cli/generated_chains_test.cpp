// SPDX-License-Identifier: MIT
// Chains of every feature that URDF files of arms have, generated: each is imported, exported and
// imported again, and moves as the equations of URDF say.
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include <Eigen/Geometry>

#include "host_tests/cli/files.hpp"

namespace armsig::cli {
namespace {

constexpr unsigned kChainsOfATest = 37;
constexpr int kReadings = 12;
constexpr double kSamePlace_m = 1e-9;

struct GeneratedJoint {
  std::string name, parent, child;
  std::string type;  // revolute, continuous, prismatic or fixed
  std::array<double, 3> xyz{}, rpy{}, axis{0, 0, 1};
  double lower = 0, upper = 0;
  int follows = -1;  // which of the joints with readings, for a mimic joint
  double multiplier = 0, offset = 0;
};

std::string triple_text(const std::array<double, 3>& v) {
  std::ostringstream text;
  text.precision(17);
  text << v[0] << ' ' << v[1] << ' ' << v[2];
  return text.str();
}

class ChainGenerator {
 public:
  explicit ChainGenerator(unsigned seed) : random_(seed) {}

  void generate() {
    if (chance(0.3)) add_slide("rail", {1, 0, 0});
    if (chance(0.3)) add_slide("lift", {0, 0, 1});
    const int turning = 3 + static_cast<int>(uniform(0, 3.99));
    for (int i = 0; i < turning; ++i) {
      if (chance(0.3)) add_fixed();
      const bool follows = i > 0 && !couples_ && chance(0.15) && add_share();
      add_turning(follows);
    }
    add_flange();
    tip_ = link_;
  }

  // The second arm of the robot, a gripper behind the tip and the links of all, in file order.
  [[nodiscard]] std::string urdf() const {
    std::string text = "<robot name=\"generated\">\n<link name=\"base\"/>\n";
    for (const GeneratedJoint& joint : joints_) text += joint_text(joint);
    for (GeneratedJoint joint : joints_) {
      joint.name = "left_" + joint.name;
      joint.child = "left_" + joint.child;
      if (joint.parent != "base") joint.parent = "left_" + joint.parent;
      if (joint.follows < 0) text += joint_text(joint);
    }
    text +=
        "<link name=\"finger\"/><link name=\"thumb\"/>\n"
        "<joint name=\"grip\" type=\"prismatic\"><parent link=\"" +
        tip_ +
        "\"/><child link=\"finger\"/><axis xyz=\"0 1 0\"/><limit lower=\"0\" "
        "upper=\"0.04\"/></joint>\n<joint name=\"grip_too\" type=\"prismatic\"><parent "
        "link=\"" +
        tip_ +
        "\"/><child link=\"thumb\"/><axis xyz=\"0 -1 0\"/><limit lower=\"0\" "
        "upper=\"0.04\"/><mimic joint=\"grip\" offset=\"0.001\"/></joint>\n";
    return text + "</robot>\n";
  }

  [[nodiscard]] const std::string& tip() const { return tip_; }
  [[nodiscard]] std::size_t endless() const {
    std::size_t count = 0;
    for (const GeneratedJoint* joint : moving()) count += joint->type == "continuous" ? 1 : 0;
    return count;
  }

  // Joints that have a reading, base first.
  [[nodiscard]] std::vector<const GeneratedJoint*> moving() const {
    std::vector<const GeneratedJoint*> found;
    for (const GeneratedJoint& joint : joints_) {
      if (joint.type != "fixed" && joint.follows < 0) found.push_back(&joint);
    }
    return found;
  }

  [[nodiscard]] std::vector<double> readings() {
    std::vector<double> q;
    for (const GeneratedJoint* joint : moving()) {
      const bool endless = joint->type == "continuous";
      q.push_back(endless ? uniform(-9, 9) : uniform(joint->lower, joint->upper));
    }
    return q;
  }

  // Where the tip is, by the equations of URDF.
  [[nodiscard]] Eigen::Vector3d tip_at(const std::vector<double>& q) const {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    std::size_t next = 0;
    for (const GeneratedJoint& joint : joints_) {
      X.translate(Eigen::Vector3d(joint.xyz[0], joint.xyz[1], joint.xyz[2]));
      X.rotate(Eigen::AngleAxisd(joint.rpy[2], Eigen::Vector3d::UnitZ()) *
               Eigen::AngleAxisd(joint.rpy[1], Eigen::Vector3d::UnitY()) *
               Eigen::AngleAxisd(joint.rpy[0], Eigen::Vector3d::UnitX()));
      if (joint.type == "fixed") continue;
      const double reading =
          joint.follows >= 0
              ? joint.multiplier * q[static_cast<std::size_t>(joint.follows)] + joint.offset
              : q[next++];
      const Eigen::Vector3d axis =
          Eigen::Vector3d(joint.axis[0], joint.axis[1], joint.axis[2]).normalized();
      if (joint.type == "prismatic") {
        X.translate(reading * axis);
      } else {
        X.rotate(Eigen::AngleAxisd(reading, axis));
      }
    }
    return X.translation();
  }

 private:
  double uniform(double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random_);
  }
  bool chance(double share) { return uniform(0, 1) < share; }

  // Right angles mostly, as arms are built; others too.
  std::array<double, 3> turned() {
    constexpr double kQuarterTurn = 1.5707963267948966;
    std::array<double, 3> rpy{};
    for (double& angle : rpy) {
      if (chance(0.45)) angle = kQuarterTurn * std::floor(uniform(-2, 3));
      if (chance(0.1)) angle = uniform(-1.5, 1.5);
    }
    return rpy;
  }
  std::array<double, 3> shifted(double most) {
    std::array<double, 3> xyz{};
    for (double& length : xyz) {
      if (chance(0.6)) length = uniform(-most, most);
    }
    return xyz;
  }

  GeneratedJoint next(const std::string& name, const std::string& type) {
    GeneratedJoint joint;
    joint.name = name;
    joint.type = type;
    joint.parent = link_;
    joint.child = "link_" + name;
    link_ = joint.child;
    return joint;
  }
  void add_slide(const std::string& name, const std::array<double, 3>& axis) {
    GeneratedJoint joint = next(name, "prismatic");
    joint.xyz = shifted(0.3);
    joint.axis = axis;
    joint.upper = uniform(0.3, 1.5);
    joints_.push_back(joint);
    ++readings_;
  }
  void add_fixed() {
    GeneratedJoint joint = next("fixed_" + std::to_string(joints_.size()), "fixed");
    joint.xyz = shifted(0.2);
    joint.rpy = turned();
    joints_.push_back(joint);
  }
  // Where a last frame of Denavit and Hartenberg can stand: what is predicted is its place.
  void add_flange() {
    joints_.back().axis = {0, 0, 1};
    GeneratedJoint joint = next("flange", "fixed");
    joint.xyz = {uniform(0, 0.2), 0, uniform(-0.2, 0.2)};
    joint.rpy = {uniform(-1, 1), 0, 0};
    joints_.push_back(joint);
  }
  // A joint that follows the last one, about the axis of the next.
  bool add_share() {
    GeneratedJoint joint = next("share", "revolute");
    joint.xyz = shifted(0.4);
    joint.rpy = turned();
    joint.lower = -9;
    joint.upper = 9;
    joint.follows = readings_ - 1;
    joint.multiplier = chance(0.5) ? -1 : 0.5;
    joint.offset = chance(0.5) ? 0 : 0.25;
    follows_name_ = name_of_last_;
    joints_.push_back(joint);
    couples_ = true;
    return true;
  }
  void add_turning(bool behind_share) {
    const std::string name = "joint_" + std::to_string(readings_ + 1);
    GeneratedJoint joint = next(name, chance(0.3) ? "continuous" : "revolute");
    if (!behind_share) {
      joint.xyz = shifted(0.4);
      joint.rpy = turned();
      constexpr std::array<std::array<double, 3>, 4> kAxes{
          {{0, 0, 1}, {0, 1, 0}, {0, 0, -1}, {1, 0, 0}}};
      joint.axis = kAxes.at(static_cast<std::size_t>(uniform(0, 3.99)));
    }
    joint.lower = -uniform(1.2, 3.1);
    joint.upper = uniform(1.2, 3.1);
    joints_.push_back(joint);
    name_of_last_ = name;
    ++readings_;
  }

  [[nodiscard]] std::string joint_text(const GeneratedJoint& joint) const {
    std::ostringstream text;
    text.precision(17);
    text << "<link name=\"" << joint.child << "\"/>\n<joint name=\"" << joint.name << "\" type=\""
         << joint.type << "\"><parent link=\"" << joint.parent << "\"/><child link=\""
         << joint.child << "\"/>\n<origin xyz=\"" << triple_text(joint.xyz) << "\" rpy=\""
         << triple_text(joint.rpy) << "\"/><axis xyz=\"" << triple_text(joint.axis) << "\"/>";
    if (joint.type == "revolute" || joint.type == "prismatic") {
      text << "<limit lower=\"" << joint.lower << "\" upper=\"" << joint.upper
           << "\" effort=\"1\" velocity=\"1\"/>";
    }
    if (joint.follows >= 0) {
      text << "<mimic joint=\"" << follows_name_ << "\" multiplier=\"" << joint.multiplier
           << "\" offset=\"" << joint.offset << "\"/>";
    }
    text << "</joint>\n";
    return text.str();
  }

  std::mt19937 random_;
  std::vector<GeneratedJoint> joints_;
  std::string link_ = "base";
  std::string tip_;
  std::string name_of_last_, follows_name_;
  int readings_ = 0;
  bool couples_ = false;
};

// Writes the readings for an arm of such joints, in radians and metres.
void write_readings(const Folder& folder, const ChainGenerator& chain,
                    const std::vector<std::vector<double>>& all) {
  std::ostringstream text;
  text.precision(17);
  const auto moving = chain.moving();
  for (std::size_t j = 0; j < moving.size(); ++j) {
    text << (j > 0 ? "," : "") << 'q' << j + 1 << (moving[j]->type == "prismatic" ? "_m" : "_rad");
  }
  for (const std::vector<double>& q : all) {
    for (std::size_t j = 0; j < q.size(); ++j) text << (j > 0 ? "," : "\n") << q[j];
  }
  write_file(folder / "q.csv", text.str() + "\n");
}

// The places that an arm description predicts for q.csv, or none.
std::vector<Eigen::Vector3d> places_of(const Folder& folder, const std::string& arm) {
  const Outcome simulated =
      run_tool(folder,
               "simulate --sigma-mm 0 --arc 60 --points 10 --out m.csv --truth-out t.yaml "
               "--arm " +
                   arm);
  EXPECT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_EQ(run_tool(folder, "predict --signature t.yaml --joints q.csv --out p.csv").status, 0);
  const Csv poses = Csv::read(folder / "p.csv");
  std::vector<Eigen::Vector3d> places;
  for (std::size_t k = 0; k < poses.rows.size(); ++k) {
    places.emplace_back(poses.number(k, "x_m"), poses.number(k, "y_m"), poses.number(k, "z_m"));
  }
  return places;
}

// Whatever the base frames: the distances between the places.
void expect_same_places(const std::vector<Eigen::Vector3d>& found,
                        const std::vector<Eigen::Vector3d>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 1; k < found.size(); ++k) {
    EXPECT_NEAR((found[k] - found[k - 1]).norm(), (expected[k] - expected[k - 1]).norm(),
                kSamePlace_m);
  }
}

void expect_done(const Folder& folder, const std::string& command) {
  const Outcome outcome = run_tool(folder, command);
  EXPECT_EQ(outcome.status, 0) << command << "\n" << outcome.err;
}

std::size_t endless_in(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

void expect_chain(const Folder& folder, ChainGenerator& chain) {
  write_file(folder / "r.urdf", chain.urdf());
  const std::string links = " --base base --tip " + chain.tip();
  expect_done(folder, "import --urdf r.urdf --out a.yaml" + links);
  EXPECT_EQ(endless_in(read_file(folder / "a.yaml"), "limits: none"), chain.endless());

  std::vector<std::vector<double>> readings;
  std::vector<Eigen::Vector3d> expected;
  for (int k = 0; k < kReadings; ++k) {
    readings.push_back(chain.readings());
    expected.push_back(chain.tip_at(readings.back()));
  }
  write_readings(folder, chain, readings);
  expect_same_places(places_of(folder, "a.yaml"), expected);

  expect_done(folder, "export --signature t.yaml --format urdf --out e.urdf");
  expect_done(folder, "export --signature t.yaml --into r.urdf --out c.urdf" + links);
  expect_done(folder, "import --urdf e.urdf --base base_link --tip last_link --out e.yaml");
  EXPECT_EQ(endless_in(read_file(folder / "e.yaml"), "limits: none"), chain.endless());
  expect_same_places(places_of(folder, "e.yaml"), expected);
  expect_done(folder, "import --urdf c.urdf --out c.yaml" + links);
  expect_same_places(places_of(folder, "c.yaml"), expected);
}

// Chains of these seeds, one after the other.
void expect_chains(unsigned first) {
  const Folder folder;
  for (unsigned seed = first; seed < first + kChainsOfATest; ++seed) {
    SCOPED_TRACE(seed);
    ChainGenerator chain(seed);
    chain.generate();
    expect_chain(folder, chain);
    if (testing::Test::HasFailure()) {
      ADD_FAILURE() << chain.urdf();
      return;
    }
  }
}

TEST(GeneratedChains, move_as_urdf_says_and_come_back_from_their_exports) { expect_chains(1); }
TEST(GeneratedChains, of_other_seeds_come_back_too) { expect_chains(1 + kChainsOfATest); }
TEST(GeneratedChains, of_further_seeds_come_back_too) { expect_chains(1 + 2 * kChainsOfATest); }

}  // namespace
}  // namespace armsig::cli
