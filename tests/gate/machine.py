"""Measures the machine, so that deadlines of tests scale with it."""
import os
import time

# Seconds that the loop of measure() takes on the machine on which the deadlines were chosen, idle (two cores of an AMD
# EPYC, 2026-11: 0.09; beside compilations on both cores 0.21).
REFERENCE_SECONDS = 0.1
LOOP_STEPS = 4_000_000
# A deadline scales by powers of two, so that a small change of speed does not reconfigure the build.
MAX_PATIENCE = 8


def measure() -> float:
    """Returns the seconds of a fixed loop on one core, under the load that is there now."""
    begin = time.monotonic()
    total = 0
    for step in range(LOOP_STEPS):
        total += step
    return time.monotonic() - begin


def patience(loop_seconds: float) -> int:
    """Returns the factor of every deadline: 1 on the reference machine, larger on a slower one."""
    factor = 1
    while factor < MAX_PATIENCE and loop_seconds > 1.5 * factor * REFERENCE_SECONDS:
        factor *= 2
    return factor


def describe(loop_seconds: float) -> str:
    with open("/proc/cpuinfo", encoding="utf-8") as info:
        model = next((line.split(":", 1)[1].strip() for line in info if line.startswith("model name")),
                     "unknown processor")
    load = os.getloadavg()[0]
    return (f"{model}, {os.cpu_count()} cores, load {load:.1f}, "
            f"loop {loop_seconds:.2f} s (reference {REFERENCE_SECONDS} s), "
            f"patience {patience(loop_seconds)}")
