"""The tests and programs built once with all changes in them, so that trying one costs no more than the test cases
that come by it.

A copy of the sources stands in a folder of its own; those that are measured are written as switched_source.py makes
them. What the compiler refuses so, and what is settled while it compiles, has no switch: workshop.py tries that.
"""
import ast
import collections
import concurrent.futures
import hashlib
import json
import os
import pathlib
import random
import re
import shlex
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "behaviour"))
import server_trials  # noqa: E402
from behaviour import all_trials, hash_of  # noqa: E402
from places import places_of  # noqa: E402
from refusals import Refusals  # noqa: E402
from switched_source import SwitchedSource  # noqa: E402
from workshop import fresh, judge, limit, tests_of, with_cases  # noqa: E402

ROOM = 1024  # for the numbers of one source
NUMBERS_MAX = 1 << 20  # kMost of changes.h
TRIALS_MAX = 400  # programs of tests/behaviour for one change
TRIALS_SECONDS = 15  # that they take as things are: sessions with a server take seconds each
FOLDERS = ("cmake", "clients", "deploy", "engine", "proto", "server", "storage")
REFUSALS_MAX = 40  # rounds; the last ones take out whole lines


class Reach:
    """Of each change the cases that come by it, the fastest first."""

    def __init__(self):
        self.cases = collections.defaultdict(list)

    def add(self, seconds, test, case, numbers):
        for number in numbers:
            self.cases[number].append((seconds, test.name, case))

    def of(self, number, names):
        return sorted(case for case in self.cases.get(number, ()) if case[1] in names)


