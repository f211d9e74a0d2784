"""Headless Chromium, driven by its DevTools protocol over a pipe (no port, no library).

    with Browser(folder) as browser:
        page = browser.page(1280, 800)
        page.go("http://127.0.0.1:8480/")
        page.wait("document.title !== ''")

A page remembers what it asked the network for, and what went wrong in its console.
"""

import base64
import json
import os
import select
import struct
import subprocess
import sys
import time
import zlib

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../support"))

from patience import PATIENCE, patient  # noqa: E402

FLAGS = [
    "--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-dev-shm-usage",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-background-timer-throttling", "--disable-renderer-backgrounding",
    "--disable-backgrounding-occluded-windows", "--hide-scrollbars", "--lang=en-US",
    "--force-device-scale-factor=1", "--force-color-profile=srgb", "--remote-debugging-pipe",
]


class Browser:
    def __init__(self, folder):
        to_us, from_browser = os.pipe()
        to_browser, from_us = os.pipe()
        command = ["sh", "-c", 'exec chromium "$@" 3<&%d 4>&%d' % (to_browser, from_browser), "sh",
                   *FLAGS, "--user-data-dir=" + os.path.join(folder, "chromium"), "about:blank"]
        self.log = open(os.path.join(folder, "chromium.log"), "wb")
        self.process = subprocess.Popen(command, pass_fds=(to_browser, from_browser),
                                        stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log,
                                        env={**os.environ, "HOME": folder})
        os.close(to_browser)
        os.close(from_browser)
        self.read_fd, self.write_fd = to_us, from_us
        self.buffer = b""
        self.last_id = 0
        self.answers = {}
        self.pages = {}

    def __enter__(self):
        return self

    def __exit__(self, *_):
        try:
            self.call("Browser.close")
        except (OSError, RuntimeError):
            pass
        try:
            self.process.wait(patient(10))
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        os.close(self.read_fd)
        os.close(self.write_fd)
        self.log.close()

    def call(self, method, session=None, **parameters):
        self.last_id += 1
        message = {"id": self.last_id, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.write_fd, data):]
        end = time.monotonic() + PATIENCE
        while self.last_id not in self.answers:
            if not self.listen(end - time.monotonic()):
                raise RuntimeError(f"no answer from Chromium to {method}")
        answer = self.answers.pop(self.last_id)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']}")
        return answer["result"]

    def listen(self, seconds):
        """Takes the next messages of Chromium; false if there is none for so long."""
        if not select.select([self.read_fd], [], [], max(0.0, seconds))[0]:
            return False
        data = os.read(self.read_fd, 1 << 20)
        if not data:
            raise RuntimeError("Chromium has ended; see chromium.log")
        *messages, self.buffer = (self.buffer + data).split(b"\0")
        for message in map(json.loads, messages):
            if "id" in message:
                self.answers[message["id"]] = message
            elif message.get("sessionId") in self.pages:
                self.pages[message["sessionId"]].hear(message["method"], message["params"])
        return True

    def page(self, width, height, phone=False):
        # A context of its own, as another person's browser: pages of one share six connections.
        context = self.call("Target.createBrowserContext")["browserContextId"]
        target = self.call("Target.createTarget", url="about:blank", browserContextId=context,
                           width=width, height=height)["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, session, target)
        self.pages[session] = page
        for domain in ("Page", "Runtime", "Log", "Network"):
            page.call(domain + ".enable")
        page.resize(width, height, phone)
        return page


class Page:
    def __init__(self, browser, session, target):
        self.browser = browser
        self.session = session
        self.target = target
        self.requests = []
        self.errors = []

    def hear(self, method, what):
        if method == "Network.requestWillBeSent":
            self.requests.append(what["request"]["url"])
        elif method == "Runtime.exceptionThrown":
            self.errors.append(what["exceptionDetails"].get("exception", {}).get(
                "description", what["exceptionDetails"]["text"]))
        elif method == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.errors.append(str([one.get("value") for one in what["args"]]))
        elif method == "Log.entryAdded" and what["entry"]["level"] in ("error", "warning"):
            self.errors.append(what["entry"]["text"] + " " + what["entry"].get("url", ""))

    def call(self, method, **parameters):
        return self.browser.call(method, self.session, **parameters)

    def close(self):
        self.browser.call("Target.closeTarget", targetId=self.target)

    def go(self, url):
        self.call("Page.navigate", url=url)

    def resize(self, width, height, phone=False):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height,
                  deviceScaleFactor=1, mobile=phone)

    def ask(self, expression):
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def wait(self, expression, seconds=PATIENCE):
        end = time.monotonic() + seconds
        while True:
            try:
                value = self.ask(expression)
            except RuntimeError:
                value = None  # the page is on its way
            if value:
                return value
            if time.monotonic() > end:
                raise AssertionError(f"the page never came to: {expression}")
            self.browser.listen(0.05)

    def press(self, key, shift=False):
        codes = {"Tab": 9, "Enter": 13, "Escape": 27, " ": 32, "ArrowLeft": 37, "ArrowUp": 38,
                 "ArrowRight": 39, "ArrowDown": 40, "PageUp": 33, "PageDown": 34, "End": 35,
                 "Home": 36}
        event = {"key": key, "code": key, "modifiers": 8 if shift else 0,
                 "windowsVirtualKeyCode": codes.get(key, ord(key[0]))}
        text = {"Enter": "\r"}.get(key, key if len(key) == 1 else None)
        self.call("Input.dispatchKeyEvent", type="keyDown", **event,
                  **({"text": text} if text else {}))
        self.call("Input.dispatchKeyEvent", type="keyUp", **event)

    def screenshot(self, file):
        with open(file, "wb") as out:
            out.write(self.capture())

    def pixels(self, left, top, width, height):
        """The pixels of this part of the page."""
        clip = {"x": left, "y": top, "width": width, "height": height, "scale": 1}
        return Picture(self.capture(clip=clip))

    def capture(self, **what):
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **what)["data"])


