#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The page of `armsig report` in a headless Chromium: report_page_test.py ARMSIG

It opens without a word on the console, with and without WebGL, on a desk and on a phone; its numbers are those of the
signature file; it is small and asks for nothing from elsewhere; it says in words what a sinusoid of the residuals means.
"""
import csv
import html.parser
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import yaml

armsig = sys.argv.pop(1)
chromium = shutil.which("chromium") or shutil.which("chromium-browser")
WEBGL = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"]


def run(*words):
    done = subprocess.run([armsig, *words], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(f"armsig {' '.join(words)}: {done.stderr}")
    return done.stdout


class Page(html.parser.HTMLParser):
    """Text by id and table cells by row, of a page after its scripts have run."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.ids, self.rows, self.cells, self.open = {}, [], None, []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        if tag in ("br", "meta", "input", "link", "img"):
            return
        self.open.append((tag, attributes.get("id")))
        if tag == "tr":
            self.rows.append((attributes, []))
        if tag in ("td", "th") and self.rows:
            self.rows[-1][1].append("")

    def handle_endtag(self, tag):
        while self.open and self.open.pop()[0] != tag:
            pass

    def handle_data(self, data):
        tags = [tag for tag, _ in self.open]
        if "script" in tags or "style" in tags:
            return
        for _, name in self.open:
            if name:
                self.ids[name] = self.ids.get(name, "") + data
        if ("td" in tags or "th" in tags) and self.rows and self.rows[-1][1]:
            self.rows[-1][1][-1] += data

    def parameter(self, joint, name):
        for attributes, cells in self.rows:
            if attributes.get("data-joint") == str(joint) and attributes.get("data-parameter") == name:
                return cells
        raise AssertionError(f"no row for {name} of joint {joint}")


def opened(path, flags, size="1280,900"):
    """The page as the browser has it, and what it said on the console."""
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run(
            [chromium, "--headless=new", "--no-sandbox", f"--user-data-dir={profile}", "--enable-logging=stderr",
             f"--window-size={size}", "--virtual-time-budget=3000", *flags, "--dump-dom", f"file://{path}"],
            capture_output=True, text=True, timeout=240)
    opened.dom = done.stdout
    return Page(done.stdout), [line for line in done.stderr.splitlines() if ":CONSOLE" in line]


def number(text):
    return float(text.replace("\u2212", "-").replace("±", "").replace("°", "").replace(",", ""))


