#!/usr/bin/python3
"""The live map as it is seen through another server: below a path, by another name, in a frame of a
page of another site. raylocd and nginx as processes, headless Chromium.

    map_front_test.py BIN_DIR OUT_DIR

Screenshots go to OUT_DIR.
"""

import argparse
import http.client
import os
import shutil
import socket
import subprocess
import sys
import tempfile

import map_test
from browser import Browser, patient
from map_test import CELLS, DEVICE, PATIENCE, SHOWN, Daemon, Recording, Sending, eventually

HERE = os.path.dirname(os.path.abspath(__file__))
NAME = "map.localhost"  # which browsers take for this machine
CONTROL = {"X-RayLoc-Control": "1"}


class Nginx:
    """Before the raylocd of that port, with its defaults."""

    def __init__(self, folder, raylocd, card):
        self.folder = os.path.join(folder, "nginx")
        os.makedirs(os.path.join(self.folder, "run/tmp"), exist_ok=True)
        os.chmod(folder, 0o755)  # its worker runs as the user `nobody`
        self.plain, self.kept = (map_test.free_port(socket.SOCK_STREAM) for _ in range(2))
        self.card = card
        with open(os.path.join(HERE, "nginx.conf"), encoding="ascii") as file:
            text = file.read()
        for name, port in (("PLAIN", self.plain), ("KEPT", self.kept), ("CARD", self.card), ("RAYLOCD", raylocd)):
            text = text.replace(f"@{name}@", str(port))
        with open(os.path.join(self.folder, "nginx.conf"), "w", encoding="ascii") as file:
            file.write(text)

    def __enter__(self):
        program = shutil.which("nginx", path=os.environ.get("PATH", "") + ":/usr/sbin")
        assert program, "there is no nginx (deploy/packages/test.txt)"
        self.process = subprocess.Popen(
            [program, "-p", self.folder, "-c", "nginx.conf", "-e", "run/error.log"], stdin=subprocess.DEVNULL)
        try:
            eventually("nginx answers", self.answers)
        except BaseException:
            self.__exit__()
            raise
        return self

    def answers(self):
        assert self.process.poll() is None, "nginx has ended"
        try:
            return self.ask(self.plain, "GET", "/healthz")[0] == 200
        except OSError:
            return False

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(PATIENCE)

    @staticmethod
    def ask(port, method, path, headers=None):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE)
        try:
            connection.request(method, path, headers=headers or {})
            answer = connection.getresponse()
            return answer.status, answer.read(), dict(answer.getheaders())
        finally:
            connection.close()


class FrontTest:
    """The common part of both: a page, seen through nginx."""

    def __init__(self, out, daemon, nginx, browser, recording):
        self.out, self.daemon, self.nginx = out, daemon, nginx
        self.browser, self.recording = browser, recording

    def open(self, url):
        page = self.browser.page(1280, 800)
        page.go(url)
        return page

    def check(self, page, url):
        """Nothing failed, and no request went to another server."""
        assert not page.errors, page.errors
        elsewhere = [one for one in page.requests if not one.startswith(url) and one != "about:blank"]
        assert len(page.requests) > 5 and not elsewhere, elsewhere

    def frame(self, page):
        """The frame within the page, and a function that evaluates in it."""
        def child():
            return page.call("Page.getFrameTree")["frameTree"].get("childFrames", [{}])[0].get("frame")
        found = eventually("there is a frame", lambda: (one := child()) and one["url"] != "about:blank" and one)

        def ask(expression):
            # It is the document that is there by now; another may come between the two calls.
            while True:
                world = page.call("Page.createIsolatedWorld", frameId=found["id"])["executionContextId"]
                try:
                    answer = page.call("Runtime.evaluate", expression=expression, returnByValue=True, contextId=world)
                except RuntimeError as error:
                    if "Cannot find context" not in str(error):
                        raise
                    continue
                return answer["result"].get("value")
        return found, ask


class DefaultTest(FrontTest):
    """raylocd has no configuration for the server before it."""

    def run(self):
        url = f"http://127.0.0.1:{self.nginx.plain}/rayloc/"
        page = self.open(url)
        page.wait("document.querySelectorAll('#plan polygon').length > 5")
        for spot in (0, 1):  # it is followed, not only found
            truth = self.recording.spots[spot]
            with Sending(self.recording, spot, self.daemon):
                page.wait(f"{SHOWN} && (() => {{ const [x, y] = {CELLS}[2].firstChild.textContent.split(',')"
                          f".map(Number); return Math.hypot(x - {truth['x']}, y - {truth['y']}) < 0.3; }})()")
                page.wait("document.querySelectorAll('#source-rows td.good').length === 3")
                self.look_at_panels(page)
        page.screenshot(os.path.join(self.out, "below-a-path.png"))
        self.check(page, url)
        page.close()
        self.other_names()
        self.no_frame()

    def look_at_panels(self, page):
        page.ask("document.querySelector('#csi').open = document.querySelector('#calibration').open = true")
        page.wait("document.querySelectorAll('#csi-charts .measured').length === 9")
        page.wait("document.querySelectorAll('#moved-rows tr').length > 0")

    def other_names(self):
        """A name that is not listed may be any host's; the name that nginx sets is not the browser's."""
        for port, path in ((self.nginx.kept, "/"), (self.nginx.kept, "/events"), (self.nginx.kept, "/api/v1/targets")):
            status, body, _ = self.nginx.ask(port, "GET", path, {"Host": f"{NAME}:{port}"})
            assert status == 421 and b"[http] origins" in body, (path, status, body)
        assert self.nginx.ask(self.nginx.kept, "GET", "/")[0] == 200, "by number"

    def no_frame(self):
        page = self.open(f"http://127.0.0.1:{self.nginx.card}/")
        eventually("it is refused", lambda: page.ask("true") and any("frame-ancestors" in one for one in page.errors))
        frame, _ = self.frame(page)
        assert frame.get("unreachableUrl"), frame
        page.close()


