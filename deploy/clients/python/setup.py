"""pip's way to the package: adds to it the classes that protoc makes of proto/rayloc/v1."""

import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

PROTO = Path(__file__).resolve().parents[3] / "proto"


class BuildWithMessages(build_py):
    def run(self) -> None:
        super().run()
        files = sorted(str(file) for file in PROTO.glob("rayloc/v1/*.proto"))
        if not files:
            raise SystemExit(f"rayloc: no messages in {PROTO}; build in a checkout of rayloc")
        out = self.build_lib
        subprocess.run(
            ["protoc", "-I", PROTO, f"--python_out={out}", f"--pyi_out={out}", *files], check=True
        )


setup(cmdclass={"build_py": BuildWithMessages})
