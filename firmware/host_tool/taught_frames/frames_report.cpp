// SPDX-License-Identifier: MIT
#include "firmware/host_tool/taught_frames/frames_report.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/table.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

// What a controller calls the numbers after x, y and z.
struct OrientationNames {
  std::string_view language;
  std::vector<std::string_view> names;
  std::string_view unit;
};

const OrientationNames& names_in(const Language& language) {
  static const std::array<OrientationNames, 6> kAll{{{"urscript", {"rx", "ry", "rz"}, "rad"},
                                                     {"rapid", {"q1", "q2", "q3", "q4"}, ""},
                                                     {"krl", {"A", "B", "C"}, "deg"},
                                                     {"fanuc", {"W", "P", "R"}, "deg"},
                                                     {"jbi", {"Rx", "Ry", "Rz"}, "deg"},
                                                     {"gcode", {"A", "B", "C"}, "deg"}}};
  return *std::ranges::find(kAll, language.name, &OrientationNames::language);
}

std::string length_text(double length_m, const Writing& writing) {
  return fmt::format("{:.{}f}", length_m / writing.metres, writing.metres == 1 ? 6 : 3);
}

// As a person reads it in a table: millimetres, whatever the controller takes.
std::vector<std::string> table_cells(const Pose& X, const Language& language) {
  std::vector<std::string> cells;
  for (const double length_m : X.p) cells.push_back(fmt::format("{:.3f}", 1e3 * length_m));
  const std::vector<double> numbers = numbers_of(X, language.writing);
  const int digits = names_in(language).unit == "deg" ? 4 : 6;
  for (std::size_t k = 3; k < numbers.size(); ++k) {
    cells.push_back(fmt::format("{:.{}f}", numbers[k], digits));
  }
  return cells;
}

// As it is entered.
std::string entered(const Pose& X, const Language& language) {
  std::vector<std::string> lengths;
  for (const double length_m : X.p) lengths.push_back(length_text(length_m, language.writing));
  const std::vector<std::string> cells = table_cells(X, language);
  const std::vector<std::string> turns(cells.begin() + 3, cells.end());
  if (language.name == "urscript") {
    return fmt::format("p[{}, {}]", fmt::join(lengths, ", "), fmt::join(turns, ", "));
  }
  if (language.name == "rapid") {
    return fmt::format("[[{}],[{}]]", fmt::join(lengths, ","), fmt::join(turns, ","));
  }
  std::string text = fmt::format("X {}, Y {}, Z {}", lengths[0], lengths[1], lengths[2]);
  const auto& names = names_in(language).names;
  for (std::size_t k = 0; k < turns.size(); ++k) text += fmt::format(", {} {}", names[k], turns[k]);
  return language.name == "krl" ? "{" + text + "}" : text;
}

std::vector<std::string> headings(const Language& language) {
  std::vector<std::string> of{"By", "x, mm", "y, mm", "z, mm"};
  const OrientationNames& names = names_in(language);
  for (const std::string_view name : names.names) {
    of.push_back(names.unit.empty() ? std::string(name) : fmt::format("{}, {}", name, names.unit));
  }
  return of;
}

std::string title_of(const TaughtTask& task, const TaughtFrame& frame) {
  std::size_t tips = 0;
  for (const std::size_t k : frame.rows) tips += task.rows[k].point->axis < 0 ? 1U : 0U;
  if (frame.kind == TaughtFrameKind::kWorkObject) {
    return fmt::format("Work object {}: {}, touched by {}", frame.name,
                       counted(frame.rows.size(), "point"), task.tip.words);
  }
  const std::size_t directions = frame.rows.size() - tips;
  return fmt::format("Tool {}: {} of one tip, {}", frame.name, counted(tips, "point"),
                     directions == 0 ? "no direction: it has the axes of the flange"
                                     : counted(directions, "direction"));
}

