// SPDX-License-Identifier: MIT
// Whoever is set or started anew in place is as if it had just been made: what it then shows is,
// bit for bit, what a fresh one shows, whatever it was and did before.
//
// A class takes part by a case below: how it is made, what it may be set to, and what it shows.
// The last test finds classes that have set() or start() and no case.
#include <bit>
#include <filesystem>
#include <fstream>
#include <memory>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/calibration/servo_inverse.hpp"
#include "core/identification.hpp"
#include "firmware/analysis/uncertainty/suggestion.hpp"
#include "hal/modbus/rtu_master.hpp"
#include "hal/simulated/drive_dictionary.hpp"
#include "host_tests/support/bent_model.hpp"
#include "host_tests/support/identified_puma.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/puma_cabinet.hpp"
#include "host_tests/support/scripted_line.hpp"

namespace armsig::controller {
namespace {

using calibration::PackedDeflections;
using calibration::ServoGravity;
using calibration::ServoMaps;
using calibration::ServoReadings;
using test::Random;

// What an object shows, as bits: equal numbers and equal zeros of another sign are not the same.
class Shown {
 public:
  void add(double value) { bits_.push_back(std::bit_cast<std::uint64_t>(value)); }
  void add(std::uint64_t value) { bits_.push_back(value); }
  template <typename Numbers>
  void add_all(const Numbers& numbers) {
    for (const auto& number : numbers) add(number);
  }
  void add(const Pose& X) {
    add_all(X.R.reshaped());
    add_all(X.p);
  }
  [[nodiscard]] bool empty() const { return bits_.empty(); }
  friend bool operator==(const Shown&, const Shown&) = default;

 private:
  std::vector<std::uint64_t> bits_;
};

// --- The cases: kNames, kInputs, set(input), show(). show() may use the object up. -------------

// An exact arm, one with coupled joints, one with a slide.
struct BentArm {
  Arm arm;
  PackedDeflections deflections;
  JointVector configuration;
};
const BentArm& bent_arm(int input) {
  static const std::vector<BentArm> all = [] {
    Random random(31);
    std::vector<BentArm> arms(4);
    arms[0].arm = arms[1].arm = test::puma560();
    arms[1].arm.couplings.push_back({2, 1, -1});
    arms[2].arm = test::stanford();
    arms[3].arm.joints = {test::puma560().joints[0], test::puma560().joints[1]};
    arms[3].arm.limits = {{-1, 2}, {-2, 1}};
    for (std::size_t i = 0; i < arms.size(); ++i) {
      arms[i].configuration = random.configuration(arms[i].arm);
      if (i > 0) arms[i].deflections = packed(test::bent_model(arms[i].arm, random));
    }
    return arms;
  }();
  return all[static_cast<std::size_t>(input)];
}

std::vector<JointVector> places(const Arm& arm) {
  Random random(32);
  std::vector<JointVector> all;
  for (int k = 0; k < 10; ++k) all.push_back(random.configuration(arm));
  return all;
}

struct ServoReadingsCase {
  static constexpr std::array kNames{"ServoReadings::set"};
  static constexpr int kInputs = 4;
  ServoReadings joints;
  int input = 0;

  void set(int to) {
    input = to;
    const BentArm& bent = bent_arm(to);
    joints.set(bent.deflections, bent.arm, bent.configuration);
  }
  Shown show() {
    Shown shown;
    const BentArm& bent = bent_arm(input);
    for (const JointVector& q : places(bent.arm)) {
      shown.add_all(*joints.turned(q));
      shown.add_all(*joints.readings(q));
    }
    shown.add_all(*joints.turned(bent.configuration));
    shown.add(joints.largest());
    for (const auto& limits : {joints.limits(), joints.turned_limits()}) {
      for (const JointLimits& of_joint : limits) {
        shown.add(of_joint.lower);
        shown.add(of_joint.upper);
      }
    }
    return shown;
  }
};

struct ServoMapsCase {
  static constexpr std::array kNames{"ServoMaps::set"};
  static constexpr int kInputs = 4;
  ServoMaps maps;
  int input = 0;

