#!/usr/bin/python3
"""The live map in a real browser: raylocd as a process, recorded datagrams over UDP, headless
Chromium, and the pixels that it shows.

    map_test.py BIN_DIR OUT_DIR [--picture FILE.png] [--only PART ...]

Screenshots go to OUT_DIR. --picture also writes the picture of the README (deploy/map_picture).
PART: live, places, compared, recording, walk, reload, editor, first-hour, no-room; by default all of them.
"""

import argparse
import csv
import gzip
import http.client
import json
import math
import os
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import tomllib

import accessibility
from browser import PATIENCE, Browser
import editor

ROOT = os.path.abspath(os.path.join(os.path.dirname(__file__), "../.."))
SITE = os.path.join(ROOT, "tests/data/sites/meeting_room")
ACCESS_POINTS = ["ap1", "ap2", "ap3"]
DEVICE = "02:52:4c:00:00:01"
CELLS = f"document.querySelector('tr[data-target=\"{DEVICE}\"]').children"
SHOWN = f"{CELLS}.length > 0"
TIME_SHOWN = "document.querySelector('#time-shown').textContent"
EVENTS = "document.querySelector('#event-rows').textContent"
ZONE = "document.querySelector('#zones text').textContent"
DOTS = "document.querySelectorAll('#residuals circle').length > 0"
CONNECTION = "document.querySelector('#connection').textContent"
EMPTY = "document.querySelector('#empty').checkVisibility() && document.querySelector('#empty').textContent"
STALE = f"{CELLS}[1].textContent.includes('stale since')"
PIXELS = 3.0
# daemon/live/http/map/map.css: the first target, and one without a newer estimate.
LIVE_COLOUR = (0x00, 0x67, 0xB8)
STALE_COLOUR = (0x66, 0x71, 0x7C)
OTHER_COLOUR = (0xB8, 0x47, 0x00)  # the first of the methods that are compared


def eventually(what, condition, seconds=PATIENCE):
    end = time.monotonic() + seconds
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < end, f"never: {what}"
        time.sleep(0.05)


def free_port(kind, used=set()):
    # Below the range from which the kernel gives out its own.
    for port in range(15000 + os.getpid() % 1600 * 10, 32000):
        with socket.socket(socket.AF_INET, kind) as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        if port not in used:
            used.add(port)
            return port
    raise RuntimeError("no free port")


