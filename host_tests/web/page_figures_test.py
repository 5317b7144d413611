#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The accuracy on the controller's live page, before a scripted controller: page_figures_test.py ARMSIG

Identify, accept, roll back, be killed and start anew, by this page and by others: every figure on the page is of the signature
that the controller names in the same reply, and none is left of another.
"""
import os
import socket
import struct
import sys
import tempfile
import threading
import unittest
import zlib

from browser import Browser, Tab, chromium
from cabinet import Page

armsig = sys.argv[1]
del sys.argv[1:2]
kJoints, kMostJoints, kPartBytes = 6, 8, 192
kReadings = " ".join(f"q{joint}_deg={joint}.0000" for joint in range(1, kJoints + 1))
kOutcome = ("# identify accuracy=reached model=maps poses=60 signature=candidate predicted_tool_error_mm=0.1111 "
            "predicted_region=limits asked_mm=0.1500")


def drawing():
    rows = [(0, 0, 0.1, 0.3, 1.57, -3, 3) if joint < kJoints else (0,) * 7 for joint in range(kMostJoints)]
    image = struct.pack("<II", kJoints, 0) + b"".join(struct.pack("<7d", *row) for row in rows) + struct.pack("<3d", 0, 0, 1)
    return image + struct.pack("<I", zlib.crc32(image))


class Controller:
    """The console of a controller that says what the test lets it say."""

    def __init__(self, path):
        self.path, self.listener, self.links = path, None, []
        self.model, self.sequence, self.candidate = "nominal", "none", None

    def start(self):
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(self.path)
        self.listener.listen()
        threading.Thread(target=self.accept, args=(self.listener,), daemon=True).start()

    def kill(self):
        self.listener.shutdown(socket.SHUT_RDWR)
        self.listener.close()
        os.unlink(self.path)
        for link in self.links:
            try:
                link.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
        self.links = []

    def accept(self, listener):
        while True:
            try:
                link, _ = listener.accept()
            except OSError:
                return
            self.links.append(link)
            threading.Thread(target=self.serve, args=(link,), daemon=True).start()

    def serve(self, link):
        try:
            with link, link.makefile("r") as lines:
                for line in lines:
                    link.sendall((self.reply(line.strip()) + "\n").encode())
        except OSError:
            pass

    def say(self, line):
        for link in self.links:
            try:
                link.sendall((line + "\n").encode())
            except OSError:
                pass  # one that has gone

    def reply(self, request):
        if request.startswith("fetch what=nominal part="):
            image, part = drawing(), int(request.rsplit("=", 1)[1])
            piece = image[(part - 1) * kPartBytes:part * kPartBytes]
            return f"ok bytes={len(image)} parts={-(-len(image) // kPartBytes)} hex={piece.hex()}"
        if request == "status":
            return (f"ok mode=holding moving=no {kReadings} x_mm=1.0 y_mm=2.0 z_mm=3.0 model={self.model} sensor=well "
                    f"sequence={self.sequence} ticks=5 late_max_us=3.0")
        if request == "candidate":
            return f"ok {self.candidate}" if self.candidate else 'error NO_CANDIDATE "there is no candidate"'
        return "ok rows=0 capacity=10" if request == "log" else "ok"


def figures(number, predicted, region, validation, air):
    return (f"signature={number} predicted_tool_error_mm={predicted} predicted_region={region} validation_rms_mm={validation} "
            f"validation_poses=20 air_c={air}")


@unittest.skipUnless(chromium, "no chromium; toolchain/setup installs it")
class PageFigures(unittest.TestCase):
    def setUp(self):
        browser = Browser()  # first: it hands the browser its first descriptors
        self.addCleanup(browser.close)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.controller = Controller(os.path.join(folder.name, "console"))
        self.controller.start()
        page = Page(armsig, self.controller.path, "--web").start()
        self.addCleanup(page.stop)
        self.tab = Tab(browser, page.address)

    def shown(self, *wanted):
        """The lines of figures that the page has, and no more: each of its words, in their order."""
        self.tab.wait("document.body.dataset.mode === 'holding'")
        lines = """[...document.querySelectorAll('#facts dt')].filter((name) => ['signature', 'candidate', 'tool', 'play']
          .includes(name.textContent)).map((name) => `${name.textContent}: ${name.nextSibling.textContent}`).join(' | ')"""
        self.tab.wait(f"({lines}) === {' | '.join(wanted)!r}")

    def test_every_figure_is_of_what_is_in_use_or_of_the_candidate(self):
        said = self.controller
        first = "signature: number 1, 0.030 mm RMS predicted at the signature configuration, 0.33 mm RMS on 20 validation poses, 21.5 \u00b0C"
        second = "signature: number 2, 0.11 mm RMS predicted over the joint limits, 0.22 mm RMS on 20 validation poses, 22.5 \u00b0C"
        in_use = {1: "signature " + figures(1, "0.0300", "configuration", "0.3300", 21.5),
                  2: "signature " + figures(2, "0.1100", "limits", "0.2200", 22.5)}
        self.shown()
        said.model = in_use[1]
        self.shown(first)
        # A self-calibration under way, and its end.
        said.sequence = ("identifying refining=yes candidate_predicted_tool_error_mm=0.1500 candidate_predicted_region=limits "
                         "asked_mm=0.1200 points=5 planned=9 left_s=3")
        self.shown(first, "candidate: 0.15 mm RMS predicted over the joint limits so far, 0.12 mm asked for")
        said.say(kOutcome)
        said.sequence = "none"
        said.candidate = (figures("candidate", "0.1100", "limits", "0.2200", 22.5) +
                          " active=1 active_rms_mm=0.4400 better=yes asked_mm=0.1200 reached=yes")
        of_candidate = ("candidate: 0.11 mm RMS predicted over the joint limits, 0.22 mm RMS on 20 validation poses, "
                        "0.12 mm asked for: reached")
        self.shown(first, of_candidate)
        self.assertEqual(self.tab.text("active-name"), "signature 1")
        # Accepted by another operator: nothing is said of it.
        said.candidate, said.model = None, in_use[2]
        self.shown(second)
        said.model = in_use[1]  # rolled back
        self.shown(first)
        said.model = "nominal"
        self.shown()
        said.model = in_use[2]
        self.shown(second)
        # Killed while it stored: what it starts with is another one than it had.
        said.kill()
        self.tab.wait("document.body.classList.contains('stale')")
        said.model = in_use[1]
        said.start()
        self.shown(first)
        said.kill()
        said.model = "nominal"
        said.start()
        self.tab.wait("!document.body.classList.contains('stale')")
        self.shown()

    def test_what_was_said_of_a_run_is_no_figure_of_the_arm(self):
        self.shown()
        self.controller.say(kOutcome)
        self.tab.wait("document.getElementById('said').textContent.includes('accuracy=reached')")
        self.shown()

    def test_a_measurement_without_an_accuracy_asked_for_says_its_region(self):
        self.controller.candidate = (figures("candidate", "0.0300", "configuration", "0.3300", 21.5) +
                                     " active=nominal active_rms_mm=5.0000 better=yes")
        self.shown("candidate: 0.030 mm RMS predicted at the signature configuration, 0.33 mm RMS on 20 validation poses")
        self.assertEqual(self.tab.text("active-name"), "the nominal model")


unittest.main(argv=[sys.argv[0]])