  void set(int to) {
    input = to;
    maps.set(bent_arm(to).deflections);
  }
  Shown show() {
    Shown shown;
    for (const JointVector& q : places(bent_arm(input).arm)) {
      ServoMaps::Values readings{};
      std::ranges::copy(q, readings.begin());
      ServoMaps::Values values{};
      ServoMaps::Values slopes{};
      shown.add(std::uint64_t{maps.at(readings, values, slopes)});
      shown.add_all(values);
      shown.add_all(slopes);
    }
    for (std::size_t i = 0; i < kMaxJoints; ++i) {
      shown.add(maps.largest(i));
      shown.add(maps.most_bent(i));
    }
    return shown;
  }
};

struct ServoGravityCase {
  static constexpr std::array kNames{"ServoGravity::set"};
  static constexpr int kInputs = 4;
  ServoGravity gravity;
  int input = 0;

  void set(int to) {
    input = to;
    gravity.set(bent_arm(to).deflections, bent_arm(to).arm);
  }
  Shown show() {
    Shown shown;
    for (const JointVector& q : places(bent_arm(input).arm)) {
      ServoGravity::Values readings{};
      std::ranges::copy(q, readings.begin());
      ServoGravity::Values by{};
      gravity.at(readings, by);
      shown.add_all(by);
    }
    for (const double bound : {gravity.lever_m(), gravity.largest(), gravity.steepest()}) {
      shown.add(bound);
    }
    return shown;
  }
};

// The servo's model, made in place: a drawing, then signatures.
struct ModelCase {
  static constexpr std::array kNames{"make_model"};
  static constexpr int kInputs = 4;
  Model model;
  int input = 0;

  void set(int to) {
    input = to;
    const BentArm& bent = bent_arm(to);
    if (to == 0) {
      make_model(bent.arm, model);
      return;
    }
    SignatureRecord record;
    record.deflections = bent.deflections;
    Signature& signature = record.signature;
    signature.types = types_of(bent.arm.joints);
    signature.configuration = bent.configuration;
    signature.pseudo_dh = bent.arm.joints;
    signature.X_SL.push_back({rotation_z(0.1 * to), Vector3(0.1, 0.2 * to, 0.3)});
    if (to != 3) {
      signature.targets.push_back(
          {.number = 1, .link = bent.arm.joints.size(), .p_S = Vector3(0.4 * to, 0.1, 0.2)});
    }
    make_model(record, bent.arm, model);
  }
  Shown show() {
    Shown shown;
    shown.add(std::uint64_t{model.identified});
    shown.add(std::uint64_t{model.chain.joint_count});
    for (const JointVector& q : places(bent_arm(input).arm)) {
      const auto X_RT = tool_pose(model, q);
      shown.add(X_RT.has_value() ? *X_RT : Pose{});
      JointVector near = q;
      for (double& reading : near) reading += 1e-3;
      calibration::LatelyTurned nothing;
      const auto found = joints_for(model, flange_pose(model, *X_RT), near, {}, nothing);
      if (found) shown.add_all(found->q);
    }
    for (const JointLimits& of_joint : model.chain.limits) {
      shown.add(of_joint.lower);
      shown.add(of_joint.upper);
    }
    return shown;
  }
};

struct SuggestionSearchCase {
  static constexpr std::array kNames{"SuggestionSearch::start"};
  static constexpr int kInputs = 3;
  std::unique_ptr<uncertainty::SuggestionSearch> search =
      std::make_unique<uncertainty::SuggestionSearch>();

  void set(int to) {
    static const test::IdentifiedPuma few(40, 15);
    static const test::IdentifiedPuma many(41, 40);
    const test::IdentifiedPuma& puma = to == 0 ? few : many;
    uncertainty::SuggestionConfig config;
    config.limits = puma.cell.arm.limits;
    config.candidates = 20;
    config.volume = 15;
    if (to == 2) config.box.lower_S.z() = 0.2;
    ASSERT_TRUE(search->start(*puma.refined, config));
  }
  Shown show() {
    Shown shown;
    shown.add(search->predicted_rms_m());
    std::array<uncertainty::Suggestion, 2> suggestions;
    EXPECT_TRUE(search->suggest(suggestions));
    for (const uncertainty::Suggestion& one : suggestions) {
      shown.add_all(one.readings);
      shown.add(one.predicted_rms_m);
    }
    return shown;
  }
};

// Requests of other length; the answer to the first may be cut off, or hang in the line.
struct RtuMasterCase {
  static constexpr std::array kNames{"RtuMaster::start"};
  static constexpr int kInputs = 3;
  test::ScriptedLine line;
  modbus::RtuMaster master{{}, line};
  hal::Instant now{std::chrono::seconds(1)};