class Daemon:
    """raylocd on ports that stay the same when it is started again. `recording`: it plays those of
    this name instead of listening. `extra`: sections of its configuration; `http_keys`: lines of [http]."""

    def __init__(self, folder, binaries, site, recording=None, extra="", http_keys=""):
        self.folder, self.binaries, self.process = folder, binaries, None
        self.http = free_port(socket.SOCK_STREAM)
        self.udp = [free_port(socket.SOCK_DGRAM) for _ in ACCESS_POINTS]
        sources = "".join(f'[[source]]\naccess_point = "{name}"\n'
                          + (f'kind = "pcap"\nspeed = 1\n'
                             f'file = "{SITE}/{recording}-{name}.pcap.gz"\n' if recording else
                             f'kind = "udp"\nlisten = "127.0.0.1:{port}"\n')
                          for name, port in zip(ACCESS_POINTS, self.udp))
        with open(os.path.join(folder, "raylocd.toml"), "w", encoding="utf-8") as file:
            file.write(f'[site]\ndirectory = "{site}"\n{sources}'
                       f'[http]\nlisten = "127.0.0.1:{self.http}"\n{http_keys}[publish]\n'
                       f'endpoint = "tcp://127.0.0.1:{free_port(socket.SOCK_STREAM)}"\n'
                       f'snapshot = "ipc://{folder}/snapshot"\n{extra}')
        self.url = f"http://127.0.0.1:{self.http}/"

    def start(self):
        with open(os.path.join(self.folder, "raylocd.log"), "ab") as log:
            self.process = subprocess.Popen(
                [os.path.join(self.binaries, "raylocd"), "--config",
                 os.path.join(self.folder, "raylocd.toml")],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        eventually("raylocd answers", self.answers)

    def answers(self):
        assert self.process.poll() is None, "raylocd has ended"
        try:
            return self.get("healthz")[0] == 200
        except OSError:
            return False

    def stop(self):
        self.process.terminate()
        assert self.process.wait(PATIENCE) == 0
        self.process = None

    def get(self, path):
        connection = http.client.HTTPConnection("127.0.0.1", self.http, timeout=PATIENCE)
        connection.request("GET", "/" + path)
        answer = connection.getresponse()
        try:
            return answer.status, answer.read(), dict(answer.getheaders())
        finally:
            connection.close()

    def position(self):
        """The position of the device by located(); None while it has none."""
        place = (self.located(DEVICE) or {}).get("position")
        return place and (place["x"], place["y"])

    def compared(self, method):
        """The last estimate of the device by a method that is compared; None while there is none."""
        status, text, _ = self.get("api/v1/compared")
        assert status == 200, status
        found = [one["compared"] for one in json.loads(text) if one["compared"]["target"].get("mac") == DEVICE
                 and one["compared"]["quality"]["method"] == method]
        return found[0] if found else None

    def located(self, mac, site=""):
        """The last filtered estimate of it, as a new viewer receives it. `site`: its path."""
        connection = http.client.HTTPConnection("127.0.0.1", self.http, timeout=PATIENCE)
        try:
            connection.request("GET", f"/{site}events")
            answer = connection.getresponse()
            assert answer.status == 200, answer.status
            for line in answer:
                if line.startswith(b"data: "):
                    messages = json.loads(line[6:])["messages"]
                    break
        finally:
            connection.close()
        for location in reversed([one["location"] for one in messages if "location" in one]):
            if location["kind"] == "LOCATION_KIND_FILTERED" and location["target"].get("mac") == mac:
                return location
        return None


class Recording:
    """The bundled recordings of the access points, to be sent spot by spot."""

    def __init__(self):
        with open(os.path.join(SITE, "device_los.csv"), encoding="ascii") as file:
            self.spots = [{key: float(value) for key, value in row.items()}
                          for row in csv.DictReader(file)]
        self.datagrams = []
        for index, name in enumerate(ACCESS_POINTS):
            with gzip.open(os.path.join(SITE, f"device_los-{name}.pcap.gz")) as file:
                data = file.read()
            at = 24
            while at < len(data):
                seconds, micros, length, _ = struct.unpack_from("<IIII", data, at)
                # Ethernet, IPv4 without options, UDP.
                self.datagrams.append((seconds + micros * 1e-6, index, data[at + 58:at + 16 + length]))
                at += 16 + length
        self.datagrams.sort(key=lambda one: one[0])

    def send(self, spot, daemon, until, mac=DEVICE, access_points=ACCESS_POINTS):
        """The datagrams of that spot at their pace, over and over until `until` is set; as if a device of
        that address had been there, and received by these access points alone."""
        begin, end = self.spots[spot]["t_start"], self.spots[spot]["t_end"]
        before, after = (bytes.fromhex(one.replace(":", "")) for one in (DEVICE, mac))
        chosen = [(stamp, index, payload.replace(before, after))
                  for stamp, index, payload in self.datagrams
                  if begin <= stamp <= end and ACCESS_POINTS[index] in access_points]
        assert chosen and all(after in payload for _, _, payload in chosen)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
            while not until.is_set():
                started = time.monotonic()
                for stamp, index, payload in chosen:
                    time.sleep(max(0.0, stamp - begin - (time.monotonic() - started)))
                    out.sendto(payload, ("127.0.0.1", daemon.udp[index]))


def survey():
    """x, y, z of each point of the calibration."""
    with open(os.path.join(SITE, "calibration.csv"), encoding="ascii") as file:
        return [(row["x"], row["y"], row["z"]) for row in csv.DictReader(file)]


class Sending:
    def __init__(self, recording, spot, daemon, **how):
        self.until = threading.Event()
        self.thread = threading.Thread(target=recording.send, args=(spot, daemon, self.until), kwargs=how)

    def __enter__(self):
        self.thread.start()

    def __exit__(self, *_):
        self.until.set()
        self.thread.join()


# ---- Where something ought to be, by the site and the rule of view.js alone ----------------------
def fitting(box):
    """Pixels of a metre, and the middle of the room."""
    with open(os.path.join(SITE, "site.toml"), "rb") as file:
        bounds = tomllib.load(file)["bounds"]
    sizes = [bounds[axis][1] - bounds[axis][0] + 0.6 for axis in "xy"]
    scale = min((box[2] - 32) / sizes[0], (box[3] - 32) / sizes[1])
    return scale, [sum(bounds[axis]) / 2 for axis in "xy"]


def expected_pixel(position, box):
    left, top, width, height = box
    scale, middle = fitting(box)
    return (left + width / 2 + (position[0] - middle[0]) * scale,
            top + height / 2 - (position[1] - middle[1]) * scale)


def map_box(page):
    """Where the layout has put the map, by Chromium's own word."""
    root = page.call("DOM.getDocument")["root"]["nodeId"]
    node = page.call("DOM.querySelector", nodeId=root, selector="#map")["nodeId"]
    quad = page.call("DOM.getBoxModel", nodeId=node)["model"]["content"]
    return quad[0], quad[1], quad[2] - quad[0], quad[5] - quad[1]


def shown_at(page, expected, colour):
    """The middle of the target's mark among the pixels within 100 of where it ought to be."""
    left, top = (max(0, int(v) - 100) for v in expected)
    x, y, count = page.pixels(left, top, 200, 200).middle_of(colour)
    return (left + x, top + y) if count > 60 else None


def assert_shown(page, daemon, colour, what):
    def error():
        position = daemon.position()
        if position is None:
            return None
        expected = expected_pixel(position, map_box(page))
        shown = shown_at(page, expected, colour)
        return None if shown is None else (math.dist(shown, expected), position)

    # The page is updated ten times a second, and its mark may still be moving.
    found = eventually(f"{what}: the mark within {PIXELS} pixels",
                       lambda: (e := error()) and e[0] <= PIXELS and e)
    print(f"{what}: {found[0]:.2f} pixels off")
    return found[1]


def silent_errors(page):
    """The page's errors, except the browser's own about a server that is away."""
    return [one for one in page.errors if "net::ERR_" not in one]


class MapTest:
    def __init__(self, folder, out, daemon, browser, recording, picture):
        self.folder, self.out, self.daemon = folder, out, daemon
        self.browser, self.recording, self.picture = browser, recording, picture
        self.pages = []

    def open(self, width, height, phone=False):
        page = self.browser.page(width, height, phone)
        page.go(self.daemon.url)
        page.wait("document.querySelectorAll('#plan > *').length > 5")
        self.pages.append(page)
        return page

    def artefact(self, page, name):
        page.screenshot(os.path.join(self.out, name + ".png"))

    def follow_spots(self, page):
        """Live and at rest, at two places."""
        before = None
        for spot in (0, 1):
            truth = self.recording.spots[spot]
            with Sending(self.recording, spot, self.daemon):
                eventually("the device is located", lambda: (p := self.daemon.position())
                           and math.dist(p, (truth["x"], truth["y"])) < 0.3)
                assert_shown(page, self.daemon, LIVE_COLOUR, f"spot {spot}, live")
                page.wait("document.querySelector('#source-rows td.good') !== null")
                page.wait("[...document.querySelectorAll('#source-rows tr')]"
                          ".every(r => Number(r.children[2].textContent) > 1)")
                self.artefact(page, f"spot-{spot}-live")
                if spot == 1:
                    self.look_at_panels(page)
            page.wait(STALE)
            position = assert_shown(page, self.daemon, STALE_COLOUR, f"spot {spot}, stale")
            assert before is None or math.dist(position, before) > 0.5, "it did not move"
            before = position

    def look_at_panels(self, page):
        """The channel and the calibration, while the device transmits."""
        page.ask("document.querySelector('#csi').open = document.querySelector('#calibration').open"
                 " = true")
        # Text and charts are written at once, and anew each second.
        text = page.wait("document.querySelectorAll('#csi-charts .measured').length === 9 && "
                         "document.querySelectorAll('#csi-charts .simulated').length === 9 && "
                         "document.querySelector('#csi-text').textContent")
        assert re.match(DEVICE + r" at -?\d+\.\d+, -?\d+\.\d+, received \d+ s ago: ", text), text
        explained = [int(word) for word in re.findall(r"ap\d (\d+) %", text)]
        # Only the gains are calibrated, so not every access point agrees; an arbitrary channel
        # explains some 10 %.
        assert len(explained) == 3 and max(explained) > 60, text
        page.ask("document.querySelector('#show-residuals').click()")
        points = len({tuple(row) for row in survey()})
        page.wait(f"document.querySelectorAll('#residuals circle').length === {points}")
        assert page.ask("document.querySelectorAll('#moved-rows tr').length") > 0
        self.artefact(page, "panels")
        page.ask("document.querySelector('#show-residuals').click()")
        page.wait("document.querySelectorAll('#residuals circle').length === 0")
        page.ask("document.querySelectorAll('details').forEach(d => { d.open = false; })")

    def plan_comes_late(self):
        """The tables do without the floor plan, which comes as soon as raylocd answers."""
        page = self.browser.page(1280, 800)
        page.call("Network.setBlockedURLs", urls=["*/api/v1/map"])
        page.go(self.daemon.url)
        self.pages.append(page)
        page.wait("document.querySelectorAll('#source-rows tr').length === 3")
        page.wait(f"{EMPTY}.startsWith('The floor plan is not known')")
        assert page.ask("getComputedStyle(document.querySelector('#markers')).display") == "none"
        page.call("Network.setBlockedURLs", urls=[])
        page.wait("document.querySelectorAll('#plan > *').length > 5")
        page.wait("!document.querySelector('#empty').checkVisibility()")
        assert not silent_errors(page), page.errors
        self.close(page)

    def hidden_page(self):
        """A hidden page leaves its place to others; a browser without storage works."""
        page = self.browser.page(1280, 800)
        page.call("Page.addScriptToEvaluateOnNewDocument", source="Object.defineProperty(window, "
                  "'localStorage', {get() { throw new DOMException('denied', 'SecurityError'); }});")
        page.go(self.daemon.url)
        self.pages.append(page)
        page.wait(f"{CONNECTION} === 'Connected'")
        theme = page.ask("document.querySelector('#theme').textContent")
        page.ask("document.querySelector('#theme').click()")
        page.wait(f"document.querySelector('#theme').textContent !== '{theme}'")
        viewers = "rayloc_http_viewers"
        eventually("the only one", lambda: self.metric(viewers) == "1")
        page.ask("Object.defineProperty(document, 'hidden', {value: true, configurable: true});"
                 "document.dispatchEvent(new Event('visibilitychange'))")
        eventually("it leaves", lambda: self.metric(viewers) == "0")
        page.ask("delete document.hidden; document.dispatchEvent(new Event('visibilitychange'))")
        eventually("it comes back", lambda: self.metric(viewers) == "1")
        page.wait(f"{CONNECTION} === 'Connected'")
        self.check(page)
        self.close(page)

    def survive_silence(self, page):
        """A raylocd that hangs: no earlier state is shown as if it were current."""
        receiving = ("document.querySelectorAll('#source-rows td.good').length === 3 && "
                     "document.querySelectorAll('#fixed .receiving').length === 3")
        with Sending(self.recording, 1, self.daemon):
            page.wait(receiving)
            self.daemon.process.send_signal(signal.SIGSTOP)
            try:
                page.wait(f"/^No word from raylocd for [0-9]+ s$/.test({CONNECTION})")
                page.wait("[...document.querySelectorAll('#source-rows tr')].every((row) => "
                          "row.children[1].textContent === 'not known' && "
                          "row.children[2].textContent === '')")
                assert page.ask("document.querySelector('#fixed .receiving')") is None
                # The connection is still open; only a new request finds out that the daemon does not answer.
                streams = page.requests.count(self.daemon.url + "events")
                page.wait(f"{CONNECTION}.startsWith('Connection lost')")
                eventually("asked anew", lambda: page.ask("true") and
                           page.requests.count(self.daemon.url + "events") > streams)
            finally:
                self.daemon.process.send_signal(signal.SIGCONT)
            page.wait(f"{CONNECTION} === 'Connected'")
            page.wait(receiving)
        page.wait(STALE)
        self.check(page)

    def survive_restart(self, page):
        page.ask("window.sameDocument = true; document.querySelector('#show-residuals').click()")
        page.wait(DOTS)
        # A page that shows the past has to notice, too.
        page.ask("document.querySelector('#play').click()")
        page.wait(f"{TIME_SHOWN}.includes('ago')")
        self.daemon.stop()
        page.wait(f"{CONNECTION}.startsWith('Connection lost')")
        self.daemon.start()
        page.wait(f"{CONNECTION} === 'Connected'")
        page.wait(f"{TIME_SHOWN} === 'live'")
        page.wait(f"{EVENTS}.includes('raylocd was started again')")
        assert "is located" in page.ask(EVENTS), "what happened before is forgotten"
        with Sending(self.recording, 2, self.daemon):
            page.wait(SHOWN)
            eventually("the device is located", self.daemon.position)
        page.wait(STALE)
        assert_shown(page, self.daemon, STALE_COLOUR, "after a restart")
        assert page.ask("window.sameDocument"), "the page was loaded again"
        self.dots_follow(page)
        # A chart of errors starts anew: that the server was away is in the console.
        assert not silent_errors(page), page.errors
        page.errors.clear()

    def dots_follow(self, page):
        """The dots of the calibration are those of this start of raylocd, and stay in their places."""
        place = "document.querySelector('#residuals g').getAttribute('transform')"
        before = page.ask(place)
        page.ask("document.querySelector('#zoom-in').click()")
        page.wait(f"{place} !== '{before}'")
        page.ask("document.querySelector('#fit').click()")
        page.wait(f"{place} === '{before}'")
        page.ask("document.querySelector('#show-residuals').click()")
        page.wait(f"!({DOTS})")

    def small_and_large(self):
        for width, height, phone in ((390, 844, True), (768, 1024, True), (3840, 2160, False)):
            page = self.open(width, height, phone)
            page.wait(f"document.querySelector('[data-target=\"{DEVICE}\"]') !== null")
            assert_shown(page, self.daemon, STALE_COLOUR, f"{width} pixels wide")
            widest = page.ask("document.documentElement.scrollWidth")
            assert widest <= width, f"{width} pixels wide: the page is {widest} wide"
            # A page on a wall is read from afar.
            letters = page.ask("document.querySelector('#markers text').getBoundingClientRect().height")
            assert 13 <= letters / max(1, width / 1920) <= 26, f"{width}: letters of {letters} pixels"
            self.artefact(page, f"{width}")
            self.nothing_is_covered(page, width)
            if phone:
                small = page.ask("[...document.querySelectorAll('button')].filter(b => "
                                 "b.checkVisibility() && "
                                 "b.getBoundingClientRect().height < 24).length")
                assert small == 0, "buttons too small for a finger"
            self.check(page)

    def nothing_is_covered(self, page, width):
        """Names are apart from one another and from the buttons; tables show all their columns."""
        boxes = page.ask("[...document.querySelectorAll('#fixed .access-point > text, #zones .zone-tag, .zoom button')]"
                         ".map((e) => { const b = e.getBoundingClientRect(); return [e.textContent, b.left, b.top, b.right, b.bottom]; })")
        assert len(boxes) >= 5 + len(ACCESS_POINTS), boxes
        for i, one in enumerate(boxes):
            for other in boxes[:i]:
                apart = one[1] >= other[3] or other[1] >= one[3] or one[2] >= other[4] or other[2] >= one[4]
                assert apart, f"{width} pixels wide: {one} covers {other}"
        cut = page.ask("[...document.querySelectorAll('.wide')].filter((e) => e.checkVisibility() && "
                       "e.scrollWidth > e.clientWidth + 1).map((e) => e.getAttribute('aria-labelledby'))")
        assert not cut, f"{width} pixels wide: columns of {cut} are cut off"
        share = page.ask("document.querySelector('#plan').getBoundingClientRect().height / "
                         "document.querySelector('#map').getBoundingClientRect().height")
        assert width > 390 or share > 0.6, f"{width} pixels wide: the plan takes {share:.2f} of its box"

    def sixteen_viewers(self):
        pages = [self.open(640, 480) for _ in range(16)]
        with Sending(self.recording, 0, self.daemon):
            truth = self.recording.spots[0]
            for page in pages:
                # It was at another spot.
                page.wait(f"(() => {{ const [x, y] = {CELLS}[2].firstChild.textContent.split(',').map(Number);"
                          f"return Math.hypot(x - {truth['x']}, y - {truth['y']}) < 0.3; }})()")
            status, _, headers = self.daemon.get("events")
            assert status == 503 and headers["Retry-After"] == "5", (status, headers)
        viewers = int(self.metric("rayloc_http_viewers"))
        assert viewers == 16, viewers
        seventeenth = self.open_refused()
        for page in pages:
            self.check(page)
        for page in pages[1:]:
            self.close(page)
        # A place is free, and the one that was refused takes it by itself.
        seventeenth.wait(f"{CONNECTION} === 'Connected'")
        self.close(seventeenth)
        # All of them saw the same.
        assert_shown(pages[0], self.daemon, STALE_COLOUR, "the first of 16 viewers")
        self.close(pages[0])

    def open_refused(self):
        page = self.browser.page(640, 480)
        page.go(self.daemon.url)
        page.wait(f"{CONNECTION}.startsWith('No stream')")
        self.pages.append(page)
        return page

    def metric(self, name):
        text = self.daemon.get("metrics")[1].decode()
        return next(line.split()[1] for line in text.splitlines() if line.startswith(name + " "))

    def check(self, page):
        assert not page.errors, page.errors
        elsewhere = [url for url in page.requests if not url.startswith(self.daemon.url)
                     and url != "about:blank"]
        assert page.requests and not elsewhere, elsewhere

    def close(self, page):
        self.pages.remove(page)
        page.close()

    def run(self):
        page = self.open(1920, 1080)
        self.follow_spots(page)
        self.nothing_is_covered(page, 1920)
        self.check(page)
        accessibility.check_by_keyboard(page, DEVICE)
        accessibility.check_tree(page)
        for theme in ("dark", "light"):  # what follows looks for the colours of light
            accessibility.check_contrast(page, theme)
            self.artefact(page, f"1920-{theme}")
        self.check(page)
        self.survive_silence(page)
        self.survive_restart(page)
        self.close(page)
        self.plan_comes_late()
        self.hidden_page()
        self.small_and_large()
        for one in list(self.pages):
            self.close(one)
        self.sixteen_viewers()


class PlaybackTest(MapTest):
    """raylocd on recordings, controlled from the page by keys."""

    POSITION = "document.querySelector('#playback-position')"
    TEXT = "document.querySelector('#playback-text').textContent"

    def state(self):
        status, body, _ = self.daemon.get("api/v1/playback")
        assert status == 200, status
        return json.loads(body)

    def reach(self, page, name):
        for _ in range(60):
            if page.ask("document.activeElement.id") == name:
                return
            page.press("Tab")
        raise AssertionError(f"not reached by Tab: {name}")

    def begin(self):
        """The beginning of the recordings [s since 1970]."""
        return min(one[0] for one in self.recording.datagrams)

    def spot_at(self, seconds):
        """The spot of the device, so long after the beginning; None on its way."""
        return next((spot for spot in self.recording.spots
                     if spot["t_start"] + 0.4 < self.begin() + seconds < spot["t_end"]), None)

    def go_to(self, page, steps):
        """By Home and so many times the arrow; the map shows the device's place at that time."""
        self.reach(page, "playback-position")
        page.press("Home")
        for _ in range(steps):
            page.press("ArrowRight")
        page.wait(f"Number({self.POSITION}.value) === {5 * steps}")
        truth = self.spot_at(5 * steps)
        eventually(f"the device at {5 * steps} s", lambda: (p := self.daemon.position())
                   and math.dist(p, (truth["x"], truth["y"])) < 0.3)
        assert_shown(page, self.daemon, LIVE_COLOUR, f"{5 * steps} s into the recording")
        # The trail does not join the positions before and after the move.
        page.wait("[...document.querySelectorAll('#trails g')].every((line) => "
                  "line.getBBox().width < 100 && line.getBBox().height < 100)")
        assert f"{5 * steps // 60}:{5 * steps % 60:02}.0 of " in \
            page.ask(f"{self.POSITION}.getAttribute('aria-valuetext')")

    def control(self, page):
        page.wait("!document.querySelector('#playback').hidden && "
                  "document.querySelector('#review').hidden")
        page.wait("document.querySelector('#event-rows li') !== null")  # and will stay while it is paused
        self.reach(page, "playback-play")
        page.press(" ")
        page.wait(f"{self.TEXT}.includes('paused')")
        paused = self.state()
        assert paused["state"] == "PLAYBACK_STATE_PAUSED", paused
        page.ask("window.beats = 0; new EventSource('/events').addEventListener('update', (event) =>"
                 " { window.beats += event.data.includes('heartbeat'); })")
        page.ask("document.querySelector('#event-rows li').stays = true")
        stops = [n for n in range(1, 20) if self.spot_at(5 * n)]
        assert len(stops) >= 2, stops
        for steps in (stops[-1], stops[0]):
            self.go_to(page, steps)
        # The zone is around the place that it is at now.
        page.wait("document.querySelector('#event-rows').textContent.includes('entered corner')")
        page.wait(f"{CELLS}[4].textContent === 'corner'")
        page.wait(f"{ZONE} === 'corner (1)'")
        assert page.ask("[...document.querySelectorAll('#event-rows li')].filter((item) => item.stays)"
                        ".length") == 1, "the list of events is written anew"
        page.wait("window.beats > 2")  # playback is paused, and nothing grows old
        stands = self.state()
        assert stands["position"] == self.state()["position"], stands
        assert page.ask(f"!{STALE}")
        self.artefact(page, "recording-paused")
        self.reach(page, "playback-speed")
        page.press("ArrowDown")
        eventually("twice as fast", lambda: self.state().get("speed") == 2)
        self.others_control(page)
        self.play(page)

    def others_control(self, page):
        """Requests of others are shown, also at the focus and after a drag back to its beginning."""
        speed = "document.querySelector('#playback-speed')"
        assert page.ask(f"document.activeElement === {speed}")
        self.ask_for("speed=4")
        page.wait(f"{speed}.value === '4'")
        page.ask(f"{self.POSITION}.dispatchEvent(new Event('input'));"
                 f"{self.POSITION}.dispatchEvent(new Event('pointerup'))")
        self.ask_for("speed=2&position=50")
        page.wait(f"Number({self.POSITION}.value) === 50 && {speed}.value === '2'")

    def ask_for(self, change):
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.http, timeout=PATIENCE)
        connection.request("POST", "/api/v1/playback?" + change, headers={"X-RayLoc-Control": "1"})
        assert connection.getresponse().status == 200
        connection.close()

    def play(self, page):
        """On to the end, and from the beginning again."""
        moves = int(self.state()["moves"])
        self.reach(page, "playback-position")
        page.press("End")
        page.wait(f"{self.TEXT}.includes('at the end')")
        page.wait(f"{EVENTS}.includes('left corner after')")
        page.wait(f"{ZONE} === 'corner' && {CELLS}[4].textContent === ''")
        assert self.state()["state"] == "PLAYBACK_STATE_ENDED"
        self.reach(page, "playback-play")
        page.press("Enter")
        page.wait(f"!{self.TEXT}.includes('at the end') && !{self.TEXT}.includes('paused')")
        again = self.state()
        assert again["state"] == "PLAYBACK_STATE_PLAYING" and int(again["moves"]) == moves + 2, again
        assert_counted(self.daemon)

    def controls_that_fail(self, page):
        """The page shows the failure, and once raylocd answers again the controls work."""
        error = "document.querySelector('#playback-error')"
        self.daemon.process.send_signal(signal.SIGSTOP)
        try:
            page.wait(f"{self.TEXT}.includes('last known')")
            shown = page.ask(self.TEXT)
            self.reach(page, "playback-play")
            page.press(" ")
            page.wait(f"{error}.checkVisibility() && {error}.textContent.includes('no answer within')")
            assert page.ask(self.TEXT) == shown, "the position of nobody knows what went on"
            self.artefact(page, "recording-not-controlled")
        finally:
            self.daemon.process.send_signal(signal.SIGCONT)
        page.wait(f"{CONNECTION} === 'Connected' && !{self.TEXT}.includes('last known')")
        # The question that was given up may have been answered since.
        button = "document.querySelector('#playback-play').textContent"
        playing = self.state()["state"] == "PLAYBACK_STATE_PLAYING"
        page.wait(f"{button} === '{'Pause' if playing else 'Play'}'")
        page.press(" ")
        page.wait(f"{button} === '{'Play' if playing else 'Pause'}' && !{error}.checkVisibility()")

    def run(self):
        page = self.open(1280, 800)
        self.control(page)
        self.controls_that_fail(page)
        self.artefact(page, "recording")
        accessibility.check_tree(page, buttons=6)
        accessibility.check_contrast(page, "dark")
        self.check(page)
        self.close(page)
        phone = self.open(390, 844, True)
        phone.wait("!document.querySelector('#playback').hidden")
        assert phone.ask("document.documentElement.scrollWidth") <= 390
        self.check(phone)
        self.close(phone)


