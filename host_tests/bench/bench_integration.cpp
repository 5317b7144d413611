// SPDX-License-Identifier: MIT
// The master and the sensor backends against the emulated arm, which is a process of its own: real
// SocketCAN, a real serial line. Run it by host_tests/bench/run.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "core/measurement/speed_of_sound.hpp"
#include "core/measurement/trilateration.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/linux/rtu_range_sensor.hpp"
#include "hal/simulated/demo_sensor.hpp"
#include "hal/simulated/drive_motion.hpp"
#include "hal/simulated/gravity.hpp"
#include "host_tests/bench/bench_master.hpp"
#include "host_tests/bench/bench_process.hpp"
#include "host_tests/bench/bus_recording.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::bench {
namespace {

using hal::DriveCondition;
using linux_hal::RtuRangeSensor;
using std::chrono::milliseconds;

std::string content(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

const JointVector& folded() {
  static const JointVector readings{0.3, -1.0, 0.6, 0.4, 0.8, -0.5};
  return readings;
}

std::unique_ptr<RtuRangeSensor> serial_sensor(const std::string& device,
                                              std::size_t receivers = 8) {
  linux_hal::RtuRangeSensorConfiguration configuration{.device = device};
  configuration.profile.receivers = receivers;
  configuration.answer_timeout = milliseconds(300);
  configuration.freshness = {.silent_after = milliseconds(1500), .stale_after = milliseconds(1500)};
  auto sensor = RtuRangeSensor::start(configuration);
  EXPECT_TRUE(sensor);
  return std::move(*sensor);
}

// Polls until there is a reading, or the error asked for; other errors are passed over.
std::optional<hal::RangeReading> reading_of(hal::RangeSensor& sensor,
                                            const std::function<void()>& meanwhile) {
  for (const hal::Instant end = linux_hal::monotonic_now() + std::chrono::seconds(60);
       linux_hal::monotonic_now() < end;) {
    const auto polled = sensor.poll(linux_hal::monotonic_now());
    if (polled && *polled) return **polled;
    meanwhile();
  }
  return std::nullopt;
}
bool reports(hal::RangeSensor& sensor, Error error) {
  for (const hal::Instant end = linux_hal::monotonic_now() + std::chrono::seconds(60);
       linux_hal::monotonic_now() < end;) {
    const auto polled = sensor.poll(linux_hal::monotonic_now());
    if (!polled && polled.error() == error) return true;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return false;
}
void pause() { std::this_thread::sleep_for(milliseconds(5)); }

// Where a reading of the demonstration's receivers says that the target is.
Result<measurement::Position> located(const hal::RangeReading& reading) {
  measurement::ReceiverArray array{.p_S = {}, .range_sigma_m = simulated::kDemoRangeSigma};
  FlightTimes flights;
  const simulated::UltrasonicConfig field = simulated::demo_sensor();
  for (std::size_t j = 0; j < reading.receivers.size(); ++j) {
    array.p_S.push_back(field.receivers_S[j]);
    flights.push_back({reading.receivers[j].flight_s, reading.receivers[j].valid});
  }
  ARMSIG_TRY(speed, measurement::speed_of_sound(reading.air_celsius));
  return measurement::trilaterate(
      array, measurement::ranges_from_times(flights, speed, measurement::SoundPath::kOneWay));
}

TEST(Bench, drives_of_another_process_are_set_up_enabled_and_moved) {
  BenchProcess arm({"--zero-counts", "1000,-2000,0,5,123456,-7", "--bandwidth-hz", "10"});
  canopen::Configuration configuration = patient_drives();
  constexpr std::array kZero{1000, -2000, 0, 5, 123456, -7};
  for (std::size_t i = 0; i < kZero.size(); ++i) {
    configuration.axes[i].scaling.zero_counts = kZero[i];
  }
  BenchMaster master(configuration);
  ASSERT_TRUE(master.enable());
  master.move(folded(), 150);
  master.run(50);
  const auto truth = arm.numbers("status", "joints");
  ASSERT_EQ(truth.size(), folded().size());
  for (std::size_t i = 0; i < folded().size(); ++i) {
    EXPECT_NEAR(truth[i], folded()[i], 1e-4);
    EXPECT_NEAR(master.master.positions()[i], folded()[i], 1e-4);
  }
  EXPECT_EQ(master.master.counters().unknown, 0U);
  EXPECT_EQ(master.master.counters().malformed, 0U);
}

TEST(Bench, drives_with_two_axes_are_set_up_moved_and_stopped) {
  BenchProcess arm({"--dual"});
  canopen::Configuration configuration = patient_drives();
  const canopen::Configuration dual = test::puma_on_dual_drives();
  for (std::size_t i = 0; i < configuration.axes.size(); ++i) {
    configuration.axes[i].node = dual.axes[i].node;
    configuration.axes[i].axis = dual.axes[i].axis;
  }
  BenchMaster master(configuration);
  ASSERT_TRUE(master.enable());
  master.move(folded(), 150);
  master.run(50);
  const auto truth = arm.numbers("status", "joints");
  ASSERT_EQ(truth.size(), folded().size());
  for (std::size_t i = 0; i < folded().size(); ++i) EXPECT_NEAR(truth[i], folded()[i], 1e-3);
  EXPECT_EQ(master.master.counters().unknown, 0U);
  arm.order("drive joint=3 kind=silent");
  ASSERT_TRUE(master.run_until([&] {
    return master.master.status(2).fault && master.master.status(3).fault;
  })) << master.conditions();
  EXPECT_FALSE(master.master.status(0).fault);
  arm.order("drive joint=4 kind=none");
  EXPECT_TRUE(master.recover());
}

TEST(Bench, drives_without_cyclic_positions_are_moved_in_the_mode_that_they_have) {
  for (const auto mode : {cia402::PositionMode::kInterpolated, cia402::PositionMode::kProfile}) {
    BenchProcess arm({"--ideal"});
    canopen::Configuration configuration = patient_drives();
    for (auto& axis : configuration.axes) axis.mode = mode;
    BenchMaster master(configuration);
    ASSERT_TRUE(master.enable());
    master.move(folded(), 150);
    master.run(100);
    const auto truth = arm.numbers("status", "joints");
    ASSERT_EQ(truth.size(), folded().size());
    for (std::size_t i = 0; i < folded().size(); ++i) EXPECT_NEAR(truth[i], folded()[i], 1e-4);
  }
}

TEST(Bench, another_program_starts_and_resets_its_own_node_beside_the_arm) {
  if (!test::have("cansend")) GTEST_SKIP() << "can-utils are not installed";
  BenchProcess arm;
  BenchMaster master;
  ASSERT_TRUE(master.enable());
  ASSERT_TRUE(master.run_beside("for f in 000#0128 000#8128 000#8228; do cansend vcan0 $f; done"));
  master.run(50);
  EXPECT_TRUE(master.master.all(DriveCondition::kEnabled)) << master.conditions();
  EXPECT_EQ(master.master.counters().foreign, 0U);
  EXPECT_GE(master.master.counters().unknown, 3U);
}

TEST(Bench, an_interface_and_drives_that_come_late_are_waited_for) {
  canopen::Configuration configuration = patient_drives();
  configuration.boot_timeout = std::chrono::milliseconds(500);
  ASSERT_EQ(std::system("ip link set vcan0 down"), 0);
  BenchMaster master(configuration);
  master.run(50);
  EXPECT_EQ(test::failure_of(master.read), Error::kBusDown);
  ASSERT_TRUE(master.run_beside("ip link set vcan0 up"));
  EXPECT_TRUE(
      master.run_until([&] { return master.master.status(0).fault == Error::kDriveAbsent; }));
  const BenchProcess arm;  // is switched on now
  EXPECT_TRUE(master.run_until([&] { return master.master.all(DriveCondition::kDisabled); }));
  EXPECT_TRUE(master.enable());
}

TEST(Bench, a_drive_that_counts_anew_homes_while_the_others_hold) {
  BenchProcess arm({"--homed", "2", "--start-deg", "10,5,-20,30,0,0"});
  BenchMaster master(patient_drives());
  ASSERT_TRUE(master.enable());
  EXPECT_NEAR(master.master.positions()[1], 0, 1e-4) << "and stands at 5 degrees";
  const JointVector before = master.master.positions();
  ASSERT_TRUE(master.master.home(1));
  master.run_until([&] { return master.master.status(1).homed || master.faulted(); });
  ASSERT_TRUE(master.become(DriveCondition::kEnabled));
  EXPECT_TRUE(master.master.status(1).homed);
  const auto truth = arm.numbers("status", "joints");
  EXPECT_NEAR(truth[1], 0, 1e-3);
  EXPECT_NEAR(master.master.positions()[1], truth[1], 1e-4);
  for (const std::size_t other : {0U, 2U, 3U, 4U, 5U}) {
    EXPECT_NEAR(master.master.positions()[other], before[other], 1e-4) << other;
  }
}

TEST(Bench, the_sensor_on_the_serial_line_tells_where_the_target_truly_is) {
  BenchProcess arm;
  const auto sensor = serial_sensor(arm.sensor_device);
  const auto reading = reading_of(*sensor, pause);
  ASSERT_TRUE(reading);
  const auto position = located(*reading);
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - arm.target_S()).norm(), 2e-3);
  EXPECT_NEAR(reading->air_celsius, 20, 0.05);
}

TEST(Bench, the_sensor_on_the_can_bus_tells_where_the_target_truly_is) {
  BenchProcess arm({"--sensor-node", "32"});
  canopen::RangeSensor sensor({.node = 32, .receivers = 6});
  canopen::Configuration configuration = patient_drives();
  configuration.others[0].nodes.push_back(32);
  BenchMaster master(configuration, &sensor);
  const auto reading = reading_of(sensor, [&] { master.tick(); });
  ASSERT_TRUE(reading);
  const auto position = located(*reading);
  ASSERT_TRUE(position);
  EXPECT_LT((position->p_S - arm.target_S()).norm(), 2e-3);
}

TEST(Bench, mbpoll_reads_the_emulated_sensor) {
  if (!test::have("mbpoll")) GTEST_SKIP() << "mbpoll is not installed";
  BenchProcess arm({"--sigma-mm", "0"});
  const std::string output = arm.sensor_device + ".mbpoll";
  const std::string command = "mbpoll -m rtu -b 115200 -P even -a 1 -t 3 -0 -r 0 -c 4 -1 -o 2 " +
                              arm.sensor_device + " >" + output + " 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << content(output);
  const std::string text = content(output);
  EXPECT_NE(text.find("[0]: \t255"), std::string::npos) << text;  // eight receivers heard it
  EXPECT_NE(text.find("[2]: \t200"), std::string::npos) << text;  // 20.0 degrees
  EXPECT_NE(text.find("[3]: \t8"), std::string::npos) << text;
}

TEST(Bench, a_sensor_that_pymodbus_serves_is_read) {
  if (std::system("/usr/bin/python3 -c 'import pymodbus, serial, serial_asyncio' 2>/dev/null") !=
      0) {
    GTEST_SKIP() << "python3-pymodbus, python3-serial or python3-serial-asyncio is not installed";
  }
  const std::string device = "/dev/shm/armsig_pymodbus_" + std::to_string(::getpid());
  const std::string command = "exec /usr/bin/python3 " ARMSIG_BENCH_FOLDER "/pymodbus_sensor.py " +
                              device + " >/dev/null 2>&1 & echo $! >" + device + ".pid";
  ASSERT_EQ(std::system(command.c_str()), 0);
  // An interpreter takes its time to start.
  for (int i = 0; i < 600 && !std::filesystem::exists(device); ++i) {
    std::this_thread::sleep_for(milliseconds(100));
  }
  const auto sensor = serial_sensor(device, 4);
  const auto reading = reading_of(*sensor, pause);
  const std::string end = "kill $(cat " + device + ".pid); rm -f " + device + " " + device + ".pid";
  EXPECT_EQ(std::system(end.c_str()), 0);
  ASSERT_TRUE(reading);
  EXPECT_NEAR(reading->air_celsius, 21.5, 1e-9);
  ASSERT_EQ(reading->receivers.size(), 4U);
  for (std::size_t j = 0; j < 4; ++j) {
    EXPECT_TRUE(reading->receivers[j].valid);
    EXPECT_NEAR(reading->receivers[j].flight_s,
                1e-9 * (3'000'000.0 + 1000.0 * static_cast<double>(j)), 1e-12);
  }
}

// How far the limb of joint 3 falls from `readings` without torque: freely until its brake has
// closed, then braked to rest.
double fall_of_joint_3(const std::vector<double>& readings) {
  simulated::SimulatedArm arm{
      .arm = tool::table2_robot(1), .X_S0 = simulated::demo_base_pose(), .targets = {}};
  arm.targets.push_back({1, 6, Vector3(0.03, 0.02, 0.12)});  // where the load is
  JointVector q;
  for (const double reading : readings) q.push_back(reading);
  const simulated::MotionConfiguration motion = simulated::honest_motion(1);
  const double pull = simulated::gravity_pull(arm, q, {})[2];
  const double t = hal::seconds(motion.brake_delay);
  const double velocity = (pull - std::copysign(motion.friction, pull)) * t;
  return velocity * t / 2 + velocity * std::fabs(velocity) / (2 * motion.brake_deceleration);
}

TEST(Bench, every_fault_of_a_drive_stops_all_of_them_under_its_name_and_can_be_reset) {
  BenchProcess arm;
  BenchMaster master;
  ASSERT_TRUE(master.enable());
  struct Fault {
    const char* kind;
    Error error;
    bool falls = false;  // the torque goes at once
  };
  for (const Fault& fault :
       {Fault{"emergency code=0x2310", Error::kDriveEmergency},
        Fault{"heartbeat", Error::kHeartbeatLost}, Fault{"feedback", Error::kFeedbackLost},
        Fault{"reboot", Error::kDriveRebooted, true},
        Fault{"pre-operational", Error::kDriveNotOperational},
        Fault{"power", Error::kDriveDroppedOut, true}}) {
    const auto before = arm.numbers("status", "joints");
    arm.order("drive joint=3 kind=" + std::string(fault.kind));
    EXPECT_TRUE(master.run_until([&] { return master.faulted(); })) << fault.kind;
    EXPECT_EQ(master.master.status(2).fault, fault.error)
        << fault.kind << ": "
        << (master.master.status(2).fault ? describe(*master.master.status(2).fault) : "no fault");
    // Two ticks for the quick stop to reach the others and their answers to come back.
    EXPECT_TRUE(master.run_until(
        [&] { return master.master.status(0).condition == DriveCondition::kStopped; },
        milliseconds(500)))
        << fault.kind;
    auto after = arm.numbers("status", "joints");
    if (fault.falls) {
      master.run(20);  // by then its brake has closed and it is at rest
      const double expected = fall_of_joint_3(before);
      const double fell = arm.numbers("status", "joints")[2] - before[2];
      EXPECT_NEAR(fell, expected, 0.1 * std::fabs(expected)) << fault.kind;
      after[2] = before[2];
    }
    for (std::size_t i = 0; i < before.size(); ++i) {
      EXPECT_NEAR(after[i], before[i], 1e-3) << fault.kind;
    }
    arm.order("drive joint=3 kind=none");
    ASSERT_TRUE(master.recover()) << fault.kind;
  }
}

TEST(Bench, a_blocked_motor_and_a_lost_sync_end_in_the_drives_own_emergencies) {
  BenchProcess arm({"--sync-loss", "100"});
  canopen::Configuration configuration = patient_drives();
  for (auto& axis : configuration.axes) axis.following_window = 0.05;
  // The drives wait 100 periods for a SYNC; the master has to be more patient with their silence.
  configuration.missed_feedback_limit = 200;
  BenchMaster master(configuration);
  ASSERT_TRUE(master.enable());
  arm.order("drive joint=2 kind=blocked");
  master.move(folded(), 100);
  EXPECT_TRUE(master.run_until([&] { return master.faulted(); }));
  EXPECT_EQ(master.master.status(1).fault, Error::kDriveEmergency);
  EXPECT_EQ(master.master.status(1).fault_code, 0x8611U);
  arm.order("drive joint=2 kind=none");
  ASSERT_TRUE(master.recover());
  arm.order("lose-sync frames=400");
  EXPECT_TRUE(master.run_until([&] { return master.faulted(); }));
  EXPECT_EQ(master.master.status(0).fault, Error::kDriveEmergency);
  EXPECT_EQ(master.master.status(0).fault_code, 0x8700U);
  arm.order("lose-sync frames=0");
  ASSERT_TRUE(master.recover());
}

TEST(Bench, an_interface_that_goes_down_faults_the_drives_and_they_come_back_with_it) {
  BenchProcess arm;
  BenchMaster master;
  ASSERT_TRUE(master.enable());
  ASSERT_TRUE(master.run_beside("ip link set vcan0 down"));
  master.run(5);
  EXPECT_FALSE(master.read);
  EXPECT_EQ(test::failure_of(master.read), Error::kBusDown);
  EXPECT_TRUE(master.faulted());
  ASSERT_TRUE(master.run_beside("ip link set vcan0 up"));
  EXPECT_TRUE(master.run_until([&] { return master.read.has_value(); }));
  EXPECT_FALSE(master.master.all(DriveCondition::kEnabled));
  EXPECT_TRUE(master.recover());
}

// Six joints at 1 kHz, three on each interface, whose nodes have the same numbers.
TEST(Bench, drives_on_two_interfaces_at_1_kHz_stop_together_when_one_goes_down) {
  BenchProcess arm({"--second-can", "vcan1", "--step-us", "200"});
  canopen::Configuration configuration = patient_drives();
  test::put_on_two_buses(configuration);
  configuration.missed_feedback_limit = 1000;
  BenchMaster master(configuration);
  ASSERT_TRUE(master.enable());
  master.move(folded(), 1500);
  master.run(500);
  const auto truth = arm.numbers("status", "joints");
  ASSERT_EQ(truth.size(), folded().size());
  for (std::size_t i = 0; i < folded().size(); ++i) EXPECT_NEAR(truth[i], folded()[i], 1e-3);
  for (const std::uint8_t bus : {std::uint8_t{0}, std::uint8_t{1}}) {
    EXPECT_EQ(master.master.counters(bus).unknown, 0U);
    EXPECT_EQ(master.master.counters(bus).malformed, 0U);
  }
  ASSERT_TRUE(master.run_beside("ip link set vcan1 down"));
  EXPECT_TRUE(master.run_until([&] {
    return master.master.status(0).condition == DriveCondition::kStopped &&
           master.master.status(2).condition == DriveCondition::kStopped;
  })) << master.conditions();
  EXPECT_EQ(test::failure_of(master.read), Error::kBusDown);
  EXPECT_EQ(master.master.status(3).fault, Error::kBusDown);
  EXPECT_EQ(master.master.status(3).words, "vcan1");
  EXPECT_FALSE(master.master.status(0).fault);
  ASSERT_TRUE(master.run_beside("ip link set vcan1 up"));
  EXPECT_TRUE(master.run_until([&] { return master.read.has_value(); }));
  EXPECT_TRUE(master.recover());
}

TEST(Bench, every_fault_of_the_serial_sensor_has_its_name_and_ends_with_its_cause) {
  BenchProcess arm;
  const auto sensor = serial_sensor(arm.sensor_device);
  ASSERT_TRUE(reading_of(*sensor, pause));
  struct Fault {
    const char* kind;
    Error error;
  };
  for (const Fault& fault :
       {Fault{"crc", Error::kSensorBadCrc}, Fault{"unit", Error::kSensorWrongUnit},
        Fault{"exception", Error::kSensorException}, Fault{"short", Error::kSensorMalformed},
        Fault{"silent", Error::kSensorSilent}, Fault{"stale", Error::kSensorStale},
        Fault{"unplugged", Error::kSensorPortGone}}) {
    arm.order("sensor kind=" + std::string(fault.kind));
    EXPECT_TRUE(reports(*sensor, fault.error)) << fault.kind;
    arm.order("sensor kind=none");
    EXPECT_TRUE(reading_of(*sensor, pause)) << fault.kind;
  }
  EXPECT_EQ(sensor->exception_code(), 4);
}

TEST(Bench, the_air_multipath_and_drop_outs_change_on_command) {
  BenchProcess arm;
  const auto sensor = serial_sensor(arm.sensor_device);
  arm.order("field air_c=31.5 dropout=0.3 multipath=0.1");
  unsigned heard = 0;
  unsigned asked = 0;
  for (int i = 0; i < 60; ++i) {
    const auto reading = reading_of(*sensor, pause);
    ASSERT_TRUE(reading);
    if (i < 5) continue;  // from before the change
    EXPECT_NEAR(reading->air_celsius, 31.5, 0.05);
    for (const auto& receiver : reading->receivers) {
      ++asked;
      heard += receiver.valid ? 1 : 0;
    }
  }
  EXPECT_NEAR(static_cast<double>(heard) / asked, 0.7, 0.12);  // 440 draws, over 5 sigma
  EXPECT_EQ(arm.ask("field dropout=2").substr(0, 13), "error REQUEST");
  EXPECT_EQ(arm.ask("sensor kind=tired").substr(0, 13), "error REQUEST");
}

TEST(Bench, no_frame_of_others_does_lasting_harm) {
  if (!test::have("cansend") || !test::have("cangen"))
    GTEST_SKIP() << "can-utils are not installed";
  BenchProcess arm;
  BenchMaster master;
  ASSERT_TRUE(master.enable());
  // Each kind of frame that only a master sends, then anything at all.
  const char* const frames =
      "(for f in 000#0200 000#8100 080# 201#0F00FFFFFF7F 601#2B40600000000000 77F#05 703#00 "
      "181#11 083#1023000000000000 701#7F 12345678#0102 123#R 7FF#0102030405060708; do "
      "cansend vcan0 $f; done; cangen vcan0 -n 400 -g 2 -I r -L r -D r) >/dev/null 2>&1";
  EXPECT_TRUE(master.run_beside(frames));
  master.run(50);
  for (std::size_t i = 0; i < master.master.count(); ++i) {
    const hal::DriveStatus status = master.master.status(i);
    if (status.condition == DriveCondition::kFaulted) {
      EXPECT_TRUE(status.fault) << "joint " << i + 1 << " is faulted and does not say why";
    }
  }
  EXPECT_GT(master.master.counters().foreign + master.master.counters().unknown, 0U);
  EXPECT_TRUE(master.recover());
}

TEST(Bench, an_independent_decoder_reads_every_frame_of_the_real_bus) {
  if (!BusRecording::possible()) GTEST_SKIP() << "tshark or can-utils are not installed";
  BusRecording recording;
  {
    BenchProcess arm({"--sensor-node", "32"});
    canopen::RangeSensor sensor({.node = 32, .receivers = 6});
    canopen::Configuration configuration = patient_drives();
    configuration.others[0].nodes.push_back(32);
    BenchMaster master(configuration, &sensor);
    ASSERT_TRUE(master.enable());
    master.move(folded(), 50);
    arm.order("drive joint=3 kind=emergency code=0x2310");
    master.run(20);
  }
  recording.end();
  const auto frames = recording.decode();
  EXPECT_GT(frames.size(), 1000U);
  test::expect_canopen_throughout(frames);
  EXPECT_EQ(std::ranges::count_if(frames,
                                  [](const test::DecodedFrame& frame) {
                                    return frame.id == "131" && frame.emergency == "0x2310";
                                  }),
            1);
}

}  // namespace
}  // namespace armsig::bench
