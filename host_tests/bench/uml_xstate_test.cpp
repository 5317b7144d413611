// SPDX-License-Identifier: MIT
// The overlay against a host that takes extended states as Linux does: whole ones only.
#include <cerrno>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "toolchain/uml/xstate_overlay.hpp"

namespace armsig::uml {
namespace {

constexpr pid_t kProcess = 42;
void* const kXstate = reinterpret_cast<void*>(std::size_t{NT_X86_XSTATE});

// The extended state of one process, as the host keeps it.
struct Host {
  std::vector<std::uint8_t> state;
  std::vector<int> requests;
  bool refuses_to_read = false;
};
Host host;

long fake_ptrace(const PtraceCall& call) {
  host.requests.push_back(call.request);
  if (call.request == PTRACE_PEEKUSER) return 0x1234;
  EXPECT_EQ(call.process, kProcess);
  EXPECT_EQ(call.address, kXstate);
  auto& given = *static_cast<iovec*>(call.data);
  if (call.request == PTRACE_GETREGSET) {
    if (host.refuses_to_read) return errno = ESRCH, -1;
    given.iov_len = std::min(given.iov_len, host.state.size());
    std::memcpy(given.iov_base, host.state.data(), given.iov_len);
    return 0;
  }
  if (given.iov_len != host.state.size()) return errno = EFAULT, -1;
  std::memcpy(host.state.data(), given.iov_base, given.iov_len);
  return 0;
}

// Sets the first `bytes` of the state to 7.
long set_part(std::size_t bytes) {
  std::vector<std::uint8_t> part(bytes, 7);
  iovec given{.iov_base = part.data(), .iov_len = part.size()};
  const long result = with_whole_xstate({PTRACE_SETREGSET, kProcess, kXstate, &given}, fake_ptrace);
  EXPECT_EQ(given.iov_base, part.data()) << "the caller's own is left alone";
  EXPECT_EQ(given.iov_len, bytes);
  return result;
}

TEST(UmlXstate, a_part_is_laid_over_the_beginning_of_the_whole_state) {
  constexpr std::size_t kPart = 2696;
  constexpr std::size_t kWhole = 11008;
  host = {.state = std::vector<std::uint8_t>(kWhole, 1), .requests = {}};
  EXPECT_EQ(set_part(kPart), 0);
  for (std::size_t i = 0; i < kWhole; ++i) ASSERT_EQ(host.state[i], i < kPart ? 7 : 1) << i;
  EXPECT_EQ(host.requests, (std::vector<int>{PTRACE_GETREGSET, PTRACE_SETREGSET}));
}

TEST(UmlXstate, a_second_process_gets_nothing_of_the_first) {
  host = {.state = std::vector<std::uint8_t>(11008, 1), .requests = {}};
  EXPECT_EQ(set_part(2696), 0);
  host = {.state = std::vector<std::uint8_t>(11008, 2), .requests = {}};
  EXPECT_EQ(set_part(100), 0);
  EXPECT_EQ(host.state[99], 7);
  EXPECT_EQ(host.state[100], 2);
}

TEST(UmlXstate, a_whole_state_passes_as_it_is) {
  host = {.state = std::vector<std::uint8_t>(2696, 1), .requests = {}};
  EXPECT_EQ(set_part(2696), 0);
  EXPECT_EQ(host.state, std::vector<std::uint8_t>(2696, 7));
}

TEST(UmlXstate, what_the_host_refuses_is_refused) {
  host = {.state = std::vector<std::uint8_t>(2696, 1), .requests = {}};
  EXPECT_EQ(set_part(3000), -1) << "more than there is";
  host.refuses_to_read = true;
  EXPECT_EQ(set_part(100), -1);
  EXPECT_EQ(host.state, std::vector<std::uint8_t>(2696, 1));
}

TEST(UmlXstate, every_other_request_passes_with_its_value) {
  host = {};
  EXPECT_EQ(with_whole_xstate({PTRACE_PEEKUSER, kProcess, nullptr, nullptr}, fake_ptrace), 0x1234);
  EXPECT_EQ(host.requests, (std::vector<int>{PTRACE_PEEKUSER}));
  host = {.state = std::vector<std::uint8_t>(300, 1), .requests = {}};
  std::vector<std::uint8_t> part(100, 7);
  iovec given{.iov_base = part.data(), .iov_len = part.size()};
  EXPECT_EQ(with_whole_xstate({PTRACE_GETREGSET, kProcess, kXstate, &given}, fake_ptrace), 0);
  EXPECT_EQ(host.requests, (std::vector<int>{PTRACE_GETREGSET}));
  EXPECT_EQ(part, std::vector<std::uint8_t>(100, 1));
}

}  // namespace
}  // namespace armsig::uml
