// SPDX-License-Identifier: MIT
// Robot programs of each language: what is read, corrected and read again has the same targets, and
// all else of it is as it was.
#include <array>

#include "core/identification.hpp"
#include "firmware/host_tool/programs/correct_program.hpp"
#include "firmware/host_tool/programs/readers.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

using namespace tool;  // NOLINT(google-build-using-namespace): its readers are the subject

struct World {
  World() : record(individual()), compensation(record, record.nominal) {
    view.compensation = &compensation;
    view.nominal = &record.nominal;
    view.start = JointVector{0.1, -1, 1, 0.2, 0.5, 0.3};
    FUZZ_CHECK(view.frames.tools.add("--tool", "0,0,100,0,0,0"));
    FUZZ_CHECK(view.frames.frames.add("--frame", "10,0,0,0,0,0"));
  }

  static SignatureRecord individual() {
    SignatureRecord record;
    record.nominal = puma560();
    record.signature =
        signature_of(table2_robot(1), JointVector{0, -1.5, 1.5, 0.5, 0.5, 0}, Pose{}, {});
    return record;
  }

  SignatureRecord record;
  Compensation compensation;
  ControllerView view;
};

const World& world() {
  static const World kWorld;
  return kWorld;
}

// Their numbers are numbers, each by itself.
void check_targets(const Program& program, std::string_view text) {
  for (const ProgramTarget& target : program.targets) {
    FUZZ_CHECK(target.line >= 1 && !target.numbers.empty());
    FUZZ_CHECK(target.values.size() == target.numbers.size());
    for (const tool::Bytes& number : target.numbers) {
      FUZZ_CHECK(number.begin < number.end && number.end <= text.size());
    }
    for (const tool::Bytes& word : target.words) FUZZ_CHECK(word.end <= text.size());
  }
  for (const LeftAsItIs& left : program.left) FUZZ_CHECK(left.line >= 1 && !left.what.empty());
}

void fuzz_language(fuzz::Bytes bytes, std::size_t which) {
  const std::string_view text = text_of(bytes);
  const Language& language = languages()[which];
  const Program program = language.read(text, world().view.frames);
  check_targets(program, text);
  const CorrectedProgram corrected = corrected_program(text, language, world().view);
  FUZZ_CHECK(corrected.targets.size() <= program.targets.size());
  const Program again = language.read(corrected.text, world().view.frames);
  FUZZ_CHECK(again.targets.size() == program.targets.size());
  FUZZ_CHECK(again.left.size() == program.left.size());
  (void)arrivals_of(corrected.text, language, world().view);
}

constexpr std::array kProgramTargets{
    Target{"urscript", [](fuzz::Bytes bytes) { fuzz_language(bytes, 0); }},
    Target{"rapid", [](fuzz::Bytes bytes) { fuzz_language(bytes, 1); }},
    Target{"krl", [](fuzz::Bytes bytes) { fuzz_language(bytes, 2); }},
    Target{"fanuc", [](fuzz::Bytes bytes) { fuzz_language(bytes, 3); }},
    Target{"jbi", [](fuzz::Bytes bytes) { fuzz_language(bytes, 4); }},
    Target{"gcode", [](fuzz::Bytes bytes) { fuzz_language(bytes, 5); }}};

}  // namespace

std::span<const Target> program_targets() { return kProgramTargets; }

}  // namespace armsig::fuzz
