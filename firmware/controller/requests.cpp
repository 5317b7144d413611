// SPDX-License-Identifier: MIT
// The requests of the console: what each verb does.
#include "firmware/controller/background.hpp"
#include "firmware/controller/fetching.hpp"

namespace armsig::controller {
namespace {

constexpr std::string_view kVerbs =
    " verbs=status,enable,disable,reset,stop,halt,move,identify,pause,resume,candidate,accept,"
    "rollback,"
    "acknowledge,signature,touch-grid,log,fetch,help";

}  // namespace

Background::Verdict Background::serve(const Request& request) {
  const std::string_view verb = request.verb;
  if (verb == "move") return move(request);
  if (verb == "log") return log(request);
  if (verb == "fetch") {
    return tell_part(
        request,
        {.signature = active() ? &*active() : nullptr,
         .candidate = identification_.has_verdict() ? &*identification_.candidate() : nullptr,
         .drawing = &configuration_.drawing},
        out_);
  }
  if (!request.arguments.empty()) return std::unexpected(Error::kUnknownRequest);
  if (verb == "stop") return command(CommandKind::kStop);
  if (verb == "halt") return command(CommandKind::kHalt);
  if (verb == "enable") return command(CommandKind::kEnable);
  if (verb == "disable") return command(CommandKind::kDisable);
  if (verb == "reset") return command(CommandKind::kReset);
  if (verb == "identify") return identify();
  if (verb == "touch-grid") return touch_grid();
  if (verb == "accept") return accept();
  if (verb == "rollback") return rollback();
  if (verb == "acknowledge") return acknowledge();
  if (verb == "candidate") return tell_candidate();
  if (verb == "pause" || verb == "resume") {
    if (!identification_.is_running()) return std::unexpected(Error::kWrongMode);
    verb == "pause" ? identification_.pause() : identification_.resume();
    return {};
  }
  if (verb == "status") {
    tell_status();
    return {};
  }
  if (verb == "signature") {
    tell_signature();
    return {};
  }
  if (verb == "help") {
    out_.text(kVerbs);
    return {};
  }
  return std::unexpected(Error::kUnknownRequest);
}

Background::Verdict Background::command(CommandKind kind) { return wait_for(mover_.send(kind)); }

Background::Verdict Background::wait_for(std::optional<Ticket> ticket) {
  if (!ticket) return std::unexpected(Error::kBusBusy);
  waiting_ticket_ = *ticket;
  waits_ = true;
  return {};
}

Background::Verdict Background::identify() {
  if (mover_.now().mode != Mode::kHolding || is_busy()) return std::unexpected(Error::kWrongMode);
  if (auto sent = command(CommandKind::kBeginSequence); !sent) return sent;
  identification_.begin(active() ? &active()->signature : nullptr, waiting_ticket_);
  return {};
}

Background::Verdict Background::touch_grid() {
  if (mover_.now().mode != Mode::kHolding || is_busy()) return std::unexpected(Error::kWrongMode);
  if (custody_.needs_acknowledgement()) return std::unexpected(Error::kDrawingUnacknowledged);
  if (auto begun = grid_.begin(); !begun) return begun;
  if (auto sent = command(CommandKind::kBeginSequence); !sent) {
    grid_.end(sent.error());
    return sent;
  }
  grid_.begun(waiting_ticket_);
  return {};
}

Background::Verdict Background::tell_candidate() {
  if (!identification_.has_verdict()) return std::unexpected(Error::kNoCandidate);
  const HeldOutReport& report = identification_.report();
  out_.text(" held_out=").integer(report.poses);
  out_.text(" candidate_rms_mm=").number(1e3 * report.candidate_rms_m, 4);
  out_.text(" active_rms_mm=").number(1e3 * report.active_rms_m, 4);
  out_.text(" better=").text(report.is_better() ? "yes" : "no");
  return {};
}

Background::Verdict Background::log(const Request& request) {
  const MeasurementLog& log = identification_.log();
  if (request.arguments.empty()) {
    out_.text(" rows=").integer(log.size()).text(" capacity=").integer(MeasurementLog::capacity());
    return {};
  }
  const auto index = parse_number(request.arguments[0].second);
  if (request.arguments.size() != 1 || request.arguments[0].first != "row") {
    return std::unexpected(Error::kUnknownRequest);
  }
  if (!index || !(*index >= 1 && *index <= static_cast<double>(log.size()))) {
    return std::unexpected(Error::kOutOfRange);
  }
  const LogEntry& row = log[static_cast<std::size_t>(*index) - 1];
  out_.text(" sweep=").integer(row.sweep).text(" pings=").integer(row.pings);
  for (std::size_t i = 0; i < row.readings.size(); ++i) {
    const bool turns = configuration_.drawing.joints[i].type == JointType::kRevolute;
    out_.text(" q").integer(i + 1).text(turns ? "_deg=" : "_mm=");
    out_.number(turns ? degrees(row.readings[i]) : 1e3 * row.readings[i], 5);
  }
  out_.text(" x_mm=").number(1e3 * row.p_S.x(), 4);
  out_.text(" y_mm=").number(1e3 * row.p_S.y(), 4);
  out_.text(" z_mm=").number(1e3 * row.p_S.z(), 4);
  out_.text(" sigma_mm=").number(1e3 * row.sigma_m, 4);
  return {};
}

}  // namespace armsig::controller