class Picture:
    """The pixels of a PNG as Chromium writes it: 8 bits, RGB or RGBA, not interlaced."""

    def __init__(self, png):
        self.width, self.height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", png[16:29])
        assert depth == 8 and kind in (2, 6) and not interlaced
        self.channels = 3 if kind == 2 else 4
        at, packed = 8, b""
        while at < len(png):
            length, name = struct.unpack(">I4s", png[at:at + 8])
            if name == b"IDAT":
                packed += png[at + 8:at + 8 + length]
            at += 12 + length
        self.rows = self.unfilter(zlib.decompress(packed))

    def unfilter(self, data):
        step, stride = self.channels, self.width * self.channels
        rows, above = [], bytearray(stride)
        for y in range(self.height):
            kind = data[y * (stride + 1)]
            row = bytearray(data[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
            if kind == 1:
                for i in range(step, stride):
                    row[i] = (row[i] + row[i - step]) & 255
            elif kind == 2:
                row = bytearray((a + b) & 255 for a, b in zip(row, above))
            elif kind == 3:
                for i in range(stride):
                    left = row[i - step] if i >= step else 0
                    row[i] = (row[i] + (left + above[i]) // 2) & 255
            elif kind == 4:
                for i in range(stride):
                    a = row[i - step] if i >= step else 0
                    b, c = above[i], above[i - step] if i >= step else 0
                    pa, pb, pc = abs(b - c), abs(a - c), abs(a + b - 2 * c)
                    row[i] = (row[i] + (a if pa <= pb and pa <= pc else b if pb <= pc else c)) & 255
            rows.append(row)
            above = row
        return rows

    def middle_of(self, colour):
        """The middle of the pixels of exactly that colour, and how many there are."""
        wanted = bytes(colour)
        found = [(x + 0.5, y + 0.5) for y, row in enumerate(self.rows) for x in range(self.width)
                 if row[x * self.channels:x * self.channels + 3] == wanted]
        count = max(1, len(found))
        return sum(x for x, _ in found) / count, sum(y for _, y in found) / count, len(found)
