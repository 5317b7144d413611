// SPDX-License-Identifier: MIT
// A master of one drive (node 1) on a scripted bus, and the script of its set-up.
#pragma once

#include <chrono>
#include <optional>

#include "hal/canopen/master.hpp"
#include "host_tests/support/puma_drives.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::test {

// The drive is asked what it does (6041h: Switch on disabled), and reset: the frames after the
// first heartbeat, in two ticks. `boots`: it says so at once.
inline void script_reset(ScriptedCanBus& bus, bool boots = true) {
  bus.expect("601#4041600000000000", {"581#4B41600050020000"});
  if (boots) {
    bus.expect("000#8201", {"701#00"});
  } else {
    bus.expect("000#8201");
  }
}

// What node 1 is asked before anything is written, with a drive's answers.
inline void script_inquiry(ScriptedCanBus& bus) {
  bus.expect("601#4000100000000000", {"581#4300100092010200"});  // 1000h: CiA 402 servo drive
  bus.expect("601#4002650000000000", {"581#4302650080000000"});  // 6502h: CSP
  bus.expect("601#407E600000000000", {"581#4F7E600000000000"});  // 607Eh: none
  bus.expect("601#4018100100000000", {"581#431810019A020000"});  // 1018h:01: vendor 29Ah
  bus.expect("601#4018100200000000", {"581#4318100292010000"});  // :02: product 192h
  bus.expect("601#4018100300000000", {"581#8018100311000906"});  // :03: no such sub-index
  bus.expect("601#4018100400000000", {"581#4318100439300000"});  // :04: serial 12345
  bus.expect("601#408F600100000000", {"581#438F6001A00F0000"});  // 608Fh:01: 4000 increments ...
  bus.expect("601#408F600200000000", {"581#438F600201000000"});  // ... a motor revolution
  bus.expect("601#4091600100000000", {"581#4391600101000000"});  // 6091h: the drive knows no gear
  bus.expect("601#4091600200000000", {"581#4391600201000000"});
  bus.expect("601#4092600100000000", {"581#8092600100000206"});  // 6092h: does not exist
  bus.expect("601#4092600200000000", {"581#8092600200000206"});
  bus.expect("601#4093600100000000", {"581#8093600100000206"});  // 6093h: does not exist
  bus.expect("601#4093600200000000", {"581#8093600200000206"});
  bus.expect("601#40A8600000000000", {"581#80A8600000000206"});  // 60A8h: does not exist
  bus.expect("601#40AA600000000000", {"581#80AA600000000206"});  // 60AAh: does not exist
}

