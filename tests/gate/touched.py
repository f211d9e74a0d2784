"""The part of the tree that a change touches."""
import pathlib
import subprocess


def git(root, *arguments):
    done = subprocess.run(["git", "-C", str(root), *arguments], capture_output=True, text=True)
    return done.stdout.split() if done.returncode == 0 else []


def base(root):
    """The commit at which the branch left origin/main; None where there is no such branch."""
    at = git(root, "merge-base", "HEAD", "origin/main")
    return at[0] if at else None


def files(root):
    """The files that differ from origin/main, or from HEAD where there is no origin."""
    return (git(root, "diff", "--name-only", base(root) or "HEAD")
            + git(root, "ls-files", "--others", "--exclude-standard"))


def rooms(names):
    """Returns the labels of the tests of the rooms that hold these files; None where any test may be touched."""
    labels = set()
    for name in names:
        parts = pathlib.PurePath(name).parts
        if parts[0] == "tests":
            parts = parts[1:]
        if len(parts) > 1 and parts[0] in ("engine", "capture", "clients", "python", "cluster"):
            labels.add(parts[0])
        elif len(parts) > 2 and parts[0] == "daemon":
            # A wing and its room; every wing uses daemon/base.
            labels.add("daemon" if parts[1] == "base" else "/".join(parts[:-1][:3]))
        elif name.endswith(".md"):
            continue
        else:
            return None
    return labels


def filters(root):
    """The ctest options for what the change touches; none where that is everything or nothing. The tests of a room
    without a folder of its own are in other rooms of its wing."""
    labels = {selector(root, label) for label in rooms(files(root)) or ()}
    return ["-L", "^(" + "|".join(sorted(labels)) + ")$"] if labels else []


def selector(root, label):
    """The expression for the labels of a room's tests; those of the nearest folder around it where it has none."""
    while label and not (root / "tests" / label).is_dir():
        label = label.rpartition("/")[0]
    return f"{label}(/.*)?"


def for_tidy(root, most):
    """The arguments of tests/lint/tidy: what changed in the branch, on main itself the latest sources."""
    at = base(root)
    if at and git(root, "rev-parse", "HEAD") != [at]:
        return "since", at, str(most)
    return "latest", str(most)