class WalkTest(PlaybackTest):
    """A walk through a zone; the picture of the README is of it."""

    def run(self):
        page = self.open(1280, 760)
        trail = "document.querySelector('#trails g')"
        self.walk_until(page, f"{CELLS}[4].textContent === 'corner' && {trail}.getBBox().width > 250")
        page.wait("document.querySelectorAll('#source-rows td.good').length === 3")
        self.artefact(page, "walk")
        self.ask_for("state=paused")
        page.wait(f"{self.TEXT}.includes('paused')")
        lost = page.ask("[...document.querySelectorAll('#source-rows tr')].map((row) => "
                        "row.children[4].textContent + row.children[5].textContent)")
        assert lost == ["00"] * 3, f"in a picture for everybody: {lost}"
        x, y = assert_shown(page, self.daemon, LIVE_COLOUR, "on the walk")
        with open(os.path.join(SITE, "walk.csv"), encoding="ascii") as file:
            path = [(float(row["x"]), float(row["y"])) for row in csv.DictReader(file)]
        assert min(math.dist(one, (x, y)) for one in path) < 0.4, (x, y)
        self.solid_room(page)
        self.ask_for("position=0&speed=0.25&state=playing")
        self.channel_of_a_burst(page)
        self.where_somebody_was(page, path)
        self.check(page)
        self.close(page)
        if self.picture:
            shutil.copy(os.path.join(self.out, "walk.png"), self.picture)

    def solid_room(self, page):
        """In three dimensions the mark is where the isometric projection puts its place, by those of two access
        points; the room is drawn, and the plan comes back."""
        page.ask("document.querySelector('#map').focus()")
        page.press("3")
        page.wait("document.querySelectorAll('#solid polygon').length > 30 && getComputedStyle(document.querySelector('#plan')).display === 'none'")
        told = self.daemon.located(DEVICE)["position"]
        with open(os.path.join(SITE, "site.toml"), "rb") as file:
            stated = [one["position"] for one in tomllib.load(file)["access_point"]]

        def on_page(place):
            x, y, z = place
            return math.sqrt(1 / 2) * (x - y), -math.sqrt(1 / 6) * (x + y + 2 * z)

        def pixel(selector):
            return page.ask(f"(() => {{ const m = document.querySelector('{selector}').getCTM(); return [m.e, m.f]; }})()")
        first, second = (pixel(f"#ap-{name}") for name in ACCESS_POINTS[:2])
        scale = math.dist(first, second) / math.dist(*map(on_page, stated[:2]))
        wanted = [q + scale * (a - b) for q, a, b in zip(first, on_page([told[axis] for axis in "xyz"]), on_page(stated[0]))]
        shown = pixel(f'.target[data-target="{DEVICE}"]')
        assert math.dist(shown, wanted) <= PIXELS, (shown, wanted)
        page.press("3")
        page.wait("getComputedStyle(document.querySelector('#solid')).display === 'none'")

    def where_somebody_was(self, page, path):
        """In cells along the walk, and in no others."""
        presence = json.loads(self.daemon.get("api/v1/presence")[1])
        assert sum(stay for _, _, stay in presence["cells"]) > 2 and presence["left_out"] == 0, presence
        away = [(x, y) for x, y, stay in presence["cells"] if stay > 0.5 and min(math.dist((x, y), one) for one in path) > 0.6]
        assert not away, away
        page.ask("document.querySelector('#heat-look').click()")
        page.wait("document.querySelectorAll('#heat rect').length > 2")
        assert DEVICE not in json.dumps(presence) and "phone" not in json.dumps(presence)
        self.artefact(page, "heat")
        page.ask("document.querySelector('#heat-look').click()")

    def channel_of_a_burst(self, page):
        """The panel shows the burst and the place of one location, by name, while the device moves."""
        told = "window.told"
        page.ask(told + " = {}; for (const kind of ['snapshot', 'update']) (window.listening ||= new EventSource('events'))"
                 ".addEventListener(kind, (event) => { for (const {location} of JSON.parse(event.data).messages) {"
                 " if (location?.kind === 'LOCATION_KIND_SNAPSHOT' && location.position) {"
                 f" const {{x, y, z}} = location.position; {told}[location.time] = [x, y, z]; }} }} }})")
        page.ask("document.querySelector('#csi').open = true")
        page.wait("/^phone at .*: amplitude/.test(document.querySelector('#csi-text').textContent)")
        # The burst's location was sent to this page as well.
        page.wait(f"(async () => (await (await fetch('api/v1/channel')).json()).some((one) => one.name === 'phone' && "
                  f"JSON.stringify({told}[one.time]) === JSON.stringify(one.position)))()")
        page.ask("document.querySelector('#csi').open = false; window.listening.close()")
        page.ask("document.querySelector('#solid-look').click()")
        ways = "new Set([...document.querySelectorAll('#rays title')].map((one) => one.textContent.split(':')[0]))"
        page.wait(f"{ways}.size === {len(ACCESS_POINTS)}")
        self.artefact(page, "solid")
        page.ask("document.querySelector('#solid-look').click()")

    def walk_until(self, page, there):
        """From the beginning, and again where a busy machine has missed the moment."""
        walking, attempts = 20.0, 4  # [s]: 9 s at half the pace
        for left in reversed(range(attempts)):
            self.ask_for("position=0&speed=0.5&state=playing")
            try:
                return page.wait(there, walking)
            except AssertionError:
                if left == 0:
                    raise