// What is written then at 500 Hz, each option read before, and after where it was not as wanted.
inline void script_settings(ScriptedCanBus& bus) {
  bus.expect("601#4016100100000000", {"581#4316100100000000"});  // 1016h:01: nobody ...
  bus.expect("601#2316100196007F00", {"581#6016100100000000"});  // ... node 127, 150 ms
  bus.expect("601#4016100100000000", {"581#4316100196007F00"});
  bus.expect("601#2B17100032000000", {"581#6017100000000000"});  // 1017h: 50 ms
  bus.expect("601#4006100000000000", {"581#4306100000000000"});  // 1006h: none ...
  bus.expect("601#23061000D0070000", {"581#6006100000000000"});  // ... 2000 us
  bus.expect("601#4006100000000000", {"581#43061000D0070000"});
  bus.expect("601#2301140101030080", {"581#6001140100000000"});  // RPDO2 off
  bus.expect("601#23011801810200C0", {"581#6001180100000000"});  // TPDO2 off
  bus.expect("601#2302140101040080", {"581#8002140100000206"});  // RPDO3: does not exist
  bus.expect("601#23021801810300C0", {"581#8002180100000206"});
  bus.expect("601#2303140101050080", {"581#8003140111000906"});  // RPDO4: no such sub-index
  bus.expect("601#23031801810400C0", {"581#8003180100000206"});
  bus.expect("601#2300140101020080", {"581#6000140100000000"});  // RPDO1 off
  bus.expect("601#2F00140201000000", {"581#6000140200000000"});  // on every SYNC
  bus.expect("601#2F00160000000000", {"581#6000160000000000"});
  bus.expect("601#2300160110004060", {"581#6000160100000000"});  // 6040h, 16 bits
  bus.expect("601#2300160220007A60", {"581#6000160200000000"});  // 607Ah, 32 bits
  bus.expect("601#2F00160002000000", {"581#6000160000000000"});
  bus.expect("601#2300140101020000", {"581#6000140100000000"});  // RPDO1 on: 201h
  bus.expect("601#23001801810100C0", {"581#6000180100000000"});  // TPDO1 off
  bus.expect("601#2F00180201000000", {"581#6000180200000000"});
  bus.expect("601#2F001A0000000000", {"581#60001A0000000000"});
  bus.expect("601#23001A0110004160", {"581#60001A0100000000"});  // 6041h, 16 bits
  bus.expect("601#23001A0220006460", {"581#60001A0200000000"});  // 6064h, 32 bits
  bus.expect("601#2F001A0002000000", {"581#60001A0000000000"});
  bus.expect("601#2300180181010040", {"581#6000180100000000"});  // TPDO1 on: 181h
  bus.expect("601#40C2600100000000", {"581#4FC2600101000000"});  // 60C2h: 1 ...
  bus.expect("601#2FC2600102000000", {"581#60C2600100000000"});  // ... 2 ...
  bus.expect("601#40C2600100000000", {"581#4FC2600102000000"});
  bus.expect("601#40C2600200000000", {"581#4FC26002FD000000"});  // ... times 10^-3 s already
  bus.expect("601#4007600000000000", {"581#4B07600001000000"});  // 6007h: fault ...
  bus.expect("601#2B07600003000000", {"581#6007600000000000"});  // ... quick stop
  bus.expect("601#4007600000000000", {"581#4B07600003000000"});
  bus.expect("601#405A600000000000", {"581#4B5A600002000000"});  // 605Ah: ramp, disabled ...
  bus.expect("601#2B5A600006000000", {"581#605A600000000000"});  // ... ramp, stay
  bus.expect("601#405A600000000000", {"581#4B5A600006000000"});
  bus.expect("601#405B600000000000", {"581#4B5B600000000000"});  // 605Bh: off at once ...
  bus.expect("601#2B5B600001000000", {"581#605B600000000000"});  // ... ramp first
  bus.expect("601#405B600000000000", {"581#4B5B600001000000"});
  bus.expect("601#405C600000000000", {"581#4B5C600001000000"});  // 605Ch: ramp first already
  bus.expect("601#405E600000000000", {"581#4B5E600002000000"});  // 605Eh: quick stop ramp already
  bus.expect("601#40B0600000000000", {"581#80B0600000000206"});  // 60B0h: does not exist
  bus.expect("601#2F60600008000000", {"581#6060600000000000"});  // mode 8 ...
  bus.expect("601#4061600000000000", {"581#4F61600008000000"});  // ... in force
  bus.expect("000#0101");
}

// Every SDO request of the set-up of node 1 at 500 Hz, each with a drive's answer, then NMT
// start.
inline void script_set_up(ScriptedCanBus& bus) {
  script_inquiry(bus);
  script_settings(bus);
}

struct MasterScript {
  explicit MasterScript(const canopen::Configuration& configuration = puma_drives(1)) {
    master.emplace(*canopen::check(configuration), bus);
    targets.resize(configuration.axes.size());
  }

  // One tick, `later` than the one before.
  void tick(hal::Duration later = std::chrono::milliseconds(1)) {
    bus.now += later;
    read = master->read(bus.now);
    if (!keep_targets) targets = master->positions();
    written = master->write(targets, bus.now);
  }

  // Start-up to a running, disabled drive at 1000 counts. Time stands still meanwhile, so that no
  // heartbeat is due.
  void start() {
    bus.expect("77F#05");
    script_reset(bus);
    script_set_up(bus);
    for (int i = 0; i < 90 && master->node_state(0).phase != canopen::Phase::kStarted; ++i)
      tick({});
    // SYNC, answered: Switch on disabled, 1000 counts; the target sent is that position.
    bus.expect("080#", {"181#5002E8030000"});
    bus.expect("201#0000E8030000");
    tick({});
  }

  // A cycle: SYNC is answered by `feedback`, and the RPDO1 must be `command`.
  void cycle(const char* feedback, const char* command) {
    bus.expect("080#", {feedback});
    bus.expect(command);
    tick();
  }

  ScriptedCanBus bus;
  std::optional<canopen::Master> master;
  JointVector targets;
  bool keep_targets = false;
  Result<void> read;
  Result<void> written;
};

}  // namespace armsig::test