class SwitchedTree:
    def __init__(self, root, folder, error_codes):
        self.root = pathlib.Path(root)
        self.folder = pathlib.Path(folder)
        self.tree = self.folder / "tree"
        self.build = self.folder / "build"
        self.compiles = {}
        self.error_codes = error_codes
        self.sources = sorted(str(path.relative_to(self.root)) for folder in FOLDERS
                              for path in (self.root / folder).rglob("*.cc"))
        assert (len(self.sources) + 1) * ROOM <= NUMBERS_MAX, "more sources than changes.h has numbers for"
        self.refusals = Refusals(pathlib.Path(__file__).with_name("refused.txt"))
        self.numbers = {}  # (file, begin, kind, after): number of a change with a switch
        self.tests = {}
        self.unfit = set()  # names of tests of which a case fails with switches, none of them awake
        self.reach = Reach()
        self.trials = collections.defaultdict(list)  # number of a change: programs that come by it
        self.anew = set()  # sources whose switches were asked for again
        self.lock = threading.Lock()

    def make(self, files, names, jobs):
        """Writes these sources with switches and builds these tests."""
        self.copy(set(files))
        shared = self.root.parent / "shared"
        subprocess.run(["cmake", "-S", str(self.tree), "-B", str(self.build), "-G", "Ninja", "-DBUILD_TESTING=ON",
                        "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG -w -D_GLIBCXX_ASSERTIONS",
                        "-DRMLCELL_TESTS_AS_RELEASED=ON", f"-DRMLCELL_SHARED_DIR={shared}"],
                       check=True, stdout=subprocess.DEVNULL)
        # The compiler is asked below what it takes, and reads the generated headers then.
        subprocess.run(["ninja", "-C", str(self.build), "rmlcell_proto"], check=True, stdout=subprocess.DEVNULL)
        with open(self.build / "compile_commands.json", encoding="utf-8") as file:
            self.compiles = {os.path.relpath(entry["file"], self.tree): entry for entry in json.load(file)}
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            list(pool.map(self.write, files))
        # Scripts drive the programs; the other tests are targets of their own.
        targets = [name for name in names if not name.startswith("integration_")]
        targets += ["rmlcell", "rmlcelld", "rmlcell-worker", "python_stubs"]
        while failed := self.failed(targets):
            # An answer of the compiler that holds no longer: a header changed.
            with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
                list(pool.map(lambda file: self.write(file, anew=True), failed & set(files)))
        self.refusals.keep()

    def failed(self, targets):
        """Builds them; the sources with switches that do not compile."""
        done = subprocess.run(["ninja", "-k", "0", "-C", str(self.build), *targets], capture_output=True, text=True, check=False)
        if done.returncode == 0:
            return set()
        objects = {entry["file"]: entry for entry in self.compiles.values()}
        failed = {os.path.relpath(file, self.tree) for file in objects
                  if re.search(rf"^FAILED: .*{re.escape(os.path.basename(file))}\.o", done.stdout, re.MULTILINE)}
        again = failed - self.anew
        if not again:
            raise SystemExit(f"the tests with switches cannot be built:\n{done.stdout[-4000:]}")
        self.anew |= again
        return again

    def learn_all(self, names, jobs):
        """Learns what each case of these tests comes by, and each trial of tests/behaviour."""
        self.tests = {test.name: test for test in tests_of(self.build, names)}
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            cases = [(test, case) for test in self.tests.values() for case in cases_of(test)]
            for found in pool.map(self.learn, *zip(*cases)):
                self.reach.add(*found)
            for learnt, numbers in pool.map(self.learn_trial, all_trials()):
                for number in numbers:
                    self.trials[number].append(learnt)

    def copy(self, files):
        (self.tree).mkdir(parents=True, exist_ok=True)
        here = [path for folder in FOLDERS for path in (self.root / folder).rglob("*") if path.is_file()]
        wanted = {path.relative_to(self.root) for path in here + list(self.root.glob("*.*")) if path.is_file()}
        for path in wanted:
            if str(path) not in files or not (self.tree / path).exists():
                put(self.tree / path, (self.root / path).read_bytes())
        for folder in FOLDERS:
            for path in list((self.tree / folder).rglob("*")):
                if path.is_file() and path.relative_to(self.tree) not in wanted:
                    path.unlink()
        for name in ("tests", "docs"):
            if not (self.tree / name).is_symlink():
                (self.tree / name).symlink_to(self.root / name)

    def write(self, file, anew=False):
        source = (self.root / file).read_text(encoding="utf-8")
        first = self.sources.index(file) * ROOM + 1
        every = {place: first + n for n, place in enumerate(places_of(self.root, file, self.error_codes))}
        assert len(every) < ROOM, file
        switched = self.accepted(file, source, every, first, anew)
        put(self.tree / file, self.head(switched.text).encode())
        with self.lock:
            for place, number in every.items():
                if number in switched.switched:
                    self.numbers[key(place)] = number
                else:
                    self.numbers.pop(key(place), None)

    @staticmethod
    def head(text):
        # Lines keep their numbers: messages and assertions name them. The name is for what stands outside rmlcell.
        return f'#include "tests/mutation/changes.h"\nnamespace changes = rmlcell::changes;\n#line 1\n{text}'

    def accepted(self, file, source, every, first, anew):
        """The source with those switches that the compiler takes."""
        switched = SwitchedSource(source, every)
        key_of_source = self.refusals.key(source, list(every))
        known = None if anew else self.refusals.get(key_of_source)
        if known is not None:
            return SwitchedSource(source, {p: n for p, n in every.items() if n - first not in known})
        kinds = {number: place.kind for place, number in every.items()}
        refused = set()
        for attempt in range(REFUSALS_MAX):
            errors = self.errors(file, switched.text)
            if not errors:
                with self.lock:
                    self.refusals.put(key_of_source, {n - first for n in refused})
                return switched
            found = blamed(switched, errors, 0 if attempt < REFUSALS_MAX / 2 else 1) - refused
            # Two arguments of two types cannot be exchanged, and their error blames what stands within them, too.
            found = {number for number in found if kinds[number] == "exchanged argument"} or found
            refused |= found or set(every.values())
            switched = SwitchedSource(source, {p: n for p, n in every.items() if n not in refused})
        return SwitchedSource(source, {})

    def errors(self, file, text):
        """(line, column) of what the compiler says against it."""
        place = self.folder / "try" / file
        put(place, self.head(text).encode())
        command = shlex.split(self.compiles[file]["command"])
        command = command[os.path.basename(command[0]) == "ccache":]
        del command[command.index("-o"):command.index("-o") + 2]
        command[command.index("-c") + 1] = str(place)
        command += ["-fsyntax-only", "-w", "-fmax-errors=0", "-ftemplate-backtrace-limit=0",
                    "-iquote", str((self.root / file).parent)]
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=self.folder)
        return places_of_errors(done.stderr, place.name) if done.returncode else set()

    def stamp(self, test):
        """Another one when what the test runs was built anew."""
        programs = [test.program] if test.program else []
        if test.drives_programs:
            programs += [f"bin/{path.name}" for path in sorted((self.build / "bin").glob("rmlcell*"))]
        stamps = [(self.build / program).stat().st_mtime_ns for program in programs]
        if not test.program:
            stamps.append(hash_of(pathlib.Path(test.command[-1]).read_bytes()))
        return stamps

    def learn(self, test, case):
        """How long a case takes and what it comes by; none of it where it fails as things are."""
        stamp = self.stamp(test)
        kept = self.folder / "reach" / test.name / f"{hashlib.sha256(case.encode()).hexdigest()[:24]}.json"
        row = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
        if row.get("stamp") != stamp:
            desk = fresh(self.folder / "desk" / str(threading.get_ident()))
            reached = desk / "reached"
            begin = time.monotonic()
            failed = judge(with_cases(test, [case]),
                           {**os.environ, **test.environment, "MUTATION_REACHED": str(reached)}, desk, 900)
            row = {"stamp": stamp, "case": case, "seconds": time.monotonic() - begin, "failed": failed,
                   "numbers": numbers_in(reached)}
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(row), encoding="utf-8")
        if row["failed"]:
            print(f"with switches {test.name} {case} fails: it is left to the slow way", flush=True)
            with self.lock:
                self.unfit.add(test.name)
        return row["seconds"], test, case, [] if row["failed"] else row["numbers"]

    def learn_trial(self, trial):
        """(the trial, how long it takes, the hash of what it says), and what it comes by."""
        with_server = trial.name.startswith("server/")
        programs = ["rmlcell", "rmlcelld", "rmlcell-worker"] if with_server else ["rmlcell"]
        stamp = [(self.build / "bin" / name).stat().st_mtime_ns for name in programs]
        stamp += [hash_of(pathlib.Path(server_trials.__file__).read_bytes())] if with_server else []
        asked = hash_of(repr(trial).encode())
        kept = self.folder / "reach" / "behaviour" / f"{trial.name.replace('/', '_').replace(' ', '_')}.json"
        row = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
        if row.get("stamp") != stamp or row.get("asked") != asked:
            reached = fresh(self.folder / "desk" / str(threading.get_ident())) / "reached"
            begin = time.monotonic()
            said = trial.said(self.command(), {**os.environ, "MUTATION_REACHED": str(reached)})
            row = {"stamp": stamp, "asked": asked, "seconds": time.monotonic() - begin, "hash": hash_of(said),
                   "numbers": numbers_in(reached)}
            kept.parent.mkdir(parents=True, exist_ok=True)
            kept.write_text(json.dumps(row), encoding="utf-8")
        return (trial, row["seconds"], row["hash"]), row["numbers"]

    def command(self):
        return self.build / "bin" / "rmlcell"

    def tried_in(self, place, names):
        """Whether some case comes by the switch of this place while it runs. What is worked out by the compiler, such as
        a table, is no switch however it was written."""
        number = self.numbers.get(key(place))
        return number is not None and bool(self.reach.of(number, names))

    def behaves_otherwise(self, place):
        """The name of a program of tests/behaviour that shows the change; "" where none of those tried does."""
        number = self.numbers.get(key(place))
        trials = list(self.trials.get(number, ())) if number else []
        random.Random(number).shuffle(trials)
        left = TRIALS_SECONDS
        for trial, seconds, expected in trials[:TRIALS_MAX]:
            left -= seconds
            if left < 0:
                break
            allowed = 5 + 20 * int(1 + seconds)
            try:
                said = trial.said(self.command(), {**os.environ, "MUTATION_CHANGE": str(number)}, 5 * allowed, limit(allowed))
            except subprocess.TimeoutExpired:
                return trial.name
            if hash_of(said) != expected and hash_of(trial.said(self.command(), {**os.environ})) == expected:
                return trial.name
        return ""

    def noticed(self, place, names):
        """What tells that a case fails with the change; "" where none does or the change has no switch."""
        number = self.numbers.get(key(place))
        cases = self.reach.of(number, names) if number else []
        begin, size = 0, 12
        while begin < len(cases):
            # A few of the fastest first: most changes need no more.
            by_test = collections.defaultdict(list)
            for seconds, name, case in cases[begin:begin + size]:
                by_test[name].append((seconds, case))
            for name, some in by_test.items():
                # Twice: a case that fails now and then by itself has noticed nothing.
                failed = self.run(self.tests[name], some, number) and self.run(self.tests[name], some, number)
                if failed:
                    return f"{name}: {failed}"
            begin, size = begin + size, 4 * size
        return ""

    def run(self, test, cases, number):
        desk = fresh(self.folder / "desk" / str(threading.get_ident()))
        command = with_cases(test, [case for _, case in cases])
        environment = {**os.environ, **test.environment, "MUTATION_CHANGE": str(number)}
        return judge(command, environment, desk, 2 + int(6 * sum(seconds for seconds, _ in cases)))


