// SPDX-License-Identifier: MIT
// One time for every process of the bench, which stands still while the host starves one of them.
//
// A library to be preloaded (LD_PRELOAD). All processes that are given the same file in
// ARMSIG_COMMON_TIME share a clock: the host's monotonic one less the time that it stood still. A
// thread that sleeps until a time (clock_nanosleep, absolute: a control loop) is a member, until it
// waits for anything else: the clock never gets further than kLag ahead of a member's wake-up
// before that member has had its turn and sleeps again. So what the bench shows depends on the code
// and not on how busy the host is. Time stamps of received frames are converted. Where every
// member is in time, which is so on a host with time to spare, the clock is the host's.
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace {

using Nanoseconds = std::int64_t;

constexpr Nanoseconds kSecond = 1'000'000'000;
// Longer than the turn of a controller, which ends its computing by this clock; shorter than any
// time-out of the bench.
constexpr Nanoseconds kLag = 40'000'000;
// A member for whom others looked at the standing clock so often waits for them, in a way that is
// not known here. Whether it was killed is asked more often.
constexpr unsigned kPatience = 4096;
// A member that keeps looking itself computes until this clock says that it is enough.
constexpr unsigned kOwnLook = kPatience / 16;
constexpr unsigned kAsk = 16;

constexpr std::size_t kMembers = 32;
constexpr std::size_t kStops = 64;

struct Member {
  pid_t process = 0;
  pid_t thread = 0;     // 0: a free place
  bool lost = false;    // no longer waited for, until it sleeps again
  Nanoseconds due = 0;  // common time of its next or last wake-up
  unsigned waited = 0;  // looks at a clock that stood still for it
};

// From common time `at` on, the clock is `behind` the host's.
struct Stop {
  Nanoseconds at = 0;
  Nanoseconds behind = 0;
};

struct Page {
  bool made = false;
  pthread_mutex_t mutex{};
  Nanoseconds last = 0;
  Nanoseconds wall = 0;  // CLOCK_REALTIME is this much ahead
  std::array<Member, kMembers> members{};
  std::array<Stop, kStops> stops{};  // a ring; the last is the one in force
  std::size_t stop = 0;
};

Nanoseconds host_time(clockid_t clock) {
  timespec time{};
  syscall(SYS_clock_gettime, clock, &time);
  return time.tv_sec * kSecond + time.tv_nsec;
}
Nanoseconds nanoseconds(const timespec& time) { return time.tv_sec * kSecond + time.tv_nsec; }
timespec time_of(Nanoseconds since) {
  return {.tv_sec = since / kSecond, .tv_nsec = since % kSecond};
}

// The mutex, which a process that is killed may take with it.
class Lock {
 public:
  explicit Lock(Page& page) : page_(page) {
    if (pthread_mutex_lock(&page_.mutex) == EOWNERDEAD) pthread_mutex_consistent(&page_.mutex);
  }
  ~Lock() { pthread_mutex_unlock(&page_.mutex); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

 private:
  Page& page_;
};

// The first process makes the page while it is alone; nullptr: not asked for.
Page* open_page() {
  const char* const path = std::getenv("ARMSIG_COMMON_TIME");
  if (path == nullptr) return nullptr;
  const int file = ::open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0 || ::ftruncate(file, sizeof(Page)) != 0) return nullptr;
  void* const at = ::mmap(nullptr, sizeof(Page), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  if (at == MAP_FAILED) return nullptr;
  Page* const page = static_cast<Page*>(at);
  if (!page->made) {
    pthread_mutexattr_t attributes{};
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setpshared(&attributes, PTHREAD_PROCESS_SHARED);
    pthread_mutexattr_setrobust(&attributes, PTHREAD_MUTEX_ROBUST);
    pthread_mutex_init(&page->mutex, &attributes);
    page->last = host_time(CLOCK_MONOTONIC);
    page->wall = host_time(CLOCK_REALTIME) - page->last;
    page->made = true;
  }
  return page;
}

Page* page() {
  static Page* const opened = open_page();
  return opened;
}

// This thread's place among the members; kMembers: none. Freed by others where a thread or process
// ends: a destructor would call the heap in a control loop.
constinit thread_local std::size_t place = kMembers;

// The thread sleeps until `due`, or has been woken then. With the lock held.
void take_place(Page& page, Nanoseconds due) {
  for (std::size_t i = 0; place == kMembers && i < kMembers; ++i) {
    if (page.members[i].thread == 0) place = i;
  }
  if (place == kMembers) return;
  page.members[place] = {
      .process = ::getpid(), .thread = ::gettid(), .due = std::max(due, page.last)};
}

void leave_place() {
  if (place == kMembers) return;
  const Lock lock(*page());
  page()->members[place] = {};
  place = kMembers;
}

// The clock stands still for `member`.
void wait_for(Member& member) {
  member.waited += member.thread == ::gettid() ? kOwnLook : 1;
  if (member.waited > kPatience) member.lost = true;
  const bool ask = member.waited % kAsk == 0;
  if (ask && ::tgkill(member.process, member.thread, 0) != 0) member = {};
}

// Common time; the clock stops where the latest member is overdue. With the lock held.
Nanoseconds look(Page& page) {
  const Stop& stop = page.stops[page.stop];
  const Nanoseconds host = host_time(CLOCK_MONOTONIC);
  Nanoseconds time = host - stop.behind;
  Member* latest = nullptr;
  for (Member& member : page.members) {
    const bool waited_for = member.thread != 0 && !member.lost;
    if (waited_for && (latest == nullptr || member.due < latest->due)) latest = &member;
  }
  if (latest != nullptr && time > latest->due + kLag) {
    time = std::max(latest->due + kLag, page.last);
    if (time != stop.at) page.stop = (page.stop + 1) % kStops;
    page.stops[page.stop] = {.at = time, .behind = host - time};
    wait_for(*latest);
  }
  page.last = std::max(page.last, time);
  return page.last;
}

// Common time at a time of the host's that is past.
Nanoseconds common_time(const Page& page, Nanoseconds host) {
  for (std::size_t back = 0; back + 1 < kStops; ++back) {
    const Stop& stop = page.stops[(page.stop + kStops - back) % kStops];
    const Stop& before = page.stops[(page.stop + kStops - back - 1) % kStops];
    if (host - stop.behind >= stop.at) return host - stop.behind;
    if (host - before.behind >= stop.at) return stop.at;
  }
  return host - page.stops[(page.stop + 1) % kStops].behind;
}

int sleep_until(Nanoseconds due, bool as_member) {
  for (;;) {
    Nanoseconds left = 0;
    {
      const Lock lock(*page());
      left = due - look(*page());
      if (as_member) take_place(*page(), due);
    }
    if (left <= 0) return 0;
    const timespec wait = time_of(left);
    if (syscall(SYS_clock_nanosleep, CLOCK_MONOTONIC, 0, &wait, nullptr) != 0) return EINTR;
  }
}

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* time) noexcept {
  const bool shared = clock == CLOCK_MONOTONIC || clock == CLOCK_REALTIME;
  if (!shared || page() == nullptr) {
    return static_cast<int>(syscall(SYS_clock_gettime, clock, time));
  }
  const Lock lock(*page());
  *time = time_of(look(*page()) + (clock == CLOCK_REALTIME ? page()->wall : 0));
  return 0;
}

int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  if (clock != CLOCK_MONOTONIC || flags != TIMER_ABSTIME || page() == nullptr) {
    leave_place();
    return syscall(SYS_clock_nanosleep, clock, flags, time, left) == 0 ? 0 : errno;
  }
  return sleep_until(nanoseconds(*time), true);
}

