# SPDX-License-Identifier: MIT
"""The emulated board with the R5F: QEMU's xlnx-zcu102, the controller on core 0, the emulated arm on core 1."""
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "cortex-r5f" / "firmware"
CONTROLLER = BUILD / "cabinet_r5f" / "cabinet_r5f_emulated.elf"
ARM = BUILD / "arm_r5f" / "arm_r5f.elf"
BANK_AT, BANK_BYTES = 0xFFFFC400, 14336  # toolchain/boards/r5f/r5f.ld


class Failure(Exception):
    """The board has not done what was expected of it."""


class Line:
    """One serial line or monitor of the board, on a Unix socket."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        deadline = time.monotonic() + 10
        while True:
            try:
                self.socket.connect(str(path))
                break
            except OSError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.05)
        self.received = b""

    def send(self, text):
        self.socket.sendall(text.encode())

    def read_line(self, seconds):
        """The next line, or None if none comes in time."""
        deadline = time.monotonic() + seconds
        while b"\n" not in self.received:
            self.socket.settimeout(max(0.01, deadline - time.monotonic()))
            try:
                more = self.socket.recv(4096)
            except TimeoutError:
                return None
            if not more:
                return None
            self.received += more
        line, self.received = self.received.split(b"\n", 1)
        return line.decode(errors="replace").strip()


class Board:
    def __init__(self, controller=CONTROLLER, arm=ARM, icount=2, bank=None):
        # An instruction is 4 ns to the emulator and 8 to the cores, whose cycle counters it drives at 1 GHz: each is a
        # fourth as fast as the real one at one instruction a cycle. Where they are slower still, steps of the background
        # take longer than a period.
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="armsig-r5f-"))
        command = [
            "qemu-system-aarch64", "-M", "xlnx-zcu102", "-object", "can-bus,id=bus", "-machine", "canbus0=bus",
            "-machine", "canbus1=bus", "-smp", "6", "-m", "2G", "-display", "none", "-S", "-semihosting",
            "-chardev", f"socket,id=monitor,path={self.folder}/monitor,server=on,wait=off",
            "-mon", "chardev=monitor,mode=readline", "-gdb", f"unix:{self.folder}/gdb,server=on,wait=off",
            "-serial", f"unix:{self.folder}/uart0,server=on,wait=on", "-serial", f"unix:{self.folder}/uart1,server=on,wait=on",
            "-device", f"loader,file={controller},cpu-num=4",
            "-global", "xlnx-zynqmp.boot-cpu=rpu-cpu[0]",
        ]
        if arm:
            command += ["-device", f"loader,file={arm},cpu-num=5"]
        if bank:
            command += ["-device", f"loader,file={bank},addr={BANK_AT:#x},force-raw=on"]
        if icount is not None:
            command += ["-icount", f"shift={icount}"]
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stderr=open(self.folder / "log", "w"),
                                        env=dict(os.environ, QEMU_AUDIO_DRV="none"))
        self.console = Line(self.folder / "uart0")
        self.arm_line = Line(self.folder / "uart1")
        self.monitor_line = Line(self.folder / "monitor")
        # The model keeps the real-time cores without power until somebody gives it to them.
        for core in range(2 if arm else 1):
            self.monitor(f"qom-set /machine/soc/rpu-cluster/rpu-cpu[{core}] start-powered-off false")
        self.reset()
        self.monitor("cont")

    def expect(self, words, seconds, bad=("# mode faulted", "# identify ended", "# identify paused", "# touch-grid ended", "error ")):
        """The console's next line that begins with `words`; one that begins with any of `bad` is a failure."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            line = self.console.read_line(left)
            if line is None:
                break
            print(line, flush=True)
            if line.startswith(words):
                return line
            if line.startswith(bad):
                raise Failure(f"expected '{words}': {line}")
        raise Failure(f"'{words}' has not come in {seconds} s")

    def expect_arm(self, words, seconds=60):
        """The next line of the emulated arm that begins with `words`."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0:
            line = self.arm_line.read_line(left)
            if line is not None and line.startswith(words):
                return
        raise Failure(f"the arm has not said '{words}' in {seconds} s")

    def tell_arm(self, request):
        self.arm_line.send(request + "\n")
        self.expect_arm("ok")

    def ask(self, request, seconds=60):
        """The reply to a request: what stands after `ok`."""
        self.console.send(request + "\n")
        return self.expect("ok", seconds, bad="error ")

    def monitor(self, command):
        self.monitor_line.send(command + "\n")

    def reset(self):
        self.monitor("system_reset")

    def bank(self):
        """What the memory that outlives a reset holds."""
        path = self.folder / "bank"
        path.unlink(missing_ok=True)
        self.monitor(f'pmemsave {BANK_AT:#x} {BANK_BYTES} "{path}"')
        deadline = time.monotonic() + 10
        while not path.exists() or path.stat().st_size < BANK_BYTES:
            if time.monotonic() > deadline:
                raise TimeoutError("no image of the bank")
            time.sleep(0.05)
        return path.read_bytes()

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()