  void set(int to) {
    for (int i = 0; i < 500 && !master.idle(now); ++i) {
      now += std::chrono::milliseconds(1);
      (void)master.poll(now);
    }
    line.written.clear();
    line.answer = test::bytes(to == 1 ? "010404000A" : "010404000100022B85");
    const modbus::ReadRequest request{
        .unit = 1,
        .function = 4,
        .registers = {.first = static_cast<std::uint16_t>(to == 2 ? 7 : 0), .count = 2}};
    ASSERT_TRUE(master.start(request, now));
  }
  Shown show() {
    Shown shown;
    for (const auto& frame : line.written) {
      for (const std::uint8_t byte : frame) shown.add(std::uint64_t{byte});
    }
    for (int ticks = 0; ticks < 500; ++ticks) {
      now += std::chrono::milliseconds(1);
      const auto answer = master.poll(now);
      if (!answer) continue;
      shown.add(static_cast<std::uint64_t>(ticks));
      shown.add(std::uint64_t{answer->has_value()});
      if (!*answer) shown.add(static_cast<std::uint64_t>((*answer).error().error));
      if (*answer) {
        for (const std::uint16_t number : **answer) shown.add(std::uint64_t{number});
      }
      return shown;
    }
    return shown;
  }
};

struct DriveDictionaryCase {
  static constexpr std::array kNames{"DriveDictionary::set"};
  static constexpr int kInputs = 2;
  static constexpr std::uint16_t kTarget = 0x607A;
  simulated::DriveDictionary dictionary{3, 1001};

  void set(int to) { dictionary.set(kTarget, 0, to == 0 ? 0xFFFFFFFF : 0x12); }
  Shown show() {
    Shown shown;
    shown.add(std::uint64_t{dictionary.get(kTarget)});
    shown.add(std::uint64_t{dictionary.get(0x6064)});
    return shown;
  }
};

// Of moves; the first is halted.
struct PathParameterCase {
  static constexpr std::array kNames{"PathParameter::begin"};
  static constexpr int kInputs = 3;
  PathParameter path;
  BrakingLimits limits;

  void set(int to) {
    PathShares shares;
    shares.add(0, 1, 1.0 + to, 0.2 * to, 1.0, 3.0);
    const double duration_s = 1.0 + 0.7 * to;
    limits = braking_limits(shares, duration_s);
    path.begin(duration_s, 0.002);
    for (int i = 0; i < 100 * to; ++i) (void)path.advance(limits);
    if (to > 0) path.brake();
  }
  Shown show() {
    Shown shown;
    for (int i = 0; i < 2000 && !path.at_rest(); ++i) {
      shown.add(path.advance(limits));
      shown.add(path.left_s());
    }
    return shown;
  }
};

struct SquareRootFactorCase {
  static constexpr std::array kNames{"SquareRootFactor::reset"};
  static constexpr int kInputs = 3;
  calibration::SquareRootFactor factor;
  std::size_t unknowns = 0;

  void set(int to) {
    unknowns = 3 + static_cast<std::size_t>(to);
    factor.reset(unknowns);
  }
  Shown show() {
    Random random(33);
    for (int k = 0; k < 12; ++k) {
      calibration::RowBlock<1> row;
      for (std::size_t c = 0; c <= unknowns; ++c) row.rows[0][c] = random.uniform(-1, 1);
      factor.absorb(row);
    }
    Shown shown;
    const auto solution = factor.solve();
    EXPECT_TRUE(solution);
    for (std::size_t i = 0; solution && i < unknowns; ++i) shown.add((*solution)[i]);
    shown.add(factor.residual_squares());
    shown.add(factor.log_determinant());
    return shown;
  }
};

// The whole sequence: halted in a sweep, or over, before it is started once more.
struct IdentificationCase {
  static constexpr std::array kNames{"IdentificationSequence::start"};
  static constexpr int kInputs = 2;
  std::unique_ptr<test::PumaCabinet> puma;

