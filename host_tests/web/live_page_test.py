#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The controller's live page in Chromium, through the whole story: live_page_test.py ARMSIG ARMSIGD CONFIGURATION

enable, identify, check, accept, roll back; jogs and homing; a quick stop, a drive that lags, a brake that stays shut, a sensor that falls
silent, with their words and black boxes; a second viewer; the controller and the server that go and come back. With ARMSIG_PICTURES=FOLDER the page is also drawn there.
"""
import csv
import json
import os
import re
import sys
import tempfile
import time
import unittest

from browser import Browser, Tab, chromium
from cabinet import Cabinet, Page, changed, kPrismatic, wait_for

armsig, armsigd, configuration = sys.argv[1:4]
del sys.argv[1:4]
pictures = os.environ.get("ARMSIG_PICTURES")
kSpeed = 6   # times real time: a busy machine sees each joint being swept
kSlow = 240  # s, on a machine with other work
WIDTHS = ((1400, 900), (800, 1000), (390, 844))


def with_cabinet(changes, speed=kSpeed, words=()):
    """Of a test: what its cabinet's configuration says instead, how fast it goes, and further words of its command."""
    def mark(test):
        test.changes, test.speed, test.words = changes, speed, words
        return test
    return mark


@unittest.skipUnless(chromium, "no chromium; toolchain/setup installs it")
class LivePage(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        test = getattr(self, self._testMethodName)
        changes = getattr(test, "changes", {})
        self.cabinet = Cabinet(armsigd, changed(configuration, self.folder.name, changes), self.folder.name, getattr(test, "speed", kSpeed))
        self.cabinet.words[1:1] = getattr(test, "words", ())
        self.cabinet.start()
        self.addCleanup(self.cabinet.stop)
        self.page = Page(armsig, self.cabinet.console, "--web", "--token-file", os.path.join(self.folder.name, "token")).start()
        self.addCleanup(lambda: self.page.stop())
        self.browser = Browser()
        self.addCleanup(self.browser.close)
        self.tab = Tab(self.browser, self.page.address)

    def mode(self, mode, tab=None):
        (tab or self.tab).wait(f"document.body.dataset.mode === '{mode}'", kSlow)

    def headline(self, words, tab=None):
        (tab or self.tab).wait(f"document.getElementById('headline').textContent.includes({json.dumps(words)})", kSlow)

    def press(self, verb, tab=None):
        (tab or self.tab).click(f"[data-verb={verb}]", kSlow)

    def press_sure(self, verb):
        """The second press of a verb that is asked twice; on a machine so busy that the first is forgotten, both."""
        self.tab.wait(f"""(() => {{
          const it = document.querySelector('[data-verb={verb}]');
          if (it.disabled) return false;
          if (!it.classList.contains('sure')) it.click();
          it.click();
          return true; }})()""", kSlow)

    def shown(self, identifier, tab=None):
        return (tab or self.tab).ask(f"document.getElementById('{identifier}').getClientRects().length > 0")

    def type(self, identifier, text):
        """As a person does, by keys, over what is there."""
        self.tab.ask(f"document.getElementById('{identifier}').select(), document.getElementById('{identifier}').focus()")
        self.tab.call("Input.dispatchKeyEvent", type="rawKeyDown", key="Delete", windowsVirtualKeyCode=46)
        self.tab.call("Input.insertText", text=text)

    def key(self, name, code):
        for kind in ("rawKeyDown", "char", "keyUp"):
            self.tab.call("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code, text="\r" if name == "Enter" else " ")

    def jogs_are(self, can):
        self.tab.wait(f"document.querySelectorAll('.jog button[aria-disabled={str(not can).lower()}]').length === 12", kSlow)

    def jogs(self, reading, step, press):
        """`press` moves the joint of `reading` by `step`."""
        self.jogs_are(True)
        to = self.readings()[reading] + step
        press()
        wait_for(lambda: abs(self.readings()[reading] - to) < 0.01, kSlow)

    def jog_button(self, joint, sign):
        return f"[data-jog='{joint}'] button:{'first' if sign < 0 else 'last'}-of-type"

    def readings(self):
        return {key: float(value) for key, value in re.findall(r"(q\d_\w+)=(\S+)", self.cabinet.ask("status")[0])}

    def stop_is_within_reach(self):
        for width, height in WIDTHS:
            self.tab.look(width, height)
            for place in ("0", "document.body.scrollHeight"):
                self.tab.ask(f"scrollTo(0, {place})")
                reach = self.tab.ask("""(() => { const it = document.getElementById('stop'), box = it.getBoundingClientRect();
                  return it.contains(document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2)) && box.height >= 44; })()""")
                self.assertTrue(reach, (width, place))
            across = self.tab.ask("document.documentElement.scrollWidth - innerWidth")
            self.assertLessEqual(across, 0, width)
        self.tab.look(*WIDTHS[0])
        self.tab.ask("scrollTo(0, 0)")

    def margins_are_equal(self):
        """What the bar and the page begin and end with, at the window's widths and on a wide screen with a scroll bar."""
        for width, height in (*WIDTHS, (1800, 500)):
            self.tab.look(width, height)
            left, right, bar, footer = self.tab.ask("""(() => {
              const box = (which) => document.querySelector(which).getBoundingClientRect();
              const inside = (which) => box(which).x + parseFloat(getComputedStyle(document.querySelector(which)).paddingLeft);
              return [box('.wide').left, document.documentElement.clientWidth - box('.wide').right, inside('.bar'), inside('footer')]; })()""")
            self.assertAlmostEqual(left, right, delta=0.5, msg=width)
            self.assertAlmostEqual(left, bar, delta=0.5, msg=width)
            self.assertAlmostEqual(left, footer, delta=0.5, msg=width)
        self.tab.look(*WIDTHS[0])

    def draw(self, name):
        if not pictures:
            return
        os.makedirs(pictures, exist_ok=True)
        for width, height in WIDTHS:
            for dark in (False, True):
                self.tab.look(width, height, dark)
                time.sleep(0.5)  # charts and arm follow the new size
                self.tab.picture(os.path.join(pictures, f"{name}-{width}-{'dark' if dark else 'light'}.png"), True)
        self.tab.look(*WIDTHS[0])

    def figures(self):
        return self.tab.text("facts")

    def test_the_whole_story(self):
        self.mode("idle")
        self.headline("Without torque")
        self.stop_is_within_reach()
        self.margins_are_equal()
        self.assertFalse(self.shown("read-only"))  # who came first holds the controls
        before = self.tab.ask("document.getElementById('arm').toDataURL()")
        self.press("enable")
        self.mode("holding")
        self.press("identify")
        self.mode("sweeping")
        self.tab.wait("/Measuring joint [2-5]/.test(document.getElementById('headline').textContent)", kSlow)
        self.press("pause")
        self.headline("paused")
        shown = "document.querySelectorAll('[data-joint=\"1\"] .point').length"
        counted = self.tab.ask(shown)
        self.assertGreaterEqual(counted, 8)
        self.tab.wait("/axis ± 0\\.0\\d+°/.test(document.querySelector('[data-joint=\"1\"] figcaption').textContent)")
        self.assertEqual(self.tab.ask("document.querySelectorAll('[data-joint=\"6\"] .point').length"), 0)
        self.assertRegex(self.tab.text("progress-left"), r"\d+ (s|min) left")
        self.assertTrue(self.tab.ask("document.querySelector('[data-verb=accept]').disabled"))
        self.stop_is_within_reach()
        self.draw("paused")
        self.press("resume")
        self.headline("The candidate is better")
        self.assertNotEqual(self.tab.ask("document.getElementById('arm').toDataURL()"), before)
        told = dict(re.findall(r"(\w+)=(\S+)", self.cabinet.ask("candidate")[0]))
        self.assertAlmostEqual(float(self.tab.text("candidate-rms").split()[0]), float(told["validation_rms_mm"]), delta=0.006)
        rows = int(re.search(r"rows=(\d+)", self.cabinet.ask("log")[0])[1]) - int(told["validation_poses"])
        self.tab.wait(f"document.querySelectorAll('.dial .point').length === {rows}")
        self.draw("candidate")
        self.press("accept")
        self.tab.wait("document.getElementById('facts').textContent.includes('number 1')", kSlow)
        self.assertIn("model=signature", self.cabinet.ask("signature")[0])
        self.press("check")
        self.headline("Checking the arm")
        self.tab.wait("/of 16 points/.test(document.getElementById('progress-points').textContent)", kSlow)
        self.assertTrue(self.tab.ask("document.querySelector('[data-verb=identify]').disabled"))
        self.draw("checking")
        self.tab.wait("document.getElementById('facts').textContent.includes('last checkas accepted')", kSlow)
        self.assertIn('check="as accepted"', self.cabinet.ask("status")[0])
        self.assertIn("check verdict", self.tab.text("said"))
        self.press("rollback")
        self.assertIn("model=signature", self.cabinet.ask("signature")[0])  # asked twice
        self.press_sure("rollback")
        self.tab.wait("document.getElementById('answer').textContent.includes('took rollback')", kSlow)
        self.assertIn("model=nominal", self.cabinet.ask("signature")[0])
        self.assertEqual(self.tab.complaints(), [])
        for address in self.tab.asked():
            self.assertTrue(address.startswith((self.page.address, "data:")), address)

    def black_box_of(self, joint):
        """The black box is shown, with the joint of the fault in front."""
        self.tab.wait("document.querySelectorAll('#black-box-charts canvas').length === 2", kSlow)
        self.assertEqual(self.tab.ask("document.getElementById('black-box-joint').value"), str(joint))
        self.assertRegex(self.tab.ask("document.getElementById('black-box-file').download"), r"^black-box-.*\.csv$")

    @with_cabinet({}, speed=0.02)  # the drives' set-up takes half a minute
    def test_shows_no_reading_before_its_drive_has_told_it(self):
        self.headline("Starting")
        shown = self.tab.ask("document.getElementById('readings').textContent")
        self.assertNotIn("NaN", shown)
        self.assertNotIn("\u00b0", shown)
        self.assertEqual(shown.count("not known"), 6, shown)
        facts = self.tab.ask("document.getElementById('facts').textContent")
        self.assertNotIn("NaN", facts)
        self.assertNotIn("undefined", facts)
        self.mode("idle")
        self.tab.wait("document.getElementById('readings').textContent.includes('\u00b0')", kSlow)
        self.assertNotIn("not known", self.tab.ask("document.getElementById('readings').textContent"))

    @with_cabinet({"following_error_deg: 3, sweep_at_deg: 0": "following_error_deg: 3, following_window_deg: 0.02, sweep_at_deg: 0"})
    def test_a_drive_that_lags_is_named_with_its_own_words(self):
        self.press("enable")
        self.mode("holding")
        self.press("identify")
        self.mode("faulted")
        self.headline("Joint 1: the drive sent an emergency message")
        self.assertEqual(self.tab.text("fault-device"), "The drive says: following error (0x8611)")
        self.assertIn("manual", self.tab.text("fault-todo"))
        self.black_box_of(1)
        self.assertEqual(self.tab.ask("document.querySelectorAll('#buttons .next').length"), 1)
        self.draw("drive-fault")
        self.press("reset")
        self.mode("idle")
        self.assertEqual(self.tab.complaints(), [])

    @with_cabinet({"targets_ignored_ms: 300": "targets_ignored_ms: 10"})
    def test_a_brake_that_stays_shut_is_named(self):
        self.press("enable")
        self.mode("faulted")
        self.headline("the drive does not follow its targets")
        self.assertIn("mode and its inputs", self.tab.text("fault-todo"))
        joint = int(re.search(r"fault_joint=(\d+)", self.cabinet.ask("status")[0])[1])
        self.black_box_of(joint)

    @with_cabinet({"reading_timeout_ms: 1000": "reading_timeout_ms: 12"})
    def test_a_silent_sensor_pauses_and_says_what_to_look_at(self):
        self.press("enable")
        self.mode("holding")
        self.press("identify")
        self.headline("The measurement is paused")
        self.tab.wait("document.getElementById('advice').textContent.startsWith('The sensor is silent')", kSlow)
        self.assertIn("baud rate", self.tab.text("advice"))
        self.assertTrue(self.tab.ask("document.getElementById('black-box').hidden"))  # no fault: the arm has torque
        late = Tab(self.browser, self.page.address)  # who comes later is told the same
        late.wait("document.getElementById('advice').textContent.startsWith('The sensor is silent')", kSlow)
        self.draw("silent")
        self.press("resume")
        self.headline("The measurement is paused")
        self.press("halt")
        self.mode("holding")

    def test_a_quick_stop_leaves_a_black_box_and_words(self):
        self.press("enable")
        self.mode("holding")
        self.press("identify")
        self.headline("Measuring joint 1")
        self.tab.click("#stop")
        self.mode("faulted")
        self.headline("stopped by the operator")
        self.assertIn("reset", self.tab.text("fault-todo"))
        self.tab.wait("document.querySelectorAll('#black-box-charts canvas').length === 2", kSlow)
        name = self.tab.ask("document.getElementById('black-box-file').download")
        self.assertRegex(name, r"^black-box-.*\.csv$")
        ticks = int(self.tab.text("black-box-lead").split()[0])
        with open(os.path.join(self.folder.name, "black-box", name)) as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.assertEqual(ticks, len(rows))
        # A stop is no joint's fault: that which went furthest is in front.
        went = {}
        for joint in range(1, 7):
            readings = [float(row[f"q{joint}_deg"]) for row in rows if row[f"q{joint}_deg"]]
            went[joint] = max(readings) - min(readings)
        self.assertEqual(self.tab.ask("document.getElementById('black-box-joint').value"), str(max(went, key=went.get)))
        self.draw("faulted")
        self.press("reset")
        self.mode("idle")

    @with_cabinet({}, speed=30, words=("--maps-deg", "0.02", "--deflection-mm", "0.5", "--backlash-deg", "0.005"))
    def test_a_self_calibration_says_what_it_predicts(self):
        self.press("enable")
        self.mode("holding")
        self.type("accuracy", "500")
        self.press("identify")
        self.tab.wait("document.getElementById('answer').textContent.includes('accuracy_mm needs a number above 0, at most 100')")
        self.type("accuracy", "")
        self.type("minutes", "30")
        self.press("identify")
        self.tab.wait("document.getElementById('answer').textContent.includes('takes nothing, or accuracy_mm')")
        self.assertIn("sequence=none", self.cabinet.ask("status")[0])
        self.type("accuracy", "0.15")
        self.press("identify")
        self.headline("Measuring poses anywhere")
        self.headline("The candidate is better")
        said = self.tab.text("said")
        predicted = float(re.search(r"accuracy=reached .*?predicted_tool_error_mm=([0-9.]+)", said)[1])
        told = re.search(r"([0-9.]+) mm RMS predicted over the joint limits.*0.15 mm asked for: reached", self.tab.text("facts"))
        self.assertAlmostEqual(float(told[1]), predicted, delta=0.006)
        late = Tab(self.browser, self.page.address)  # who comes later is told the same
        late.wait("document.getElementById('facts').textContent.includes('0.15 mm asked for: reached')", kSlow)
        self.draw("self-calibrated")
        self.press("accept")
        self.figures_of(1, predicted)
        # Nothing of a signature that is no longer in use; nor after the controller was killed.
        self.press_sure("rollback")
        self.no_figures()
        self.cabinet.process.kill()
        self.cabinet.process.wait()
        os.unlink(self.cabinet.console)
        self.cabinet.start()
        self.mode("idle")
        self.no_figures()

    def figures_of(self, number, predicted):
        """The page has the accuracy of signature `number`, as the controller tells it, and of nothing else."""
        self.tab.wait(f"document.getElementById('facts').textContent.includes('number {number}')", kSlow)
        facts = self.tab.text("facts")
        told = dict(re.findall(r"(\w+)=(\S+)", self.cabinet.ask("status")[0]))
        self.assertEqual((told["signature"], told["predicted_region"]), (str(number), "limits"))
        self.assertEqual(float(told["predicted_tool_error_mm"]), predicted)
        self.assertEqual(len(re.findall("predicted", facts)), 1, facts)
        self.assertAlmostEqual(float(re.search(r"([0-9.]+) mm RMS predicted over the joint limits", facts)[1]), predicted, delta=0.006)
        self.assertIn(f"mm RMS on {told['validation_poses']} validation poses", facts)

    def no_figures(self):
        self.tab.wait("!document.body.classList.contains('stale') && "
                      "!/predicted|validation|reached|number/.test(document.getElementById('facts').textContent)", kSlow)

    @with_cabinet(kPrismatic, speed=0.3)  # so that a busy machine can halt a move
    def test_jogs_one_joint_by_a_step(self):
        self.mode("idle")
        self.assertFalse(self.tab.ask("document.getElementById('jog').open"))
        self.tab.ask("document.querySelector('#jog summary').focus()")
        self.key("Enter", 13)
        self.assertTrue(self.tab.ask("document.getElementById('jog').open"))
        self.jogs_are(False)
        self.tab.click(self.jog_button(2, -1))  # says that it can't, and does not
        self.press("enable")
        self.mode("holding")
        self.jogs("q2_deg", -1, lambda: self.tab.click(self.jog_button(2, -1)))
        self.jogs("q3_mm", 1, lambda: self.tab.click(self.jog_button(3, 1)))
        self.tab.click("[name=step][value='0.1']")
        self.jogs("q2_deg", 0.1, lambda: self.tab.click(self.jog_button(2, 1)))
        self.assertEqual(self.tab.ask("Array.from(document.querySelectorAll('.jog button'), (it) => it.ariaLabel).slice(2, 6)"),
                         ["Joint 2 by \u22120.1 degrees", "Joint 2 by 0.1 degrees", "Joint 3 by \u22120.1 mm", "Joint 3 by 0.1 mm"])
        # By keys, again and again: the button keeps the focus while the arm moves.
        self.tab.ask(f"document.querySelector({json.dumps(self.jog_button(4, 1))}).focus()")
        for name, code in (("Enter", 13), (" ", 32), ("Enter", 13)):
            self.jogs("q4_deg", 0.1, lambda: self.key(name, code))
        # Halt stops it.
        before = self.readings()["q1_deg"]
        self.tab.click("[name=step][value='5']")
        self.jogs_are(True)
        self.tab.click(self.jog_button(1, 1))
        self.mode("servoing")
        self.jogs_are(False)
        self.tab.click("#jog [data-verb=halt]", kSlow)
        self.mode("holding")
        self.assertLess(self.readings()["q1_deg"] - before, 4.5)
        self.jogs_are(True)
        self.stop_is_within_reach()
        self.draw("jog")
        self.assertEqual(self.tab.complaints(), [])

    @with_cabinet({"gear_ratio: 100, zero_counts: 0, reversed: no,": "gear_ratio: 100, reference: homed, homing_method: 37,",
                   "node: 2, counts_per_revolution: 4000, gear_ratio: 100,": "node: 2, counts_per_revolution: 4000, gear_ratio: 100, reference: none,"})
    def test_an_unreferenced_joint_can_be_homed(self):
        self.mode("idle")
        self.tab.wait("document.getElementById('facts').textContent.includes('joint 1,2: look at it, then confirm, or home it')", kSlow)
        homes = "Array.from(document.querySelectorAll('[data-verb=home]'), (it) => it.textContent)"
        self.assertEqual(self.tab.ask(homes), ["Home joint 1", "Home joint 2"])
        self.press("enable")
        self.mode("holding")
        self.press('home][data-joint="2"')
        self.press_sure('home][data-joint="2"')
        self.tab.wait("document.getElementById('answer').textContent.includes('reference: homed')", kSlow)
        self.draw("unreferenced")
        self.assertNotIn("workstation", self.tab.text("answer"))  # the reason, and no remedy for others
        self.press_sure('home][data-joint="1"')
        self.tab.wait("document.getElementById('facts').textContent.includes('joint 2: look at it, then confirm, or home it')", kSlow)
        self.tab.wait(f"{homes}.join() === 'Home joint 2'", kSlow)
        self.assertIn("unreferenced=2 ", self.cabinet.ask("status")[0])
        homing = "import('./meaning.js').then((it) => it.situation({ status: { mode: 'homing', sequence: 'none' }, candidate: null }, '', 6))"
        self.assertEqual([self.tab.ask(f"{homing}.then((it) => it.{word})") for word in ("headline", "next")], ["A joint is being homed", "halt"])

    @with_cabinet({"accept_sent: ": "touches: {file: touches.csv}\nvirtual: {ball: {x_mm: 150, y_mm: 0, z_mm: 50}, "
                                    "sockets: [{place: A1, x_mm: 400, y_mm: 200, z_mm: 100}]}\naccept_sent: "})
    def test_an_arm_that_is_led_by_hand_is_touched(self):
        self.mode("idle")
        self.assertTrue(self.shown("touching"))
        for count in (1, 2):
            self.assertEqual(self.cabinet.ask("emulate place=A1"), ["ok"])
            self.type("place", "A1")
            self.press("touch")
            self.tab.wait(f"document.getElementById('answer').textContent === 'Touched A1: {count} there, {count} in all.'", kSlow)
        self.draw("touches")
        self.assertEqual(self.tab.complaints(), [])
        self.type("place", "A 1")
        self.press("touch")
        self.tab.wait("document.getElementById('answer').textContent.includes('place needs a letter or digit')", kSlow)
        self.press("drop-touch")
        self.press_sure("drop-touch")
        self.tab.wait("document.getElementById('answer').textContent === 'Dropped a touch of A1: 1 there, 1 in all.'", kSlow)
        self.assertEqual(self.cabinet.ask("touches"), ["ok touches=1 places=A1:1"])
        with open(os.path.join(self.folder.name, "touches.csv")) as file:
            self.assertEqual([line.split(",")[0] for line in file], ["place", "A1"])

    def test_without_a_file_of_touches_there_is_no_button_for_them(self):
        self.mode("idle")
        self.assertFalse(self.shown("touching"))

    def test_a_second_viewer_looks_on_until_it_takes_over(self):
        self.mode("idle")
        second = Tab(self.browser, self.page.address)
        self.mode("idle", second)
        second.wait("!document.getElementById('read-only').hidden")
        self.assertTrue(second.ask("document.querySelector('[data-verb=enable]').disabled"))
        self.assertTrue(self.shown("read-only", second))
        second.click("#take-over")
        self.press("enable", second)
        self.mode("holding")
        self.tab.wait("!document.getElementById('read-only').hidden")
        self.assertTrue(self.tab.ask("document.querySelector('[data-verb=disable]').disabled"))
        self.tab.click("#stop")
        self.mode("faulted", second)

    def test_what_is_old_never_looks_alive(self):
        self.mode("idle")
        self.cabinet.process.kill()
        self.tab.wait("document.body.classList.contains('stale')", 5)
        self.tab.wait("document.getElementById('lost').textContent.includes('No connection to the controller')")
        self.assertEqual(self.tab.text("mode"), "not known")
        self.assertEqual(self.tab.ask("document.querySelectorAll('#buttons button:not(:disabled)').length"), 0)
        self.cabinet.process.wait()
        os.unlink(self.cabinet.console)
        self.cabinet.start()
        self.mode("idle")
        port = self.page.port
        self.page.stop()
        self.tab.wait("document.getElementById('lost').textContent.includes('server has gone')", 10)
        self.page = Page(armsig, self.cabinet.console, "--web", str(port), "--token-file", os.path.join(self.folder.name, "token")).start()
        self.tab.wait("!document.body.classList.contains('stale')", kSlow)
        self.press("enable")
        self.mode("holding")


unittest.main(argv=sys.argv)