@unittest.skipUnless(chromium, "no chromium; toolchain/setup installs it")
class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        os.chdir(cls.folder.name)
        run("demo", "--out", "demo")
        cls.path = os.path.abspath("demo/report.html")
        with open(cls.path) as file:
            cls.text = file.read()
        cls.page, cls.console = opened(cls.path, WEBGL)
        cls.dom = opened.dom
        with open("demo/robot1-encoder.yaml") as file:
            cls.signature = yaml.load(file, yaml.CSafeLoader)
        cls.data = json.loads(re.search(r'id="report">(.*?)</script>', cls.text, re.S)[1])

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_opens_in_silence(self):
        self.assertEqual(self.console, [])
        self.assertRegex(self.page.ids["headline"], r"By the nominal model the tool misses by [0-9.]+ mm, by the arm signature by")

    def test_opens_in_silence_on_a_phone_and_without_webgl(self):
        page, console = opened(self.path, NO_WEBGL, "390,844")
        self.assertEqual(console, [])
        self.assertIn("no WebGL", page.ids["arm-section"])
        self.assertEqual(page.parameter(3, "a_m"), self.page.parameter(3, "a_m"))

    def test_is_small_and_self_contained(self):
        self.assertLess(len(self.text.encode()), 2_000_000)
        outside = re.findall(r'(?:src|href)\s*=\s*["\']?(?:https?:)?//', self.text)
        self.assertEqual(outside, [])
        self.assertNotIn("@ARMSIG", self.text)
        for licence in ("three 0.", "uplot 1."):
            self.assertIn(licence, self.text)

    def test_has_the_numbers_of_the_signature(self):
        for joint, stated in enumerate(self.signature["joints"], 1):
            for key, name in (("theta_rad", "theta_offset_rad"), ("d_m", "d_m"), ("a_m", "a_m"), ("alpha_rad", "alpha_rad")):
                exact = self.data["parameters"]["rows"][joint - 1]["actual"][key]
                self.assertEqual(exact, stated["pseudo_dh"][name])
                cells = self.page.parameter(joint, key)
                scale = 1e3 if key.endswith("_m") else 180 / math.pi
                decimals = len(cells[3].partition(".")[2])
                self.assertEqual(number(cells[3]), float(f"{scale * exact:.{decimals}f}"), (joint, key))
                sigma = scale * self.data["parameters"]["rows"][joint - 1]["sigma"][key]
                if sigma > 0:
                    self.assertAlmostEqual(number(cells[4]), sigma, delta=0.5001 * 10 ** -decimals)
            sweep, shown = stated["sweep"], self.data["sweeps"][joint - 1]
            for ours, theirs in (("radius_m", "radius_m"), ("used", "used"), ("rejected", "rejected"),
                                 ("rms_radial_m", "residual_radial_m"), ("rms_normal_m", "residual_normal_m"),
                                 ("rms_tangential_m", "residual_tangential_m")):
                self.assertAlmostEqual(shown[ours], sweep[theirs], delta=1e-11)  # fitted again, from 17 digits
            self.assertEqual(len(shown["points"]), sweep["used"] + sweep["rejected"])
        with open("demo/robot1-encoder.yaml") as file:
            self.assertIn(self.page.ids["about"].split("CRC-32 ")[1][:10], file.read())

    def test_explains_parameters_of_nearly_parallel_axes(self):
        self.assertGreater(self.data["parameters"]["rows"][1]["actual"]["d_m"], 100)
        self.assertIn("nearly parallel", self.page.ids["near-parallel"])

    def test_says_what_is_different_joint_by_joint(self):
        differences = self.data["differences"]
        lines = [cells for attributes, cells in self.page.rows if "data-kind" in attributes]
        self.assertEqual(len(lines), len(differences["joints"]))
        self.assertEqual({line["joint"] for line in differences["joints"]}, {2, 3, 4, 5, 6})
        for cells, line in zip(lines, differences["joints"], strict=True):
            self.assertEqual(cells[1].replace("\u00a0", " "), line["what"])
            self.assertAlmostEqual(number(cells[4]), 1e3 * line["effect_rms_m"], delta=0.0006)
        total = 1e3 * differences["total_rms_m"]
        self.assertAlmostEqual(sum(number(cells[5]) for cells in lines), total, delta=0.002 * total + 0.0005 * len(lines))
        self.assertAlmostEqual(total, 1e3 * self.data["map"]["nominal_rms_m"], delta=0.001 * total)

    def test_draws_what_is_different_joint_by_joint(self):
        lines = self.data["differences"]["joints"]
        drawn = re.findall(r"<title>Joint (\d), ([^:<]*): ([^<]*)</title>", self.dom)
        self.assertEqual(len(drawn), len(lines))
        for kind, word in (("tilt", "Tilt"), ("shift", "Shift"), ("zero", "Zero of the reading")):
            self.assertIn(f"<figcaption>{word}</figcaption>", self.dom, kind)
        for line in lines:
            scale = 180 / math.pi if "value_rad" in line else 1e3
            value, sigma = (line.get(f"{name}_rad", line.get(f"{name}_m")) for name in ("value", "sigma"))
            told = [words for joint, what, words in drawn if (int(joint), what) == (line["joint"], line["what"])]
            self.assertEqual(len(told), 1)
            shown, _, off = told[0].partition(" ± ")
            self.assertAlmostEqual(number(shown.replace(" mm", "")), scale * value, delta=0.0006)
            self.assertAlmostEqual(number(off), scale * sigma, delta=0.0006)

    def test_tells_in_words_what_its_charts_show(self):
        self.assertEqual(self.dom.count('class="values"'), 7)  # of six joints, and of the map of the error
        self.assertRegex(self.dom, r'id="map"[^>]*aria-label="[^"]*From [0-9.]+ (mm|µm) to [0-9.]+ (mm|µm)\.')
        self.assertRegex(self.dom, r'id="download"[^>]*href="blob:')
        self.assertIn('touch-action: pan-y', re.search(r'<canvas id="arm"[^>]*>', self.dom)[0])

    def test_predicts_what_is_true(self):
        ratio = self.data["map"]["true_rms_m"] / self.data["map"]["predicted_rms_m"]
        self.assertTrue(1 / 1.6 < ratio < 1.6, ratio)

    def test_shows_the_task_as_the_demonstration_prints_it(self):
        evaluated = json.loads(run("evaluate", "--json", "--arm", "demo/puma560.yaml", "--signature",
                                   "demo/robot1-encoder.yaml", "--truth", "demo/robot1-truth.yaml"))["evaluation"]
        for index in evaluated["with_signature"]:
            self.assertAlmostEqual(self.data["grid"]["with_signature"][index], evaluated["with_signature"][index], delta=1e-12)
        for improvement in evaluated["improvement"]:
            self.assertIn(f"{improvement:.1f} ×", self.page.ids["grid"])

    def test_has_a_certificate(self):
        told = self.data["certificate"]
        known = [source["sigma_m"] for source in told["sources"] if source["sigma_m"] is not None]
        self.assertAlmostEqual(math.hypot(*known), told["combined_m"], delta=1e-12)
        self.assertAlmostEqual(told["combined_m"], self.data["map"]["predicted_rms_m"], delta=1e-12)
        expanded = told["expanded"]
        self.assertIn(f"{1e3 * expanded['length_m']:.3f} mm", self.page.ids["budget"])
        self.assertIn("coverage probability 95 %", self.page.ids["budget"])
        self.assertAlmostEqual(expanded["length_m"], expanded["factor"] * told["combined_m"], delta=1e-12)
        # Of a length that has one direction, and of one that has three alike: nothing is outside of these.
        self.assertTrue(1.6140 <= expanded["factor"] <= 1.9600, expanded)
        self.assertIn(f"k = {expanded['factor']:.2f}", self.page.ids["coverage"])
        for source in ("Repeatability of the arm", "Temperature", "Scale of the instrument"):
            self.assertIn(source, self.page.ids["budget"])
        self.assertIn("RP): not measured", self.page.ids["accuracy"])
        self.assertIn("Readings beyond those measured, which the limits allow: joint 6 beyond −180° to 180°.", self.page.ids["not-measured"])
        self.assertEqual(told["operator"], "")

    def test_tells_sensor_and_model_apart_where_the_sensor_is_stated(self):
        run("simulate", "--arm", "ur10e", "--tolerances", "1", "--sigma-mm", "0.1", "--out", "practice.csv")
        run("identify", "--arm", "ur10e", "--measurements", "practice.csv", "--method", "refined", "--out", "practice.yaml")
        words = ["report", "--signature", "practice.yaml", "--operator", "A. Smith & Sons", "--instrument", "AT960 <tracker>",
                 "--instrument-serial", "4711", "--serial", "20195", "--out", "signed.html"]
        run(*words)
        page, console = opened(os.path.abspath("signed.html"), NO_WEBGL)
        self.assertEqual(console, [])
        for name, place in (("A. Smith & Sons", "about"), ("20195", "about"), ("AT960 <tracker>", "instrument"), ("4711", "instrument")):
            self.assertIn(name, page.ids[f"certificate-{place}"])
        self.assertIn("not traceable", page.ids["traceability"])
        with open("signed.html") as file:
            told = json.loads(re.search(r'id="report">(.*?)</script>', file.read(), re.S)[1])["certificate"]
        by_source = {source["source"]: source["sigma_m"] for source in told["sources"]}
        self.assertAlmostEqual(math.hypot(by_source["Sensor"], by_source["Model"]), told["combined_m"], delta=1e-12)
        self.assertGreater(by_source["Sensor"], by_source["Model"])  # the arm is as the model says
        self.assertIn("left out of the fit in turn", page.ids["accuracy"])

    def test_counts_poses_beside_the_sweeps_as_measured_where_the_method_uses_them(self):
        run("simulate", "--arm", "ur10e", "--tolerances", "1", "--arc", "60", "--sigma-mm", "0.1", "--free-poses", "40", "--out",
            "mixed.csv")
        beyond = {}
        for method in ("encoder", "refined"):
            run("identify", "--arm", "ur10e", "--measurements", "mixed.csv", "--method", method, "--out", "mixed.yaml")
            run("report", "--signature", "mixed.yaml", "--measurements", "mixed.csv", "--out", "mixed.html")
            with open("mixed.html") as file:
                told = json.loads(re.search(r'id="report">(.*?)</script>', file.read(), re.S)[1])["certificate"]["not_measured"]
            beyond[method] = [int(upper) for upper in re.findall(r"joint \d beyond −\d+° to (\d+)°", " ".join(told))]
        self.assertEqual(beyond["encoder"], [30] * 6)
        self.assertEqual(len(beyond["refined"]), 6)
        self.assertGreater(min(beyond["refined"]), 180)

    def test_draws_a_slide_where_the_drawing_has_it_and_says_what_of_its_rows_is_free(self):
        run("simulate", "--arm", "stanford", "--tolerances", "1", "--sigma-mm", "0.1", "--free-poses", "30", "--out", "slide.csv")
        run("identify", "--arm", "stanford", "--measurements", "slide.csv", "--method", "encoder", "--out", "slide.yaml")
        run("report", "--signature", "slide.yaml", "--measurements", "slide.csv", "--out", "slide.html")
        page, console = opened(os.path.abspath("slide.html"), NO_WEBGL)
        self.assertEqual(console, [])
        with open("slide.html") as file:
            told = json.loads(re.search(r'id="report">(.*?)</script>', file.read(), re.S)[1])
        # The target that was measured is 300 mm beside the slide: no part of the arm is.
        for frame in told["arm"]["frames"]:
            for drawn, actual in zip(frame["nominal"], frame["actual"], strict=True):
                self.assertLess(math.dist(drawn, actual), 0.02)
        for joint, key in ((2, "d_m"), (2, "a_m"), (3, "a_m")):
            cells = page.parameter(joint, key)
            self.assertRegex(cells[1], "[†*]$")
            self.assertEqual(cells[5], "")
        self.assertIn("where the line of a slide is put", page.ids["parameter-notes"])
        self.assertIn("30 validation poses, which no fit has used", page.ids["sentences"])  # for good, not in turn
        self.assertIn("positions left out of the fit, one visit each", page.ids["accuracy"])

    def free_poses(self):
        """Free poses of a simulated arm with noise of 0.1 mm, one of them 3 mm off: the data of the page, and the page."""
        run("simulate", "--arm", "ur10e", "--tolerances", "1", "--sigma-mm", "0.1", "--free-poses", "120", "--out", "drawn.csv")
        with open("drawn.csv", newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        with open("free.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            free = [row for row in rows if row["sweep"] == "0"]
            free[49]["x_mm"] = str(float(free[49]["x_mm"]) + 3)
            writer.writerows(free)
        self.assertEqual(len(free), 120)
        identified = json.loads(run("identify", "--json", "--arm", "ur10e", "--measurements", "free.csv", "--out", "free.yaml"))
        run("report", "--signature", "free.yaml", "--measurements", "free.csv", "--laboratory", "Laboratory, Street 1", "--customer", "Works",
            "--place", "Hall 3", "--measured-on", "2026-11-20", "--conditions", "1.2 kg", "--certificate-number", "K-1",
            "--instrument-certificate", "D-4711", "--out", "free.html")
        page, console = opened(os.path.abspath("free.html"), NO_WEBGL)
        self.assertEqual(console, [])
        with open("free.html") as file:
            return json.loads(re.search(r'id="report">(.*?)</script>', file.read(), re.S)[1]), page, identified

    def test_shows_free_poses_one_by_one(self):
        data, page, identified = self.free_poses()
        poses = data["poses"]
        self.assertEqual(len(poses["poses"]), 120)
        self.assertEqual([pose["line"] for pose in poses["poses"] if pose["outlier"]], [51])  # below the header
        lengths = [math.hypot(*pose["e"]) for pose in poses["poses"]]
        self.assertAlmostEqual(math.sqrt(sum(length ** 2 for length in lengths) / 120), poses["signature"]["rms_m"], delta=1e-8)
        histogram = poses["histogram"]
        self.assertEqual(histogram["counts"], [float(sum(1 for length in lengths if min(36, length // histogram["bin_m"]) == k)) for k in range(37)])
        self.assertAlmostEqual(sum(histogram["expected"]), 120, delta=1e-6)
        worst = [(attributes["data-line"], cells) for attributes, cells in page.rows if "data-line" in attributes]
        self.assertEqual(len(worst), 10)
        self.assertEqual(worst[0][0], "51")
        self.assertIn("outlier", worst[0][1])
        self.assertEqual([number(cells[1]) for _, cells in worst], sorted((number(cells[1]) for _, cells in worst), reverse=True))
        self.assertNotIn("sweeps", page.ids)
        # One figure stands for the signature, and it is the one that identify prints.
        figure = identified["cross_validation"]["rms_m"]
        self.assertEqual([pose["line"] for pose in poses["poses"] if pose["outlier"]], identified["refinement"]["rejected_lines"])
        self.assertAlmostEqual(poses["nominal"]["rms_m"], identified["refinement"]["nominal_rms_m"], delta=1e-12)
        self.assertAlmostEqual(data["verdict"]["validation"]["rms_m"], figure, delta=1e-12)
        self.assertIn(f"{1e3 * figure:.3f} mm" if figure < 1e-3 else f"{1e3 * figure:.2f} mm", page.ids["headline"])
        self.assertEqual(len(page.ids["other-figures-table"].split("mm")) - 1, len(data["verdict"]["other_figures"]))

    def test_has_a_certificate_with_what_each_sheet_has_to_say(self):
        _, page, _ = self.free_poses()
        for name, place in (("Laboratory, Street 1", "about"), ("Works", "about"), ("Hall 3", "about"), ("2026-11-20", "about"),
                            ("1.2 kg", "conditions"), ("D-4711", "instrument"), ("free.csv: 120 rows", "origin")):
            self.assertIn(name, page.ids[f"certificate-{place}"])
        self.assertIn("traceable to the metre", page.ids["traceability"])
        sheets = page.ids["sheets"]
        pages = re.findall(r"Calibration certificate K-1, UR10e\s*page (\d) of (\d)", sheets)
        self.assertGreaterEqual(len(pages), 2)
        self.assertEqual(pages, [(str(k + 1), str(len(pages))) for k in range(len(pages))])
        self.assertTrue(sheets.index("End of the certificate") > sheets.index("Authorised by"))
        self.assertIn("Before: nominal parameters", page.ids["adjustment"])
        self.assertIn("After: parameters of the signature", page.ids["adjustment"])
        self.assertIn("joint 1 beyond", page.ids["not-measured"])

    def test_takes_no_serial_number_but_the_signatures(self):
        run("identify", "--arm", "demo/puma560.yaml", "--measurements", "demo/robot1-measurements.csv", "--sensor",
            "demo/sensor.yaml", "--serial", "0042", "--out", "numbered.yaml")
        words = [armsig, "report", "--signature", "numbered.yaml", "--out", "numbered.html", "--serial"]
        self.assertEqual(subprocess.run([*words, "0042"], capture_output=True).returncode, 0)
        other = subprocess.run([*words, "0043"], capture_output=True, text=True)
        self.assertEqual(other.returncode, 2)
        self.assertIn("0042", other.stderr)

    def test_says_in_words_what_a_sinusoid_means(self):
        with open("demo/robot1-measurements.csv", newline="") as file:
            lines = [line for line in file if not line.startswith("#")]
        rows = list(csv.DictReader(lines))
        for row in rows:
            if row["sweep"] == "4":
                reading = math.radians(float(row["q4_deg"]))
                row["q4_deg"] = str(math.degrees(reading + math.radians(0.1) * math.sin(reading)))
        with open("eccentric.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
        run("identify", "--arm", "demo/puma560.yaml", "--measurements", "eccentric.csv", "--sensor", "demo/sensor.yaml",
            "--out", "s.yaml")
        run("report", "--signature", "s.yaml", "--measurements", "eccentric.csv", "--sensor", "demo/sensor.yaml", "--out",
            "r.html")
        page, console = opened(os.path.abspath("r.html"), WEBGL)
        self.assertEqual(console, [])
        found = re.search(r"A sinusoid, once per turn: the readings of this joint err by ([0-9.]+)° ± ([0-9.]+)°",
                          page.ids["sweeps"])
        self.assertTrue(found)
        self.assertAlmostEqual(float(found[1]), 0.1, delta=max(0.003, 5 * float(found[2])))
        self.assertIn("disk is mounted off its centre", page.ids["sweeps"])
        self.assertIn("encoder of joint 4", page.ids["next-steps"])

    def test_has_no_certificate_of_other_measurements(self):
        self.assertIn("robot1-measurements.csv: 720 rows, CRC-32 of the rows 0x", self.page.ids["certificate-origin"])
        run("simulate", "--arm", "demo/puma560.yaml", "--truth", "demo/robot1-truth.yaml", "--sensor", "demo/sensor.yaml", "--seed",
            "9", "--out", "later.csv")
        run("report", "--signature", "demo/robot1-encoder.yaml", "--measurements", "later.csv", "--sensor", "demo/sensor.yaml",
            "--out", "later.html")
        page, console = opened(os.path.abspath("later.html"), NO_WEBGL)
        self.assertEqual(console, [])
        words = "later.csv holds other measurements than robot1-measurements.csv"
        self.assertIn(words, page.ids["warnings"])
        self.assertIn(words, page.ids["certificate-section"])
        self.assertIn("No certificate", page.ids["certificate-section"])
        self.assertNotIn("certificate-about", page.ids)

    def test_does_without_measurements(self):
        run("report", "--signature", "demo/robot2-encoder.yaml", "--out", "bare.html")
        page, console = opened(os.path.abspath("bare.html"), WEBGL)
        self.assertEqual(console, [])
        self.assertRegex(page.ids["headline"], r"^At validation poses the tool is [0-9.]+ mm from where the arm signature puts it\.$")
        self.assertIn("--measurements", page.ids["sweeps"])


unittest.main(argv=[sys.argv[0]])