  IdentificationCase() {
    Configuration quick = test::puma_controller();
    quick.dwell.pings = 1;
    quick.sweeps.points = quick.sweeps.most_points = 7;
    quick.sweeps.validation_poses = 3;
    puma = std::make_unique<test::PumaCabinet>(1, quick);
    puma->cabinet->sensor().field().range_sigma_m = 0;
    EXPECT_TRUE(puma->enable());
  }
  void set(int to) {
    if (puma->mode() != Mode::kHolding) {
      ASSERT_EQ(puma->ask("halt"), "ok");
      ASSERT_TRUE(puma->run_until(Mode::kHolding));
    }
    ASSERT_EQ(puma->ask("identify"), "ok");
    ASSERT_TRUE(puma->run_until(Mode::kSweeping, 1));
    if (to == 0) puma->run(20);
    if (to == 1) ASSERT_TRUE(puma->run_until(Mode::kHolding, 600));
  }
  Shown show() {
    Shown shown;
    const IdentificationSequence& sequence = puma->cabinet->state().identification();
    shown.add(static_cast<std::uint64_t>(sequence.points_done() > 5));
    shown.add(static_cast<std::uint64_t>(sequence.points_planned()));
    shown.add(std::uint64_t{sequence.is_paused()});
    shown.add(std::uint64_t{sequence.has_verdict()});
    if (!sequence.has_verdict()) return shown;
    shown.add(static_cast<std::uint64_t>(sequence.points_done()));
    for (std::size_t k = 0; k < sequence.log().size(); ++k) {
      shown.add_all(sequence.log()[k].readings());
    }
    shown.add(static_cast<std::uint64_t>(sequence.report().poses));
    return shown;
  }
};

// --- The test ----------------------------------------------------------------------------------

template <typename Case>
class SetAgain : public testing::Test {};
using Cases = testing::Types<ServoReadingsCase, ServoMapsCase, ServoGravityCase, ModelCase,
                             SuggestionSearchCase, RtuMasterCase, DriveDictionaryCase,
                             PathParameterCase, SquareRootFactorCase, IdentificationCase>;
TYPED_TEST_SUITE(SetAgain, Cases);

template <typename Case>
Shown shown_after(std::initializer_list<int> inputs) {
  const auto one = std::make_unique<Case>();
  for (const int input : inputs) one->set(input);
  return one->show();
}

TYPED_TEST(SetAgain, is_as_a_fresh_one_whatever_it_was) {
  for (int last = 0; last < TypeParam::kInputs; ++last) {
    const Shown fresh = shown_after<TypeParam>({last});
    ASSERT_FALSE(fresh.empty());
    for (int other = 0; other < TypeParam::kInputs; ++other) {
      if (other != last) {
        EXPECT_FALSE(shown_after<TypeParam>({other}) == fresh) << "inputs that show the same";
      }
      EXPECT_TRUE(shown_after<TypeParam>({other, last}) == fresh) << other << " then " << last;
      const auto used = std::make_unique<TypeParam>();
      used->set(other);
      (void)used->show();
      used->set(last);
      EXPECT_TRUE(used->show() == fresh) << other << " used, then " << last;
    }
    EXPECT_TRUE(shown_after<TypeParam>({last, last, last, last}) == fresh) << last << " four times";
  }
}

template <typename... Each>
std::set<std::string> names(testing::Types<Each...>* /*cases*/) {
  std::set<std::string> all;
  (all.insert(Each::kNames.begin(), Each::kNames.end()), ...);
  return all;
}

// Every member function set() or start() of a header, with its class.
std::set<std::string> found_in_headers() {
  const std::regex of_class(R"(^(?:class|struct)\s+(\w+)[^;]*$)");
  const std::regex member(R"(^ {2}(?!.*\bstatic\b)[\w:<>\[\], ]+\s(set|start)\([^{]*)");
  std::set<std::string> found;
  for (const char* room : {"core", "hal", "firmware"}) {
    const std::filesystem::path folder = std::filesystem::path(ARMSIG_SOURCE) / room;
    for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) {
      if (file.path().extension() != ".hpp") continue;
      std::ifstream lines(file.path());
      std::string name;
      for (std::string line; std::getline(lines, line);) {
        std::smatch match;
        if (std::regex_match(line, match, of_class)) name = match[1];
        if (!std::regex_search(line, match, member)) continue;
        if (line.find(") const") == std::string::npos) found.insert(name + "::" + match[1].str());
      }
    }
  }
  return found;
}

TEST(SetAgainCases, are_of_every_class_that_is_set_or_started) {
  const std::set<std::string> known = names(static_cast<Cases*>(nullptr));
  const std::set<std::string> found = found_in_headers();
  EXPECT_GE(found.size(), 7U) << "the search finds nothing";
  for (const std::string& name : found) EXPECT_TRUE(known.contains(name)) << name << " has no case";
}

}  // namespace
}  // namespace armsig::controller