class PlacesTest(MapTest):
    """Two devices that a single access point receives: their other possible places are shown."""

    OTHER = "02:52:4c:00:00:03"  # not in the site: located as any other
    SURE, UNSURE = 6, 11  # spots: the first has one place; the second has another place, too
    BOXES = "[...document.querySelectorAll('{}')].map((e) => {{ const b = e.getBoundingClientRect();" \
            "return [b.x + b.width / 2, b.y + b.height / 2, b.width / 2, b.height / 2]; }})"

    def run(self):
        page = self.open(1280, 800)
        with Sending(self.recording, self.SURE, self.daemon, mac=self.OTHER, access_points=["ap1"]), \
                Sending(self.recording, self.UNSURE, self.daemon, access_points=["ap1"]):
            for mac in (DEVICE, self.OTHER):
                page.wait(f"document.querySelector('tr[data-target=\"{mac}\"] td.good') !== null")
            page.wait("document.querySelector('#ghosts circle') !== null")
            self.artefact(page, "places")
        page.wait("document.querySelectorAll('#target-rows td.warn').length === 2")  # nothing moves
        drawn = [self.expect_regions(page, mac) for mac in (DEVICE, self.OTHER)]
        assert drawn[0] and not drawn[1], f"other places of the unsure and of the sure one: {drawn}"
        assert len(page.ask(self.BOXES.format("#ghosts circle"))) == len(drawn[0])
        accessibility.check_contrast(page, "dark")
        self.check(page)
        self.close(page)

    def expect_regions(self, page, mac):
        """The mark, what is published about it, and its other places; these in the list, too."""
        told = self.daemon.located(mac)
        box = map_box(page)
        scale, _ = fitting(box)
        mark = expected_pixel((told["position"]["x"], told["position"]["y"]), box)
        circles = page.ask(self.BOXES.format("#regions circle"))
        outer = min(circles, key=lambda one: math.dist(one[:2], mark))
        assert math.dist(outer[:2], mark) < 1 and abs(outer[2] - scale * told["accuracy_m"]) < 1, (outer, told)
        inner = min(page.ask(self.BOXES.format("#regions ellipse")), key=lambda one: math.dist(one[:2], mark))
        assert math.dist(inner[:2], mark) < 1, (inner, mark)
        places = apart(told)
        rings = page.ask(self.BOXES.format("#ghosts circle"))
        listed = page.ask(f"document.querySelector('tr[data-target=\"{mac}\"] td p').textContent")
        for weight, position in places:
            expected = expected_pixel(position, box)
            assert min(math.dist(one[:2], expected) for one in rings) <= PIXELS, (expected, rings)
            assert f"or {position[0]:.2f}, {position[1]:.2f} ({100 * weight:.0f} %)" in listed, listed
        assert listed.count("or ") == len(places), (listed, places)
        return places


