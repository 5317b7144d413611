# SPDX-License-Identifier: MIT
"""A virtual controller and the server of its live page, as an operator starts them."""
import os
import re
import signal
import socket
import subprocess
import threading
import time


class Cabinet:
    """armsigd --virtual in `folder`; `speed` times real time."""

    def __init__(self, armsigd, configuration, folder, speed):
        self.folder = folder
        self.console = os.path.join(folder, "console")
        self.words = [armsigd, "--virtual", "--speed", str(speed), "--console", self.console, "--store",
                      os.path.join(folder, "store"), configuration]
        self.process = None

    def start(self):
        with open(os.path.join(self.folder, "armsigd.log"), "a") as log:
            self.process = subprocess.Popen(self.words, stdout=log, stderr=log, cwd=self.folder)
        wait_for(lambda: self.process.poll() is not None or os.path.exists(self.console) and self.answers())

    def answers(self):
        with socket.socket(socket.AF_UNIX) as attempt:
            return attempt.connect_ex(self.console) == 0

    def ask(self, *requests):
        """The replies to `requests`."""
        with socket.socket(socket.AF_UNIX) as line:
            line.settimeout(30)
            line.connect(self.console)
            file, replies = line.makefile("rw"), []
            for request in requests:
                file.write(request + "\n")
                file.flush()
                replies.append(next(text.strip() for text in file if text.startswith(("ok", "error"))))
            return replies

    def stop(self):
        if self.process:
            self.process.send_signal(signal.SIGTERM)
            self.process.wait(30)
        self.process = None


class Tap:
    """A console at `path` between a page's server and the controller; keeps each line that the controller is sent."""

    def __init__(self, console, path):
        self.console, self.lines = console, []
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(path)
        self.listener.listen()
        threading.Thread(target=self.serve, daemon=True).start()

    def serve(self):
        while True:
            near, far = self.listener.accept()[0], socket.socket(socket.AF_UNIX)
            far.connect(self.console)
            for source, sink, lines in ((near, far, self.lines), (far, near, None)):
                threading.Thread(target=self.pass_on, args=(source, sink, lines), daemon=True).start()

    @staticmethod
    def pass_on(source, sink, lines):
        try:
            for line in source.makefile("rb"):
                if lines is not None:
                    lines.append(line.decode().rstrip("\n"))
                sink.sendall(line)
        except OSError:
            pass
        finally:
            sink.close()

    def commands(self):
        """Of what was sent, all but what only asks."""
        return [line for line in self.lines if line.split(" ")[0] not in ("status", "log", "candidate", "help", "fetch", "signature")]


# The third joint of the Puma's configuration as a prismatic one.
kPrismatic = {"""revolute, theta_deg: 0, d_mm: 0,      a_mm: -20.32, alpha_deg: 90,  limits_deg: [-45, 225],
     node: 3, counts_per_revolution: 4000, gear_ratio: 100,
     speed_deg_per_s: 60, acceleration_deg_per_s2: 180, following_error_deg: 3, sweep_at_deg: 90}""":
              """prismatic, theta_deg: 0, d_mm: 0, a_mm: -20.32, alpha_deg: 90, limits_mm: [-400, 400],
     node: 3, counts_per_revolution: 4000, gear_ratio: 10, lead_mm: 10,
     speed_mm_per_s: 100, acceleration_mm_per_s2: 300, following_error_mm: 5, sweep_at_mm: 200}"""}


def changed(configuration, folder, changes):
    """A copy of `configuration` in `folder` with each key of `changes` replaced, once, by its value."""
    with open(configuration) as file:
        text = file.read()
    for old, new in changes.items():
        if text.count(old) < 1:
            raise AssertionError(f"{configuration} has no {old}")
        text = text.replace(old, new, 1)
    path = os.path.join(folder, "cabinet.yaml")
    with open(path, "w") as file:
        file.write(text)
    return path


class Page:
    """armsig connect --web."""

    def __init__(self, armsig, console, *words):
        self.words = [armsig, "connect", console, *words]

    def start(self):
        self.process = subprocess.Popen(self.words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.match(r"http://127\.0\.0\.1:(\d+)/([0-9a-f]{32})/$", line)
        if not found:
            raise AssertionError(f"{line}{self.process.stderr.read()}")
        self.address, self.port, self.token = line.strip(), int(found[1]), found[2]
        return self

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(30)
        self.process.stdout.close()
        self.process.stderr.close()


def wait_for(condition, timeout=60):
    until = time.monotonic() + timeout
    while not condition():
        if time.monotonic() > until:
            raise AssertionError("it took too long")
        time.sleep(0.02)
