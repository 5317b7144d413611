// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/command.hpp"

#include <utility>

#include "firmware/host_tool/presentation/say.hpp"

namespace armsig::tool {
namespace {

// What --json prints is of this form: keys are added under the same number, and none changes its
// meaning or goes without another.
constexpr const char* kJsonSchema = "armsig-result/1";

}  // namespace

int fail(const Problem& problem, ExitStatus status, const CommonOptions& options) {
  complain("armsig: {}", render(problem));
  if (options.json) {
    nlohmann::ordered_json error{{"what", problem.what}, {"expected", problem.expected}};
    if (!problem.file.empty()) error["file"] = problem.file;
    if (problem.line > 0) error["line"] = problem.line;
    if (problem.column > 0) error["column"] = problem.column;
    print_json({{"status", static_cast<int>(status)}, {"error", std::move(error)}});
  }
  return status;
}

std::unexpected<Failure> no_answer(Problem problem) {
  return std::unexpected(Failure(std::move(problem), kNoAnswer));
}

int status_of(const Attempt<ExitStatus>& attempt, const CommonOptions& options) {
  if (attempt) return *attempt;
  return fail(attempt.error().problem, attempt.error().status, options);
}

void print_json(const nlohmann::ordered_json& result) {
  nlohmann::ordered_json stated{{"schema", kJsonSchema}};
  stated.update(result);
  say("{}\n", json_text(stated, 2));
}

void add_common(CLI::App& command, CommonOptions& options) {
  command.add_flag("--json", options.json, "print the result for programs on standard output");
}

}  // namespace armsig::tool