class ComparedTest(MapTest):
    """Two methods on one map: the second has a colour and a shape of its own, and the legend names both."""

    MARK = "document.querySelector('#compared [data-method=spotfi]')"
    LEGEND = "[...document.querySelectorAll('#methods li')].map((one) => one.textContent.trim())"

    def run(self):
        page = self.open(1280, 800)
        names = page.wait(f"(({self.LEGEND}).length > 0) && {self.LEGEND}")
        assert [name.split(",")[0] for name in names] == ["rayloc", "spotfi"], names
        truth = self.recording.spots[0]
        with Sending(self.recording, 0, self.daemon):
            eventually("the device is located", lambda: (p := self.daemon.position())
                       and math.dist(p, (truth["x"], truth["y"])) < 0.3)
            page.wait(f"{self.MARK} !== null")
            assert_shown(page, self.daemon, LIVE_COLOUR, "by the site's method")
            eventually("the mark of spotfi in its colour, where it is", lambda: self.is_shown(page))
            page.wait(f"{CELLS}[2].textContent.includes('spotfi: ')")
            self.artefact(page, "compared")
        accessibility.check_contrast(page, "dark")
        accessibility.check_contrast(page, "light")
        self.check(page)
        self.close(page)

    def is_shown(self, page):
        place = (self.daemon.compared("spotfi") or {}).get("position")
        if not place:
            return False
        expected = expected_pixel((place["x"], place["y"]), map_box(page))
        shown = shown_at(page, expected, OTHER_COLOUR)
        return shown is not None and math.dist(shown, expected) <= PIXELS


def apart(location):
    """Weight and middle of the places that are not the mark's, of hypotheses of which none are at the
    edge of the rule (places.js): linked where nearer than 0.65 m."""
    groups = []
    for one in location["hypotheses"]:
        x, y, weight = one["position"]["x"], one["position"]["y"], one["weight"]
        linked = [group for group in groups if any(math.dist((x, y), other[:2]) < 0.65 for other in group)]
        groups = [group for group in groups if group not in linked] + [sum(linked, [(x, y, weight)])]
    where = location["position"]["x"], location["position"]["y"]
    groups.sort(key=lambda group: min(math.dist(one[:2], where) for one in group))
    return [(sum(one[2] for one in group), tuple(sum(one[2] * one[axis] for one in group)
                                                / sum(one[2] for one in group) for axis in (0, 1)))
            for group in groups[1:]]


class NoRoomTest(MapTest):
    """Where nothing is located, what is received is shown nevertheless."""

    def run(self):
        page = self.browser.page(1280, 800)
        page.go(self.daemon.url)
        with Sending(self.recording, 0, self.daemon):
            page.wait("document.querySelectorAll('#source-rows td.good').length === 3")
            page.wait(f"({EMPTY}).includes('method')")
            page.wait("document.querySelector('#site').textContent !== ''")
            self.artefact(page, "no-room")
        self.check_modules(page)
        self.check(page)
        page.close()

    def check_modules(self, page):
        with open(os.path.join(ROOT, "tests/e2e/map_modules_test.js"), encoding="utf-8") as file:
            for name in page.ask(file.read()):
                print(name)


class ReloadTest(MapTest):
    """A map that is open shows what a reload has made of its site, one of several."""

    def run(self):
        page = self.open(1280, 800)
        page.wait(f"{ZONE} === 'corner'")
        path = os.path.join(self.daemon.site, "site.toml")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace('name = "corner"', 'name = "desk"'))
        self.daemon.process.send_signal(signal.SIGHUP)
        page.wait(f"{ZONE} === 'desk'")
        page.wait("document.querySelector('#event-list').textContent.includes('the site was prepared anew')")
        self.check(page)
        self.close(page)


