// SPDX-License-Identifier: MIT
// The languages, with what the words of a configuration mean in each.
#include <array>
#include <cmath>

#include <fmt/core.h>

#include "firmware/host_tool/programs/readers.hpp"

namespace armsig::tool {
namespace {

bool is_at_least(double value, double bound, double tolerance) {
  return value >= bound - tolerance;
}
bool is_below(double value, double bound, double tolerance) { return value < bound + tolerance; }

// A bit that is set where `value` is below zero.
bool bit_agrees(bool set, double value, double tolerance) {
  return set ? is_below(value, 0, tolerance) : is_at_least(value, 0, tolerance);
}
bool bit_of(long word, unsigned bit) {
  return ((static_cast<unsigned long>(word) >> bit) & 1UL) != 0;
}

// KRL: S has bit 0 where the wrist is behind axis 1, bit 1 where it is in front of the lower arm,
// bit 2 where A5 is negative; T has a bit for each negative axis.
bool krl_matches(const std::vector<long>& words, const JointVector& q, const Stance& stance,
                 double tolerance) {
  const long s = words[0];
  bool agrees = bit_agrees(bit_of(s, 0), stance.front, tolerance) &&
                bit_agrees(bit_of(s, 1), -stance.ahead, tolerance) &&
                bit_agrees(bit_of(s, 2), q[4], tolerance);
  for (unsigned i = 0; i < 6; ++i) {
    agrees = agrees && bit_agrees(bit_of(words[1], i), q[i], tolerance);
  }
  return agrees;
}

// Bits beyond these say other things, and stay.
std::vector<long> krl_words(const std::vector<long>& before, const JointVector& q,
                            const Stance& stance) {
  long s = before[0] & ~7L;
  if (stance.front < 0) s |= 1;
  if (stance.ahead > 0) s |= 2;
  if (q[4] < 0) s |= 4;
  long t = before[1] & ~63L;
  for (unsigned i = 0; i < 6; ++i) {
    if (q[i] < 0) t |= 1L << i;
  }
  return {s, t};
}

std::string krl_in_words(const std::vector<long>& words) {
  return fmt::format("S {}, T {}", words[0], words[1]);
}

// RAPID: quarter turns of axes 1, 4 and 6; cfx has bit 2 where the wrist is behind axis 1, bit 1
// where it is behind the lower arm, bit 0 where axis 5 is negative.
constexpr std::array<std::size_t, 3> kQuarterAxes{0, 3, 5};

bool rapid_matches(const std::vector<long>& words, const JointVector& q, const Stance& stance,
                   double tolerance) {
  bool agrees = bit_agrees(bit_of(words[3], 2), stance.front, tolerance) &&
                bit_agrees(bit_of(words[3], 1), stance.ahead, tolerance) &&
                bit_agrees(bit_of(words[3], 0), q[4], tolerance);
  for (std::size_t k = 0; k < kQuarterAxes.size(); ++k) {
    const double reading = q[kQuarterAxes[k]];
    const double from = static_cast<double>(words[k]) * kPi / 2;
    agrees = agrees && is_at_least(reading, from, tolerance) &&
             is_below(reading, from + kPi / 2, tolerance);
  }
  return agrees;
}

std::vector<long> rapid_words(const std::vector<long>& /*before*/, const JointVector& q,
                              const Stance& stance) {
  std::vector<long> words;
  for (const std::size_t axis : kQuarterAxes) {
    words.push_back(std::lround(std::floor(q[axis] / (kPi / 2))));
  }
  words.push_back((stance.front < 0 ? 4 : 0) + (stance.ahead < 0 ? 2 : 0) + (q[4] < 0 ? 1 : 0));
  return words;
}

std::string rapid_in_words(const std::vector<long>& words) {
  return fmt::format("[{}, {}, {}, {}]", words[0], words[1], words[2], words[3]);
}

}  // namespace

const std::vector<Language>& languages() {
  static const std::vector<Language> kAll{
      {"urscript", ".script .urscript", kUrWriting, read_urscript, nullptr, nullptr, nullptr,
       false},
      {"rapid", ".mod .modx .prg", kRapidWriting, read_rapid, rapid_matches, rapid_words,
       rapid_in_words, false},
      {"krl", ".src .dat", kKrlWriting, read_krl, krl_matches, krl_words, krl_in_words, false},
      {"fanuc", ".ls", kFanucWriting, read_fanuc, nullptr, nullptr, nullptr, true},
      {"jbi", ".jbi", kJbiWriting, read_jbi, nullptr, nullptr, nullptr, true},
      {"gcode", ".ngc .nc .gcode", kGcodeWriting, read_gcode, nullptr, nullptr, nullptr, false}};
  return kAll;
}

const Language* language_of(std::string_view file) {
  const std::size_t dot = file.rfind('.');
  if (dot == std::string_view::npos) return nullptr;
  std::string suffix(file.substr(dot));
  for (char& c : suffix) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  for (const Language& language : languages()) {
    std::string_view all = language.suffixes;
    while (!all.empty()) {
      const std::size_t end = std::min(all.find(' '), all.size());
      if (all.substr(0, end) == suffix) return &language;
      all.remove_prefix(std::min(end + 1, all.size()));
    }
  }
  return nullptr;
}

}  // namespace armsig::tool
