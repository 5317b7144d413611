#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Barriers in the report, its certificate and the live page: pages_test.py ARMSIG ARMSIGD CONFIGURATION AXE

axe-core looks at each page in Chromium, on a desk and on a phone, light and dark; what it calls serious or critical fails.
"""
import os
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir, "web"))
from browser import Browser, Tab, chromium  # noqa: E402
from cabinet import Cabinet, Page  # noqa: E402

armsig, armsigd, configuration, axe = map(os.path.abspath, sys.argv[1:5])
del sys.argv[1:5]
kLooks = ((1400, 900, False), (1400, 900, True), (390, 844, False), (390, 844, True))
kSlow = 240  # s
kFind = """axe.run(document, { resultTypes: ['violations'] }).then(({ violations }) => violations.map(({ impact, id, nodes }) =>
  [impact, id, nodes.map(({ target, any }) => `${target.join(' ')}: ${any[0]?.message ?? ''}`)]))"""


@unittest.skipUnless(chromium, "no chromium; toolchain/setup installs it")
class Barriers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        with open(axe) as file:
            cls.axe = file.read()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def setUp(self):
        self.browser = Browser()
        self.addCleanup(self.browser.close)

    def open(self, address, ready):
        tab = Tab(self.browser, address)
        until = time.monotonic() + kSlow
        while not tab.ask(f"document.readyState === 'complete' && !!({ready})"):
            self.assertLess(time.monotonic(), until, f"{address} never gets ready: {ready}")
            time.sleep(0.1)
        tab.ask(self.axe + "; true")
        return tab

    def serious(self, tab):
        return [found for found in tab.ask(kFind) if found[0] in ("serious", "critical")]

    def look_everywhere(self, tab, what):
        for width, height, dark in kLooks:
            tab.look(width, height, dark)
            time.sleep(0.5)  # charts follow the new size
            with self.subTest(what, width=width, dark=dark):
                self.assertEqual(self.serious(tab), [])

    def run_armsig(self, *words):
        subprocess.run([armsig, *words], check=True, capture_output=True, cwd=self.folder.name)

    def test_are_seen_where_there_are_any(self):
        tab = self.open("data:text/html,<title>x</title><main><h1>x</h1><img src='data:,'><p style='color:%23eee'>pale</p></main>", "true")
        self.assertEqual({name for _, name, _ in self.serious(tab)} & {"image-alt", "color-contrast"}, {"image-alt", "color-contrast"})

    def test_are_not_in_the_report_and_its_certificate(self):
        self.run_armsig("simulate", "--arm", "ur10e", "--tolerances", "1", "--sigma-mm", "0.1", "--free-poses", "30", "--out", "m.csv")
        self.run_armsig("identify", "--arm", "ur10e", "--measurements", "m.csv", "--out", "s.yaml")
        self.run_armsig("report", "--signature", "s.yaml", "--measurements", "m.csv", "--operator", "A. Smith", "--out", "r.html")
        tab = self.open(f"file://{self.folder.name}/r.html", "document.querySelector('#certificate-about td') && document.querySelector('.uplot')")
        for values in ("document.querySelector('.values summary').click()", "scrollTo(0, document.body.scrollHeight)"):
            tab.ask(values)
        self.look_everywhere(tab, "report")

    def test_are_not_in_the_live_page(self):
        cabinet = Cabinet(armsigd, configuration, self.folder.name, 20)
        cabinet.start()
        self.addCleanup(cabinet.stop)
        page = Page(armsig, cabinet.console, "--web").start()
        self.addCleanup(page.stop)
        tab = self.open(page.address, "document.body.dataset.mode === 'idle'")
        tab.ask("document.getElementById('jog').open = true")
        self.look_everywhere(tab, "idle")
        tab.look(*kLooks[0])
        cabinet.ask("enable")
        tab.wait("document.body.dataset.mode === 'holding'", kSlow)
        self.assertEqual(cabinet.ask("identify"), ["ok"])
        tab.wait("document.querySelectorAll('.dial .point').length > 4", kSlow)
        self.look_everywhere(tab, "identifying")
        cabinet.ask("stop")
        tab.wait("document.querySelectorAll('#black-box-charts canvas').length === 2", kSlow)
        self.look_everywhere(tab, "faulted")
        second = self.open(page.address, "!document.getElementById('read-only').hidden")
        self.assertEqual(self.serious(second), [])
        cabinet.stop()
        tab.wait("document.body.classList.contains('stale')")
        self.assertEqual([name for _, name, _ in self.serious(tab) if name != "color-contrast"], [])  # what is old is pale


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]])