void print_numbers(const FoundFrame& frame, const Language& language) {
  Table table(headings(language));
  const auto add = [&](std::string name, const Pose& X) {
    std::vector<std::string> cells = table_cells(X, language);
    cells.insert(cells.begin(), std::move(name));
    table.add_row(std::move(cells));
  };
  add("found model", frame.found.X);
  add("nominal model", frame.nominal.X);
  say("\n{}\n", table.render());
}

void print_sigmas(const FoundFrame& frame) {
  const Vector3 sigma_mm = 1e3 * frame.origin_sigma_m();
  say("  1 sigma of x, y, z: {:.3f}, {:.3f}, {:.3f} mm\n", sigma_mm.x(), sigma_mm.y(),
      sigma_mm.z());
  if (!frame.found.oriented) return;
  const Vector3 sigma_rad = frame.turn_sigma_rad();
  say("  1 sigma of its turn about its own x, y, z: {:.4f}, {:.4f}, {:.4f} deg\n",
      degrees(sigma_rad.x()), degrees(sigma_rad.y()), degrees(sigma_rad.z()));
}

void print_cost(const TaughtFrame& frame, const FoundFrame& of) {
  say("  teaching by the nominal model costs {:.3f} mm", 1e3 * of.apart_m);
  if (of.found.oriented) say(" and {:.4f} deg", degrees(of.turned_rad));
  say("\n");
  if (of.found.freedom == 0) {
    say("  no points beyond the minimum: nothing checks them\n");
    return;
  }
  say("  {} miss {} by {:.3f} mm RMS; by the nominal model {:.3f} mm\n",
      frame.kind == TaughtFrameKind::kTool ? "the touches" : "the points",
      frame.kind == TaughtFrameKind::kTool ? "one tip" : "the frame", 1e3 * of.found.rms_m,
      1e3 * of.nominal.rms_m);
}

void print_points(const TaughtTask& task, const TaughtFrame& frame, const FoundFrame& of) {
  if (of.found.freedom == 0) return;
  Table table({"Point", "line", "missed, mm", "nominal, mm"});
  for (std::size_t n = 0; n < frame.rows.size(); ++n) {
    const TaughtRow& row = task.rows[frame.rows[n]];
    table.add_row({std::string(row.point->name), std::to_string(row.line),
                   fmt::format("{:.3f}", 1e3 * of.found.misses_m[n]),
                   fmt::format("{:.3f}", 1e3 * of.nominal.misses_m[n])});
  }
  say("\n{}", table.render());
}

std::string teach_in_words(const TaughtFrames& result) {
  const TeachNoise& teach = result.teach;
  const std::string sigma = fmt::format("{:.3f} mm, 1 sigma of a coordinate", 1e3 * teach.sigma_m);
  switch (teach.source) {
    case TeachSource::kResiduals:
      return fmt::format(
          "A point was taught to {}, by what the points miss with {} degrees of "
          "freedom.",
          sigma, teach.freedom);
    case TeachSource::kStated:
      return fmt::format("A point was taught to {}, as stated.", sigma);
    case TeachSource::kAssumed:
      return fmt::format(
          "A point is assumed to be taught to {}: too few points are beyond the "
          "minimum. State it by --teach-sigma-mm.",
          sigma);
  }
  return {};
}

std::string signature_in_words(const TaughtFrames& result) {
  return result.signature_counts
             ? "The uncertainty of the signature is part of every sigma."
             : "The signature has no covariance: its uncertainty is no part of the sigmas.";
}

nlohmann::ordered_json frame_pose_json(const Pose& X, const Language& language) {
  const Eigen::Quaterniond q(X.R);
  return {{"p_m", {X.p.x(), X.p.y(), X.p.z()}},
          {"q_wxyz", {q.w(), q.x(), q.y(), q.z()}},
          {"entered", entered(X, language)}};
}

nlohmann::ordered_json touches_json(const TaughtTask& task, const TaughtFrame& frame,
                                    const FoundFrame& of) {
  auto points = nlohmann::ordered_json::array();
  for (std::size_t n = 0; n < frame.rows.size(); ++n) {
    const TaughtRow& row = task.rows[frame.rows[n]];
    points.push_back({{"point", row.point->name},
                      {"line", row.line},
                      {"missed_m", of.found.misses_m[n]},
                      {"nominal_missed_m", of.nominal.misses_m[n]}});
  }
  return points;
}

