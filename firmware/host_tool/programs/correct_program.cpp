// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/correct_program.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "firmware/host_tool/programs/configuration.hpp"

namespace armsig::tool {
namespace {

struct Replacement {
  Bytes at;
  std::string by;
};

// A target on its way: in the nominal model's frames.
struct Placed {
  Pose X_BF;  // of the flange, where it is a pose
  Pose X_FT;  // the tool on the nominal model's last frame
  JointVector nominal;
};

// What changes of the program, target by target.
class ProgramRun {
 public:
  ProgramRun(const Language& language, const ControllerView& controller)
      : language_(language), controller_(controller), before_(controller.start) {}

  // Where the nominal controller goes for it; nothing, with the reason, where it goes nowhere.
  [[nodiscard]] std::expected<Placed, std::string> place(const ProgramTarget& target) {
    Placed placed;
    placed.X_FT = controller_.X_nE * target.X_FT;
    const EncoderArm& arm = controller_.compensation->nominal();
    if (target.joints) {
      placed.nominal = readings_of(target.values);
      const auto X_BF = arm.forward(placed.nominal);
      if (!X_BF) return std::unexpected(std::string(describe(X_BF.error())));
      placed.X_BF = *X_BF;
    } else {
      const auto X_WT = pose_of(target.values, language_.writing);
      if (!X_WT) return std::unexpected("its quaternion is not of length 1");
      placed.X_BF = controller_.X_0C * target.X_BW * *X_WT * placed.X_FT.inverse();
      ProgramTarget of_nominal = target;
      of_nominal.X_FT = placed.X_FT;
      const JointVector before = target.near.empty() ? before_ : readings_of(target.near);
      Chosen chosen = chosen_readings(controller_, language_, of_nominal, placed.X_BF, before);
      if (!chosen.readings) return std::unexpected(std::move(chosen.why_not));
      placed.nominal = *chosen.readings;
    }
    before_ = placed.nominal;
    return placed;
  }

 private:
  [[nodiscard]] JointVector readings_of(const std::vector<double>& values) const {
    JointVector readings(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
      readings[i] = language_.writing.radians * values[i];
    }
    return readings;
  }

  const Language& language_;
  const ControllerView& controller_;
  JointVector before_;
};

std::string number_in(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  // Zeros at the end say nothing; one digit stays behind the point.
  const std::size_t point = text.find('.');
  while (text.size() > point + 2 && text.back() == '0') text.pop_back();
  return text == "-0.0" ? "0.0" : text;
}

void replace_numbers(const ProgramTarget& target, const Writing& writing,
                     const std::vector<double>& values, std::vector<Replacement>& all) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool length = !target.joints && i < 3;
    all.push_back({target.numbers[i], number_in(values[i], length ? writing.length_decimals
                                                                  : writing.angle_decimals)});
  }
}

// The configuration's words, where those of the corrected readings are others.
std::string replace_words(const ProgramTarget& target, const Language& language,
                          const ControllerView& controller, const JointVector& readings,
                          std::vector<Replacement>& all) {
  if (target.words.empty() || language.matches == nullptr) return {};
  const Stance stance = stance_of(*controller.nominal, controller.X_0C.R, readings);
  if (language.matches(target.configuration, readings, stance, 0)) return {};
  const std::vector<long> now = language.words_at(target.configuration, readings, stance);
  if (now == target.configuration) return {};
  for (std::size_t i = 0; i < now.size(); ++i) {
    all.push_back({target.words[i], std::to_string(now[i])});
  }
  return language.in_words(now) + " for " + language.in_words(target.configuration);
}

// Words that are not read must stay what they are.
Correction correction_of(const ProgramTarget& target, const Placed& placed,
                         const Language& language, const ControllerView& controller) {
  Correction correction = controller.compensation->pose(placed.X_BF, placed.nominal, placed.X_FT);
  const bool words_stay = target.joints || !language.words_unread ||
                          in_one_configuration(*controller.nominal, controller.X_0C.R,
                                               placed.nominal, correction.readings);
  if (correction.why == Uncorrected::kNone && !words_stay) {
    correction.why = Uncorrected::kConfiguration;
  }
  return correction;
}

