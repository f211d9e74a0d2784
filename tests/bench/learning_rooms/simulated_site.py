"""One drawn room with one number of access points: simulated, calibrated, and replayed after power cycles."""
from __future__ import annotations

import argparse
import csv
import json
import os
import random
import shutil
import subprocess
from pathlib import Path
from typing import Any

from beliefs import add_ends, learning_ends, located, phases_at_end, read_beliefs, read_bursts, read_truth
from beliefs import RATE_HZ, Phases
from drawn_rooms import drawn_room
from walks import walk

FRAMES_A_POINT = 10
SURVEY_ERROR_M = 0.005
FULL_ERRORS = 3.0  # of the plan, multiple of those that a calibration leaves
SURVEYED_AT, WALKED_AT = 1718000000, 1718100000  # POSIX seconds
DEVICE_HEIGHT_M, HEIGHT_SIGMA_M = 1.2, 0.3
HANDLED = ("--height-sigma", HEIGHT_SIGMA_M, "--tilt-deg", 35, "--power-sigma-db", 4)
CORES = (2, 0, 3)  # of the drawn access points
NO_SUCCESS = 79  # exit status of a calibration that explains too little of the survey

Row = dict[str, Any]


class SimulatedSite:
    def __init__(self, options: argparse.Namespace, number: int, aps: int) -> None:
        self.options, self.number, self.aps = options, number, aps
        self.folder = options.out.with_name(options.out.name + ".rooms") / f"room{number}-{aps}"
        self.room = drawn_room(options.seed, number)
        self.ids = [f"ap{n + 1}" for n in range(aps)]
        self.calibration: Row = {}  # empty: not made yet
        self.day1: Phases = {}

    def call(self, *words: object, allowed: tuple[int, ...] = (0,)) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [str(self.options.rayloc), *map(str, words)], capture_output=True, text=True, check=False,
            env={**os.environ, "XDG_CACHE_HOME": str(self.folder / "cache")},
        )
        if done.returncode not in allowed:
            last = done.stderr.strip().splitlines()[-1:] or ["no message"]
            raise RuntimeError(f"rayloc {words[0]} ended with {done.returncode}: {last[0]}")
        return done

    def captures(self, name: str) -> list[str]:
        return [f"{ap}={self.folder / f'{name}-{ap}.pcap'}" for ap in self.ids]

    def simulate(self, points: Path, name: str, *words: object) -> Phases:
        """Simulates a recording of each access point. Returns the phases of its chains."""
        seed = 1000 * self.options.seed + self.number
        done = self.call("simulate", self.folder / "true", "--points", points, "--seed", seed, "--quiet", "--force",
                         "--out", *self.captures(name), *words)
        return {
            ap["id"]: {chain["core"]: chain["phase_deg"] for chain in ap["chains"]}
            for ap in json.loads(done.stdout)["access_points"]
        }

    def make_rooms(self) -> None:
        """The room as it is, in the folder `true`, and as it is stated, in `stated`."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        draw = random.Random(f"{self.options.seed} stated {self.number}")
        stated = self.room.stated(draw, FULL_ERRORS if self.options.full else 1.0)
        for name, room in (("true", self.room), ("stated", stated)):
            plan = self.folder / f"{name}.toml"
            plan.write_text(room.plan(self.aps))
            self.call("scene", "room", plan, "--out", self.folder / name, "--quiet")

    def make_survey(self) -> Path:
        """Simulates the survey. Returns its points."""
        planned, points = self.folder / "planned.csv", self.folder / "points.csv"
        self.call("calibrate", self.folder / "stated", "--plan", "--plan-points", self.options.points,
                  "--out", planned, "--quiet")
        with planned.open() as file, points.open("w") as out:
            out.write("t_start,t_end,x,y,z\n")
            for n, place in enumerate(csv.DictReader(file)):
                start = SURVEYED_AT + 5 * n
                out.write(f"{start},{start + 4},{place['x']},{place['y']},{place['z']}\n")
        self.day1 = self.simulate(points, "survey", "--frames", FRAMES_A_POINT, "--survey-error", SURVEY_ERROR_M)
        return points

    def calibrate(self) -> None:
        self.make_rooms()
        points = self.make_survey()
        status = self.call(
            "calibrate", self.folder / "stated", *([] if self.options.full else ["--gains-only"]), "--points", points,
            "--survey-error", SURVEY_ERROR_M, "--capture", *self.captures("survey"), "--out", self.folder / "site",
            "--quiet", "--force", allowed=(0, NO_SUCCESS),
        ).returncode
        report = json.loads((self.folder / "site/report.json").read_text())
        explained = {ap: round(held["after"], 3) for ap, held in report["heldout"].items()}
        self.calibration = {"status": status, "id": report["calibration_id"], "explained": explained}

    def remove(self) -> None:
        if not self.options.keep:
            shutil.rmtree(self.folder, ignore_errors=True)

    def unknown_chains(self) -> Path:
        """A chain file by which all chains are unknown, without evidence."""
        zeros = [0.0 for _ in CORES]
        states = [
            {"id": ap, "chains": "learning", "cores": CORES, "factor": [[1.0, 0.0] for _ in CORES],
             "phase_sigma_rad": zeros, "level_sigma": zeros, "since_ns": 0, "bursts": 0}
            for ap in self.ids
        ]
        file = self.folder / "unknown.json"
        file.write_text(json.dumps({"format": 1, "calibration": self.calibration["id"], "access_points": states}))
        return file

    def simulate_walk(self, number: int, truth: Path) -> Phases:
        """Simulates a walk on a day of its own. Returns the rotations of the chains since the survey."""
        points, day = self.folder / f"walk{number}.csv", self.folder / f"day{number}.toml"
        draw = random.Random(f"{self.options.seed} walk {self.number} {number}")
        with points.open("w") as file:
            file.write("t,x,y,z\n")
            for n, (x, y) in enumerate(walk(self.room, draw, self.options.walk, RATE_HZ)):
                file.write(f"{WALKED_AT + n / RATE_HZ:.3f},{x:.4f},{y:.4f},{DEVICE_HEIGHT_M}\n")
        day.write_text(f'base = "default"\nday = {2 + number}\n')
        day2 = self.simulate(points, f"walk{number}", "--second-day", day, "--truth", truth, *HANDLED)
        return {ap: {core: day2[ap][core] - self.day1[ap][core] for core in CORES} for ap in self.ids}

    def cycle(self, number: int) -> Row:
        """The figures of one power cycle."""
        if not self.calibration:
            self.calibrate()
        truth, fixes, chains = (
            self.folder / f"{name}{number}.{suffix}"
            for name, suffix in (("truth", "csv"), ("fixes", "jsonl"), ("chains", "json"))
        )
        rotated = self.simulate_walk(number, truth)
        known = [] if self.options.unnoticed else ["--chains", self.unknown_chains()]
        done = self.call(
            "replay", self.folder / "site", *self.captures(f"walk{number}"), "--method", "rayloc", "--kind", "device",
            "--height-sigma", HEIGHT_SIGMA_M, "--snapshots", "acquire", *known, "--chains-out", chains,
            "--out", fixes, "--threads", self.options.threads,
        )
        bursts = read_bursts(fixes, read_truth(truth))
        beliefs = read_beliefs(done.stderr, rotated, bursts)
        add_ends(beliefs, phases_at_end(chains, rotated))
        end = learning_ends(bursts, beliefs, self.ids)
        return {
            "beliefs": beliefs, "unlearned": bursts[-1]["learning"],
            "while_learning": located(bursts[:end]), "afterwards": located(bursts[end:]),
        }
