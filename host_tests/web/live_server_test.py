#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The server of the controller's live page, as strangers and careless friends use it: live_server_test.py ARMSIG ARMSIGD CONFIGURATION

Without the key nothing is told; names of elsewhere, other origins, garbage and crowds are refused; a second viewer looks on;
a reader that does not read is dropped; the console that goes and comes back is told. Of a request only the values of its own
verb are taken, within their bounds, and the controller is sent nothing else.
"""
import http.client
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
import unittest

from cabinet import Cabinet, Page, Tap, changed, kPrismatic, wait_for

armsig, armsigd, configuration = sys.argv[1:4]
del sys.argv[1:4]
kMostViewers = 6


class Stream:
    """The events that one viewer is sent."""

    def __init__(self, page, viewer):
        self.socket = socket.create_connection(("127.0.0.1", page.port), 10)
        self.socket.sendall(f"GET /{page.token}/events?viewer={viewer} HTTP/1.1\r\nHost: 127.0.0.1:{page.port}\r\n\r\n".encode())
        self.answer = http.client.HTTPResponse(self.socket)
        self.answer.begin()

    def close(self):
        self.answer.close()
        self.socket.close()

    def next(self, name="state"):
        """The data of the next event of this name."""
        for _ in range(1000):
            kind = self.answer.readline().decode().strip()
            if kind == f"event: {name}":
                return json.loads(self.answer.readline().decode()[len("data: "):])
        raise AssertionError(f"no event {name}")

    def until(self, condition, timeout=30):
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            state = self.next()
            if condition(state):
                return state
        raise AssertionError(f"never: {state}")


class Served(unittest.TestCase):
    changes = {}  # of the configuration

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.cabinet = Cabinet(armsigd, changed(configuration, cls.folder.name, cls.changes), cls.folder.name, 20)
        cls.cabinet.start()
        cls.tap = Tap(cls.cabinet.console, os.path.join(cls.folder.name, "tap"))
        cls.page = Page(armsig, cls.console(), "--web").start()
        stream = Stream(cls.page, "first")
        stream.until(lambda state: state["status"].get("mode") == "idle")
        stream.close()

    @classmethod
    def console(cls):
        return cls.cabinet.console

    @classmethod
    def tearDownClass(cls):
        cls.page.stop()
        cls.cabinet.stop()
        cls.folder.cleanup()

    def get(self, path, method="GET", host=None, body=None, **headers):
        link = http.client.HTTPConnection("127.0.0.1", self.page.port, timeout=10)
        link.putrequest(method, path, skip_host=True)
        link.putheader("Host", host or f"127.0.0.1:{self.page.port}")
        if body is not None:
            link.putheader("Content-Length", str(len(body)))
        for name, value in headers.items():
            link.putheader(name.replace("_", "-"), value)
        link.endheaders(body)
        answer = link.getresponse()
        self.headers = answer.headers
        text = answer.read().decode()
        link.close()
        return answer.status, text

    def post(self, body, **changed):
        status, self.words = self.get(f"/{self.page.token}/request", "POST", body=body.encode(), Content_Type="application/json", **changed)
        return status

    def ask(self, viewer, verb, **changed):
        return self.post(json.dumps({"viewer": viewer, "verb": verb}), **changed)

    def open(self, viewer):
        stream = Stream(self.page, viewer)
        self.addCleanup(stream.close)
        return stream


class LiveServer(Served):
    def test_tells_nothing_without_the_key(self):
        wrong = "0" * 32
        for path in ("/", "/page.html", f"/{wrong}/", f"/{wrong}/events?viewer=a", f"/{self.page.token[:-1]}/", f"/{self.page.token}",
                     f"//{self.page.token}/", f"/x/../{self.page.token}/", f"/{self.page.token}0/advice.json"):
            status, text = self.get(path)
            self.assertEqual(status, 403, path)
            self.assertNotIn(self.page.token, text)
        self.assertEqual(self.get(f"/{wrong}/request", "POST", body=b'{"viewer":"a","verb":"stop"}', Content_Type="application/json")[0], 403)
        self.assertEqual(self.get(f"/{self.page.token}/")[0], 200)

    def test_answers_to_its_own_name_only(self):
        path = f"/{self.page.token}/"
        for host in ("evil.example", f"evil.example:{self.page.port}", "127.0.0.1", f"127.0.0.1:{self.page.port + 1}", ""):
            self.assertIn(self.get(path, host=host or " ")[0], (400, 403), host)
        self.assertEqual(self.get(path, host=f"localhost:{self.page.port}")[0], 200)

    def test_takes_no_request_of_another_origin(self):
        stream = self.open("origin")
        stream.next()
        self.assertEqual(self.ask("origin", "stop", Origin="http://evil.example"), 403)
        self.assertEqual(self.ask("origin", "stop", Origin="null"), 403)
        body = b'{"viewer":"origin","verb":"stop"}'
        self.assertEqual(self.get(f"/{self.page.token}/request", "POST", body=body, Content_Type="text/plain")[0], 400)
        self.assertNotIn("mode=faulted", self.cabinet.ask("status")[0])

    def test_offers_only_the_quick_stop_before_anything_is_known(self):
        buttons = re.findall(r"<button[^>]*>", self.get(f"/{self.page.token}/")[1])
        verbs = [re.search(r'data-verb="([^"]*)"', button) for button in buttons if " disabled" not in button]
        self.assertEqual([verb[1] for verb in verbs if verb], ["stop"])
        self.assertGreater(len(buttons), 10)

    def test_lets_a_page_load_nothing_from_elsewhere(self):
        for name in ("", "live.css", "main.js", "arm.js", "dials.js", "jog.js", "meaning.js", "black_box.js", "words.js", "advice.json"):
            status, text = self.get(f"/{self.page.token}/{name}")
            self.assertEqual(status, 200, name)
            self.assertIn("default-src 'none'", self.headers["Content-Security-Policy"])
            self.assertIn("frame-ancestors 'none'", self.headers["Content-Security-Policy"])
            self.assertEqual(self.headers["X-Content-Type-Options"], "nosniff")
            self.assertEqual(self.headers["Referrer-Policy"], "no-referrer")
            self.assertNotRegex(text, r"(?:src|href|url)\s*[=(]\s*[\"']?(?:https?:)?//")

    def test_gives_no_file_but_its_own(self):
        for name in ("../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "nothing", "page.html/x"):
            self.assertEqual(self.get(f"/{self.page.token}/{name}")[0], 404, name)
        self.assertEqual(self.get(f"/{self.page.token}/", "DELETE")[0], 405)

    def test_refuses_garbage(self):
        stream = self.open("garbage")
        stream.next()
        path = f"/{self.page.token}/request"
        for body in (b"", b"{", b"[]", b"null", b'{"viewer":1,"verb":"stop"}', b'{"viewer":"garbage","verb":"move q1_deg=9"}',
                     b'{"viewer":"garbage","verb":"stop\\nenable"}', b'{"viewer":"gar bage","verb":"stop"}', b"\xff\xfe", b"[" * 400):
            self.assertEqual(self.get(path, "POST", body=body, Content_Type="application/json")[0], 400, body)
        self.assertEqual(self.get(path, "POST", body=b"x" * 5000, Content_Type="application/json")[0], 413)
        self.assertEqual(self.get(f"/{self.page.token}/events")[0], 400)
        self.assertEqual(self.get(f"/{self.page.token}/events?viewer=a%0Ab")[0], 400)
        for bytes_ in (b"\0" * 100, b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"A" * 20000):
            with socket.create_connection(("127.0.0.1", self.page.port), 10) as link:
                link.sendall(bytes_)
        self.assertTrue(stream.next()["linked"])
        self.assertIn("mode=", self.cabinet.ask("status")[0])

    def test_gives_the_controls_to_one_and_quick_stop_to_all(self):
        first, second = self.open("first"), self.open("second")
        first.next(), second.next()
        self.assertEqual(self.ask("first", "take-over"), 202)
        first.until(lambda state: state["holds"])
        self.assertFalse(second.until(lambda state: state["viewers"] >= 2)["holds"])
        self.assertEqual(self.ask("second", "enable"), 403)
        self.assertIn("another viewer holds the controls", self.words)
        self.assertEqual(self.ask("nobody", "enable"), 403)
        self.assertEqual(self.ask("nobody", "take-over"), 202)  # who does not look can't take
        self.assertTrue(first.next()["holds"])
        self.assertEqual(self.ask("second", "stop"), 202)
        faulted = first.until(lambda state: state["status"].get("mode") == "faulted")
        self.assertEqual(faulted["status"]["fault"], "QUICK_STOP")
        self.assertEqual(self.ask("second", "reset"), 403)
        self.assertEqual(self.ask("second", "take-over"), 202)
        self.assertFalse(first.until(lambda state: not state["holds"])["free"])
        self.assertEqual(self.ask("first", "reset"), 403)
        self.assertEqual(self.ask("second", "reset"), 202)
        second.until(lambda state: state["status"].get("mode") == "idle")
        second.close()
        first.until(lambda state: state["free"])
        self.assertEqual(self.ask("first", "enable"), 403)  # free controls are taken as well, not had
        self.assertIn("nobody holds the controls; take them over first", self.words)

    def test_bounds_how_many_look(self):
        streams = []
        wait_for(lambda: self.viewers() == 0)
        for k in range(kMostViewers):
            streams.append(self.open(f"crowd{k}"))
        self.assertEqual(self.get(f"/{self.page.token}/events?viewer=late")[0], 503)
        self.assertEqual(self.get(f"/{self.page.token}/")[0], 200)
        self.assertEqual(self.ask("late", "stop"), 202)
        streams[0].until(lambda state: state["status"].get("mode") == "faulted")
        for stream in streams:
            stream.close()
        wait_for(lambda: self.viewers() == 0)
        self.cabinet.ask("reset")

    def viewers(self):
        """How many look, but for ourselves."""
        try:
            stream = Stream(self.page, "count")
            try:
                return stream.next()["viewers"] - 1
            finally:
                stream.close()
        except (AssertionError, OSError):
            return kMostViewers

    def test_drops_a_reader_that_does_not_read(self):
        wait_for(lambda: self.viewers() == 0)
        slow = socket.socket()
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        slow.connect(("127.0.0.1", self.page.port))
        self.addCleanup(slow.close)
        slow.sendall(f"GET /{self.page.token}/events?viewer=slow HTTP/1.1\r\nHost: 127.0.0.1:{self.page.port}\r\n\r\n".encode())
        watching = self.open("watching")
        watching.until(lambda state: state["viewers"] == 2)
        watching.until(lambda state: state["viewers"] == 1, 200)

    def test_tells_at_once_that_the_controller_has_gone(self):
        stream = self.open("gone")
        stream.until(lambda state: state["linked"])
        self.cabinet.process.kill()
        killed = time.monotonic()
        self.cabinet.process.wait()
        state = stream.until(lambda state: not state["linked"])
        self.assertLess(time.monotonic() - killed, 2)
        self.assertNotEqual(state["why"], "")
        self.cabinet.process = None
        os.unlink(self.cabinet.console)
        self.cabinet.start()
        stream.until(lambda state: state["linked"] and state["status"].get("mode") == "idle")

    def test_says_why_it_does_not_start(self):
        def refused(*words):
            done = subprocess.run([armsig, "connect", *words], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, 2, done)
            return done.stderr
        self.assertIn("is taken", refused(self.cabinet.console, "--web", str(self.page.port)))
        self.assertIn("no/such", refused("no/such", "--web"))
        refused(self.cabinet.console, "--web", "70000")
        bad = os.path.join(self.folder.name, "bad-token")
        with open(bad, "w") as file:
            file.write("../../x\n")
        self.assertIn("bad-token", refused(self.cabinet.console, "--web", "--token-file", bad))

    def peak_kib(self):
        with open(f"/proc/{self.page.process.pid}/status") as file:
            return int(re.search(r"VmHWM:\s+(\d+) kB", file.read())[1])

    def flooded(self, head, piece):
        """What is sent to it, 8 MiB of pieces at most, until it takes no more; of 24 strangers one after the other."""
        before = self.peak_kib()
        for _ in range(24):
            with socket.create_connection(("127.0.0.1", self.page.port), 10) as stranger:
                sent = 0
                try:
                    stranger.sendall(head)
                    while sent < 8 << 20:
                        stranger.sendall(piece)
                        sent += len(piece)
                except OSError:
                    pass  # it has ended the connection
                self.assertLess(sent, 8 << 20)
        return self.peak_kib() - before

    def test_holds_little_of_what_a_stranger_sends(self):
        host = f"Host: 127.0.0.1:{self.page.port}\r\n".encode()
        for name, head, piece in (
                ("a request line without an end", b"GET /", b"a" * 65536),
                ("a header without an end", b"GET / HTTP/1.1\r\n" + host + b"X: ", b"a" * 65536),
                ("headers without an end", b"GET / HTTP/1.1\r\n" + host, b"X: y\r\n" * 10000),
                ("a chunked body", b"POST / HTTP/1.1\r\n" + host + b"Transfer-Encoding: chunked\r\n\r\n", b"10000\r\n" + b"a" * 65536 + b"\r\n"),
                ("a chunk without an end", b"POST / HTTP/1.1\r\n" + host + b"Transfer-Encoding: chunked\r\n\r\n", b"1" * 65536),
                ("a long body", b"POST / HTTP/1.1\r\n" + host + b"Content-Length: 1000000000\r\n\r\n", b"a" * 65536)):
            with self.subTest(name):
                self.assertLess(self.flooded(head, piece), 4096)
        self.assertEqual(self.get(f"/{self.page.token}/")[0], 200)

    def test_serves_no_ranges(self):
        many = "bytes=" + ",".join(["0-"] * 200)
        status, text = self.get(f"/{self.page.token}/main.js", Range=many)
        self.assertEqual((status, text), self.get(f"/{self.page.token}/main.js"))
        self.assertEqual(status, 200)
        self.assertLess(len(self.get("/", Range=many)[1]), 200)

    def test_believes_no_key_that_others_may_read(self):
        def start(file):
            return subprocess.run([armsig, "connect", self.cabinet.console, "--web", "--token-file", file], capture_output=True,
                                  text=True, timeout=60)
        key = os.path.join(self.folder.name, "open-key")
        with open(key, "w") as file:
            file.write("0123456789abcdef" * 2)
        for mode in (0o644, 0o640, 0o604, 0o620, 0o602):
            os.chmod(key, mode)
            done = start(key)
            self.assertEqual(done.returncode, 2, oct(mode))
            self.assertIn("others may read or write it", done.stderr)
        os.chmod(key, 0o600)
        link = os.path.join(self.folder.name, "link")
        os.symlink(key, link)
        self.assertEqual(start(link).returncode, 2)
        os.mkfifo(os.path.join(self.folder.name, "pipe"), 0o600)
        self.assertEqual(start(os.path.join(self.folder.name, "pipe")).returncode, 2)
        if os.geteuid() == 0:
            os.chown(key, 65534, 65534)
            self.assertIn("another user", start(key).stderr)

    def test_keeps_its_key_where_it_is_told(self):
        kept = os.path.join(self.folder.name, "token")
        first = Page(armsig, self.cabinet.console, "--web", "--token-file", kept).start()
        first.stop()
        self.assertEqual(os.stat(kept).st_mode & 0o777, 0o600)
        second = Page(armsig, self.cabinet.console, "--web", "--token-file", kept).start()
        second.stop()
        self.assertEqual(first.token, second.token)
        self.assertNotEqual(first.token, self.page.token)


class Requests(Served):
    """Of an arm whose third joint is prismatic, and whose first is unreferenced."""
    changes = kPrismatic | {"gear_ratio: 100, zero_counts: 0, reversed: no,": "gear_ratio: 100, reference: none,",
                            "accept_sent: ": "touches: {file: touches.csv}\naccept_sent: "}

    @classmethod
    def console(cls):
        return os.path.join(cls.folder.name, "tap")

    def setUp(self):
        self.stream = self.open("typist")
        self.assertEqual(self.ask("typist", "take-over"), 202)
        self.stream.until(lambda state: state["holds"])
        self.addCleanup(self.at_rest)

    def at_rest(self):
        self.cabinet.ask("halt", "disable")
        self.stream.until(lambda state: state["status"]["mode"] == "idle")

    def send(self, verb, **values):
        return self.post(json.dumps({"viewer": "typist", "verb": verb, **values}))

    def answer_to(self, verb, **values):
        """Of the controller."""
        known = (self.stream.next()["answer"] or {"number": 0})["number"]
        self.assertEqual(self.send(verb, **values), 202, self.words)
        answer = self.stream.until(lambda state: state["answer"] and state["answer"]["number"] > known)["answer"]
        self.assertEqual(answer["verb"], verb)
        return answer["words"]

    def refuses(self, reason, *bodies):
        """Each of `bodies`, what follows viewer and verb in the text of a request."""
        sent = len(self.tap.commands())
        for body in bodies:
            with self.subTest(body):
                self.assertEqual(self.post('{"viewer":"typist",' + body + "}"), 400)
                self.assertIn(reason, self.words)
        self.stream.next(), self.stream.next()
        self.assertEqual(self.tap.commands()[sent:], [])

    def test_takes_no_number_out_of_its_bounds(self):
        bad = ("0", "-1", "-1e-9", "true", "null", '"1"', '"1\\nstop"', "[1]", '{"a":1}', '""')
        for value in (*bad, "100.001", "1e300"):
            if value != '{"a":1}':
                self.refuses("accuracy_mm needs a number above 0, at most 100", f'"verb":"identify","accuracy_mm":{value}')
        for value in (*bad, "4320.1"):
            if value != '{"a":1}':
                self.refuses("minutes needs a number above 0, at most 4320", f'"verb":"identify","accuracy_mm":1,"minutes":{value}')
        for value in ("0", "5.001", "-5.001", "1e300", '"1"', "true", "null"):
            self.refuses("step_deg needs a number from -5 to 5, other than 0", f'"verb":"move","joint":2,"step_deg":{value}')
        for value in ("NaN", "nan", "Infinity", "-Infinity", "1e999", "-1e999", "0x1", "+1", ".5", "1\nstop", '{"a":1}', "1,"):
            self.refuses("not a request of the page", f'"verb":"identify","accuracy_mm":{value}',
                         f'"verb":"move","joint":2,"step_deg":{value}', f'"verb":"home","joint":{value}')

    def test_takes_no_joint_that_the_arm_has_not(self):
        for value in ("0", "7", "-1", "1.5", "1e300", '"1"', "true", "null", "18446744073709551617"):
            self.refuses("joint needs the number of a joint, 1 to 6", f'"verb":"home","joint":{value}')
            self.refuses("joint needs the number of a revolute joint", f'"verb":"move","joint":{value},"step_deg":1')
            self.refuses("joint needs the number of a prismatic joint", f'"verb":"move","joint":{value},"step_mm":1')
        self.refuses("revolute", '"verb":"move","joint":3,"step_deg":1')
        self.refuses("prismatic", '"verb":"move","joint":2,"step_mm":1')

    def test_takes_no_place_but_a_name(self):
        for value in ('""', "1", "null", "true", '["A1"]', '"A 1"', '"A1\\nstop"', '"A,1"', '"=A1"', '"-A"', '"../A"', '"\\u00e9"', '"A1 place=B1"',
                      '"A1\\u0000"', '"' + 33 * "A" + '"'):
            self.refuses("place needs a letter or digit", f'"verb":"touch","place":{value}')
        self.refuses("takes place\n", '"verb":"touch"', '"verb":"touch","place":"A1","joint":1')
        self.refuses("takes nothing\n", '"verb":"drop-touch","place":"A1"')

    def test_takes_exactly_the_keys_of_a_verb(self):
        self.refuses("takes nothing\n", *(f'"verb":"{verb}","{key}":1' for verb in ("enable", "stop", "check", "accept", "halt", "take-over")
                                          for key in ("joint", "accuracy_mm", "", "x y", "step_deg\\nstop")))
        self.refuses("takes nothing, or accuracy_mm, or accuracy_mm and minutes", '"verb":"identify","minutes":30', '"verb":"identify","anew":"yes"',
                     '"verb":"identify","accuracy_mm":1,"anew":"yes"', '"verb":"identify","accuracy_mm anew=yes":1',
                     '"verb":"identify","accuracy_mm":1,"minutes":1,"joint":1')
        self.refuses("takes joint and step_deg, or joint and step_mm", '"verb":"move"', '"verb":"move","joint":1', '"verb":"move","step_deg":1',
                     '"verb":"move","joint":1,"step_deg":1,"step_mm":1', '"verb":"move","q1_deg":1', '"verb":"move","joint":1,"step_deg":1,"pace":1')
        self.refuses("takes joint\n", '"verb":"home"', '"verb":"home","q1_deg":1')
        self.refuses("none that the page has", '"verb":"confirm","q1_deg":1', '"verb":"move dq1_deg=1"', '"verb":"enable\\nstop"', '"verb":"touch-grid"',
                     '"verb":1', '"verb":null')
        # Of two values another reader may take the other.
        self.refuses("not a request of the page", '"verb":"enable","verb":"stop"', '"verb":"enable","viewer":"typist"',
                     '"verb":"move","joint":1,"joint":2,"step_deg":1')
        self.refuses("not a request of the page", *('"verb":"enable"' + rest for rest in (",", "}{", "\0", '\n"stop"')))

    def test_sends_the_controller_the_values_in_words_of_its_own(self):
        sent = len(self.tap.commands())
        self.assertEqual(self.answer_to("enable"), "ok")
        holding = self.stream.until(lambda state: state["status"]["mode"] == "holding")["status"]
        steps = ((2, "step_deg", -1), (3, "step_mm", 5), (1, "step_deg", 0.1), (2, "step_deg", 1e-3))
        for joint, key, step in steps:
            reading = f"q{joint}_{key.removeprefix('step_')}"
            target = float(self.stream.next()["status"][reading]) + step
            self.assertEqual(self.answer_to("move", joint=joint, **{key: step}), "ok")
            self.stream.until(lambda state: state["status"]["mode"] == "holding" and abs(float(state["status"][reading]) - target) < 5e-3)
        self.assertEqual(self.tap.commands()[sent:], ["enable", "move dq2_deg=-1 pace=0.1", "move dq3_mm=5 pace=0.1", "move dq1_deg=0.1 pace=0.1",
                                                      "move dq2_deg=0.001 pace=0.1"])
        after = self.stream.next()["status"]
        for key, by in (("q1_deg", 0.1), ("q2_deg", -0.999), ("q3_mm", 5), ("q4_deg", 0)):
            self.assertAlmostEqual(float(after[key]) - float(holding[key]), by, delta=0.01, msg=key)
        self.assertEqual(after["unreferenced"], "1")
        self.assertIn("reference: homed", self.answer_to("home", joint=1))
        self.assertIn("UNREFERENCED", self.answer_to("identify", accuracy_mm=0.15, minutes=30))
        self.assertIn("UNREFERENCED", self.answer_to("identify", accuracy_mm=1e-5))
        self.assertIn("UNREFERENCED", self.answer_to("check"))
        self.assertIn("UNREFERENCED", self.answer_to("touch", place="Bar-2.left_end"))
        self.assertIn("there is no touch to drop", self.answer_to("drop-touch"))
        self.assertEqual(self.tap.commands()[sent + 5:], ["home joint=1", "identify accuracy_mm=0.15 minutes=30", "identify accuracy_mm=1e-05", "check",
                                                          "touch place=Bar-2.left_end", "drop-touch"])

    def test_learns_from_the_controller_what_is_possible_when(self):
        late = self.open("late")
        verbs = late.next("arm")["verbs"]
        self.assertEqual(verbs["move"], {"modes": ["holding"], "alone": True})
        self.assertEqual(verbs["enable"], {"modes": ["idle"], "alone": False})
        self.assertEqual(verbs["accept"], {"modes": ["idle", "holding"], "alone": True})
        self.assertEqual(verbs["touch"], {"modes": ["idle", "holding"], "alone": False})
        self.assertEqual(set(verbs), {"stop", "enable", "disable", "halt", "reset", "identify", "pause", "resume", "check", "accept", "rollback",
                                      "acknowledge", "home", "move", "touch", "drop-touch"})
        late.close()


unittest.main(argv=[sys.argv[0]])
