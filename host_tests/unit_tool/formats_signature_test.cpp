// SPDX-License-Identifier: MIT
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/canonical.hpp"
#include "firmware/formats/signature_file.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/random_signature.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::tool {
namespace {

using test::RandomRecord;

SignatureRecord a_record() { return RandomRecord(1).make(6); }

std::string text_of(const SignatureRecord& record) {
  const auto text = signature_text(record);
  EXPECT_TRUE(text) << render(text.error());
  return text.value_or("");
}

std::string message_of(const std::string& text) {
  const auto record = parse_signature(text, "S.yaml");
  return record ? "read" : render(record.error());
}

// `text` with the first `from` replaced.
std::string edited(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// `text` with every `from` replaced.
std::string all_edited(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

// The rest of the line behind the first `start`.
std::string line_after(const std::string& text, const std::string& start) {
  const std::size_t at = text.find(start) + start.size();
  return text.substr(at, text.find('\n', at) - at);
}

// `text` with a crc32 that matches.
std::string forged(const std::string& text) {
  const auto whole = sealed(edited(text, "crc32:" + line_after(text, "crc32:") + "\n", ""));
  EXPECT_TRUE(whole) << render(whole.error());
  return whole.value_or("");
}

// `text` with the first `from` replaced and a crc32 that matches.
std::string forged(const std::string& text, const std::string& from, const std::string& to) {
  return forged(edited(text, from, to));
}

// The same for the value of the first key that is spelt so.
std::string forged_value(const std::string& text, const std::string& key,
                         const std::string& value) {
  return forged(text, key + ": " + line_after(text, key + ": "), key + ": " + value);
}

void expect_same(const Pose& a, const Pose& b) {
  EXPECT_EQ(a.R, b.R);
  EXPECT_EQ(a.p, b.p);
}

void expect_same(const DhJoint& a, const DhJoint& b) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.theta_rad, b.theta_rad);
  EXPECT_EQ(a.d_m, b.d_m);
  EXPECT_EQ(a.a_m, b.a_m);
  EXPECT_EQ(a.alpha_rad, b.alpha_rad);
}

void expect_same(const s_model::Parameters& a, const s_model::Parameters& b) {
  EXPECT_EQ(a.beta_rad, b.beta_rad);
  EXPECT_EQ(a.d_m, b.d_m);
  EXPECT_EQ(a.a_m, b.a_m);
  EXPECT_EQ(a.alpha_rad, b.alpha_rad);
  EXPECT_EQ(a.gamma_rad, b.gamma_rad);
  EXPECT_EQ(a.b_m, b.b_m);
}

void expect_same(const features::JointFeature& a, const features::JointFeature& b) {
  EXPECT_EQ(a.type, b.type);
  EXPECT_EQ(a.axis_S, b.axis_S);
  EXPECT_EQ(a.point_S, b.point_S);
  EXPECT_EQ(a.radial_S, b.radial_S);
  EXPECT_EQ(a.radius_m, b.radius_m);
  EXPECT_EQ(a.reference_reading, b.reference_reading);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.quality.used, b.quality.used);
  EXPECT_EQ(a.quality.rejected, b.quality.rejected);
  EXPECT_EQ(a.quality.lowest_reading, b.quality.lowest_reading);
  EXPECT_EQ(a.quality.highest_reading, b.quality.highest_reading);
  EXPECT_EQ(a.quality.rms_normal_m, b.quality.rms_normal_m);
  EXPECT_EQ(a.quality.rms_radial_m, b.quality.rms_radial_m);
  EXPECT_EQ(a.quality.rms_tangential_m, b.quality.rms_tangential_m);
  EXPECT_EQ(a.quality.encoder_ratio, b.quality.encoder_ratio);
  EXPECT_EQ(a.quality.encoder_ratio_sigma, b.quality.encoder_ratio_sigma);
  EXPECT_EQ(a.quality.sigma_m, b.quality.sigma_m);
  EXPECT_EQ(a.quality.sigma_is_estimated, b.quality.sigma_is_estimated);
}