nlohmann::ordered_json frame_json(const TaughtTask& task, const TaughtFrame& frame,
                                  const FoundFrame& of, const Language& language) {
  const Vector3 origin_m = of.origin_sigma_m();
  nlohmann::ordered_json json{{"name", frame.name},
                              {"kind", word_of(frame.kind)},
                              {"oriented", of.found.oriented},
                              {"found", frame_pose_json(of.found.X, language)},
                              {"nominal", frame_pose_json(of.nominal.X, language)}};
  json["sigma_m"] = {origin_m.x(), origin_m.y(), origin_m.z()};
  json["sigma_rad"] = nullptr;
  if (of.found.oriented) {
    const Vector3 turn_rad = of.turn_sigma_rad();
    json["sigma_rad"] = {turn_rad.x(), turn_rad.y(), turn_rad.z()};
  }
  json["nominal_apart_m"] = of.apart_m;
  json["nominal_turned_rad"] = of.turned_rad;
  json["degrees_of_freedom"] = of.found.freedom;
  json["missed_rms_m"] = of.found.rms_m;
  json["nominal_missed_rms_m"] = of.nominal.rms_m;
  json["points"] = touches_json(task, frame, of);
  return json;
}

}  // namespace

void print_taught_frames(const TaughtTask& task, const TaughtFrames& result,
                         const Language& language) {
  for (std::size_t f = 0; f < task.frames.size(); ++f) {
    say("{}{}\n", f == 0 ? "" : "\n", title_of(task, task.frames[f]));
    print_numbers(result.frames[f], language);
    print_sigmas(result.frames[f]);
    print_cost(task.frames[f], result.frames[f]);
    print_points(task, task.frames[f], result.frames[f]);
    say("\n  to enter:\n  {}\n", entered(result.frames[f].found.X, language));
  }
  say("\n{}", paragraph(teach_in_words(result) + " " + signature_in_words(result), 0));
  say("{}", paragraph("Enter the frames of the found model where programs are corrected by "
                      "`armsig compensate`, and correct them with these frames. Programs that run "
                      "as they are keep the frames that the controller taught.",
                      0));
}

nlohmann::ordered_json json_of(const TaughtTask& task, const TaughtFrames& result,
                               const Language& language) {
  constexpr std::array<std::string_view, 3> kSources{"residuals", "stated", "assumed"};
  nlohmann::ordered_json json{
      {"status", 0},
      {"frames", nlohmann::ordered_json::array()},
      {"touched_by", task.tip.words},
      {"teach_sigma_m", result.teach.sigma_m},
      {"teach_sigma_from", kSources.at(static_cast<std::size_t>(result.teach.source))},
      {"degrees_of_freedom", result.teach.freedom},
      {"signature_uncertainty", result.signature_counts},
      {"language", language.name},
      {"warnings", result.warnings}};
  for (std::size_t f = 0; f < task.frames.size(); ++f) {
    json["frames"].push_back(frame_json(task, task.frames[f], result.frames[f], language));
  }
  return json;
}

FramesFile file_of(const TaughtTask& task, const TaughtFrames& result) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kControllers{
      {{"krl", "KUKA"}, {"rapid", "ABB"}, {"fanuc", "FANUC, Yaskawa"}, {"urscript", "UR"}}};
  FramesFile file;
  for (std::size_t f = 0; f < task.frames.size(); ++f) {
    const bool tool = task.frames[f].kind == TaughtFrameKind::kTool;
    NamedPose frame{task.frames[f].name, result.frames[f].found.X, {}};
    for (const auto& [name, maker] : kControllers) {
      const Language& language = *std::ranges::find(languages(), name, &Language::name);
      frame.forms.push_back(fmt::format("{}: {}", maker, entered(frame.X, language)));
    }
    (tool ? file.tools : file.work_objects).push_back(std::move(frame));
  }
  return file;
}

}  // namespace armsig::tool