int nanosleep(const timespec* time, timespec* left) {
  leave_place();
  if (page() == nullptr) return static_cast<int>(syscall(SYS_nanosleep, time, left));
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  while (sleep_until(nanoseconds(now) + nanoseconds(*time), false) != 0) {
  }
  return 0;
}

ssize_t recvmsg(int socket, msghdr* message, int flags) {
  const ssize_t received = syscall(SYS_recvmsg, socket, message, flags);
  if (received < 0 || page() == nullptr) return received;
  for (cmsghdr* part = CMSG_FIRSTHDR(message); part != nullptr; part = CMSG_NXTHDR(message, part)) {
    if (part->cmsg_level != SOL_SOCKET || part->cmsg_type != SO_TIMESTAMPNS) continue;
    timespec stamp{};
    std::memcpy(&stamp, CMSG_DATA(part), sizeof stamp);
    const Nanoseconds wall = host_time(CLOCK_REALTIME) - host_time(CLOCK_MONOTONIC);
    const Lock lock(*page());
    stamp = time_of(common_time(*page(), nanoseconds(stamp) - wall) + page()->wall);
    std::memcpy(CMSG_DATA(part), &stamp, sizeof stamp);
  }
  return received;
}

// What else a thread may wait for: it is no member meanwhile.

int poll(pollfd* files, nfds_t count, int timeout_ms) {
  if (timeout_ms != 0) leave_place();
  return static_cast<int>(syscall(SYS_poll, files, count, timeout_ms));
}

int select(int count, fd_set* readable, fd_set* writable, fd_set* other, timeval* timeout) {
  leave_place();
  return static_cast<int>(syscall(SYS_select, count, readable, writable, other, timeout));
}

pid_t waitpid(pid_t process, int* status, int options) {
  leave_place();
  return static_cast<pid_t>(syscall(SYS_wait4, process, status, options, nullptr));
}

int system(const char* command) {
  leave_place();
  return next<decltype(system)>("system")(command);
}

int pthread_join(pthread_t thread, void** result) {
  leave_place();
  return next<decltype(pthread_join)>("pthread_join")(thread, result);
}

}  // extern "C"