def key(place):
    return place.file, place.begin, place.kind, place.after


def put(path, content):
    if not path.exists() or path.read_bytes() != content:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def numbers_in(reached):
    return [match.start() for match in re.finditer(rb"[^\0]", reached.read_bytes())] if reached.exists() else []


def cases_of(test):
    if not test.program:
        for suite in ast.parse(pathlib.Path(test.command[-1]).read_text(encoding="utf-8")).body:
            for part in suite.body if isinstance(suite, ast.ClassDef) else ():
                if isinstance(part, ast.FunctionDef) and part.name.startswith("test"):
                    yield f"{suite.name}.{part.name}"
        return
    listed = subprocess.run([*test.command, "--gtest_list_tests"], capture_output=True, text=True, check=True,
                            env={**os.environ, **test.environment}).stdout
    suite = ""
    for line in listed.splitlines():
        name = line.split("#")[0].strip()
        if not line.startswith(" "):
            suite = name
        elif not name.startswith("DISABLED_") and not suite.startswith("DISABLED_"):
            yield suite + name


def places_of_errors(text, name):
    """Where the compiler saw each error in this file; of one in a template where the file asked for it."""
    found, asked = set(), set()
    for line in text.splitlines():
        match = re.match(r"(\S+?):(\d+):(\d+): +(error|required from)", line)
        if not match:
            continue
        place = int(match[2]), int(match[3])
        inside = os.path.basename(match[1]) == name
        if match[4] == "required from":
            asked = {place} if inside else asked
        else:
            found |= {place} if inside else asked
            asked = set()
    return found


def blamed(switched, errors, lines_around):
    """The numbers of what was put where the compiler stumbled."""
    starts = [0, *(match.end() for match in re.finditer("\n", switched.text)), len(switched.text)]
    found = set()
    for line, column in errors:
        begin, end = starts[max(0, line - 1 - lines_around)], starts[min(line + lines_around, len(starts) - 1)]
        marks = [mark for mark in switched.marks if begin <= mark[0] < end]
        at = starts[line - 1] + column - 1
        inside = [mark for mark in marks if mark[0] <= at < mark[1]]
        before = [mark for mark in marks if mark[0] <= at][-1:]
        found |= {number for _, _, number in (marks if lines_around else inside or before or marks)}
    return found
