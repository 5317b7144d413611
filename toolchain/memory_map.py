# SPDX-License-Identifier: MIT
"""Holds the sections of an image against the regions of the memory protection unit that the image sets up: the emulator
has no cache, so that only this shows a bank, or what another core looks at, in memory that is written back later or never.

The image tells its regions by the symbol armsig_mpu_regions (toolchain/boards/r5f/protection.hpp); one that has none has
no such unit.
"""
import re
import struct
import subprocess

REGION = struct.Struct("<IIIB3x")
EXECUTE_NEVER = 1 << 12
CACHED_TYPES = (0b001011, 0b000010, 0b000011)  # TEX, S, C, B with C set: write-back or write-through
SMALLEST = 32


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


class Region:
    def __init__(self, base, log2, access, without):
        self.base, self.size, self.access, self.without = base, 1 << log2, access, without

    def covers(self, address):
        if not self.base <= address < self.base + self.size:
            return False
        return not self.without >> ((address - self.base) * 8 // self.size) & 1

    def is_cached(self):
        return self.access & 0b111011 in CACHED_TYPES

    def is_writable(self):
        return self.access >> 8 & 7 == 3

    def is_executable(self):
        return not self.access & EXECUTE_NEVER


def sections(elf):
    """Name, address, size, place in the file and flags of what takes memory."""
    for line in run("arm-none-eabi-objdump", "-h", "-w", elf).splitlines():
        match = re.match(r"\s*\d+ (\S+)\s+([0-9a-f]{8})\s+([0-9a-f]{8})\s+[0-9a-f]{8}\s+([0-9a-f]{8})\s+2\*\*\d+\s+(.*)$", line)
        if match and "ALLOC" in match.group(5) and int(match.group(2), 16) > 0:
            yield (match.group(1), int(match.group(3), 16), int(match.group(2), 16), int(match.group(4), 16), match.group(5))


def regions(elf):
    """In the order in which they are set up: the last one that covers an address counts."""
    for line in run("arm-none-eabi-nm", "-S", elf).splitlines():
        words = line.split()
        if len(words) == 4 and words[3] == "armsig_mpu_regions":
            at, size = int(words[0], 16), int(words[1], 16)
            break
    else:
        return []
    for _, address, length, place, _ in sections(elf):
        if address <= at and at + size <= address + length:
            with open(elf, "rb") as file:
                file.seek(place + at - address)
                return [Region(*fields) for fields in REGION.iter_unpack(file.read(size))]
    return []


def check(elf, uncached, unmapped):
    """What is wrong: `uncached` names sections, `unmapped` ranges of addresses that no region may cover."""
    found = regions(elf)
    if not found:
        return []
    bad = []
    for name, begin, size, _, flags in sections(elf):
        for address in range(begin, begin + size, SMALLEST):
            covering = [region for region in found if region.covers(address)]
            if not covering:
                bad.append(f"{name}: nothing lets the core touch {address:#x}")
                break
            region = covering[-1]
            if name in uncached and region.is_cached():
                bad.append(f"{name}: {address:#x} is cached, and what is written there is lost with a reset")
                break
            if region.is_writable() and region.is_executable():
                bad.append(f"{name}: {address:#x} may be written and executed")
                break
            if "CODE" in flags and (region.is_writable() or not region.is_executable()):
                bad.append(f"{name}: {address:#x} is code, and may be written or not be executed")
                break
    for begin, end in unmapped:
        for region in found:
            if region.base < end and begin < region.base + region.size:
                bad.append(f"the region at {region.base:#x} maps memory that this image does not have")
    return bad