void expect_same(const Signature& a, const Signature& b) {
  ASSERT_EQ(a.joint_count(), b.joint_count());
  ASSERT_EQ(a.features.size(), b.features.size());
  ASSERT_EQ(a.targets.size(), b.targets.size());
  for (std::size_t i = 0; i < a.joint_count(); ++i) {
    EXPECT_EQ(a.types[i], b.types[i]);
    EXPECT_EQ(a.configuration[i], b.configuration[i]);
    expect_same(a.X_SL[i], b.X_SL[i]);
    expect_same(a.s_model[i], b.s_model[i]);
    expect_same(a.pseudo_dh[i], b.pseudo_dh[i]);
  }
  for (std::size_t i = 0; i < a.features.size(); ++i) expect_same(a.features[i], b.features[i]);
  expect_same(a.X_SL.back(), b.X_SL.back());
  for (std::size_t i = 0; i < a.targets.size(); ++i) {
    EXPECT_EQ(a.targets[i].number, b.targets[i].number);
    EXPECT_EQ(a.targets[i].link, b.targets[i].link);
    EXPECT_EQ(a.targets[i].p_S, b.targets[i].p_S);
    EXPECT_EQ(a.targets[i].covariance_m2, b.targets[i].covariance_m2);
  }
}

TEST(SignatureFile, gives_back_every_bit_of_random_signatures) {
  RandomRecord random(7);
  for (int trial = 0; trial < 64; ++trial) {
    const SignatureRecord written = random.make(static_cast<std::size_t>(1 + trial % 8));
    const auto read = parse_signature(text_of(written), "S.yaml");
    ASSERT_TRUE(read) << render(read.error());
    expect_same(written.signature, read->signature);
    for (std::size_t i = 0; i < written.nominal.joints.size(); ++i) {
      expect_same(written.nominal.joints[i], read->nominal.joints[i]);
      EXPECT_EQ(written.nominal.limits[i].lower, read->nominal.limits[i].lower);
      EXPECT_EQ(written.nominal.limits[i].upper, read->nominal.limits[i].upper);
    }
    ASSERT_EQ(written.nominal.couplings.size(), read->nominal.couplings.size());
    EXPECT_EQ(*written.covariance, *read->covariance);
    EXPECT_EQ(written.accuracy, read->accuracy);
    EXPECT_EQ(written.controller_signature, read->controller_signature);
    EXPECT_EQ(written.air_c, read->air_c);
  }
}

TEST(SignatureFile, gives_back_every_text) {
  const SignatureRecord written = a_record();
  const auto read = parse_signature(text_of(written), "S.yaml");
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_EQ(read->arm_name, written.arm_name);
  EXPECT_EQ(read->serial, "0012");
  EXPECT_EQ(read->method, "encoder");
  EXPECT_EQ(read->time, written.time);
  EXPECT_EQ(read->version, written.version);
  EXPECT_EQ(read->warnings, written.warnings);
  EXPECT_EQ(read->covariance_of, written.covariance_of);
}

TEST(SignatureFile, keeps_what_is_absent_absent) {
  SignatureRecord record = a_record();
  record.covariance.reset();
  record.accuracy = {};
  record.controller_signature = 0;
  record.air_c.reset();
  record.warnings.clear();
  record.serial.clear();
  record.signature.features.clear();
  record.signature.targets.clear();
  const auto read = parse_signature(text_of(record), "S.yaml");
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_FALSE(read->covariance);
  EXPECT_EQ(read->accuracy, ToolAccuracy());
  EXPECT_EQ(read->controller_signature, 0U);
  EXPECT_FALSE(read->air_c);
  EXPECT_TRUE(read->serial.empty());
  EXPECT_TRUE(read->signature.features.empty());
  EXPECT_TRUE(read->signature.targets.empty());
}

