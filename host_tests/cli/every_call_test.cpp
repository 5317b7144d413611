// SPDX-License-Identifier: MIT
// The command ended, or refused by the system, at every one of its system calls: the file it was to
// write is the old one or the new one, and a refusal is told.
#include <fcntl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>

#include "host_tests/cli/files.hpp"

#if defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)

namespace armsig::cli {
namespace {

// What is done to the call with a number, counted from the first that opens a file of the folder.
enum class Fate : std::uint8_t { kNone, kKilled, kRefused };

struct Traced {
  int status = -1;  // of the exit; -1: ended by a signal
  int signal = 0;
  long calls = 0;  // from the first that opens a file of the folder, those of brk left out
};

[[noreturn]] void become_tool(const Folder& folder, const std::vector<std::string>& words) {
  if (::chdir(folder.path().c_str()) != 0) ::_exit(98);
  const int quiet = ::open("said", O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(quiet, STDOUT_FILENO);
  ::dup2(quiet, STDERR_FILENO);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::ptrace(PTRACE_TRACEME, 0, nullptr, nullptr);
  ::execv(ARMSIG_TOOL, arguments.data());
  ::_exit(99);
}

// The path that a stopped process gives to openat.
std::string path_of(pid_t child, const user_regs_struct& registers) {
  std::string path;
  for (unsigned long long at = registers.rsi; path.size() < 4096; at += sizeof(long)) {
    errno = 0;
    const long word = ::ptrace(PTRACE_PEEKDATA, child, at, nullptr);
    if (errno != 0) return path;
    for (std::size_t i = 0; i < sizeof word; ++i) {
      const auto byte = static_cast<char>(static_cast<unsigned long>(word) >> (8 * i));
      if (byte == '\0') return path;
      path += byte;
    }
  }
  return path;
}

// Runs `words`; the call with the number `chosen` meets its fate.
Traced trace(const Folder& folder, const std::vector<std::string>& words, long chosen, Fate fate) {
  Traced traced;
  const pid_t child = ::fork();
  if (child == 0) become_tool(folder, words);
  int status = 0;
  ::waitpid(child, &status, 0);
  ::ptrace(PTRACE_SETOPTIONS, child, nullptr, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
  bool entering = true;
  bool counting = false;
  bool refuse_now = false;
  for (int forward = 0;;) {
    (void)::ptrace(PTRACE_SYSCALL, child, nullptr, forward);  // refused where it was killed
    forward = 0;
    if (::waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) break;
    if (WSTOPSIG(status) != (SIGTRAP | 0x80)) {
      forward = WSTOPSIG(status);
      continue;
    }
    user_regs_struct registers{};
    ::ptrace(PTRACE_GETREGS, child, nullptr, &registers);
    if (entering) {
      const auto call = static_cast<long>(registers.orig_rax);
      if (call == SYS_openat && words[3] == path_of(child, registers)) counting = true;
      // brk knows no errno: it tells a refusal by the break that stays. mmap stands for both.
      const bool counts = call != SYS_exit_group && call != SYS_brk;
      if (counting && counts && ++traced.calls == chosen) {
        if (fate == Fate::kKilled) ::kill(child, SIGKILL);
        refuse_now = fate == Fate::kRefused;
        if (refuse_now) registers.orig_rax = static_cast<unsigned long long>(-1);
        if (refuse_now) ::ptrace(PTRACE_SETREGS, child, nullptr, &registers);
      }
    } else if (refuse_now) {
      refuse_now = false;
      registers.rax = static_cast<unsigned long long>(-EIO);
      ::ptrace(PTRACE_SETREGS, child, nullptr, &registers);
    }
    entering = !entering;
  }
  if (WIFEXITED(status)) traced.status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) traced.signal = WTERMSIG(status);
  return traced;
}

struct Work {
  // Of the command line; word 3 is the first file that is read, the last the one that is written.
  std::vector<std::string> words;
};

class EveryCall : public testing::TestWithParam<Work> {
 protected:
  void SetUp() override {
    ASSERT_EQ(measure_two_joints(folder_).status, 0);
    write_file(out(), kOld);
    const Traced whole = trace(folder_, GetParam().words, 0, Fate::kNone);
    if (whole.status == 99 || whole.calls == 0) GTEST_SKIP() << "no ptrace here";
    ASSERT_EQ(whole.status, 0) << read_file(folder_ / "said");
    calls_ = whole.calls;
    new_ = read_file(out());
  }
  [[nodiscard]] std::filesystem::path out() const { return folder_ / GetParam().words.back(); }
  // One run on an old file, with one call that meets its fate.
  Traced again(long call, Fate fate) {
    write_file(out(), kOld);
    return trace(folder_, GetParam().words, call, fate);
  }
  // Two signatures of one arm differ in their time.
  [[nodiscard]] bool is_new() const { return read_file(out()).size() == new_.size(); }
  [[nodiscard]] bool is_old() const { return read_file(out()) == kOld; }

  static constexpr const char* kOld = "what stood there before\n";
  Folder folder_;
  std::string new_;
  long calls_ = 0;
};

TEST_P(EveryCall, that_is_the_last_leaves_the_old_file_or_the_new_one) {
  bool saw_old = false;
  bool saw_new = false;
  for (long call = 1; call <= calls_; ++call) {
    const Traced ended = again(call, Fate::kKilled);
    ASSERT_EQ(ended.signal, SIGKILL) << "call " << call;
    ASSERT_TRUE(is_old() || is_new()) << "call " << call << ": " << read_file(out());
    saw_old = saw_old || is_old();
    saw_new = saw_new || is_new();
  }
  EXPECT_TRUE(saw_old);
  EXPECT_TRUE(saw_new);
}

TEST_P(EveryCall, that_fails_is_told_or_does_not_matter) {
  int told = 0;
  for (long call = 1; call <= calls_; ++call) {
    const Traced ended = again(call, Fate::kRefused);
    ASSERT_EQ(ended.signal, 0) << "call " << call;
    ASSERT_TRUE(is_old() || is_new()) << "call " << call << ": " << read_file(out());
    if (ended.status == 0) {
      EXPECT_TRUE(is_new()) << "call " << call;
      continue;
    }
    ++told;
    EXPECT_TRUE(ended.status == 1 || ended.status == 2) << "call " << call;
    EXPECT_NE(read_file(folder_ / "said").find("armsig: "), std::string::npos) << "call " << call;
  }
  EXPECT_GE(told, 4);  // at least: the input opened and read, the output opened and renamed
}

INSTANTIATE_TEST_SUITE_P(, EveryCall,
                         testing::Values(Work{{"armsig", "export", "--signature", "t.yaml",
                                               "--format", "urdf", "--out", "o.urdf"}},
                                         Work{{"armsig", "identify", "--arm", "arm.yaml",
                                               "--measurements", "m.csv", "--out", "s.yaml"}}),
                         [](const auto& work) {
                           return work.index == 0 ? "of_export" : "of_identify";
                         });

}  // namespace
}  // namespace armsig::cli

#endif
