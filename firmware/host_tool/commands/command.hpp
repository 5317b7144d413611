// SPDX-License-Identifier: MIT
// What the commands of `armsig` have in common: exit status, problems, results for programs.
#pragma once

#include <cstdint>
#include <expected>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

enum ExitStatus : std::uint8_t {
  kDone = 0,
  kNoAnswer = 1,  // the data do not support an answer: refused, not converged, drifted
  kBadInput = 2,  // wrong usage or unreadable input
};

// Options that every command takes.
struct CommonOptions {
  bool json = false;
};

// Says on standard error what is wrong, and with --json on standard output too. Returns `status`.
int fail(const Problem& problem, ExitStatus status, const CommonOptions& options);

// Why a command ends without a result. Most of what goes wrong is the input.
struct Failure {
  Problem problem;
  ExitStatus status = kBadInput;

  // A problem that ARMSIG_TRY passes on becomes one.
  Failure(Problem of_input)
      : problem(std::move(of_input)) {}  // NOLINT(google-explicit-constructor)
  Failure(Problem of_data, ExitStatus how) : problem(std::move(of_data)), status(how) {}
};

template <typename T>
using Attempt = std::expected<T, Failure>;

// The data do not support an answer.
[[nodiscard]] std::unexpected<Failure> no_answer(Problem problem);

// The exit status of a command; says what is wrong where it failed.
int status_of(const Attempt<ExitStatus>& attempt, const CommonOptions& options);

// Prints a result for programs on standard output.
void print_json(const nlohmann::ordered_json& result);

// Adds a command to `app`; when it is chosen, its exit status goes to `status`.
void add_demo(CLI::App& app, int& status);
void add_simulate(CLI::App& app, int& status);
void add_identify(CLI::App& app, int& status);
void add_join(CLI::App& app, int& status);
void add_plan(CLI::App& app, int& status);
void add_predict(CLI::App& app, int& status);
void add_solve(CLI::App& app, int& status);
void add_compensate(CLI::App& app, int& status);
void add_frames(CLI::App& app, int& status);
void add_arms(CLI::App& app, int& status);
void add_check(CLI::App& app, int& status);
void add_suggest(CLI::App& app, int& status);
void add_evaluate(CLI::App& app, int& status);
void add_report(CLI::App& app, int& status);
void add_export(CLI::App& app, int& status);
void add_import(CLI::App& app, int& status);
void add_connect(CLI::App& app, int& status);

// The flag --json of a command.
void add_common(CLI::App& command, CommonOptions& options);

}  // namespace armsig::tool