class ToldTest(FrontTest):
    """raylocd plays a recording, and has a configuration for the server before it."""

    @staticmethod
    def keys(card):
        return (f'base_path = "/home"\norigins = ["http://{NAME}:80", "http://nas.example"]\n'
                f'frame_ancestors = ["http://127.0.0.1:{card}"]\n')

    def run(self):
        plain = f"http://127.0.0.1:{self.nginx.plain}"
        # nginx states a Host of its own, or one without the port.
        for asked, base in ((f"{plain}/rayloc/", None), (f"{plain}/home", f"{plain}/home/"),
                            (f"http://{NAME}:{self.nginx.kept}/", None)):
            page = self.open(asked)
            self.control(page)
            page.requests = [one for one in page.requests if one != asked]
            self.check(page, base or asked)
            page.close()
        self.others_do_not_control()
        self.card()

    def control(self, page):
        text = "document.querySelector('#playback-text').textContent"
        button = "document.querySelector('#playback-play')"
        page.wait("!document.querySelector('#playback').hidden")
        page.wait(SHOWN)
        for _ in range(2):
            before = page.ask(f"{button}.textContent")
            page.ask(f"{button}.click()")
            page.wait(f"{button}.textContent !== '{before}'")
            state = page.ask("document.querySelector('#playback-error').textContent")
            assert state == "", state
            page.wait(f"{text}.includes('paused') === {'true' if before == 'Pause' else 'false'}")

    def others_do_not_control(self):
        path = "/rayloc/api/v1/playback?state=paused"
        for origin, status in (("http://nas.example", 200), ("http://evil.example", 403),
                               ("http://127.0.0.1:1", 403), ("null", 403)):
            found = self.nginx.ask(self.nginx.plain, "POST", path, {"Origin": origin, **CONTROL})[0]
            assert found == status, (origin, found)
        assert self.nginx.ask(self.nginx.plain, "POST", "/rayloc/api/v1/playback?state=playing", CONTROL)[0] == 200

    def card(self):
        """In a frame of a page of another site, as in a card of Home Assistant."""
        page = self.open(f"http://127.0.0.1:{self.nginx.card}/")
        _, ask = self.frame(page)
        eventually("the target is shown in the frame", lambda: ask(SHOWN))
        eventually("it is told on", lambda: ask("document.querySelector('#connection').textContent") == "Connected")
        page.screenshot(os.path.join(self.out, "in-a-frame.png"))
        assert not page.errors, page.errors
        page.close()


def events_come_at_once(folder, binaries, site, card):
    """Events pass through nginx at once, however short they are: after the first snapshot, which comes with
    the head, raylocd sends nothing for a minute but a sign of life."""
    daemon = Daemon(folder, binaries, site, extra='heartbeat_s = 60\n[engine]\nmethod = "none"\n')
    daemon.start()
    try:
        with Nginx(folder, daemon.http, card) as nginx:
            connection = http.client.HTTPConnection("127.0.0.1", nginx.plain, timeout=patient(40))
            connection.request("GET", "/rayloc/events")
            answer = connection.getresponse()
            lines = [answer.readline()]
            while lines[-1] != b":\n":
                assert lines[-1], "nginx has closed a stream that is silent"
                lines.append(answer.readline())
            assert b"event: snapshot\n" in lines, lines
            connection.close()
    finally:
        daemon.stop()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("binaries")
    parser.add_argument("out")
    arguments = parser.parse_args()
    os.makedirs(arguments.out, exist_ok=True)
    folder = tempfile.mkdtemp(prefix="rayloc-front.")
    daemon = None
    site = map_test.calibrate(folder, arguments.binaries)
    card = map_test.free_port(socket.SOCK_STREAM)
    try:
        events_come_at_once(folder, arguments.binaries, site, card)
        with Browser(folder) as browser:
            for test, make in ((DefaultTest, lambda: Daemon(folder, arguments.binaries, site)),
                               (ToldTest, lambda: Daemon(folder, arguments.binaries, site, "device_los",
                                                         http_keys=ToldTest.keys(card)))):
                daemon = make()
                daemon.start()
                with Nginx(folder, daemon.http, card) as nginx:
                    test(arguments.out, daemon, nginx, browser, Recording()).run()
                daemon.stop()
    except BaseException:
        for log in ("raylocd.log", "chromium.log", "nginx/run/error.log"):
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
