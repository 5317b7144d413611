#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The fleet's page with 1,000 arms in Chromium: with_record fleet_page_test.py ARMSIG_FLEET AXE

axe-core looks at every view for barriers; what it calls serious or critical fails.

With ARMSIG_PICTURES=FOLDER the pages are also drawn there.
"""
import hashlib
import os
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "web"))
from browser import Browser, Tab, chromium  # noqa: E402

program, axe = sys.argv[1:3]
del sys.argv[1:3]
record = os.environ["ARMSIG_RECORD"]
pictures = os.environ.get("ARMSIG_PICTURES")
FIND = """axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => violations.map(({ impact, id, nodes }) =>
  [impact, id, nodes.map(({ target, any }) => `${target.join(' ')}: ${any[0]?.message ?? ''}`).slice(0, 3)]))"""
SIZES = ((1400, 900), (800, 1000), (390, 844))
ARMS = 1000
FIRST_VIEW_S = 0.3
FORMER = ("theta1_deg=0.010000 d1_mm=0.0000 a1_mm=0.0000 alpha1_deg=-90.000000 theta2_deg=0.000000 d2_mm=149.0900 "
          "a2_mm=431.8000 alpha2_deg=0.001000 theta3_deg=90.000000 d3_mm=0.0000 a3_mm=-20.3200 alpha3_deg=90.000000")
BENDS = "".join(f" zero{n}_rad=0 rest{n}_rad=0.2 map{n}_from_rad=-3.1 map{n}_knots_per_rad=19 map{n}_step_rad=1e-08 map{n}="
                + ",".join(str(300 * n * (k % 5)) for k in range(120)) for n in (1, 2, 3)) + " gravity=2,3,1.5e-05"
ACTUAL = FORMER.replace("a2_mm=431.8000", "a2_mm=432.2000").replace("alpha3_deg=90.000000", "alpha3_deg=90.050000") + BENDS
FILL = """
INSERT INTO arm (node, online, current) SELECT 'arm-' || n, n % 50 <> 0, jsonb_build_object('mode',
  CASE WHEN n % 211 = 0 THEN 'faulted' ELSE 'servoing' END, 'fault', CASE WHEN n % 211 = 0 THEN
  'DRIVE_EMERGENCY joint 4: continuous over-current' END, 'validation_rms_mm', 0.08 + n % 17 * 0.003, 'model', 'signature',
  'signature', encode(sha256(n::text::bytea), 'hex'), 'firmware', '0.21.0', 'sensor', 'well', 'air_c', 21.5,
  'late_p99_us', 8) FROM generate_series(1, {arms}) AS n;
INSERT INTO drift (node, signature, checks, sum, last_at, last_mm, verdict, named_at) SELECT 'arm-' || n, 'x', 300,
  CASE WHEN n = 777 THEN '{{9,1,1}}' ELSE '{{0.5,1,0.2}}' END::float8[], now(), '{{0.01,0,0}}', 'as accepted',
  CASE WHEN n = 777 THEN now() END FROM generate_series(1, {arms}) AS n;
INSERT INTO journal (node, journal, contiguous) VALUES ('arm-777', 1, 400);
INSERT INTO row (node, journal, number, at, historical, reading) SELECT 'arm-777', 1, n, now() - make_interval(hours => 400 - n),
  false, jsonb_build_object('verdict', 'as accepted', 'dx_mm', 0.02 * sin(n) + CASE WHEN n > 390 THEN 0.1 ELSE 0 END, 'dy_mm',
  0.02 * cos(n), 'dz_mm', 0.01, 'check_sigma_mm', 0.02, 'poses', 20) FROM generate_series(1, 400) AS n;
