"""Time limit of a whole run, and processes that end with it."""
import os
import signal
import subprocess
import time


class Budget:
    def __init__(self, seconds: float):
        self._end = time.monotonic() + seconds

    def left(self) -> float:
        return self._end - time.monotonic()

    def spent(self) -> bool:
        return self.left() <= 0


def run(command, budget, log, environment=None, each_line=None):
    """Runs a command with its output in the file `log`; returns its exit status, None once the budget is spent.

    The command leads a process group of its own, which is killed as a whole: a test that hangs leaves
    no process behind. `each_line` receives every line of the output as it is written.
    """
    with open(log, "ab") as out:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT,
                                   env=environment, start_new_session=True)
    with open(log, encoding="utf-8", errors="replace") as lines:
        try:
            while True:
                status = process.poll()
                for line in lines:
                    if each_line is not None:
                        each_line(line)
                if status is not None:
                    return status
                if budget.spent():
                    return None
                try:
                    process.wait(timeout=min(0.5, max(0.05, budget.left())))
                except subprocess.TimeoutExpired:
                    pass
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGTERM)
                try:
                    process.wait(timeout=5)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
