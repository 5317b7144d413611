#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A range sensor served by pymodbus, an independent Modbus implementation.

usage: pymodbus_sensor.py DEVICE    makes DEVICE, a symbolic link to a serial line, and serves on it
"""
import os
import select
import sys
import threading
import time
import tty

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server import StartSerialServer
from pymodbus.transaction import ModbusRtuFramer

RECEIVERS = 4
STATUS = (1 << RECEIVERS) - 1
DECIDEGREES = 215


def registers(sequence):
    values = [STATUS, sequence & 0xFFFF, DECIDEGREES, RECEIVERS]
    for j in range(RECEIVERS):
        time_ns = 3_000_000 + 1000 * j
        values += [time_ns >> 16, time_ns & 0xFFFF]
    return values


def line():
    """A pseudo-terminal; its near end, its far end's name. The far end stays open."""
    near, far = os.openpty()
    tty.setraw(far)
    return near, os.ttyname(far)


def relay(one, other):
    while True:
        for ready in select.select([one, other], [], [])[0]:
            os.write(other if ready == one else one, os.read(ready, 256))


def main():
    near_server, server_device = line()
    near_client, client_device = line()
    threading.Thread(target=relay, args=(near_server, near_client), daemon=True).start()
    block = ModbusSequentialDataBlock(0, registers(0))
    slave = ModbusSlaveContext(ir=block, zero_mode=True)

    def measure():
        sequence = 0
        while True:
            sequence += 1
            block.setValues(0, registers(sequence))
            time.sleep(0.02)

    threading.Thread(target=measure, daemon=True).start()
    os.symlink(client_device, sys.argv[1])
    StartSerialServer(
        context=ModbusServerContext(slaves={1: slave}, single=False),
        framer=ModbusRtuFramer,
        port=server_device,
        baudrate=115200,
        parity="N",
    )


main()
