#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Runs the HAL file of an export for some servo periods, as halcmd and the component offset would.

run_hal.py FILE: joints are commanded to 0, 10, ... 50 degrees, drives follow at once. Prints for
each joint what the drive was commanded and what came back to the joint, a line each. offset(9):
out = in + offset, fb-out = fb-in - offset, each in its own function; what no thread calls is not
run.
"""
import re
import sys


class Hal:
    def __init__(self, file):
        self.pins = {f"joint.{i}.motor-pos-cmd": 10.0 * i for i in range(6)}
        self.pins |= {f"joint.{i}.motor-pos-fb": 0.0 for i in range(6)}
        self.functions, self.thread, self.nets = {}, [], []
        for line in file:
            words = line.split("#")[0].split()
            if words:
                getattr(self, words[0])(*words[1:])

    def loadrt(self, component, names):
        assert component == "offset", component
        for name in names.removeprefix("names=").split(","):
            self.pins |= {f"{name}.{pin}": 0.0 for pin in ("offset", "in", "out", "fb-in", "fb-out")}
            self.functions[f"{name}.update-output"] = lambda n=name: self.put(
                f"{n}.out", self.pins[f"{n}.in"] + self.pins[f"{n}.offset"])
            self.functions[f"{name}.update-feedback"] = lambda n=name: self.put(
                f"{n}.fb-out", self.pins[f"{n}.fb-in"] - self.pins[f"{n}.offset"])

    def setp(self, pin, value):
        if not pin.startswith("genserkins."):
            assert pin in self.pins, pin
        self.put(pin, float(value))

    def addf(self, function, thread):
        assert thread == "servo-thread"
        self.thread.append(self.functions.pop(function))  # a function runs in one thread, once

    def net(self, name, *pins):
        assert re.fullmatch(r"[\w-]+", name), name
        source, arrow, sink = pins
        assert arrow == "=>" and source in self.pins and sink in self.pins, pins
        self.nets.append((source, sink))

    def put(self, pin, value):
        self.pins[pin] = value

    def period(self):
        for function in self.thread:
            for source, sink in self.nets:
                self.pins[sink] = self.pins[source]
            function()
        for source, sink in self.nets:
            self.pins[sink] = self.pins[source]
        for i in range(6):  # the drive
            self.put(f"joint-offset.{i}.fb-in", self.pins[f"joint-offset.{i}.out"])


def main():
    with open(sys.argv[1]) as file:
        hal = Hal(file)
    for _ in range(3):
        hal.period()
    for i in range(6):
        print(hal.pins[f"joint-offset.{i}.out"], hal.pins[f"joint.{i}.motor-pos-fb"],
              hal.pins[f"joint-offset.{i}.offset"])


main()
