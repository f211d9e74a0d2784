#!/usr/bin/python3
"""The live map in a real browser: raylocd as a process, recorded datagrams over UDP, headless
Chromium, and the pixels that it shows.

    map_test.py BIN_DIR OUT_DIR [--picture FILE.png] [--only PART ...]

Screenshots go to OUT_DIR. --picture also writes the picture of the README (deploy/map_picture).
PART: live, places, recording, walk, no-room; all of them unless told.
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
from browser import Browser

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
PATIENCE = 60.0
PIXELS = 3.0
# daemon/http/map/map.css: the first target, and one without a newer estimate.
LIVE_COLOUR = (0x00, 0x67, 0xB8)
STALE_COLOUR = (0x66, 0x71, 0x7C)


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
        """Of the device, as located() tells it."""
        location = self.located(DEVICE)
        return location and (location["position"]["x"], location["position"]["y"])

    def located(self, mac):
        """The last filtered estimate of it, as a new viewer is told it."""
        connection = http.client.HTTPConnection("127.0.0.1", self.http, timeout=PATIENCE)
        try:
            connection.request("GET", "/events")
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
        that address had been there, and heard by these access points alone."""
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
        expected = expected_pixel(position, map_box(page))
        shown = shown_at(page, expected, colour)
        return None if shown is None else (math.dist(shown, expected), position)

    # The page is told ten times a second, and what it is told may still be moving.
    found = eventually(f"{what}: the mark within {PIXELS} pixels",
                       lambda: (e := error()) and e[0] <= PIXELS and e)
    print(f"{what}: {found[0]:.2f} pixels off")
    return found[1]


def silent_errors(page):
    """What the browser itself says about a server that is away."""
    return [one for one in page.errors if "net::ERR_" not in one]


class MapTest:
    def __init__(self, folder, out, daemon, browser, recording, picture):
        self.folder, self.out, self.daemon = folder, out, daemon
        self.browser, self.recording, self.picture = browser, recording, picture
        self.pages = []

    def open(self, width, height, phone=False):
        page = self.browser.page(width, height, phone)
        page.go(self.daemon.url)
        page.wait("document.querySelectorAll('#plan polygon').length > 5")
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
        assert re.match(DEVICE + r" at -?\d+\.\d+, -?\d+\.\d+, heard \d+ s ago: ", text), text
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
        page.wait("document.querySelectorAll('#plan polygon').length > 5")
        page.wait("!document.querySelector('#empty').checkVisibility()")
        assert not silent_errors(page), page.errors
        self.close(page)

    def hidden_page(self):
        """A page that nobody looks at leaves its place to others; a browser that keeps nothing does."""
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
        """A raylocd that hangs: nothing that was said is shown as if it still held."""
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
                # The connection is open as before; that nobody is there can only be found out anew.
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
        # Whoever looks at the past has to notice, too.
        page.ask("document.querySelector('#play').click()")
        page.wait(f"{TIME_SHOWN}.includes('ago')")
        self.daemon.stop()
        page.wait(f"{CONNECTION}.startsWith('Connection lost')")
        self.daemon.start()
        page.wait(f"{CONNECTION} === 'Connected'")
        page.wait(f"{TIME_SHOWN} === 'live'")
        page.wait(f"{EVENTS}.includes('raylocd was started again')")
        assert "confirmed" in page.ask(EVENTS), "what happened before is forgotten"
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
        """What is shown of the calibration is of this start of raylocd, and stays in its place."""
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
            # What hangs on a wall is read from afar.
            letters = page.ask("document.querySelector('#markers text').getBoundingClientRect().height")
            assert 13 <= letters / max(1, width / 1920) <= 26, f"{width}: letters of {letters} pixels"
            self.artefact(page, f"{width}")
            if phone:
                small = page.ask("[...document.querySelectorAll('button')].filter(b => "
                                 "b.checkVisibility() && "
                                 "b.getBoundingClientRect().height < 24).length")
                assert small == 0, "buttons too small for a finger"
            self.check(page)

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
        """Of the recordings [s since 1970]."""
        return min(one[0] for one in self.recording.datagrams)

    def spot_at(self, seconds):
        """Where the device stood, so long after the beginning; None on its way."""
        return next((spot for spot in self.recording.spots
                     if spot["t_start"] + 0.4 < self.begin() + seconds < spot["t_end"]), None)

    def go_to(self, page, steps):
        """By so many times Home and the arrow; the map shows where the device stood then."""
        self.reach(page, "playback-position")
        page.press("Home")
        for _ in range(steps):
            page.press("ArrowRight")
        page.wait(f"Number({self.POSITION}.value) === {5 * steps}")
        truth = self.spot_at(5 * steps)
        eventually(f"the device at {5 * steps} s", lambda: (p := self.daemon.position())
                   and math.dist(p, (truth["x"], truth["y"])) < 0.3)
        assert_shown(page, self.daemon, LIVE_COLOUR, f"{5 * steps} s into the recording")
        # What was before the move is not joined to it.
        page.wait("[...document.querySelectorAll('#trails polyline')].every((line) => "
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
        page.wait("window.beats > 2")  # it stands still, and nothing grows old
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
        """What others ask for is shown, where the focus is and after a drag to where it began, too."""
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
        """Whoever looks is told, and once raylocd answers again the controls work."""
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
        trail = "document.querySelector('#trails polyline')"
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
        self.ask_for("position=0&speed=0.25&state=playing")
        self.channel_of_a_burst(page)
        self.check(page)
        self.close(page)
        if self.picture:
            shutil.copy(os.path.join(self.out, "walk.png"), self.picture)

    def channel_of_a_burst(self, page):
        """The panel: of the burst and the place of one location, by name; while nobody stands still."""
        told = "window.told"
        page.ask(told + " = {}; for (const kind of ['snapshot', 'update']) (window.listening ||= new EventSource('events'))"
                 ".addEventListener(kind, (event) => { for (const {location} of JSON.parse(event.data).messages) {"
                 " if (location?.kind === 'LOCATION_KIND_SNAPSHOT' && location.position) {"
                 f" const {{x, y, z}} = location.position; {told}[location.time] = [x, y, z]; }} }} }})")
        page.ask("document.querySelector('#csi').open = true")
        page.wait("/^phone at .*: amplitude/.test(document.querySelector('#csi-text').textContent)")
        # Of a burst that was told to this page as well.
        page.wait(f"(async () => (await (await fetch('api/v1/channel')).json()).some((one) => one.name === 'phone' && "
                  f"JSON.stringify({told}[one.time]) === JSON.stringify(one.position)))()")
        page.ask("document.querySelector('#csi').open = false; window.listening.close()")

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
    """Two devices, of which one access point alone hears: where else they may be is shown."""

    OTHER = "02:52:4c:00:00:03"  # not in the site: located as any other
    SURE, UNSURE = 6, 11  # spots: the first is well told from there; the second has another place
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


def calibrate(folder, binaries):
    site = os.path.join(folder, "site")
    captures = [f"{name}={SITE}/calibration-{name}.pcap.gz" for name in ACCESS_POINTS]
    subprocess.run([os.path.join(binaries, "rayloc"), "calibrate", SITE, "--gains-only", "--quiet",
                    "--capture", *captures, "--points", SITE + "/calibration.csv", "--out", site],
                   check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    return site


# What is tested, and the raylocd that it looks at.
PARTS = {
    "live": (MapTest, Daemon),
    "places": (PlacesTest, Daemon),
    "recording": (PlaybackTest, of_spots),
    "walk": (WalkTest, of_walk),
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
