"""The repetition of failed real-time tests, and the tests whose failure does not decide."""
import datetime
import re

MAX_REPEATED = 3
QUARANTINE_DAYS = 14
MAX_QUARANTINED = 5

# Reports of the sanitizers, of a process that a signal ended, and of a broken law of accounting. None of these is
# a matter of timing, so none is repeated.
DEFECT = re.compile(
    r"(ERROR: (Address|Leak)Sanitizer|WARNING: ThreadSanitizer|runtime error: |SUMMARY: \w*Sanitizer"
    r"|\bunaccounted\b|\bended by signal \d|^ctest: (SEGFAULT|ILLEGAL|NUMERICAL|Subprocess|Not Run|.*[Ee]xception))", re.MULTILINE)
SEED = re.compile(r"seed[ =:]+(\d+)", re.IGNORECASE)


class QuarantineError(Exception):
    pass


def read_quarantine(path, today=None):
    """Reads lines `TEST | reason | YYYY-MM-DD`; returns {test: reason}.

    Raises QuarantineError with file and line for a line that is malformed, more than 14 days old or one too many.
    """
    today = today or datetime.date.today()
    tests = {}
    with open(path, encoding="utf-8") as lines:
        for number, line in enumerate(lines, 1):
            if not line.strip() or line.startswith("#"):
                continue
            fields = [field.strip() for field in line.split("|")]
            place = f"{path}:{number}"
            if len(fields) != 3 or not all(fields):
                raise QuarantineError(f"{place}: expected 'TEST | reason | YYYY-MM-DD'")
            try:
                date = datetime.date.fromisoformat(fields[2])
            except ValueError:
                raise QuarantineError(f"{place}: '{fields[2]}' is no date YYYY-MM-DD") from None
            if not 0 <= (today - date).days <= QUARANTINE_DAYS:
                raise QuarantineError(f"{place}: {fields[0]} has been here since {date}; mend or delete the test "
                                      f"(at most {QUARANTINE_DAYS} days)")
            tests[fields[0]] = fields[1]
            if len(tests) > MAX_QUARANTINED:
                raise QuarantineError(f"{place}: at most {MAX_QUARANTINED} tests may be in quarantine")
    return tests


def may_repeat(failures):
    """True where one repetition of these failed tests may decide: few, in real time, and no defect in their output."""
    return (0 < len(failures) <= MAX_REPEATED
            and all("realtime" in each.labels and not DEFECT.search(each.output) for each in failures))


def seed_of(output):
    match = SEED.search(output)
    return match.group(1) if match else "-"