class EditorTest(MapTest):
    """From an empty folder and a drawing to a target on the map, by the clicks of a person."""

    SPOT = 3
    SAID = "document.querySelector('#said').textContent"

    def run(self):
        office = os.path.join(self.folder, "office")
        drawing = os.path.join(self.folder, "office.obj")
        editor.write_obj(SITE, drawing)
        editor.refuse_strangers(self.daemon.binaries, office)
        studio = editor.Studio(self.folder, self.daemon.binaries, office)
        try:
            page = self.browser.page(1280, 800)
            self.pages.append(page)
            page.go(eventually("rayloc studio serves", studio.address))
            person = editor.Person(page)
            self.draw(page, person, drawing)
            self.draw_over(page, person)
            self.mistakes(page, person, office)
            person.click_at(person.pixel(-1.4, 1.05))  # with its handle and its fields
            for theme in ("light", "dark"):
                accessibility.show_theme(page, theme)
                accessibility.check_texts(page, theme, 20)
                self.artefact(page, f"editor-{theme}")
            refused = [one for one in page.errors if "422" not in one]
            assert not refused, refused
            assert all(url.startswith((studio.address(), "about:blank", "blob:" + studio.address())) for url in page.requests), page.requests
            self.close(page)
        finally:
            studio.stop()
        # Two lines of a shell and a walk with the phone, for which a person needs as long as for forty clicks.
        self.locate(office)
        person.clicks += 40
        self.go_on(person, office)
        minutes = person.clicks * editor.SECONDS_PER_CLICK / 60
        print(f"from an empty folder to a target: {person.clicks} clicks, {minutes:.1f} minutes")
        assert minutes <= 15, minutes

    def draw(self, page, person, drawing):
        page.wait(f"{self.SAID} === 'Nothing is here yet'")
        clicks = person.clicks  # a mistake is no part of the task
        person.fill("#import-height", "2e")  # no number, so that the field has no value
        person.choose_file("#import", drawing)
        page.wait(f"{self.SAID}.includes('height')")
        page.ask("document.querySelector('#import-height').value = '3'")
        page.ask("document.querySelector('#import-height').value = ''")
        person.clicks = clicks
        person.fill("#import-scale", "5000")  # reaches the import, which refuses it
        person.choose_file("#import", drawing)
        page.wait(f"{self.SAID}.includes('--scale')")
        page.ask("document.querySelector('#import-scale').value = ''")
        person.choose_file("#import", drawing)
        page.wait(f"{self.SAID}.startsWith('office is begun')")
        page.wait("document.querySelectorAll('#plan polygon').length > 5")
        with open(os.path.join(SITE, "site.toml"), "rb") as file:
            stated = tomllib.load(file)["access_point"][:2]
        for one in stated:
            person.place_access_point(one["id"], one["position"], one["yaw_deg"])
        spot = self.recording.spots[self.SPOT]
        corners = [person.pixel(spot["x"] + side, spot["y"] + side) for side in (-0.5, 0.5)]
        person.click("[data-tool=zone]")
        person.drag(*corners)
        page.wait("document.querySelector('.zone-name').textContent === 'zone1'")
        person.click("[data-tool=furniture]")
        person.drag(person.pixel(-0.2, 1.1), person.pixel(0.1, 1.3))
        page.wait("document.querySelector('.object-name').textContent === 'furniture1'")
        person.fill("[data-field=name]", "crate")
        person.fill('[data-field="height [m]"]', "0.2")
        person.name_device(DEVICE, "phone")

    def draw_over(self, page, person):
        """A picture of a floor plan under the drawing: two places and a length, moved, faded, taken away."""
        picture, pdf, broken, damaged = (os.path.join(self.folder, name) for name in ("plan.png", "plan.pdf", "broken.png", "damaged.pdf"))
        red, green = (255, 0, 0), (0, 160, 0)
        marks = ((100, red), (500, green))
        squares = [(x, 200, colour) for x, colour in marks]
        editor.write_png(picture, 600, 300, squares, 20)
        editor.write_pdf(pdf, 600, 300, [[], squares], 20)
        for path, content in ((damaged, b"%PDF-1.7\n"), (broken, b"no picture")):
            with open(path, "wb") as file:
                file.write(content)
        clicks = person.clicks  # a person has one plan, without mistakes
        for path, reason in ((damaged, "cannot be read"), (broken, "no picture that this browser reads")):
            person.choose_file("#underlay-file", path)
            page.wait(f"{self.SAID}.startsWith('{os.path.basename(path)}: ') && {self.SAID}.includes('{reason}')")
        assert page.ask("document.querySelector('#underlay-fields').getBoundingClientRect().height") == 0
        person.choose_file("#underlay-file", picture)
        page.wait(f"{self.SAID}.startsWith('plan.png lies under the drawing')")
        assert page.ask("document.querySelector('#underlay-page-field').hidden && document.querySelector('#underlay-drawn-field').hidden")
        person.clicks = clicks
        person.choose_file("#underlay-file", pdf)
        page.wait(f"{self.SAID}.startsWith('plan.pdf, page 1 of 2, lies under the drawing')")
        person.fill("#underlay-drawn", "30")
        said = page.wait(f"{self.SAID}.startsWith('At 1:30 the picture is ') && {self.SAID}")
        assert said.split()[5:8] == ["3.05", "x", "1.52"], said  # 4 x 2 inches of paper
        person.fill("#underlay-page", "3")
        page.wait(f"{self.SAID}.includes('pages 1 to 2')")
        assert page.ask("document.querySelector('#underlay-page').value") == "1"
        person.fill("#underlay-page", "2")
        page.wait(f"{self.SAID}.startsWith('plan.pdf, page 2 of 2, lies under the drawing')")
        assert page.ask("document.querySelector('#underlay-drawn').value") == "30"
        person.click("#underlay-scale")
        page.wait("document.querySelector('#underlay-picture image') !== null")
        page.ask("(() => { const e = document.querySelector('#underlay-shown'); e.value = 1; e.dispatchEvent(new Event('input')); })()")
        person.clicks += 1
        drawn = "document.querySelectorAll('#plan, #drawn, #marks').forEach((e) => { e.style.visibility = '%s'; })"
        page.ask(drawn % "hidden")  # its own lines may cross the marks

        def place_of(x, colour):
            """The place of the square of that colour, on the page by its pixels, and on the floor."""
            left, top, scale = page.ask("(() => { const b = document.querySelector('#underlay-picture image').getBoundingClientRect();"
                                        " return [b.x, b.y, b.width / 600]; })()")
            corner = [int(left + x * scale) - 25, int(top + 200 * scale) - 25]
            x, y, count = page.pixels(*corner, 50, 50).middle_of(colour)
            at = (corner[0] + x, corner[1] + y)
            origin, unit = person.pixel(0, 0), person.pixel(1, 1)
            return at, [(a - b) / (c - b) for a, b, c in zip(at, origin, unit)], count

        def settle():
            page.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        ends = [eventually("the picture is shown", lambda one=one: (p := place_of(*one))[2] > 20 and p) for one in marks]
        for pixel, _, _ in ends:
            person.click_at(pixel)
        page.wait("document.activeElement.id === 'underlay-length'")
        person.fill("#underlay-length", "2")
        said = page.wait(f"{self.SAID}.startsWith('The picture is ') && {self.SAID}")
        assert abs(float(said.split()[3]) - 3) < 0.02, said  # 600 of its pixels, of 2 m for 400, as well as was clicked
        settle()
        now = [place_of(*one) for one in marks]
        assert math.dist(now[0][1], ends[0][1]) < 0.03, (now, ends)
        assert abs(math.dist(now[0][1], now[1][1]) - 2) < 0.03, now
        person.click("#underlay-move")
        person.drag(now[0][0], person.pixel(-1.0, 0.5))
        settle()
        assert math.dist(place_of(*marks[0])[1], (-1.0, 0.5)) < 0.03, place_of(*marks[0])
        page.ask(drawn % "visible")
        page.ask("(() => { const e = document.querySelector('#underlay-shown'); e.value = 0.4; e.dispatchEvent(new Event('input')); })()")
        page.wait("document.querySelector('#underlay-picture').getAttribute('opacity') === '0.4'")
        self.artefact(page, "editor-underlay")
        for theme in ("light", "dark"):
            accessibility.show_theme(page, theme)
            accessibility.check_texts(page, theme, 20)
        accessibility.show_theme(page, "light")
        person.click("#underlay-remove")
        page.wait("document.querySelector('#underlay-picture').childElementCount === 0")

    def mistakes(self, page, person, office):
        """An undone deletion comes back, and a refused change stays drawn."""
        ids = "[...document.querySelectorAll('#marks .access-point text')].map((e) => e.textContent).join()"
        person.click_at(person.pixel(-1.4, 1.05))
        person.click("#delete")
        page.wait(f"{ids} === 'ap2'")
        person.click("#undo")
        page.wait(f"{ids} === 'ap1,ap2'")
        person.click_at(person.pixel(self.recording.spots[self.SPOT]["x"], self.recording.spots[self.SPOT]["y"]))
        person.fill("[data-field=name]", "a/b")
        person.click("#save")
        page.wait(f"{self.SAID}.startsWith('Not saved') && {self.SAID}.includes(\"without '/'\")")
        with open(os.path.join(office, "site.toml"), encoding="utf-8") as file:
            begun = file.read()
        assert "access_point]]\nid = \"ap1\"" not in begun.replace("# ", "#"), begun
        assert page.ask(ids) == "ap1,ap2" and page.ask("document.querySelectorAll('#drawn .furniture').length") == 1
        person.fill("[data-field=name]", "desk")
        person.click("#save")
        page.wait(f"{self.SAID}.startsWith('saved')")
        with open(os.path.join(office, "site.toml"), encoding="utf-8") as file:
            saved = file.read()
        assert saved.startswith(begun), "what was there stays as it was"
        written = tomllib.loads(saved)
        assert [one["id"] for one in written["access_point"]] == ["ap1", "ap2"], saved
        assert written["zone"][0]["name"] == "desk" and written["transmitter"][0]["name"] == "phone", saved
        with open(os.path.join(office, "site.toml.bak"), encoding="utf-8") as file:
            assert file.read() == begun
        rayloc(self.daemon.binaries, "scene", "check", office)

    def locate(self, office):
        located = os.path.join(self.folder, "located")
        captures = [f"{one}={SITE}/{name}-{one}.pcap.gz" for name in ("device_los", "walk") for one in ACCESS_POINTS[:2]]
        rayloc(self.daemon.binaries, "calibrate", office, "--unsurveyed", "--quiet", "--capture", *captures, "--out", located)
        self.daemon.listen({"office": located}, ACCESS_POINTS[:2])
        self.daemon.url += "site/office/"
        self.daemon.start()

    def go_on(self, person, office):
        """The target is on the map; what is named then takes effect in the raylocd that runs."""
        page = self.open(1280, 800)
        person.page = page
        with Sending(self.recording, self.SPOT, self.daemon, access_points=ACCESS_POINTS[:2]):
            page.wait(f"{CELLS}[0].textContent.includes('phone') && {CELLS}[1].className === 'good'")
            page.wait("document.querySelector('#markers .target')?.checkVisibility()")
            self.artefact(page, "editor-located")
            person.click("#edit")
            page.wait("document.querySelector('#drawn .zone') !== null")
            spot = self.recording.spots[self.SPOT]
            person.click_at(person.pixel(spot["x"], spot["y"]))
            person.fill("[data-field=name]", "bench")
            person.click("#save")
            page.wait(f"{self.SAID} === 'saved; raylocd takes it up now'")
            person.click("#live-map")
            page.wait(f"{ZONE}.startsWith('bench')")
            self.check(page)
            self.close(page)
            self.walk(person, spot)

    def walk(self, person, spot):
        """A point of a survey, on a phone."""
        phone = self.browser.page(390, 844, True)
        self.pages.append(phone)
        phone.go(self.daemon.url + "edit")
        phone.wait("document.querySelectorAll('#plan polygon').length > 5")
        assert phone.ask("document.documentElement.scrollWidth") <= 390
        person = editor.Person(phone)
        person.click("#survey-tool")
        person.click_at(person.pixel(spot["x"], spot["y"]))
        phone.wait("document.querySelector('#survey-text').textContent.endsWith(': enough')")
        self.artefact(phone, "editor-survey")
        person.click("#survey-keep")
        phone.wait("document.querySelector('#survey-text').textContent.startsWith('1 points')")
        with open(os.path.join(self.folder, "located", "survey.csv"), encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == 1 and math.dist((float(rows[0]["x"]), float(rows[0]["y"])), (spot["x"], spot["y"])) < 0.02, rows
        self.check(phone)
        self.close(phone)


class FirstHourTest(MapTest):
    """From an empty folder, the DXF of an office and two access points to a target on the map, by the clicks of a
    person; and the same from a scan of that office."""

    ACCESS_POINTS = (("ap1", (0.6, 0.6, 2.2), 33), ("ap2", (5.8, 3.8, 2.2), -147))
    SURVEY = ((1.5, 1.2), (2.5, 3.4), (3.4, 1.0), (4.6, 2.6), (5.4, 1.6), (1.2, 3.2))
    SPOT = (2.5, 2.9)
    HEIGHT = 1.2
    SHELL = 40  # clicks: what a person needs for the lines of a shell and of raylocd.toml
    ON_FOOT = 12  # clicks: half a minute to go to a point and wait there, with the clicks for it
    TEXT = "document.querySelector('#calibrate-text').textContent"

    def run(self):
        self.folder = os.path.join(self.folder, "first-hour")
        os.makedirs(self.folder)
        drawing, scan = (os.path.join(self.folder, name) for name in ("office.dxf", "office.glb"))
        office, scanned = (os.path.join(self.folder, name) for name in ("office", "scanned"))
        editor.write_dxf(drawing)
        clicks = {"office": self.draw("office", drawing)}
        assert editor.write_scan(office, scan) > 20000
        clicks["scanned"] = self.draw("scanned", scan)
        for i, place in enumerate((*self.SURVEY, self.SPOT)):
            self.simulate(office, f"spot{i}", place)
        names = [one[0] for one in self.ACCESS_POINTS]
        self.daemon.listen({"office": office}, names)
        self.daemon.start()
        walked, pressed = self.survey()
        self.daemon.stop()
        clicks["office"] += walked + pressed
        shutil.copy(os.path.join(office, "survey.csv"), scanned)
        clicks["scanned"] += walked + self.calibrate_scanned(scanned)
        self.daemon.listen({name: os.path.join(self.folder, name, "calibrated") for name in clicks}, names)
        self.daemon.start()
        for name in clicks:
            with self.sending(len(self.SURVEY), 2):
                self.find(name)
        for name, count in clicks.items():
            count += self.SHELL + self.ON_FOOT * len(self.SURVEY)
            minutes = count * editor.SECONDS_PER_CLICK / 60
            print(f"from an empty folder and a file to a target ({name}): {count} clicks, {minutes:.1f} minutes")
            assert minutes <= 15, minutes

    def studio(self, name, *options):
        studio = editor.Studio(self.folder, self.daemon.binaries, os.path.join(self.folder, name), *options)
        page = self.browser.page(1280, 800)
        page.go(eventually("rayloc studio serves", studio.address))
        return studio, page, editor.Person(page)

    def draw(self, name, file):
        """The site of that name, in `rayloc studio`; how many clicks."""
        studio, page, person = self.studio(name)
        try:
            page.wait(f"{EditorTest.SAID} === 'Nothing is here yet'")
            person.choose_file("#import", file)
            page.wait(f"{EditorTest.SAID}.startsWith('{name} is begun')")
            for one in self.ACCESS_POINTS:
                person.place_access_point(*one)
            person.name_device(DEVICE, "phone")
            person.click("#save")
            page.wait(f"{EditorTest.SAID}.startsWith('saved')")
            self.artefact(page, f"first-hour-{name}")
            assert not page.errors, page.errors
        finally:
            page.close()
            studio.stop()
        rayloc(self.daemon.binaries, "scene", "check", os.path.join(self.folder, name))
        return person.clicks

    def captures(self, what):
        return [os.path.join(self.folder, f"{what}-{one}.pcap") for one, _, _ in self.ACCESS_POINTS]

    def simulate(self, office, what, place):
        """Simulates the recordings of the office's access points, with the phone there for 40 s."""
        points = os.path.join(self.folder, what + ".csv")
        begin = time.time() - 3600
        with open(points, "w", encoding="ascii") as file:
            file.write(f"t_start,t_end,x,y,z\n{begin:.3f},{begin + 40:.3f},{place[0]},{place[1]},{self.HEIGHT}\n")
        outputs = [f"{one}={file}" for (one, _, _), file in zip(self.ACCESS_POINTS, self.captures(what))]
        rayloc(self.daemon.binaries, "simulate", office, "--points", points, "--frames", "1000", "--quiet", "--out", *outputs)

    def sending(self, spot, sites=1):
        """`rayloc send` of the phone there to so many sites, at the recorded pace."""
        return SendingProcess(self.daemon, self.captures(f"spot{spot}"), sites)

    def survey(self):
        """On a phone, in the raylocd that records; how many clicks for the points, and for the calibration."""
        phone = self.browser.page(390, 844, True)
        self.pages.append(phone)
        phone.go(self.daemon.url + "site/office/edit")
        phone.wait("document.querySelectorAll('#plan > *').length > 5")
        person = editor.Person(phone)
        person.click("#calibrate-start")
        phone.wait(f"{EditorTest.SAID}.startsWith('Not calibrated: walk a survey first')")
        person.clicks = 0
        for i, place in enumerate(self.SURVEY):
            with self.sending(i):
                person.click("#survey-tool")
                person.click_at(person.pixel(*place))
                phone.wait("document.querySelector('#survey-text').textContent.endsWith(': enough')")
                person.click("#survey-keep")
                phone.wait(f"document.querySelector('#survey-text').textContent.startsWith('{i + 1} points')")
        walked, person.clicks = person.clicks, 0
        self.calibrate(phone, person, "office")
        assert phone.ask("document.documentElement.scrollWidth") <= 390
        self.artefact(phone, "first-hour-calibrated")
        phone.errors = [one for one in phone.errors if "422" not in one]
        self.check(phone)
        self.read_report(phone)
        self.close(phone)
        return walked, person.clicks

    def calibrate(self, page, person, name):
        """By the button; its text is that of the report."""
        page.ask("document.querySelector('#calibrate-what').value = 'chains'")
        person.clicks += 2
        person.click("#calibrate-start")
        page.wait(f"{self.TEXT}.startsWith('Calibrating for')")
        page.wait(f"{self.TEXT}.startsWith('Good: expect ')")
        with open(os.path.join(self.folder, name, "calibrated", "report.json"), encoding="utf-8") as file:
            assert page.ask(self.TEXT) == json.load(file)["verdict"]["expectation"]
        assert page.ask("document.querySelector('#calibrate-next').textContent").startswith(
            f"It is in {self.folder}/{name}/calibrated. ")

    def read_report(self, page):
        """The link leads to it, with its own styles and nothing that the policy refuses."""
        page.go(page.ask("document.querySelector('#calibrate-report').href"))
        page.wait("document.querySelectorAll('svg').length > 0")
        assert page.ask("getComputedStyle(document.body).maxWidth") != "none"
        assert not page.errors, page.errors

    def calibrate_scanned(self, folder):
        """In `rayloc studio`, of what raylocd recorded: ended with it, stopped, and done."""
        recorded = os.path.join(self.daemon.folder, "recorded", "office")
        captures = [f"{file.partition('-')[0]}={recorded}/{file}" for file in sorted(os.listdir(recorded))]
        studio, page, person = self.studio("scanned", "--capture", *captures)
        person.click("#calibrate-start")
        page.wait(f"{self.TEXT}.startsWith('Calibrating for')")
        eventually("the calibration is a process", lambda: self.calibrations(folder))
        page.close()
        studio.stop()
        eventually("the calibration ends with the studio", lambda: not self.calibrations(folder))
        shutil.rmtree(os.path.join(folder, "calibrated"), ignore_errors=True)
        studio, page, person = self.studio("scanned", "--capture", *captures)
        try:
            person.click("#calibrate-start")
            page.wait(f"{self.TEXT}.startsWith('Calibrating for')")
            person.click("#calibrate-stop")
            page.wait(f"{self.TEXT}.startsWith('Stopped.')")
            assert not os.path.exists(os.path.join(folder, "calibrated"))
            person.clicks = 0
            self.calibrate(page, person, "scanned")
            for theme in ("light", "dark"):
                accessibility.show_theme(page, theme)
                accessibility.check_texts(page, theme, 20)
            assert not page.errors, page.errors
        finally:
            page.close()
            studio.stop()
        return person.clicks

    @staticmethod
    def calibrations(folder):
        """Processes of `rayloc calibrate` of that site."""
        found = []
        for name in os.listdir("/proc"):
            try:
                with open(f"/proc/{name}/cmdline", "rb") as file:
                    words = file.read().split(b"\0")
            except (NotADirectoryError, FileNotFoundError, ProcessLookupError):
                continue
            if b"calibrate" in words and folder.encode() in words:
                found.append(name)
        return found

    def find(self, name):
        """The target is on the map where the phone is."""
        path = f"site/{name}/"
        page = self.browser.page(1280, 800)
        page.go(self.daemon.url + path)
        self.pages.append(page)
        page.wait(f"{CELLS}[0].textContent.includes('phone') && {CELLS}[1].className === 'good'")
        page.wait("document.querySelector('#markers .target')?.checkVisibility()")
        place = eventually("the phone is located", lambda: self.daemon.located(DEVICE, path))["position"]
        off = math.dist((place["x"], place["y"]), self.SPOT)
        print(f"{name}: {off:.2f} m off")
        assert off < 0.3, place
        self.artefact(page, f"first-hour-{name}-located")
        self.check(page)
        self.close(page)


class SendingProcess:
    """`rayloc send`, of two access points to each of so many sites of a raylocd."""

    def __init__(self, daemon, files, sites):
        ports = daemon.udp[:len(files) * sites]
        self.command = [os.path.join(daemon.binaries, "rayloc"), "send", *files * sites]
        for port in ports:
            self.command += ["--to", f"127.0.0.1:{port}"]

    def __enter__(self):
        self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(PATIENCE)


def rayloc(binaries, *arguments):
    subprocess.run([os.path.join(binaries, "rayloc"), *arguments], check=True, stdin=subprocess.DEVNULL,
                   stdout=subprocess.DEVNULL)


def assert_counted(daemon):
    """However it was moved, every datagram that was received is accounted for."""
    for source in json.loads(daemon.get("api/v1/sources")[1]):
        counters = {key: int(value) for key, value in source["counters"].items()
                    if key != "rejected"}
        assert counters["received"] == counters["processed"] + counters["in_flight"], source
        assert counters["frames_dropped"] == 0 and not source["counters"]["rejected"], source


def with_zone(site, name, x, y):
    """The same site, with a zone around there, and a device that has a name."""
    copy = f"{site}-{name}"
    shutil.copytree(site, copy)
    west, east, south, north = x - 0.4, x + 0.4, y - 0.4, y + 0.4
    path = os.path.join(copy, "site.toml")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    mac = f"mac = '{DEVICE}'\n"
    assert text.count(mac) == 1
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace(mac, mac + 'name = "phone"\n'))
        file.write(f'\n[[zone]]\nname = "corner"\npolygon = [[{west}, {south}], [{east}, {south}], '
                   f'[{east}, {north}], [{west}, {north}]]\nenter_after_s = 0.1\n')
    return copy