TEST(SignatureFile, refuses_a_predicted_error_without_its_region_or_with_another_word) {
  const std::string text = text_of(a_record());
  const std::string region = "  predicted_region: measured\n";
  ASSERT_NE(text.find(region), std::string::npos);
  EXPECT_NE(message_of(forged(edited(text, region, ""))).find("predicted_region"),
            std::string::npos);
  EXPECT_NE(message_of(forged(edited(text, region, "  predicted_region: anywhere\n")))
                .find("configuration, measured, limits"),
            std::string::npos);
  const std::string negative = edited(text, "validation_rms_m: ", "validation_rms_m: -");
  EXPECT_NE(message_of(forged(negative)).find("no negative length"), std::string::npos);
}

TEST(SignatureFile, says_what_it_is_in_its_first_key) {
  const std::string text = text_of(a_record());
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line) && line.starts_with('#')) {
  }
  EXPECT_EQ(line, "armsig: signature/1");
}

TEST(SignatureFile, refuses_a_changed_number) {
  const std::string text = edited(text_of(a_record()), "a_m: 0.", "a_m: 0.9");
  EXPECT_NE(message_of(text).find("the content does not match its crc32"), std::string::npos)
      << message_of(text);
}

TEST(SignatureFile, refuses_a_changed_last_digit_of_any_number) {
  const std::string text = text_of(a_record());
  const std::string digits = "0123456789";
  std::size_t count = 0;
  for (std::size_t at = 0; (at = text.find('.', at)) != std::string::npos; ++at) {
    const std::size_t end = text.find_first_not_of(digits, at + 1);
    if (end - at < 12 || ++count % 60 != 0) continue;
    std::string changed = text;
    // A digit before the last, so that the number is surely another double.
    changed[end - 3] = changed[end - 3] == '5' ? '6' : '5';
    EXPECT_NE(message_of(changed), "read") << text.substr(at, end - at);
  }
  EXPECT_GT(count, 500U);
}

TEST(SignatureFile, refuses_a_changed_name) {
  const std::string text = edited(text_of(a_record()), "serial: \"0012\"", "serial: \"0013\"");
  EXPECT_NE(message_of(text).find("crc32"), std::string::npos);
}

TEST(SignatureFile, takes_other_comments_and_indentation) {
  std::string text = "# for cell 4\n" + text_of(a_record());
  text = all_edited(text, "\n      - [", "\n          -   [ ");
  text = all_edited(text, ", ", " ,   ");
  EXPECT_EQ(message_of(text), "read");
}

TEST(SignatureFile, takes_another_spelling_of_a_number) {
  SignatureRecord record = a_record();
  record.air_c = 20;
  EXPECT_EQ(message_of(edited(text_of(record), "air_c: 20\n", "air_c: 2.0e+1\n")), "read");
}

TEST(SignatureFile, refuses_a_missing_crc) {
  const std::string message = message_of(edited(text_of(a_record()), "\ncrc32: ", "\n# "));
  EXPECT_NE(message.find("the file has no key \"crc32\""), std::string::npos) << message;
}

TEST(SignatureFile, refuses_another_version) {
  const std::string message = message_of(edited(text_of(a_record()), "signature/1", "signature/2"));
  EXPECT_NE(message.find("armsig: \"signature/2\"; expected armsig: signature/1"),
            std::string::npos)
      << message;
}

TEST(SignatureFile, refuses_another_first_key) {
  const std::string message =
      message_of(forged(edited(text_of(a_record()), "\narmsig: signature/1\n", "\n"),
                        "\nserial:", "\narmsig: signature/1\nserial:"));
  EXPECT_NE(message.find("the first key is \"name\""), std::string::npos) << message;
}

TEST(SignatureFile, refuses_pseudo_dh_that_disagrees_with_the_frames) {
  SignatureRecord record = a_record();
  record.signature.pseudo_dh[2].a_m += 1e-4;
  const auto text = signature_text(record);
  ASSERT_FALSE(text);
  EXPECT_NE(render(test::failure_of(text)).find("pseudo_dh and the link frames differ"),
            std::string::npos)
      << render(text.error());
}

TEST(SignatureFile, refuses_a_base_pose_that_disagrees_with_the_first_axis) {
  const std::string message =
      message_of(forged_value(text_of(a_record()), "position_m", "[2, 0, 0]"));
  EXPECT_NE(message.find("the base pose and the frame of joint 1 differ"), std::string::npos)
      << message;
}

