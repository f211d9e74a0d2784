"""Which Debian package has a Python package that is missing."""

from __future__ import annotations

PACKAGES = {
    "zmq": "python3-zmq",
    "google": "python3-protobuf",
    "paho": "python3-paho-mqtt",
    "numpy": "python3-numpy",
    "torch": "python3-torch",
}


def explained(error: ModuleNotFoundError) -> ModuleNotFoundError:
    """The same error with what to do about it; one of a package that we do not need as it is."""
    name = error.name or ""
    if name.startswith("rayloc.v1"):
        what = "a build makes it from proto/: use PYTHONPATH=BUILD/python, or install python3-rayloc"
    elif name == "rayloc._engine":
        what = (
            "the engine is a native module, which pip does not make: install python3-rayloc, or use "
            "PYTHONPATH=BUILD/python of a build, each with /usr/bin/python3"
        )
    elif name.split(".")[0] in PACKAGES:
        package = PACKAGES[name.split(".")[0]]
        what = (
            f"install Debian's {package} (apt-get install {package}) and use /usr/bin/python3, "
            "which finds it; deploy/clients/README.md states how with pip"
        )
    else:
        return error
    return ModuleNotFoundError(f"Python package {name} is missing: {what}", name=error.name)
