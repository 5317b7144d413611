# SPDX-License-Identifier: MIT
"""A headless Chromium, driven over its debugging pipe: nothing but the standard library."""
import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

kLaidOut_s = 0.3  # after a change of what there is to see

chromium = shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    def __init__(self):
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        to_browser, self.sending = os.pipe()
        self.receiving, from_browser = os.pipe()
        # Above 4, so that 3 and 4 are free to be what the browser expects.
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_browser, from_browser)]

        def three_and_four():
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(
            [chromium, "--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", "--no-first-run",
             f"--user-data-dir={self.profile.name}", "about:blank"],
            preexec_fn=three_and_four, pass_fds=(3, 4), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for end in (to_browser, from_browser, *ends):
            os.close(end)
        self.number, self.received, self.heard = 0, b"", []

    def close(self):
        try:
            self.call("Browser.close")
            self.process.wait(20)
        except (RuntimeError, OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        os.close(self.sending)
        os.close(self.receiving)
        self.profile.cleanup()

    def call(self, method, session=None, timeout=60, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.sending, json.dumps(message).encode() + b"\0")
        until = time.monotonic() + timeout
        while time.monotonic() < until:
            for told in self.receive(until - time.monotonic()):
                if told.get("id") != self.number:
                    self.heard.append(told)
                elif "error" in told:
                    raise RuntimeError(f"{method}: {told['error']}")
                else:
                    return told["result"]
        raise RuntimeError(f"{method}: no answer")

    def receive(self, timeout):
        if not select.select([self.receiving], [], [], max(0, timeout))[0]:
            return []
        part = os.read(self.receiving, 1 << 20)
        if not part:
            raise RuntimeError("the browser has gone")
        *whole, self.received = (self.received + part).split(b"\0")
        return [json.loads(text) for text in whole]


class Tab:
    def __init__(self, browser, address, width=1400, height=900, dark=False):
        self.browser = browser
        target = browser.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        self.call("Performance.enable", timeDomain="threadTicks")
        self.look(width, height, dark)
        self.call("Page.navigate", url=address)

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def look(self, width, height, dark=False, reduced=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 500)
        self.call("Emulation.setEmulatedMedia", features=[
            {"name": "prefers-color-scheme", "value": "dark" if dark else "light"},
            {"name": "prefers-reduced-motion", "value": "reduce" if reduced else "no-preference"}])

    def ask(self, expression):
        told = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in told:
            raise AssertionError(f"{expression}: {told['exceptionDetails']}")
        return told["result"].get("value")

    def processor_s(self):
        """What the page has taken of a processor so far, whatever else the machine has to do."""
        metrics = self.call("Performance.getMetrics")["metrics"]
        return next(metric["value"] for metric in metrics if metric["name"] == "TaskDuration")

    def text(self, identifier):
        return self.ask(f"document.getElementById({json.dumps(identifier)}).textContent")

    def wait(self, expression, timeout=30):
        """Until `expression` is true in the page."""
        until = time.monotonic() + timeout
        while time.monotonic() < until:
            if self.ask(f"document.readyState === 'complete' && location.protocol === 'http:' && !!({expression})"):
                return
            time.sleep(0.05)
        raise AssertionError(f"not within {timeout} s: {expression}; the page says: {self.ask('document.body.innerText')}")

    def click(self, selector, timeout=0):
        """What a finger finds at the middle of it is clicked, as soon as that is it and it is not disabled.

        Looked at and clicked in one breath: news may disable a button between two questions.
        """
        click = f"""(() => {{
          const it = document.querySelector({json.dumps(selector)});
          if (it.getBoundingClientRect().y < 0 || it.getBoundingClientRect().bottom > innerHeight) {{
            it.scrollIntoView({{ block: 'center', behavior: 'instant' }});
          }}
          const box = it.getBoundingClientRect();
          const there = document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2);
          if (it.disabled || !it.contains(there)) return false;
          it.click();
          return true; }})()"""
        if timeout:
            self.wait(click, timeout)
        elif not self.ask(click):
            raise AssertionError(f"{selector} can't be clicked")

    def picture(self, path, whole=False, clip=None):
        """Of the window, of the whole page, or of a part of it."""
        part = {"clip": clip} if clip else {}
        if whole:  # it is laid out without a scroll bar then, and cut as if there were one
            self.call("Emulation.setScrollbarsHidden", hidden=True)
            time.sleep(kLaidOut_s)
        told = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole or clip is not None, **part)
        with open(path, "wb") as file:
            file.write(base64.b64decode(told["data"]))
        if whole:
            self.call("Emulation.setScrollbarsHidden", hidden=False)

    def complaints(self):
        """What the page said on the console, and requests to elsewhere."""
        said = []
        for told in self.browser.heard:
            if told.get("sessionId") != self.session:
                continue
            parameters = told.get("params", {})
            if told.get("method") in ("Runtime.exceptionThrown", "Runtime.consoleAPICalled"):
                said.append(json.dumps(parameters))
            if told.get("method") == "Log.entryAdded":
                said.append(parameters["entry"]["text"])
        return said

    def asked(self):
        return [told["params"]["request"]["url"] for told in self.browser.heard
                if told.get("sessionId") == self.session and told.get("method") == "Network.requestWillBeSent"]
