#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""The server of the controller's live page, as strangers and careless friends use it: live_server_test.py ARMSIG ARMSIGD CONFIGURATION

Without the key nothing is told; names of elsewhere, other origins, garbage and crowds are refused; a second viewer looks on;
a reader that does not read is dropped; the console that goes and comes back is told.
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

from cabinet import Cabinet, Page, wait_for

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


class LiveServer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.cabinet = Cabinet(armsigd, configuration, cls.folder.name, 20)
        cls.cabinet.start()
        cls.page = Page(armsig, cls.cabinet.console, "--web").start()
        stream = Stream(cls.page, "first")
        stream.until(lambda state: state["status"].get("mode") == "idle")
        stream.close()

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

    def ask(self, viewer, verb, **changed):
        body = json.dumps({"viewer": viewer, "verb": verb}).encode()
        status, self.words = self.get(f"/{self.page.token}/request", "POST", body=body, Content_Type="application/json", **changed)
        return status

    def open(self, viewer):
        stream = Stream(self.page, viewer)
        self.addCleanup(stream.close)
        return stream

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
        for name in ("", "live.css", "main.js", "arm.js", "dials.js", "meaning.js", "black_box.js", "words.js", "advice.json"):
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


unittest.main(argv=[sys.argv[0]])
