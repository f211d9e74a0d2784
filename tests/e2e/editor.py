"""A person at the editor of the map: clicks that are counted, and the drawings and scans that are imported."""

import glob
import os
import random
import re
import struct
import subprocess
import zlib

from browser import PATIENCE

SECONDS_PER_CLICK = 2.0  # of an experienced user


class Person:
    """Real events of mouse and keys in a page; each press counts, and each field that is filled counts two."""

    def __init__(self, page, clicks=0):
        self.page, self.clicks = page, clicks

    def mouse(self, kind, at, **more):
        self.page.call("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], **more)

    def click_at(self, at):
        self.drag(at, at)

    def drag(self, begin, end):
        self.clicks += 1
        self.mouse("mousePressed", begin, button="left", clickCount=1)
        if begin != end:
            self.mouse("mouseMoved", end, button="left", buttons=1)
        self.mouse("mouseReleased", end, button="left", clickCount=1)

    def place(self, selector):
        return self.page.wait("(() => { const e = document.querySelector(%r); e.scrollIntoView({block: 'nearest'});"
                              " const b = e.getBoundingClientRect(); return !e.disabled && b.width > 0 &&"
                              " [b.x + b.width / 2, b.y + b.height / 2]; })()" % selector)

    def click(self, selector):
        self.click_at(self.place(selector))

    def fill(self, selector, text):
        self.click(selector)
        self.clicks += 1
        self.page.ask("document.activeElement.select()")
        self.page.call("Input.insertText", text=text)
        self.page.press("Tab")
        self.page.ask("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def choose_file(self, selector, path):
        self.clicks += 4  # a window of the system
        root = self.page.call("DOM.getDocument")["root"]["nodeId"]
        node = self.page.call("DOM.querySelector", nodeId=root, selector=selector)["nodeId"]
        self.page.call("DOM.setFileInputFiles", nodeId=node, files=[path])

    def place_access_point(self, name, position, yaw_deg):
        """As measured with a tape: numbers correct the place of the click."""
        x, y, z = position
        self.click("[data-tool=place]")
        self.click_at(self.pixel(x, y))
        self.page.wait(f"document.querySelector('[data-field=name]')?.value === '{name}'")
        for field, value in (("x [m]", x), ("y [m]", y), ("height [m]", z), ("faces [°, from +x to +y]", yaw_deg)):
            self.fill(f'[data-field="{field}"]', str(value))

    def name_device(self, mac, name):
        self.fill("#device-mac", mac)
        self.click("#add-device")
        self.fill(f'[data-field="name of {mac}"]', name)

    def pixel(self, x, y):
        """Where that place of the site is on the page, by the editor's own drawing."""
        return self.page.ask(f"(() => {{ const m = document.querySelector('#plan').getScreenCTM();"
                             f" return [m.a * {x} + m.e, m.d * {y} + m.f]; }})()")


class Studio:
    """`rayloc studio` as a process."""

    def __init__(self, folder, binaries, site, *options):
        self.log = os.path.join(folder, "studio.log")
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen([os.path.join(binaries, "rayloc"), "studio", site, "--listen", "127.0.0.1:0", *options],
                                            stdin=subprocess.DEVNULL, stdout=log, stderr=log)

    def address(self):
        assert self.process.poll() is None, "rayloc studio has ended"
        with open(self.log, encoding="utf-8") as log:
            found = re.match(r"(http://127\.0\.0\.1:\d+/) ", log.read())
        return found and found[1]

    def stop(self):
        self.process.terminate()
        assert self.process.wait(PATIENCE) == 0


def refuse_strangers(binaries, site):
    """No host on the network writes files without a token."""
    refused = subprocess.run([os.path.join(binaries, "rayloc"), "studio", site, "--listen", "0.0.0.0:0"], timeout=PATIENCE,
                             stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    assert refused.returncode == 64 and "could write the files of the site" in refused.stderr, refused
    assert not os.path.exists(site)


def write_obj(site, path):
    """The scene of a site as Blender would export it: an object a mesh, with its material, y up."""
    with open(os.path.join(site, "scene.xml"), encoding="utf-8") as file:
        materials = dict(re.findall(r'id="mesh-(\w+)".*?<ref id="mat-itu_(\w+)"', file.read(), re.S))
    lines, first = [], 1
    for mesh in sorted(glob.glob(os.path.join(site, "meshes", "*.ply"))):
        name = os.path.splitext(os.path.basename(mesh))[0]
        with open(mesh, "rb") as file:
            head, body = file.read().split(b"end_header\n", 1)
        vertices, faces = (int(one) for one in re.search(rb"element vertex (\d+).*element face (\d+)", head, re.S).groups())
        lines += [f"o {name}", f"usemtl {materials[name]}"]
        for x, y, z in struct.iter_unpack("<3f", body[:12 * vertices]):
            lines.append(f"v {x} {z} {-y}")
        for sides, a, b, c in struct.iter_unpack("<B3i", body[12 * vertices:12 * vertices + 13 * faces]):
            assert sides == 3
            lines.append(f"f {first + a} {first + b} {first + c}")
        first += vertices
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


def write_dxf(path):
    """An office as an architect draws it, in millimetres, by a program of other people: walls with two faces, a
    window, a desk."""
    import ezdxf  # Debian: python3-ezdxf
    drawing = ezdxf.new("R2010")
    drawing.header["$INSUNITS"] = 4
    space = drawing.modelspace()

    def rectangle(x0, y0, x1, y1, layer):
        space.add_lwpolyline([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], close=True, dxfattribs={"layer": layer})
    rectangle(1000, 2000, 7400, 6400, "A-WALL")
    rectangle(1200, 2200, 7200, 6200, "A-WALL")
    for y in (2070, 2130):
        space.add_line((2200, y), (3700, y), dxfattribs={"layer": "A-GLAZ"})
    rectangle(5300, 2400, 6900, 3200, "FURNITURE")
    drawing.saveas(path)


def write_png(path, width, height, marks, side):
    """A white picture with squares of that side around places in it: (x, y, colour), y down."""
    rows = [bytearray(b"\xff" * 3 * width) for _ in range(height)]
    for x, y, colour in marks:
        for row in rows[y - side // 2:y + side // 2]:
            row[3 * (x - side // 2):3 * (x + side // 2)] = bytes(colour) * side

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
                   + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))


def write_pdf(path, width, height, pages, side):
    """As write_png, at 150 pixels an inch, with such marks on each page."""
    objects = [b"<</Type/Catalog/Pages 2 0 R>>", b""]
    for marks in pages:
        squares = "\n".join(f"{r / 255} {g / 255} {b / 255} rg {x - side / 2} {height - y - side / 2} {side} {side} re f" for x, y, (r, g, b) in marks)
        content = f"{72 / 150} 0 0 {72 / 150} 0 0 cm\n{squares}"
        objects.append(f"<</Type/Page/Parent 2 0 R/MediaBox[0 0 {width * 72 / 150} {height * 72 / 150}]/Contents {len(objects) + 2} 0 R>>".encode())
        objects.append(f"<</Length {len(content)}>>stream\n{content}\nendstream".encode())
    objects[1] = f"<</Type/Pages/Count {len(pages)}/Kids[{' '.join(f'{2 * i + 3} 0 R' for i in range(len(pages)))}]>>".encode()
    text, offsets = b"%PDF-1.4\n", []
    for i, one in enumerate(objects):
        offsets.append(len(text))
        text += b"%d 0 obj\n%s\nendobj\n" % (i + 1, one)
    table = b"0000000000 65535 f \n" + b"".join(b"%010d 00000 n \n" % one for one in offsets)
    with open(path, "wb") as file:
        file.write(text + b"xref\n0 %d\n%strailer<</Size %d/Root 1 0 R>>\nstartxref\n%d\n%%%%EOF\n"
                   % (len(objects) + 1, table, len(objects) + 1, len(text)))


def triangles(site):
    """The triangles of all meshes of an imported site."""
    for mesh in sorted(glob.glob(os.path.join(site, "meshes", "*.ply"))):
        with open(mesh, encoding="ascii") as file:
            head, body = file.read().split("end_header\n", 1)
        count = int(re.search(r"element vertex (\d+)", head)[1])
        rows = [line.split() for line in body.splitlines()]
        points = [tuple(float(one) for one in row) for row in rows[:count]]
        for sides, *corners in rows[count:]:
            assert sides == "3"
            yield [points[int(i)] for i in corners]


def cut(triangle, longest):
    """Four of each until no side is longer."""
    a, b, c = triangle
    squares = [sum((p - q) ** 2 for p, q in zip(*pair)) for pair in ((a, b), (b, c), (c, a))]
    if max(squares) <= longest ** 2:
        yield triangle
        return
    ab, bc, ca = (tuple((p + q) / 2 for p, q in zip(*pair)) for pair in ((a, b), (b, c), (c, a)))
    for part in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)):
        yield from cut(part, longest)


def write_scan(site, path, longest=0.15, noise=0.01):
    """The room of a site as a phone scans it: one mesh without names, finely cut, each corner off by a centimetre, y
    up; as GLB by assimp. Returns how many triangles."""
    chance = random.Random(7)
    numbers, lines, faces = {}, ["o scan"], []
    for triangle in triangles(site):
        for part in cut(triangle, longest):
            face = "f"
            for corner in part:
                key = tuple(round(one, 5) for one in corner)
                if key not in numbers:
                    numbers[key] = len(numbers) + 1
                    x, y, z = (one + chance.gauss(0, noise) for one in corner)
                    lines.append(f"v {x:.4f} {z:.4f} {-y:.4f}")
                face += f" {numbers[key]}"
            faces.append(face)
    with open(path + ".obj", "w", encoding="ascii") as file:
        file.write("\n".join(lines + faces) + "\n")
    subprocess.run(["assimp", "export", path + ".obj", path], check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    return len(faces)
