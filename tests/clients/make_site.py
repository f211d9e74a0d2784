"""Makes the site that the tests locate in: the bundled one with the gains of one access point
calibrated, and with a georeference, which it does not state.    make_site.py OUT"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

SITE = Path(__file__).resolve().parents[2] / "tests/data/sites/meeting_room"


def make_site(out: Path) -> None:
    shutil.rmtree(out, ignore_errors=True)
    rayloc = os.environ["RAYLOC_BIN"] + "/rayloc"
    recording = ["--capture", f"ap2={SITE}/calibration-ap2.pcap.gz"]
    points = ["--points", f"{SITE}/calibration.csv", "--out", str(out)]
    calibrate = [rayloc, "calibrate", str(SITE), "--gains-only", "--quiet"]
    subprocess.run([*calibrate, *recording, *points], check=True)
    with (out / "site.toml").open("a") as toml:
        toml.write("\n[georeference]\nlatitude = 49.87\nlongitude = 8.65\naltitude_m = 144.0\n")


if __name__ == "__main__":
    make_site(Path(sys.argv[1]))
