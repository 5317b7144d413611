// SPDX-License-Identifier: MIT
// armsigd as its operator meets it: --check, and a whole identification about the emulated arm.
#include <sys/stat.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "host_tests/cli/run_tool.hpp"
#include "host_tests/unit_daemon/virtual_daemon.hpp"

namespace armsig::cli {
namespace {

Outcome run_daemon(const Folder& folder, const std::string& arguments) {
  const std::string command = "cd '" + folder.path().string() +
                              "' && timeout 20 '" ARMSIG_DAEMON "' " + arguments +
                              " >.out 2>.err </dev/null";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  return {WIFEXITED(raw) ? WEXITSTATUS(raw) : -1, read_file(folder / ".out"),
          read_file(folder / ".err")};
}

TEST(Daemon, checks_a_configuration_without_opening_anything) {
  const Folder folder;
  const Outcome outcome = run_daemon(folder, "--check '" ARMSIG_REFERENCE "'");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("6 joints at 500 Hz on can0"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("252 vertices"), std::string::npos) << outcome.out;
}

TEST(Daemon, looks_at_no_drives_where_the_interface_is_not_there) {
  const Folder folder;
  std::string text = read_file(ARMSIG_REFERENCE);
  text.replace(text.find("interface: can0"), 15, "interface: none");
  write_file(folder / "cabinet.yaml", text);
  const Outcome outcome = run_daemon(folder, "--drives cabinet.yaml");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "armsigd: none: the CAN interface is down or gone\n");
}

TEST(Daemon, refuses_a_wrong_configuration_with_its_place_and_status_2) {
  const Folder folder;
  std::string text = read_file(ARMSIG_REFERENCE);
  text.replace(text.find("node: 2"), 7, "node: 1");
  write_file(folder / "cabinet.yaml", text);
  for (const char* option : {"--check", "--drives", "--virtual", ""}) {
    const Outcome outcome = run_daemon(folder, std::string("cabinet.yaml ") + option);
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_NE(outcome.err.find("cabinet.yaml:"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("node 1"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << "one line, please";
  }
}

void expect_not_opened(const Folder& folder, const std::string& store, const std::string& console,
                       const std::string& words) {
  const Outcome outcome = run_daemon(
      folder, "'" ARMSIG_REFERENCE "' --store '" + store + "' --console '" + console + "'");
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.err, "armsigd: " + words + "\n");
}

TEST(Daemon, says_why_it_cannot_open_its_store_or_its_console) {
  const Folder folder;
  std::filesystem::create_directory(folder / "folder");
  write_file(folder / "text", "no socket");
  expect_not_opened(folder, "/nonexistent/store", "c",
                    "/nonexistent/store: the folder /nonexistent is not there");
  expect_not_opened(folder, "folder", "c", "folder: a folder is there");
  expect_not_opened(folder, "s", "/nonexistent/c",
                    "/nonexistent/c: the folder /nonexistent is not there");
  expect_not_opened(folder, "s", "text", "text: what is there is no socket");
  const std::string far(120, 'f');
  expect_not_opened(folder, "s", far,
                    far + ": the path of a socket has at most 107 bytes, this one 120");
}

TEST(Daemon, says_that_another_has_its_store_or_its_console) {
  const Folder folder;
  const VirtualDaemon running(folder, "1");
  expect_not_opened(folder, "store", "c", "store: in use: is another armsigd running?");
  expect_not_opened(folder, "s", "console", "console: in use: is another armsigd running?");
}

TEST(Daemon, names_what_is_wrong_with_its_command_line) {
  const Folder folder;
  const auto expect_words = [&](const std::string& arguments, const std::string& words) {
    const Outcome outcome = run_daemon(folder, arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_EQ(outcome.err, "armsigd: " + words + "\n");
    EXPECT_EQ(outcome.out, "");
  };
  expect_words("--virtaul c.yaml", "armsigd has no option \"--virtaul\"; expected --virtual");
  expect_words("c.yaml --virtual --speed -1",
               "--speed: \"-1\" is out of its range; expected 0 or more");
  expect_words("--check", "configuration is required; expected what armsigd --help says");
}

TEST(Daemon, has_a_console_for_its_group_and_nobody_else) {
  const Folder folder;
  VirtualDaemon daemon(folder);
  struct stat status{};
  ASSERT_EQ(::stat(daemon.console_path().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0660U);
  EXPECT_EQ(daemon.end(SIGTERM), 0);
}

// end() is 0 where the process ended of its own accord, after its stop.
TEST(Daemon, brings_the_arm_to_rest_at_every_signal_that_can_be_caught) {
  const Folder folder;
  VirtualDaemon daemon(folder);
  for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGUSR1, SIGALRM, SIGXCPU, SIGRTMIN + 3}) {
    EXPECT_EQ(daemon.end(signal), 0) << signal;
    daemon.start();
  }
  for (const int signal : {SIGPIPE, SIGTSTP, SIGXFSZ}) {
    EXPECT_TRUE(daemon.survives(signal)) << signal;
  }
  EXPECT_EQ(daemon.end(SIGTERM), 0);
}

// At 20 times real time, so that the half second after the fault is soon over.
TEST(Daemon, keeps_the_seconds_before_a_fault_in_a_file_that_status_names) {
  const Folder folder;
  VirtualDaemon daemon(folder, "20");
  ASSERT_TRUE(daemon.is_in("idle"));
  EXPECT_EQ(daemon.ask("status").find("black_box="), std::string::npos);
  EXPECT_EQ(daemon.ask("enable"), "ok");
  ASSERT_TRUE(daemon.is_in("holding"));
  EXPECT_EQ(daemon.ask("move q1_deg=60"), "ok");
  ASSERT_TRUE(daemon.is_in("servoing"));
  EXPECT_EQ(daemon.ask("stop"), "ok");
  std::string status;
  std::size_t at = std::string::npos;
  for (int i = 0; i < 500 && at == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    status = daemon.ask("status");
    at = status.find(" black_box=");
  }
  ASSERT_NE(at, std::string::npos) << status;
  const std::string path = status.substr(at + 11, status.find(' ', at + 1) - at - 11);
  EXPECT_EQ(std::filesystem::path(path).parent_path(), folder / "black-box");
  const std::string text = read_file(path);
  EXPECT_NE(text.find("# fault: QUICK_STOP: "), std::string::npos) << text.substr(0, 300);
  EXPECT_NE(text.find(",servoing,"), std::string::npos);
  EXPECT_NE(text.find("\n0.000000,faulted,"), std::string::npos);
}

TEST(Daemon, answers_armsig_connect) {
  const Folder folder;
  VirtualDaemon daemon(folder, "1");
  ASSERT_TRUE(daemon.is_in("idle"));
  write_file(folder / "requests", "status\nmove q1_deg=5\n");
  const std::string command = "cd '" + folder.path().string() +
                              "' && '" ARMSIG_TOOL "' connect console <requests >.out 2>.err";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  EXPECT_EQ(WEXITSTATUS(raw), 1);
  const std::string out = read_file(folder / ".out");
  EXPECT_TRUE(out.starts_with("ok mode=idle")) << out;
  EXPECT_NE(out.find("\nerror WRONG_MODE "), std::string::npos) << out;
}

// As what reports meets it: it may ask, and it hears what an operator does at the other console.
TEST(Daemon, lets_what_reports_ask_and_hear_at_a_socket_of_its_own_and_move_nothing) {
  const Folder folder;
  const std::string reporting = (folder / "report").string();
  write_file(folder / "cabinet.yaml",
             read_file(ARMSIG_REFERENCE) + "reporting_console: " + reporting + "\n");
  test::ConsoleProcess reporter(
      {ARMSIG_DAEMON, (folder / "cabinet.yaml").string(), "--virtual", "--console",
       (folder / "console").string(), "--store", (folder / "store").string(), "--speed", "1"},
      reporting);
  ASSERT_TRUE(reporter.is_in("idle"));
  EXPECT_TRUE(reporter.ask("enable").starts_with("error NOT_PERMITTED "));
  EXPECT_TRUE(reporter.ask("stop").starts_with("error NOT_PERMITTED "));
  const std::string command = "cd '" + folder.path().string() +
                              "' && '" ARMSIG_TOOL "' connect console enable --wait >.out 2>.err";
  const int raw = std::system(command.c_str());  // NOLINT(cert-env33-c): our own command line
  EXPECT_EQ(WEXITSTATUS(raw), 0) << read_file(folder / ".err");
  EXPECT_TRUE(reporter.is_in("holding"));
  EXPECT_TRUE(reporter.ask("fetch what=nominal part=1").starts_with("ok bytes="));
}

TEST(Daemon, identifies_the_emulated_arm_and_knows_it_after_it_was_killed) {
  const Folder folder;
  {
    VirtualDaemon daemon(folder);
    ASSERT_TRUE(daemon.is_in("idle"));
    EXPECT_EQ(daemon.ask("signature"), "ok model=nominal");
    EXPECT_EQ(daemon.ask("enable"), "ok");
    ASSERT_TRUE(daemon.is_in("holding"));
    EXPECT_EQ(daemon.ask("identify"), "ok");
    ASSERT_TRUE(daemon.hear("# identify done"));
    ASSERT_TRUE(daemon.is_in("holding"));
    EXPECT_NE(daemon.ask("candidate").find("better=yes"), std::string::npos);
    EXPECT_EQ(daemon.ask("accept"), "ok");
    EXPECT_TRUE(daemon.ask("signature").starts_with("ok model=signature signature=1"));
    EXPECT_EQ(daemon.end(SIGKILL), -1);
  }
  VirtualDaemon daemon(folder);
  EXPECT_TRUE(daemon.ask("signature").starts_with("ok model=signature signature=1"));
  EXPECT_EQ(daemon.end(SIGTERM), 0);
}

// The Puma 560 of the reference, all of its lengths 3.3 times as large: it reaches 3 m.
std::string large_arm() {
  std::string text = read_file(ARMSIG_REFERENCE);
  text = text.substr(0, text.find("\ngrid:") + 1);
  for (const auto& [from, to] : std::initializer_list<std::pair<std::string, std::string>>{
           {"149.09", "492"},
           {"431.8", "1425"},
           {"-20.32", "-67"},
           {"430.7", "1421"},
           {"floor_mm: 672", "floor_mm: 2218"}}) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  }
  return text;
}

TEST(Daemon, identifies_an_emulated_arm_that_is_larger_than_the_frame_of_its_receivers) {
  const Folder folder;
  write_file(folder / "large.yaml", large_arm());
  VirtualDaemon daemon(folder, "0", {}, (folder / "large.yaml").string());
  ASSERT_TRUE(daemon.is_in("idle"));
  EXPECT_EQ(daemon.ask("enable"), "ok");
  ASSERT_TRUE(daemon.is_in("holding"));
  EXPECT_EQ(daemon.ask("identify"), "ok");
  ASSERT_TRUE(daemon.hear("# identify done"));
  EXPECT_NE(daemon.ask("candidate").find("better=yes"), std::string::npos);
}

// The arm of docs/self-calibration.md, as its operator meets it.
TEST(Daemon, refines_until_the_accuracy_is_reached_that_was_asked_for) {
  const Folder folder;
  VirtualDaemon daemon(folder, "0",
                       {"--maps-deg", "0.02", "--deflection-mm", "0.5", "--backlash-deg", "0.005"});
  ASSERT_TRUE(daemon.is_in("idle"));
  EXPECT_EQ(daemon.ask("enable"), "ok");
  ASSERT_TRUE(daemon.is_in("holding"));
  EXPECT_EQ(daemon.ask("identify accuracy_mm=0.15 minutes=240"), "ok");
  ASSERT_TRUE(daemon.hear("# identify accuracy=reached model=maps "));
  ASSERT_TRUE(daemon.hear("# identify backlash q1_deg="));
  ASSERT_TRUE(daemon.hear("# identify done"));
  ASSERT_TRUE(daemon.is_in("holding"));
  EXPECT_NE(daemon.ask("candidate").find("better=yes"), std::string::npos);
  EXPECT_EQ(daemon.ask("accept"), "ok");
  EXPECT_NE(daemon.ask("status").find(" maps=yes "), std::string::npos);
  EXPECT_EQ(daemon.end(SIGTERM), 0);
}

}  // namespace
}  // namespace armsig::cli
