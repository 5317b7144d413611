// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/terminal.hpp"

#include <histedit.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>
#include <utility>

#include "firmware/formats/wrapping.hpp"

namespace armsig::tool {
namespace {

constexpr int kMostLines = 500;  // of history

// What all of `words` begin with.
std::string common_begin(const std::vector<std::string>& words) {
  std::string common = words.front();
  for (const std::string& word : words) {
    const auto differ = std::ranges::mismatch(common, word).in1;
    common.erase(differ, common.end());
  }
  return common;
}

std::string in_columns(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : "  ") + word;
  return paragraph(text, 0);
}

}  // namespace

class Terminal::Library {
 public:
  Library(std::string prompt, int descriptor, Complete complete, Hear hear, std::string file)
      : prompt_(std::move(prompt)),
        descriptor_(descriptor),
        complete_(std::move(complete)),
        hear_(std::move(hear)),
        file_(std::move(file)),
        edit_(::el_init("armsig", stdin, stdout, stderr)),
        history_(::history_init()) {
    HistEvent event{};
    ::history(history_, &event, H_SETSIZE, kMostLines);
    ::history(history_, &event, H_SETUNIQUE, 1);
    if (!file_.empty()) ::history(history_, &event, H_LOAD, file_.c_str());
    ::el_set(edit_, EL_CLIENTDATA, this);
    ::el_set(edit_, EL_EDITOR, "emacs");
    ::el_set(edit_, EL_SIGNAL, 1);  // whoever ends this process leaves the terminal as it was
    ::el_set(edit_, EL_SETTY, "-d", "-isig", nullptr);
    ::el_set(edit_, EL_BIND, "^C", "em-kill-line", nullptr);
    ::el_set(edit_, EL_PROMPT, &Library::prompt);
    ::el_set(edit_, EL_HIST, ::history, history_);
    ::el_set(edit_, EL_GETCFN, &Library::next_key);
    ::el_set(edit_, EL_ADDFN, "armsig-complete", "completes a word", &Library::complete);
    ::el_set(edit_, EL_BIND, "^I", "armsig-complete", nullptr);
  }
  ~Library() {
    HistEvent event{};
    if (!file_.empty()) ::history(history_, &event, H_SAVE, file_.c_str());
    ::history_end(history_);
    ::el_end(edit_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  std::optional<std::string> read_line() {
    // Before the prompt: libedit itself shows it first, and keys that came then would be the
    // terminal's own.
    ::el_set(edit_, EL_PREP_TERM, 1);
    int length = 0;
    const char* const text = ::el_gets(edit_, &length);
    if (text == nullptr || length <= 0) {
      (void)std::fputs("\r\033[K", stdout);
      return std::nullopt;
    }
    std::string line(text, static_cast<std::size_t>(length));
    while (line.ends_with('\n') || line.ends_with('\r')) line.pop_back();
    HistEvent event{};
    if (!line.empty()) ::history(history_, &event, H_ENTER, line.c_str());
    return line;
  }

 private:
  static Library& of(EditLine* edit) {
    void* self = nullptr;
    ::el_get(edit, EL_CLIENTDATA, &self);
    return *static_cast<Library*>(self);
  }
  static char* prompt(EditLine* edit) { return of(edit).prompt_.data(); }

  // What libedit asks for each key: its number of characters, 0 at the end.
  static int next_key(EditLine* edit, wchar_t* key) { return of(edit).wait_for_key(*key); }

  // False where the talk has ended.
  bool hear() {
    const auto said = hear_();
    if (!said) return false;
    if (said->empty()) return true;
    (void)std::fputs("\r\033[K", stdout);
    Terminal::print(*said);
    ::el_set(edit_, EL_REFRESH);
    return true;
  }

  // Requests are ASCII: other bytes are no keys.
  int wait_for_key(wchar_t& key) {
    for (;;) {
      std::array<pollfd, 2> ready{pollfd{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0},
                                  pollfd{.fd = descriptor_, .events = POLLIN, .revents = 0}};
      if (::poll(ready.data(), ready.size(), -1) < 0) {
        if (errno == EINTR) continue;
        return 0;
      }
      if (ready[1].revents != 0 && !hear()) return 0;
      if (ready[0].revents == 0) continue;
      unsigned char byte = 0;
      const ssize_t count = ::read(STDIN_FILENO, &byte, 1);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return 0;
      if (byte >= 0x80) continue;
      key = byte;
      return 1;
    }
  }

  static unsigned char complete(EditLine* edit, int /*key*/) {
    Library& self = of(edit);
    const LineInfo* const line = ::el_line(edit);
    const std::string_view before(line->buffer,
                                  static_cast<std::size_t>(line->cursor - line->buffer));
    const std::size_t blank = before.find_last_of(" \t");
    const std::size_t begun = before.size() - (blank == std::string_view::npos ? 0 : blank + 1);
    const std::vector<std::string> words = self.complete_(before);
    if (words.empty()) return CC_ERROR;
    std::string further = common_begin(words).substr(begun);
    if (words.size() == 1 && !words.front().ends_with('=')) further += ' ';
    if (further.empty()) {
      (void)std::fputs(("\r\n" + in_columns(words)).c_str(), stdout);
      return CC_REDISPLAY;
    }
    return ::el_insertstr(edit, further.c_str()) < 0 ? CC_ERROR : CC_REFRESH;
  }

  std::string prompt_;
  int descriptor_;
  Complete complete_;
  Hear hear_;
  std::string file_;
  EditLine* edit_;
  History* history_;
};

Terminal::Terminal(std::string prompt, int descriptor, Complete complete, Hear hear,
                   std::string history_file)
    : library_(std::make_unique<Library>(std::move(prompt), descriptor, std::move(complete),
                                         std::move(hear), std::move(history_file))) {}
Terminal::~Terminal() = default;

std::optional<std::string> Terminal::read_line() { return library_->read_line(); }

void Terminal::print(std::string_view text) {
  (void)std::fwrite(text.data(), 1, text.size(), stdout);
  (void)std::fflush(stdout);
}

std::string console_history_file() {
  // The environment of a person's shell, read before any thread is begun.
  const char* const state = std::getenv("XDG_STATE_HOME");  // NOLINT(concurrency-mt-unsafe)
  const char* const home = std::getenv("HOME");             // NOLINT(concurrency-mt-unsafe)
  std::filesystem::path folder;
  if (state != nullptr && *state == '/') {
    folder = state;
  } else if (home != nullptr && *home == '/') {
    folder = std::filesystem::path(home) / ".local" / "state";
  } else {
    return {};
  }
  folder /= "armsig";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return error ? std::string() : (folder / "console").string();
}

}  // namespace armsig::tool