def of_spots(folder, binaries, site):
    """raylocd on the recording of a device at rest, in a zone ten seconds after the beginning."""
    x, y = (Recording().spots[2][axis] for axis in "xy")
    return Daemon(folder, binaries, with_zone(site, "spots", x, y), "device_los")


def of_walk(folder, binaries, site):
    return Daemon(folder, binaries, with_zone(site, "walk", -1.0, 0.9), "walk")


class LaterDaemon(Daemon):
    """raylocd on a site that is yet to be drawn."""

    listens = False

    def listen(self, directories, access_points):
        """To those access points of each of the sites, whose folders are given by their names."""
        self.listens = True
        while len(self.udp) < len(directories) * len(access_points):
            self.udp.append(free_port(socket.SOCK_DGRAM))
        ports = iter(self.udp)
        tables = ""
        for name, directory in directories.items():
            tables += f'[[site]]\nname = "{name}"\ndirectory = "{directory}"\n'
            tables += "".join(f'[[source]]\nsite = "{name}"\naccess_point = "{one}"\nkind = "udp"\n'
                              f'listen = "127.0.0.1:{next(ports)}"\n' for one in access_points)
        path = os.path.join(self.folder, "raylocd.toml")
        with open(path, encoding="utf-8") as file:
            rest = file.read()
        with open(path, "w", encoding="utf-8") as file:
            file.write(tables + rest[rest.index("[http]"):])

    def start(self):
        if self.listens:
            super().start()


