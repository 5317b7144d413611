// SPDX-License-Identifier: MIT
// Descriptions in YAML: arm, sensor, frames, signature, configuration of the daemon. What is
// accepted is written, and read back as the same bits.
#include <array>
#include <cmath>

#include "firmware/formats/arm_file.hpp"
#include "firmware/formats/canonical.hpp"
#include "firmware/formats/frames_file.hpp"
#include "firmware/formats/sensor_file.hpp"
#include "firmware/formats/signature_file.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "host_tests/fuzz/fuzz.hpp"

namespace armsig::fuzz {
namespace {

using namespace tool;  // NOLINT(google-build-using-namespace): its readers are the subject

void fuzz_arm(Bytes bytes) {
  const auto arm = parse_arm(text_of(bytes), "F");
  check_words(arm);
  if (!arm) return;
  const std::string written = arm_text(*arm);
  const auto again = parse_arm(written, "F");
  check_words(again);
  FUZZ_CHECK(again);
  FUZZ_CHECK(arm_text(*again) == written);
}

void fuzz_sensor(Bytes bytes) {
  const auto sensor = parse_sensor(text_of(bytes), "F");
  check_words(sensor);
  if (!sensor) return;
  const std::string written = sensor_text(*sensor);
  const auto again = parse_sensor(written, "F");
  check_words(again);
  FUZZ_CHECK(again);
  FUZZ_CHECK(sensor_text(*again) == written);
}

// Orientations are within rounding.
void fuzz_frames(Bytes bytes) {
  const auto frames = parse_frames(text_of(bytes), "F");
  check_words(frames);
  if (!frames) return;
  const auto again = parse_frames(frames_text(*frames), "F");
  check_words(again);
  FUZZ_CHECK(again && again->tools.size() == frames->tools.size());
}

void check_signature(std::string_view text) {
  const auto record = parse_signature(text, "F");
  check_words(record);
  if (!record) return;
  const auto written = signature_text(*record);
  check_words(written);
  FUZZ_CHECK(written);
  const auto again = parse_signature(*written, "F");
  check_words(again);
  FUZZ_CHECK(again);
  const auto twice = signature_text(*again);
  FUZZ_CHECK(twice && *twice == *written);
}

void fuzz_signature(Bytes bytes) { check_signature(text_of(bytes)); }

// Behind the seal: whoever edits a signature may compute a CRC.
void fuzz_resealed(Bytes bytes) {
  std::string body(text_of(bytes));
  const std::size_t seal = body.rfind("\ncrc32:");
  if (seal != std::string::npos) body.resize(seal + 1);
  const auto text = sealed(body);
  check_words(text);
  if (text) check_signature(*text);
}

void fuzz_configuration(Bytes bytes) {
  const auto configuration = daemon::parse_configuration(text_of(bytes), "F");
  check_words(configuration);
  if (!configuration) return;
  FUZZ_CHECK(controller::check(configuration->controller));
  FUZZ_CHECK(canopen::check(configuration->drives));
  FUZZ_CHECK(configuration->bus_loads.at(0) >= 0 && configuration->bus_loads.at(0) <= 1);
}

constexpr std::array kTargets{
    Target{"arm", fuzz_arm},           Target{"sensor", fuzz_sensor},
    Target{"frames", fuzz_frames},     Target{"signature", fuzz_signature},
    Target{"resealed", fuzz_resealed}, Target{"configuration", fuzz_configuration}};

}  // namespace

std::span<const Target> description_targets() { return kTargets; }

}  // namespace armsig::fuzz
