// SPDX-License-Identifier: MIT
// What a controller has, fetched over its console: the signature in use or the candidate, the
// drawing, and what its last identification measured. And a candidate the other way.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/controller/signature_record.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/host_tool/console/console_client.hpp"

namespace armsig::tool {

class Fetcher {
 public:
  // `console` must outlive it; each reply is waited for no longer than `longest`. `name` stands for
  // the controller in problems.
  Fetcher(ConsoleClient& console, std::string name, std::chrono::milliseconds longest)
      : console_(console), name_(std::move(name)), longest_(longest) {}

  // Its readings are those of the joints, whatever couples their motors.
  [[nodiscard]] Read<Arm> drawing();
  // `what`: "signature", the one in use, or "candidate". Refuses where there is none.
  [[nodiscard]] Read<controller::SignatureRecord> record(std::string_view what, const Arm& drawing);
  // The rows of the last identification; refuses where nothing was measured since the start.
  [[nodiscard]] Read<std::vector<MeasurementRow>> log(const JointTypes& types);
  // Sends a record; the controller has it as its candidate then. Refuses by the controller's words.
  [[nodiscard]] Read<void> deliver(const controller::RecordImage& record, const std::string& by);

 private:
  // The words behind the "ok" that answers `request`; refuses an error, silence, and a reply that
  // lacks one of `keys`.
  [[nodiscard]] Read<std::vector<std::string>> ask(const std::string& request,
                                                   const std::vector<std::string>& keys);
  [[nodiscard]] Read<void> image(std::string_view what, std::span<std::uint8_t> bytes);
  [[nodiscard]] Read<double> number(const std::string& text) const;
  [[nodiscard]] std::unexpected<Problem> refused(std::string what, std::string expected) const;

  ConsoleClient& console_;
  std::string name_;
  std::chrono::milliseconds longest_;
};

}  // namespace armsig::tool