def of_sites(folder, binaries, site):
    """One of several sites, with a zone."""
    daemon = Daemon(folder, binaries, with_zone(site, "sites", -1.0, 0.9))
    path = os.path.join(folder, "raylocd.toml")
    with open(path, encoding="utf-8") as file:
        text = file.read()
    with open(path, "w", encoding="utf-8") as file:
        file.write(text.replace("[site]\n", '[[site]]\nname = "room"\n')
                   .replace("[[source]]\n", '[[source]]\nsite = "room"\n'))
    daemon.site = f"{site}-sites"
    daemon.url += "site/room/"
    return daemon


def calibrate(folder, binaries):
    site = os.path.join(folder, "site")
    captures = [f"{name}={SITE}/calibration-{name}.pcap.gz" for name in ACCESS_POINTS]
    subprocess.run([os.path.join(binaries, "rayloc"), "calibrate", SITE, "--gains-only", "--quiet",
                    "--capture", *captures, "--points", SITE + "/calibration.csv", "--out", site],
                   check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    return site


# The parts of the test, and the raylocd of each.
PARTS = {
    "live": (MapTest, Daemon),
    "places": (PlacesTest, Daemon),
    "compared": (ComparedTest, lambda folder, binaries, site:
                 Daemon(folder, binaries, site, extra='[engine]\nmethod = ["rayloc", "spotfi"]\n')),
    "recording": (PlaybackTest, of_spots),
    "walk": (WalkTest, of_walk),
    "reload": (ReloadTest, of_sites),
    "editor": (EditorTest, lambda folder, binaries, site: LaterDaemon(folder, binaries, site, http_keys="edit = true\n")),
    "first-hour": (FirstHourTest, lambda folder, binaries, site: LaterDaemon(
        folder, binaries, site, http_keys="edit = true\n", extra=f'[record]\ndirectory = "{folder}/recorded"\n')),
    "no-room": (NoRoomTest, lambda folder, binaries, site:
                Daemon(folder, binaries, site, extra='[engine]\nmethod = "none"\n')),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("binaries")
    parser.add_argument("out")
    parser.add_argument("--picture")
    parser.add_argument("--only", nargs="+", choices=PARTS, default=list(PARTS), metavar="PART")
    arguments = parser.parse_args()
    os.makedirs(arguments.out, exist_ok=True)
    folder = tempfile.mkdtemp(prefix="rayloc-map.")
    daemon = None
    site = calibrate(folder, arguments.binaries)
    try:
        with Browser(folder) as browser:
            for part in arguments.only:
                test, make = PARTS[part]
                daemon = make(folder, arguments.binaries, site)
                daemon.start()
                test(folder, arguments.out, daemon, browser, Recording(), arguments.picture).run()
                daemon.stop()
    except BaseException:
        for log in ("raylocd.log", "chromium.log"):
            with open(os.path.join(folder, log), "a+", encoding="utf-8", errors="replace") as file:
                file.seek(0)
                print(f"---- {log}\n{file.read()[-4000:]}", file=sys.stderr)
        raise
    finally:
        if daemon and daemon.process:
            daemon.process.kill()
            daemon.process.wait()
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