// The numbers to be written in place of the target's.
std::vector<double> values_of(const ProgramTarget& target, const Placed& placed,
                              const Correction& correction, const Language& language,
                              const ControllerView& controller) {
  if (!target.joints) {
    const Pose X_0W = controller.X_0C * target.X_BW;
    return numbers_of(X_0W.inverse() * correction.X_BF * placed.X_FT, language.writing);
  }
  std::vector<double> values;
  for (const double q : correction.readings) values.push_back(q / language.writing.radians);
  return values;
}

std::string replaced(std::string_view text, std::vector<Replacement> all) {
  std::ranges::sort(all, {}, [](const Replacement& one) { return one.at.begin; });
  std::string result;
  std::size_t copied = 0;
  for (const Replacement& one : all) {
    if (one.at.begin < copied) continue;  // of a text that is no program, twice in one place
    result += text.substr(copied, one.at.begin - copied);
    result += one.by;
    copied = one.at.end;
  }
  return result += text.substr(copied);
}

// Axes beside the arm's own are not read: of each one that moves, a remark where it does so first.
void remark_external_axes(Program& program) {
  constexpr double kNone = 1e9;  // RAPID writes 9E9 of an axis that is not there
  std::vector<double> first;
  std::vector<bool> moves;
  for (const ProgramTarget& target : program.targets) {
    for (std::size_t k = 0; k < target.external.size(); ++k) {
      const double value = target.external[k];
      if (k >= first.size()) {
        first.push_back(value);
        moves.push_back(false);
      }
      if (first[k] >= kNone) first[k] = value;
      if (moves[k] || value >= kNone || value == first[k]) continue;
      moves[k] = true;
      program.left.push_back(
          {target.line,
           fmt::format("{}: external axis {} moves; targets are corrected as if it did not "
                       "move the arm's base",
                       target.name, k + 1),
           true});
    }
  }
}

Program read_program(std::string_view text, const Language& language,
                     const ControllerView& controller) {
  Program program = language.read(text, controller.frames);
  remark_external_axes(program);
  return program;
}

void by_line(std::vector<LeftAsItIs>& left) {
  std::ranges::sort(left, {}, [](const LeftAsItIs& one) { return std::tie(one.line, one.what); });
}

}  // namespace

CorrectedProgram corrected_program(std::string_view text, const Language& language,
                                   const ControllerView& controller) {
  Program program = read_program(text, language, controller);
  CorrectedProgram result;
  result.left = std::move(program.left);
  result.tried = program.targets.size();
  std::vector<Replacement> replacements;
  ProgramRun run(language, controller);
  for (const ProgramTarget& target : program.targets) {
    const auto placed = run.place(target);
    if (!placed) {
      result.left.push_back({target.line, target.name + ": " + placed.error()});
      continue;
    }
    CorrectedTarget corrected{target.line, target.name, {}, {}};
    corrected.correction = correction_of(target, *placed, language, controller);
    const Correction& correction = corrected.correction;
    if (correction.why == Uncorrected::kNone) {
      replace_numbers(target, language.writing,
                      values_of(target, *placed, correction, language, controller), replacements);
      corrected.words =
          replace_words(target, language, controller, correction.readings, replacements);
    } else {
      result.left.push_back(
          {target.line, target.name + ": " + std::string(describe(correction.why))});
    }
    result.targets.push_back(std::move(corrected));
  }
  result.text = replaced(text, std::move(replacements));
  by_line(result.left);
  return result;
}

Arrivals arrivals_of(std::string_view text, const Language& language,
                     const ControllerView& controller) {
  Program program = read_program(text, language, controller);
  Arrivals result;
  result.left = std::move(program.left);
  const Pose X_C0 = controller.X_0C.inverse();
  ProgramRun run(language, controller);
  for (const ProgramTarget& target : program.targets) {
    const auto placed = run.place(target);
    const auto X_BA = placed ? controller.compensation->arrives(placed->nominal, placed->X_FT)
                             : Result<Pose>(std::unexpected(Error::kNotFinite));
    if (!X_BA) {
      result.left.push_back(
          {target.line,
           target.name + ": " + (placed ? std::string(describe(X_BA.error())) : placed.error())});
      continue;
    }
    result.arrivals.push_back(
        {target.line, target.name, X_C0 * placed->X_BF * placed->X_FT, X_C0 * *X_BA});
  }
  by_line(result.left);
  return result;
}

}  // namespace armsig::tool
