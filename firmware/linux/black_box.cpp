// SPDX-License-Identifier: MIT
#include "firmware/linux/black_box.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <system_error>

#include <fmt/format.h>

#include "core/base/error_name.hpp"
#include "core/base/pose.hpp"
#include "firmware/controller/fault_words.hpp"
#include "firmware/controller/text.hpp"

namespace armsig::daemon {
namespace {

constexpr std::string_view kPrefix = "black-box-";
// Of one recording, whatever the period: 16 MiB with every joint.
constexpr std::size_t kMostRows = 100'000;

std::size_t ticks_in(hal::Duration time, hal::Duration period) {
  return std::clamp<std::size_t>(static_cast<std::size_t>(time / period), 1, kMostRows);
}

// UTC, in the order of which names sort.
std::string stamp() {
  const time_t now = ::time(nullptr);
  tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  (void)std::strftime(text.data(), text.size(), "%Y%m%dT%H%M%SZ", &utc);
  return text.data();
}

std::string on_one_line(std::string text) {
  std::ranges::replace_if(text, [](char c) { return static_cast<unsigned char>(c) < 0x20; }, '?');
  return text;
}

std::string words_of(const controller::Fault& fault) {
  controller::Line line;
  line.text(name(fault.error));
  if (fault.joint) line.text(" joint=").integer(*fault.joint + 1);
  line.device_object(fault.object);
  controller::tell_words(line, fault);
  line.text(": ").text(describe(fault.error));
  return std::string(line.view());
}

}  // namespace

BlackBox::BlackBox(const BlackBoxConfiguration& configuration, Journal& journal)
    : configuration_(configuration), journal_(journal) {
  const std::size_t ticks =
      ticks_in(configuration.before + configuration.after, configuration.period);
  for (Recording& recording : recordings_) recording.rows.resize(ticks);
}

void BlackBox::add(Recording& recording, const controller::Snapshot& snapshot,
                   hal::Duration lateness) const {
  Row& row = recording.rows[recording.next];
  row.at = snapshot.now;
  row.lateness = lateness;
  row.mode = snapshot.mode;
  row.limits_active = snapshot.limits_active;
  row.known = snapshot.known;
  for (std::size_t i = 0; i < configuration_.joints.size(); ++i) {
    row.actual[i] = snapshot.positions[i];
    row.commanded[i] = snapshot.commanded[i];
    row.status_words[i] = snapshot.status_words[i];
  }
  recording.next = (recording.next + 1) % recording.rows.size();
  recording.count = std::min(recording.count + 1, recording.rows.size());
}

void BlackBox::do_take(const controller::Snapshot& snapshot, hal::Duration lateness) {
  Recording& recording = recordings_[filling_];
  add(recording, snapshot, lateness);
  const bool faulted = snapshot.mode == controller::Mode::kFaulted;
  if (faulted && !was_faulted_ && left_ == 0) {
    recording.fault_at = snapshot.now;
    left_ = 1 + ticks_in(configuration_.after, configuration_.period);
  }
  was_faulted_ = faulted;
  if (left_ == 0) return;
  if (snapshot.fault) recording.fault = *snapshot.fault;  // its reason may come later
  if (--left_ > 0) return;
  if (complete_.load(std::memory_order_acquire) >= 0) {
    ++missed_;
    return;
  }
  complete_.store(static_cast<int>(filling_), std::memory_order_release);
  filling_ = 1 - filling_;
  recordings_[filling_].next = recordings_[filling_].count = 0;
}

void BlackBox::write_if_due() {
  const unsigned missed = missed_;
  if (missed != told_missed_) {
    journal_.tell(
        Priority::kWarning,
        fmt::format("black box: {} faults came too fast to be written", missed - told_missed_));
    told_missed_ = missed;
  }
  const int complete = complete_.load(std::memory_order_acquire);
  if (complete < 0) return;
  const std::string base = configuration_.folder + "/" + std::string(kPrefix) + stamp();
  std::string path;
  ::mkdir(configuration_.folder.c_str(), 0750);
  int result = EEXIST;
  for (int i = 1; result == EEXIST && i < 100; ++i) {
    path = fmt::format("{}-{:02}.csv", base, i);
    result = write(recordings_[static_cast<std::size_t>(complete)], path);
  }
  complete_.store(-1, std::memory_order_release);
  if (result != 0) {
    journal_.tell(Priority::kWarning,
                  fmt::format("black box: {}: {}", path, std::strerror(result)));
    return;
  }
  journal_.tell(Priority::kNotice, "black box: " + path);
  Path& told = last_file_.writing();
  told.clear();
  for (const char c : path) {
    if (!told.full()) told.push_back(c);
  }
  last_file_.publish();
  remove_old_files();
}

int BlackBox::write(const Recording& recording, const std::string& path) const {
  const int descriptor =
      ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0640);
  if (descriptor < 0) return errno;
  std::FILE* const file = ::fdopen(descriptor, "w");
  if (file == nullptr) {
    const int reason = errno;
    ::close(descriptor);
    ::unlink(path.c_str());
    return reason;
  }
  int reason = 0;
  try {
    print(recording, file);
  } catch (const std::system_error& error) {  // fmt's, where the file takes no more
    reason = error.code().value();
  } catch (const std::bad_alloc&) {
    reason = ENOMEM;
  }
  if (std::fclose(file) != 0 && reason == 0) reason = errno;
  if (reason != 0) ::unlink(path.c_str());
  return reason;
}

// Columns as docs/formats.md names quantities: the unit in the name.
void BlackBox::print(const Recording& recording, std::FILE* file) const {
  fmt::print(file, "# armsigd black box of {}, written {}\n# fault: {}\n",
             on_one_line(configuration_.name), stamp(), words_of(recording.fault));
  fmt::print(file, "# t_s is of the tick in which it was seen; statuswords are CiA 402's\n");
  fmt::print(file, "t_s,mode,late_us");
  for (std::size_t i = 0; i < configuration_.joints.size(); ++i) {
    const bool turns = configuration_.joints[i] == JointType::kRevolute;
    fmt::print(file, ",q{0}_{1},q{0}_commanded_{1},q{0}_statusword,q{0}_limited", i + 1,
               turns ? "deg" : "mm");
  }
  fmt::print(file, "\n");
  const std::size_t size = recording.rows.size();
  for (std::size_t k = 0; k < recording.count; ++k) {
    const Row& row = recording.rows[(recording.next + size - recording.count + k) % size];
    fmt::print(file, "{:.6f},{},{:.1f}", hal::seconds(row.at - recording.fault_at), name(row.mode),
               1e6 * hal::seconds(row.lateness));
    for (std::size_t i = 0; i < configuration_.joints.size(); ++i) {
      const bool turns = configuration_.joints[i] == JointType::kRevolute;
      const auto told = [&](double reading) { return turns ? degrees(reading) : 1e3 * reading; };
      if ((row.known >> i & 1) == 0) {
        fmt::print(file, ",,");  // nor was there anything to command
      } else {
        fmt::print(file, ",{:.5f},{:.5f}", told(row.actual[i]), told(row.commanded[i]));
      }
      fmt::print(file, ",0x{:04X},{}", row.status_words[i], row.limits_active >> i & 1);
    }
    fmt::print(file, "\n");
  }
}

void BlackBox::remove_old_files() const {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(configuration_.folder, ignored)) {
    const std::string file = entry.path().filename().string();
    if (file.starts_with(kPrefix) && file.ends_with(".csv")) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (std::size_t i = 0; i + kMostFiles < files.size(); ++i) {
    std::filesystem::remove(files[i], ignored);
  }
}

}  // namespace armsig::daemon