TEST(SignatureFile, refuses_a_reading_offset_that_disagrees_with_pseudo_dh) {
  const std::string message =
      message_of(forged_value(text_of(a_record()), "reading_offset_m", "0.25"));
  EXPECT_NE(message.find("is not that of its pseudo_dh"), std::string::npos) << message;
}

TEST(SignatureFile, refuses_directions_that_are_no_frame) {
  const std::string message =
      message_of(forged_value(text_of(a_record()), "x_direction", "[1, 0, 0]"));
  EXPECT_NE(message.find("no right-handed frame"), std::string::npos) << message;
}

TEST(SignatureFile, refuses_a_target_beyond_the_arm) {
  const std::string message = message_of(forged(text_of(a_record()), "link: 6", "link: 7"));
  EXPECT_NE(message.find("link: \"7\"; expected an integer from 1 to 6"), std::string::npos)
      << message;
}

TEST(SignatureFile, refuses_a_target_number_given_twice) {
  const std::string message = message_of(forged(text_of(a_record()), "number: 2", "number: 1"));
  EXPECT_NE(message.find("target 1 is given twice"), std::string::npos) << message;
}

TEST(SignatureFile, refuses_an_unknown_method) {
  const std::string message =
      message_of(forged(text_of(a_record()), "method: encoder", "method: guess"));
  EXPECT_NE(message.find("method: \"guess\"; expected paper, encoder, refined or exact"),
            std::string::npos)
      << message;
}

TEST(SignatureFile, refuses_a_time_that_is_not_utc) {
  const std::string message = message_of(forged(text_of(a_record()), "12:00:00Z", "12:00:00"));
  EXPECT_NE(message.find("expected UTC like"), std::string::npos) << message;
}

TEST(SignatureFile, refuses_an_unknown_key_and_names_the_nearest) {
  const std::string message =
      message_of(forged(text_of(a_record()), "reading_offset", "reading_ofset"));
  EXPECT_NE(message.find("unknown key \"reading_ofset_"), std::string::npos) << message;
  EXPECT_NE(message.find("expected reading_offset_"), std::string::npos) << message;
}

TEST(SignatureFile, refuses_sweeps_of_some_joints_only) {
  SignatureRecord record = a_record();
  std::string text = text_of(record);
  const std::size_t start = text.rfind("    sweep:\n");
  text.erase(start, text.find("last_link:") - start);
  const std::string message = message_of(forged(text));
  EXPECT_NE(message.find("5 of 6 joints have a sweep"), std::string::npos) << message;
}

TEST(SignatureFile, refuses_a_negative_variance) {
  const std::string message = message_of(
      forged(text_of(a_record()), "covariance_m2:\n      - [", "covariance_m2:\n      - [-"));
  EXPECT_NE(message.find("a negative variance"), std::string::npos) << message;
}

TEST(SignatureFile, refuses_to_write_what_is_not_finite) {
  SignatureRecord record = a_record();
  record.signature.s_model[0].b_m = std::nan("");
  const auto text = signature_text(record);
  ASSERT_FALSE(text);
  EXPECT_NE(render(test::failure_of(text)).find("is not a finite number"), std::string::npos);
}

TEST(SignatureFile, refuses_to_write_an_incomplete_signature) {
  SignatureRecord record = a_record();
  record.signature.pseudo_dh.clear();
  EXPECT_FALSE(signature_text(record));
  EXPECT_FALSE(signature_text(SignatureRecord{}));
}

TEST(SignatureFile, leaves_the_old_file_when_the_new_one_is_refused) {
  const std::string path = test::temporary("signature.yaml");
  ASSERT_TRUE(write_signature_file(path, a_record()));
  SignatureRecord bad = a_record();
  bad.method = "guess";
  const auto written = write_signature_file(path, bad);
  ASSERT_FALSE(written);
  EXPECT_EQ(test::failure_of(written).file, path);
  const auto read = read_signature_file(path);
  ASSERT_TRUE(read) << render(read.error());
  expect_same(read->signature, a_record().signature);
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace armsig::tool
