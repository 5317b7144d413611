// SPDX-License-Identifier: MIT
// armsig: the operator's command.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <memory>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/command_line/help_form.hpp"
#include "firmware/command_line/option_problem.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/wrapping.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/commands/examples.hpp"
#include "firmware/host_tool/commands/usage.hpp"
#include "firmware/host_tool/presentation/say.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"

namespace {

constexpr const char* kDescription =
    "armsig finds the arm signature of a robot arm: its actual kinematic parameters,\n"
    "from sweeps of one joint at a time, and states their uncertainty.";

constexpr const char* kFooter =
    "Start with `armsig demo`. Files and units: docs/formats.md.\n"
    "Exit status: 0 done; 1 the data do not support an answer; 2 wrong usage or unreadable input.";

// Every command's --help ends with what a person would type.
void add_examples(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands({})) {
    std::string footer = "Examples:\n";
    for (const armsig::tool::Example& example : armsig::tool::kExamples) {
      if (example.command == command->get_name()) footer += "  " + std::string(example.line) + "\n";
    }
    command->footer(footer + "\n" + kFooter);
  }
}

// One line of help in `width` columns: what describes goes on under where it begins; names and
// examples stay as they are, to be copied.
std::string fitted_line(const std::string& line, std::size_t width) {
  using armsig::tool::paragraph;
  constexpr std::size_t kColumn = 30;  // the column where the parser begins it
  const std::size_t indent = line.find_first_not_of(' ');
  if (armsig::tool::width_of(line) <= width || indent == std::string::npos) return line + '\n';
  if (indent == 0 || indent >= kColumn) return paragraph(line.substr(indent), indent, width);
  if (line.compare(kColumn - 2, 2, "  ") != 0) return line + '\n';
  std::string lines = paragraph(line.substr(kColumn), kColumn, width);
  return lines.replace(0, kColumn, line, 0, kColumn);
}

std::string fitted(const std::string& help) {
  std::istringstream lines(help);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    text += fitted_line(line, armsig::tool::output_width());
  }
  return text;
}

// `armsig` alone asks for help, as `armsig help` does; `armsig help COMMAND` for that of a command.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  if (words.empty()) return {"--help"};
  if (words.front() != "help") return words;
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

bool is_command(const CLI::App& app, const std::string& word) {
  return std::ranges::any_of(app.get_subcommands({}),
                             [&](const CLI::App* command) { return command->get_name() == word; });
}

void add_commands(CLI::App& app, int& status) {
  using namespace armsig::tool;
  add_demo(app, status);
  add_simulate(app, status);
  add_plan(app, status);
  add_identify(app, status);
  add_predict(app, status);
  add_solve(app, status);
  add_compensate(app, status);
  add_frames(app, status);
  add_check(app, status);
  add_suggest(app, status);
  add_evaluate(app, status);
  add_report(app, status);
  add_export(app, status);
  add_import(app, status);
  add_arms(app, status);
  add_join(app, status);
  add_connect(app, status);
}

int run(int argc, char** argv) {
  using namespace armsig::tool;
  CLI::App app{kDescription, "armsig"};
  app.footer(kFooter);
  app.formatter(std::make_shared<HelpForm>());
  app.set_help_flag("-h,--help", "print this help");
  app.set_version_flag("-V,--version", "armsig " ARMSIG_VERSION, "print the version");
  app.require_subcommand(1);
  int status = kDone;
  add_commands(app, status);
  add_examples(app);
  demand_finite_numbers(app);
  const std::vector<std::string> words = words_of(argc, argv);
  if (asks_for_standard_output(words)) leave_standard_output_to_the_file();
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& error) {
    std::ostringstream out;
    std::ostringstream err;
    // Of a command that there is not, no help is given.
    const bool has_command = words.front().starts_with('-') || is_command(app, words.front());
    if (app.exit(error, out, err) == 0 && has_command) {  // --help, --version
      put(stdout, fitted(out.str()));
      return kDone;
    }
    const bool json = std::ranges::find(words, "--json") != words.end();
    return fail(usage_problem(app, error, words), kBadInput, {.json = json});
  }
  return status;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    armsig::tool::remove_temporaries_on_signals();
    const int status = run(argc, argv);
    if (std::fflush(stdout) == 0) return status;
    std::fputs("armsig: the output can't be written\n", stderr);
    return armsig::tool::kNoAnswer;
  } catch (const std::bad_alloc&) {
    std::fputs("armsig: out of memory\n", stderr);
    return armsig::tool::kNoAnswer;
  } catch (const std::exception& error) {
    // A full terminal: nothing that a command could have foreseen.
    std::fprintf(stderr, "armsig: %s\n", error.what());
    return armsig::tool::kNoAnswer;
  }
}
