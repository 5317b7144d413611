// SPDX-License-Identifier: MIT
// Touches by request (docs/without-a-tracker.md): `touch place=A1` keeps the readings of an arm
// that stands, led by hand or held after a move, `drop-touch` takes the last one back, `touches`
// counts them. Beside the controller, which knows nothing of it.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "firmware/controller/background.hpp"
#include "firmware/controller/text.hpp"
#include "firmware/linux/touch_file.hpp"
#include "hal/console.hpp"
#include "hal/mailbox.hpp"

namespace armsig::daemon {

struct TouchVerb {
  std::string_view name;
  std::string_view help;
  controller::Modes modes = controller::kInAnyMode;
  bool only_asks = false;
};
[[nodiscard]] std::span<const TouchVerb> touch_verbs();
// Null if there is none.
[[nodiscard]] const TouchVerb* find_touch_verb(std::string_view name);

// The first functions are of the background's thread and never wait; write_if_due() is of one that
// may.
class TouchRecorder {
 public:
  // `configuration` outlives it.
  TouchRecorder(const controller::Configuration& configuration, const TouchFiles& files);

  // From now on, before the first request. `background` is stepped by the thread of serve().
  void attend(const controller::Background& background) { background_ = &background; }

  // Answers `client` of `console`, which outlives this: at once where the request is refused,
  // otherwise when the arm has stood long enough, and the disk is done.
  void serve(const TouchVerb& verb, const controller::Request& request, hal::Console& console,
             hal::ConsoleClient client);
  // Looks at the arm, and answers what is done. To be called whenever a console is read.
  void step();

  // Does what was asked for with the file.
  void write_if_due();

 private:
  using Place = FixedVector<char, kLongestPlace>;
  // 64 places, of the plan and of the file, and what is before them.
  using ReplyText = FixedVector<char, 3072>;

  struct Client {
    hal::Console* console = nullptr;
    hal::ConsoleClient id = 0;
  };
  struct Job {
    Client client;
    const TouchVerb* verb = nullptr;
    Place place;
    JointVector readings;
  };
  struct Reply {
    Client client;
    ReplyText text;
  };
  // A touch whose arm is being looked at.
  struct Look {
    Client client;
    const TouchVerb* verb = nullptr;
    Place place;
    hal::Instant began;
    hal::Instant last;
    JointVector first;  // readings
    JointVector sum;
    unsigned count = 0;
    unsigned idle_steps = 0;  // without a new tick
  };

  // Errors: those of a `touch` that an arm does not permit; what they are about goes to `out`.
  [[nodiscard]] Result<void> may_touch(const TouchVerb& verb, controller::Line& out) const;
  [[nodiscard]] Result<void> begin_look(const TouchVerb& verb, const controller::Request& request,
                                        const Client& client, controller::Line& out);
  // True when the arm has stood long enough.
  [[nodiscard]] Result<bool> look(controller::Line& out);
  [[nodiscard]] Result<void> post(const Job& job);
  static void refuse(const Client& client, Error error, const controller::Line& out);

  const controller::Configuration& configuration_;
  TouchFile file_;
  const controller::Background* background_ = nullptr;
  std::optional<Look> look_;
  hal::Mailbox<Job, 8> jobs_;
  hal::Mailbox<Reply, 8> replies_;
  std::optional<Reply> unposted_;  // of the thread that writes
};

}  // namespace armsig::daemon
