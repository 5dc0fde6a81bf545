#!/usr/bin/env python3
"""Compares what two builds do: with programs, with the tools, in the editor, and as a server. README.md has the list.

    behaviour.py keep BIN FOLDER          runs them all with BIN/rmlcell and keeps what it says, a file a program
    behaviour.py hash FOLDER              a line of name and hash for each of them, on standard output
    behaviour.py compare A B [--within X] says where two folders differ; numbers may differ by X, relative or absolute
    behaviour.py check BIN HASHES         runs them all and compares with the hashes of a file

What is kept is all that they say, exit status and files included. Ends with 1 when something differs.
"""
import argparse
import concurrent.futures
import gzip
import hashlib
import os
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from programs import all_programs  # noqa: E402
from server_trials import all_server_trials  # noqa: E402
from tool_trials import all_tool_trials  # noqa: E402
from trials import ROOT  # noqa: E402

SHARED = pathlib.Path(os.environ.get("RMLCELL_SHARED", ROOT.parent / "shared"))
NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def each(command, take):
    """Calls take(name, bytes) for all that is tried, in its order."""
    trials = all_trials()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for trial, said in zip(trials, pool.map(lambda one: one.said(command), trials)):
            take(trial.name, said)


def all_trials():
    shared = SHARED if SHARED.exists() else None
    return [*(program.trial() for program in all_programs(shared)), *all_tool_trials(), *all_server_trials()]


def path_of(folder, name):
    return folder / (re.sub(r"[^\w.-]", "_", name) + ".gz")


def keep(command, folder):
    folder.mkdir(parents=True, exist_ok=True)

    def take(name, said):
        path_of(folder, name).write_bytes(gzip.compress(said, mtime=0))
    each(command, take)


def hash_of(said):
    return hashlib.sha256(said).hexdigest()[:24]


def numbers_agree(one, other, within):
    if one == other:
        return True
    a, b = float(one), float(other)
    return abs(a - b) <= within * max(1.0, abs(a), abs(b))


def lines_agree(one, other, within):
    if one == other:
        return True
    if within == 0.0 or NUMBER.sub(b"#", one) != NUMBER.sub(b"#", other):
        return False
    return all(numbers_agree(a, b, within) for a, b in zip(NUMBER.findall(one), NUMBER.findall(other)))


def compare(a, b, within):
    different = 0
    for path in sorted(set(p.name for p in a.iterdir()) | set(p.name for p in b.iterdir())):
        if not (a / path).exists() or not (b / path).exists():
            print(f"{path}: only in one")
            different += 1
            continue
        one, other = ((folder / path).read_bytes() for folder in (a, b))
        if one == other:
            continue
        one, other = (gzip.decompress(text).splitlines() for text in (one, other))
        first = next((n for n, pair in enumerate(zip(one, other)) if not lines_agree(*pair, within)), None)
        if first is None and len(one) == len(other):
            continue
        different += 1
        first = min(len(one), len(other)) if first is None else first
        print(f"{path}: line {first + 1}")
        for side, lines in (("-", one), ("+", other)):
            print(f"  {side} {lines[first][:200].decode(errors='replace') if first < len(lines) else '(ends)'}")
    return different


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name, words in (("keep", ("bin", "folder")), ("hash", ("folder",)), ("compare", ("a", "b")), ("check", ("bin", "hashes"))):
        made = commands.add_parser(name)
        for word in words:
            made.add_argument(word, type=pathlib.Path)
        if name == "compare":
            made.add_argument("--within", type=float, default=0.0)
    options = parser.parse_args()
    if options.command == "keep":
        keep(options.bin.resolve() / "rmlcell", options.folder)
        return 0
    if options.command == "hash":
        for path in sorted(options.folder.iterdir()):
            print(f"{hash_of(gzip.decompress(path.read_bytes()))} {path.name.removesuffix('.gz')}")
        return 0
    if options.command == "compare":
        different = compare(options.a, options.b, options.within)
        print(f"{different} differ")
        return 1 if different else 0
    known = dict(reversed(line.split(" ", 1)) for line in options.hashes.read_text(encoding="utf-8").splitlines())
    found = {}
    each(options.bin.resolve() / "rmlcell", lambda name, said: found.update({path_of(pathlib.Path(), name).name.removesuffix(".gz"): hash_of(said)}))
    if not SHARED.exists():  # the corpora are elsewhere
        known = {name: value for name, value in known.items() if name in found}
    wrong = [name for name in sorted(known | found) if known.get(name) != found.get(name)]
    for name in wrong:
        print(name)
    print(f"{len(wrong)} of {len(known | found)} differ")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