INSERT INTO signature (hash, document) VALUES ('{former}', '{former_text}'), ('{actual}', '{actual_text}');
INSERT INTO worn (node, hash, since, identified_ms, predicted_tool_error_mm, predicted_region, validation_rms_mm, validation_poses, number, air_c) VALUES
  ('arm-777', '{former}', now() - interval '200 days', 1.75e12, 0.08, 'limits', 0.11, 20, 1, 20.5),
  ('arm-777', '{actual}', now() - interval '1 day', 1.76e12, 0.07, 'limits', 0.10, 20, 2, 21.5);
UPDATE arm SET current = current || jsonb_build_object('signature', '{actual}') WHERE node = 'arm-777';
"""


def sha256(text):
    return hashlib.sha256(text.encode()).hexdigest()


def free_port():
    with socket.socket() as attempt:
        attempt.bind(("127.0.0.1", 0))
        return attempt.getsockname()[1]


@unittest.skipUnless(chromium, "no chromium; toolchain/setup installs it")
class FleetPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        port = free_port()
        cls.address = f"http://127.0.0.1:{port}"
        configuration = os.path.join(cls.folder.name, "fleet.yaml")
        with open(configuration, "w") as file:
            file.write(f"armsig: fleet/1\ngroup: plant\nhost: fleet\ndatabase: {record}\npage_port: {port}\n"
                       f"broker: {{address: 127.0.0.1, port: {free_port()}}}\n")
        cls.host = subprocess.Popen([program, configuration], stderr=subprocess.DEVNULL)
        cls.addClassCleanup(cls.stop)
        cls.wait(lambda: "\narmsig_record_up 1\n" in cls.get("/metrics"))
        fill = FILL.format(arms=ARMS, former=sha256(FORMER), former_text=FORMER, actual=sha256(ACTUAL), actual_text=ACTUAL)
        subprocess.run(["psql", "-X", "-q", "-v", "ON_ERROR_STOP=1", "-d", record], input=fill, text=True, check=True)
        cls.browser = Browser()
        cls.addClassCleanup(cls.browser.close)

    @classmethod
    def stop(cls):
        cls.host.send_signal(signal.SIGTERM)
        cls.host.wait(30)

    @classmethod
    def get(cls, path):
        try:
            with urllib.request.urlopen(cls.address + path, timeout=10) as reply:
                return reply.read().decode()
        except OSError:
            return ""

    @staticmethod
    def wait(condition):
        until = time.monotonic() + 60
        while not condition():
            if time.monotonic() > until:
                raise AssertionError("it took too long")
            time.sleep(0.05)

    def open(self, path, width=1400, height=900, dark=False):
        tab = Tab(self.browser, self.address + path, width, height, dark)
        tab.wait("performance.getEntriesByName('first-contentful-paint').length > 0")
        return tab

    def look(self, tab, name):
        across = tab.ask("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        self.assertLessEqual(across, 0, f"{name} is wider than its window")
        self.assertEqual(tab.complaints(), [])
        self.assertTrue(all(asked.startswith((self.address, "about:")) for asked in tab.asked()), tab.asked())
        if pictures:
            os.makedirs(pictures, exist_ok=True)
            tab.picture(os.path.join(pictures, name + ".png"))

    def host_processor_s(self):
        with open(f"/proc/{self.host.pid}/stat") as file:
            ticks = file.read().rsplit(")", 1)[1].split()[11:13]  # utime, stime
        return sum(map(int, ticks)) / os.sysconf("SC_CLK_TCK")

    def test_a_thousand_arms_are_seen_after_a_third_of_a_second_of_processor(self):
        for width, height in SIZES:
            for dark in (False, True):
                before_s = self.host_processor_s()
                tab = self.open("/", width, height, dark)
                page_s, host_s = tab.processor_s(), self.host_processor_s() - before_s
                self.assertEqual(tab.ask("document.querySelectorAll('tr').length"), ARMS + 1)
                # The last arm is there where one looks for it, in the columns of the first.
                self.assertTrue(tab.ask(
                    """(() => { const rows = [...document.querySelectorAll('tr')]
                      rows.at(-1).scrollIntoView()
                      const places = row => [...row.cells].map(cell => Math.round(cell.getBoundingClientRect().x))
                      return places(rows[0]).length == 9 && places(rows.at(-1)).join() == places(rows[0]).join() })()"""))
                tab.ask("scrollTo(0, 0)")
                self.look(tab, f"arms-{width}-{'dark' if dark else 'light'}")
                tab.call("Page.close")
                print(f"first view at {width} by {height}: {page_s:.2f} s of the page's processor, {host_s:.2f} s of the host's")
                self.assertGreater(page_s, 0)
                self.assertLess(page_s + host_s, FIRST_VIEW_S)

    def test_the_drifting_arm_stands_first_and_leads_to_what_changed(self):
        tab = self.open("/")
        self.assertIn("1000 arms", tab.ask("document.querySelector('h1').textContent"))
        self.assertIn("980 connected, 20 away, 1 drifting", tab.ask("document.querySelector('p').textContent"))
        tab.click("td a")
        tab.wait("document.querySelector('h1').textContent == 'arm-777'")
        text = tab.ask("document.body.innerText")
        for words in ("named as drifting", "Mean residual of the last 200 checks", "The last change", "validation"):
            self.assertIn(words, text)
        # Of the joints, the third axis was shifted and the fourth is not there: rows are of three.
        joints = tab.ask("[...[...document.querySelectorAll('table')].find(t => t.innerText.startsWith('joint')).rows]"
                         ".map(row => [...row.cells].map(cell => cell.textContent))")
        self.assertEqual([row[0] for row in joints], ["joint", "1", "2", "3"])
        self.assertAlmostEqual(float(joints[3][2]), 0.4, places=3)
        self.assertAlmostEqual(float(joints[2][2]), 0, places=3)
        for width, height in SIZES:
            tab.look(width, height)
            self.look(tab, f"arm-{width}")
        tab.look(*SIZES[0])
        tab.click(f"a[href='/signature/{sha256(ACTUAL)}']")
        tab.wait("document.querySelector('h1').textContent.startsWith('Signature')")
        self.assertIn(ACTUAL, tab.ask("document.body.innerText"))
        for width, height in SIZES:
            tab.look(width, height)
            self.look(tab, f"signature-{width}")

    def test_no_view_has_a_barrier(self):
        with open(axe) as file:
            script = file.read()
        # Of a thousand rows alike, forty are enough.
        few = "[...document.querySelectorAll('tr')].slice(40).forEach(row => row.remove()); true"
        for path in ("/", "/arm/arm-777", "/arm/arm-3", f"/signature/{sha256(ACTUAL)}", f"/signature/{sha256(FORMER)}",
                     f"/compare/{sha256(FORMER)}/{sha256(ACTUAL)}"):
            tab = self.open(path)
            tab.ask(script + "; true")
            tab.ask(few)
            tab.ask("document.querySelectorAll('details').forEach(one => { one.open = true }); true")
            for width, height, dark in ((1400, 900, False), (1400, 900, True), (390, 844, False), (390, 844, True)):
                tab.look(width, height, dark)
                with self.subTest(path, width=width, dark=dark):
                    self.assertEqual([found for found in tab.ask(FIND) if found[0] in ("serious", "critical")], [])

    def test_two_signatures_are_held_against_each_other(self):
        tab = self.open(f"/compare/{sha256(FORMER)}/{sha256(ACTUAL)}")
        self.assertRegex(tab.ask("document.body.innerText"), r"Together 0\.\d+ mm at the tool")
        self.assertIn("gravity", tab.ask("document.querySelector('table').innerText"))
        self.assertIn("what they do at the tool is in the sum", tab.ask("document.body.innerText"))
        self.look(tab, "compare")
        self.assertEqual(self.get(f"/compare/{sha256('x')}/{sha256(ACTUAL)}"), "")
        self.assertTrue(re.search(r"^armsig_arms_drifting 1$", self.get("/metrics"), re.M))


if __name__ == "__main__":
    unittest.main()
