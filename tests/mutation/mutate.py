#!/usr/bin/env python3
"""Changes the meaning of the code in one place, runs the tests of that part, and counts what they notice.

    mutate.py [--seed N] [--count 300] [--area NAME ...]   as many changes, the areas in turn
    mutate.py --area NAME --file PATH                      every change of these sources, whatever the count
    mutate.py --kind "error code"                          these kinds only
    mutate.py --again                                      the survivors of that seed once more
    mutate.py --report                                     what is known of that seed, running nothing

Which changes are made follows from the seed and the sources. Each result is kept at once in
build/mutation/results/, and a run that was broken off goes on where it was. Ends with 1 when an area
notices less than 95 of 100.
"""
import argparse
import collections
import concurrent.futures
import csv
import hashlib
import json
import math
import os
import pathlib
import random
import re
import sys
import threading

sys.path.insert(0, str(pathlib.Path(__file__).parent))
from areas import AREAS  # noqa: E402
from places import KINDS, places_of  # noqa: E402
from switched_tree import SwitchedTree  # noqa: E402
from workshop import Workshop, fresh  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "mutation"
GOAL = 0.95
ARGUED_MAX = 0.10  # of the changes of an area, those that are listed as equivalent by an argument
BEHAVIOUR = "behaviour: "  # the hashes of tests/behaviour noticed it, and no test that says what is right
COUNTED = ("noticed", "survived")


class Arguments:
    """The changes that change nothing, with the reason, as the tables of equivalent/ list them. Where other lines of
    the source read the same, one of the three lines before it says which one is meant, or EACH that all of them are."""
    EACH = "(each)"

    def __init__(self):
        self.rows = {}
        self.lines = {}
        for table in sorted((pathlib.Path(__file__).parent / "equivalent").glob("*.csv")):
            with open(table, encoding="utf-8", newline="") as file:
                for row in csv.DictReader(file):
                    self.rows[row["file"], row["line"], row["change"], row["behind"] or ""] = row["why"]

    def of(self, file, text, change, line):
        """Why this change at this line changes nothing; None where nobody says so."""
        return self.rows.get(self.row_of(file, text, change, line))

    def row_of(self, file, text, change, line):
        """The row that means it."""
        if file not in self.lines:
            self.lines[file] = (ROOT / file).read_text(encoding="utf-8").split("\n")
        before = [other.strip() for other in reversed(self.lines[file][max(line - 4, 0):line - 1])]
        found = ((file, text, change, behind) for behind in ["", self.EACH, *before])
        return next((row for row in found if row in self.rows), None)


def error_codes():
    rows = (ROOT / "engine/core/catalogue.def").read_text(encoding="utf-8")
    return sorted("k" + symbol for symbol in re.findall(r"^RMLCELL_ERROR\(\w+, \d+, (\w+),", rows, re.MULTILINE))


def change_of(place):
    return f"{place.before} => {place.after}"


def sources_of(area):
    """Without the programs that only the build runs: what they make stands, whatever is changed in them."""
    return [str(path.relative_to(ROOT)) for folder in AREAS[area].folders for path in sorted((ROOT / folder).glob("*.cc"))
            if not path.name.endswith("_maker.cc")]


def sequence(area, seed, codes, files, kinds):
    """The places of an area in the order in which this seed takes them: first a kind, then a place of it."""
    by_kind = collections.defaultdict(list)
    for name in sources_of(area):
        for place in places_of(ROOT, name, codes) if not files or name in files else ():
            if not kinds or place.kind in kinds:
                by_kind[place.kind].append(place)
    dice = random.Random(f"{seed} {area}")
    while any(by_kind.values()):
        places = by_kind[dice.choice([kind for kind in KINDS if by_kind[kind]])]
        yield places.pop(dice.randrange(len(places)))


