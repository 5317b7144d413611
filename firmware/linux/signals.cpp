// SPDX-License-Identifier: MIT
#include "firmware/linux/signals.hpp"

#include <signal.h>

#include <initializer_list>

namespace armsig::daemon {
namespace {

volatile std::sig_atomic_t caught = 0;

void set_action(int number, void (*handler)(int)) {
  struct sigaction action{};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigfillset(&action.sa_mask);
  (void)::sigaction(number, &action, nullptr);
}

}  // namespace

const volatile std::sig_atomic_t& catch_signals() {
  for (const int number : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM, SIGVTALRM,
                           SIGPROF, SIGPOLL, SIGPWR, SIGXCPU, SIGSTKFLT}) {
    set_action(number, [](int signal) { caught = signal; });
  }
  for (int number = SIGRTMIN; number <= SIGRTMAX; ++number) {
    set_action(number, [](int signal) { caught = signal; });
  }
  // A write beyond a limit of the file system fails with EFBIG instead, and is told.
  for (const int number : {SIGPIPE, SIGXFSZ, SIGTSTP, SIGTTIN, SIGTTOU}) {
    set_action(number, SIG_IGN);
  }
  return caught;
}

}  // namespace armsig::daemon