class Ledger:
    """Results of one seed, one line each, written at once. A result holds for the text that its file had."""

    def __init__(self, path):
        self.path = path
        self.rows = {}
        self.lock = threading.Lock()
        if path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                row = json.loads(line)
                self.rows[self.key(row)] = row

    @staticmethod
    def key(row):
        return row["area"], row["file"], row["begin"], row["kind"], row["change"], row["source"]

    def get(self, row):
        return self.rows.get(self.key(row))

    def add(self, row):
        with self.lock, open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps(row) + "\n")
            self.rows[self.key(row)] = row


def row_of(area, place):
    source = (ROOT / place.file).read_bytes()
    return {"area": area, "file": place.file, "begin": place.begin, "line": place.line, "kind": place.kind,
            "change": change_of(place), "text": place.text, "source": hashlib.sha256(source).hexdigest()[:16]}


class Measurement:
    def __init__(self, options):
        self.options = options
        results = BUILD / "results"
        results.mkdir(parents=True, exist_ok=True)
        self.ledger = Ledger(results / f"{options.seed}.jsonl")
        self.arguments = Arguments()
        self.codes = error_codes()
        self.workshop = None
        self.switches = None
        self.tests = {}
        self.originals = {}
        self.free = list(range(options.jobs))
        self.lock = threading.Lock()

    def prepare(self, areas):
        wanted = sorted({name for area in areas for name in AREAS[area].tests})
        self.switches = SwitchedTree(ROOT, BUILD / "switched", self.codes)
        # All sources, whichever are asked for: another choice builds nothing anew.
        self.switches.make([name for area in AREAS for name in sources_of(area)], wanted, self.options.jobs)
        self.workshop = Workshop(self.switches.tree, self.switches.build)
        good = self.workshop.measure(self.workshop.tests(wanted), fresh(BUILD / "try" / "as-it-is"),
                                     BUILD / "results" / "times.json")
        tests = {test.name: test for test in good}
        self.tests = {area: [tests[name] for name in AREAS[area].tests if name in tests] for area in areas}
        self.switches.learn_all(wanted, self.options.jobs)

    def original(self, file, flags):
        """The object of the source as it is, to compare with."""
        with self.lock:
            known = self.originals.get((file, flags))
        if known is None:
            place = fresh(BUILD / "try" / f"original-{threading.get_ident()}")
            made = self.workshop.compile(file, (ROOT / file).read_text(encoding="utf-8"), place, flags)
            known = made.read_bytes() if made else b""
            with self.lock:
                self.originals[file, flags] = known
        return known

    def judge(self, area, place):
        """The row of one change, tried if it was not."""
        row = row_of(area, place)
        known = self.ledger.get(row)
        if known and not (self.options.again and known["outcome"] == "survived"):
            return known
        with self.lock:
            desk = self.free.pop()
        try:
            row["outcome"], row["by"] = self.attempt(area, place, fresh(BUILD / "try" / str(desk)))
        finally:
            with self.lock:
                self.free.append(desk)
        self.ledger.add(row)
        print(f"{row['outcome']:9} {area:10} {place.file}:{place.line} {place.kind}: {row['change']!r:.80} {row['by']}",
              flush=True)
        return row

    def attempt(self, area, place, desk):
        noticed = self.switches.noticed(place, AREAS[area].tests)
        if noticed:
            return "noticed", noticed
        shown = self.switches.behaves_otherwise(place)
        if shown:
            return "noticed", f"{BEHAVIOUR}{shown}"
        changed_source = place.applied((ROOT / place.file).read_text(encoding="utf-8"))
        changed = self.workshop.compile(place.file, changed_source, desk)
        if changed is None:
            return "invalid", "no C++"
        if changed.read_bytes() == self.original(place.file, ()):
            return "identical", "object code"
        tried = self.switches.tried_in(place, AREAS[area].tests)
        for test in self.tests[area]:
            if tried and test.name not in self.switches.unfit:
                continue  # its cases were tried
            # Twice: a test that fails now and then by itself has noticed nothing.
            failed = (self.workshop.run(test, desk, place.file, changed) and
                      self.workshop.run(test, desk, place.file, changed))
            if failed:
                return "noticed", f"{test.name}: {failed}"
        # A sharper look at what nobody noticed.
        optimised = self.workshop.compile(place.file, changed_source, fresh(desk / "optimised"), ("-O2",))
        if optimised.read_bytes() == self.original(place.file, ("-O2",)):
            return "identical", "object code at -O2"
        return "survived", ""

    def measure(self, areas):
        self.prepare(areas)
        share = math.inf if self.options.file else math.ceil(self.options.count / len(areas))
        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            for area in areas:
                self.measure_area(area, share, pool)

    def measure_area(self, area, share, pool):
        """The first `share` changes that are C++ and change the code, whatever the order they end in."""
        places = sequence(area, self.options.seed, self.codes, self.options.file, self.options.kind)
        counted, waiting = 0, set()
        while counted < share:
            while counted + len(waiting) < share and len(waiting) < 2 * self.options.jobs:
                place = next(places, None)
                if place is None:
                    break
                waiting.add(pool.submit(self.judge, area, place))
            if not waiting:
                return
            done, waiting = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
            counted += sum(future.result()["outcome"] in COUNTED for future in done)

    def report(self, areas):
        """The figures by area as text, and whether each reaches the goal."""
        lines = [f"{'area':10} {'changes':>7} {'noticed':>7} {'argued':>7} {'hashes':>7} {'left':>5} {'share':>7}   "
                 "same object code, left out"]
        left, good = [], True
        for area in areas:
            rows = [row for row in self.current(area) if row["outcome"] != "invalid"]
            by_hash = [row for row in rows if row["by"].startswith(BEHAVIOUR)]
            noticed = sum(row["outcome"] == "noticed" for row in rows) - len(by_hash)
            survived = [row for row in rows if row["outcome"] == "survived"]
            argued = [row for row in survived
                      if self.arguments.of(row["file"], row["text"], row["change"], row["line"])]
            identical = sum(row["outcome"] == "identical" for row in rows)
            meant = noticed + len(by_hash) + len(survived) - len(argued)
            share = noticed / meant if meant else 0.0  # nothing tried shows nothing
            tried = meant + len(argued)
            good = good and share >= GOAL and len(argued) <= ARGUED_MAX * max(1, tried)
            lines.append(f"{area:10} {tried:7} {noticed:7} {len(argued):7} {len(by_hash):7} "
                         f"{len(survived) - len(argued):5} {100 * share:6.1f}%   {identical}")
            left += by_hash + [row for row in survived if row not in argued]
        lines += ["", "hashes: seen by the hashes of tests/behaviour alone, and not counted as noticed."]
        if left:
            lines += ["", "Left unnoticed:"]
            lines += [f"  {row['file']}:{row['line']} {row['kind']}: {row['change']}"
                      f"{' (hashes)' if row['by'] else ''}\n      {row['text']}" for row in left]
        return "\n".join(lines), good

    def current(self, area):
        """Rows of the area whose files are as they were."""
        known = {}
        for row in self.ledger.rows.values():
            if row["area"] == area:
                path = ROOT / row["file"]
                if row["file"] not in known:
                    known[row["file"]] = hashlib.sha256(path.read_bytes()).hexdigest()[:16] if path.exists() else ""
                if row["source"] == known[row["file"]]:
                    yield row


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", default="1")
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--area", action="append", choices=AREAS)
    parser.add_argument("--file", action="append")
    parser.add_argument("--kind", action="append", choices=KINDS)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--report", action="store_true")
    parser.add_argument("--results", help="write the report into this file, too")
    options = parser.parse_args()
    areas = options.area or list(AREAS)
    measurement = Measurement(options)
    if not options.report:
        measurement.measure(areas)
    text, good = measurement.report(areas)
    print(text)
    if options.results:
        pathlib.Path(options.results).write_text(f"Seed {options.seed}\n\n{text}\n", encoding="utf-8")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
