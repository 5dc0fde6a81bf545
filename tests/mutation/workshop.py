"""Builds one changed source and tries the tests on it, beside a build that stays as it is.

The changed source becomes an archive of its own that stands before the library it belongs to when a program is
linked, so that nothing of the build is written over and several changes can be tried at a time. The build
compiles each source by itself (switched_tree.py): where several are compiled together, the compiler may have put the
old code into a neighbour.
"""
import json
import math
import os
import pathlib
import re
import resource
import shlex
import shutil
import subprocess

MEMORY_BYTES_MAX = 6 << 30
QUIET_S = 60


class Test:
    """One entry of CTest."""

    def __init__(self, name, command, environment, build):
        self.name = name
        self.environment = environment
        self.cpu_s = 0.0
        program = os.path.relpath(command[0], build)
        self.program = None if program.startswith("..") else program  # None: a script
        self.drives_programs = "RMLCELL_BIN" in environment
        self.command = command


class Workshop:
    def __init__(self, root, build):
        self.root = pathlib.Path(root)
        self.build = pathlib.Path(build)
        with open(self.build / "compile_commands.json", encoding="utf-8") as file:
            # Of the objects of one source the one in a library is what most tests link.
            entries = sorted(json.load(file), key=lambda entry: self.archive_of(entry) is not None)
        self.compiles = {os.path.relpath(entry["file"], self.root): entry for entry in entries}
        self.links = {}

    def tests(self, names):
        return tests_of(self.build, names)

    def link(self, output):
        """The command that makes `output`, a path below the build."""
        if output not in self.links:
            lines = subprocess.run(["ninja", "-C", str(self.build), "-t", "commands", "-s", output], check=True,
                                   capture_output=True, text=True).stdout.splitlines()
            command = [line for line in lines if f"-o {output} " in line][-1]
            self.links[output] = re.sub(r"^: && | && :$", "", command)
        return self.links[output]

    def programs(self):
        return sorted(f"bin/{path.name}" for path in (self.build / "bin").iterdir()
                      if path.name.startswith("rmlcell") and os.access(path, os.X_OK))

    def object_of(self, file):
        return object_made_by(self.compiles[file])

    def library_of(self, file):
        """The archive that holds the object, or None where it is linked by itself."""
        return self.archive_of(self.compiles[file])

    def archive_of(self, entry):
        folder, _, rest = object_made_by(entry).partition("/CMakeFiles/")
        archive = f"{folder}/lib{rest.split('.dir/')[0]}.a"
        return archive if (self.build / archive).exists() else None

    def compile(self, file, source, to, flags=()):
        """The object of `source` as if it stood in `file`; None where it is no C++."""
        changed = to / pathlib.Path(file).name
        changed.write_text(source, encoding="utf-8")
        command = shlex.split(self.compiles[file]["command"])
        if os.path.basename(command[0]) == "ccache":
            command = command[1:]
        made = to / "changed.o"
        command[command.index("-o") + 1] = str(made)
        command[command.index("-c") + 1] = str(changed)
        # Warnings are no matter here, and messages carry the file's own name. The libraries' own checks
        # see an index past an end, as they do in the builds with sanitizers.
        command += ["-w", "-D_GLIBCXX_ASSERTIONS", "-Deigen_assert(holds)=((holds)?void():__builtin_trap())",
                    f"-ffile-prefix-map={changed}={self.root / file}",
                    "-iquote", str((self.root / file).parent), *flags]
        done = subprocess.run(command, cwd=self.build, capture_output=True, text=True, check=False)
        return made if done.returncode == 0 else None

    def relink(self, output, file, changed, to):
        """`output` with the changed object, or None where it does not hold that source."""
        command = self.link(output)
        archive, original = self.library_of(file), self.object_of(file)
        if archive is None:
            if not re.search(rf"(^| ){re.escape(original)}( |$)", command):
                return None
            command = command.replace(f" {original} ", f" {changed} ")
        else:
            if f" {archive}" not in command:
                return None
            own = to / "changed.a"
            if not own.exists():
                subprocess.run(["ar", "rcs", str(own), str(changed)], check=True)
            command = command.replace(f" {archive}", f" {own} {archive}")
        made = to / output
        made.parent.mkdir(parents=True, exist_ok=True)
        command = command.replace(f"-o {output} ", f"-o {made} ")
        done = subprocess.run(command, cwd=self.build, shell=True, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise RuntimeError(f"{output} cannot be linked: {done.stderr[-2000:]}")
        return made

    def run(self, test, place, file=None, changed=None):
        """What tells that the test fails, "" where it passes, None where it does not concern the file."""
        command, environment = with_cases(test), {**os.environ, **test.environment}
        if changed:
            made = self.relink(test.program, file, changed, place) if test.program else None
            if made:
                command[0] = str(made)
            elif not test.drives_programs:
                return None
            if test.drives_programs:
                if not self.relink_programs(file, changed, place) and not made:
                    return None
                environment["RMLCELL_BIN"] = str(place / "bin")
        # By processor time: a machine that is busy with other things decides nothing.
        return judge(command, environment, place, int(test.cpu_s * 6) + 20 if test.cpu_s else 600)

    def relink_programs(self, file, changed, place):
        """All programs in place/bin, those that hold the source with the changed object; whether one does."""
        (place / "bin").mkdir(exist_ok=True)
        touched = False
        for program in self.programs():
            made = place / program
            if not made.exists() and not self.relink(program, file, changed, place):
                made.symlink_to(self.build / program)
            touched = touched or not made.is_symlink()
        return touched

    def measure(self, tests, place, kept):
        """Runs each test on the code as it is and gives those that pass: what fails then tells nothing. `kept` holds
        what is known."""
        known = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
        good = []
        for test in tests:
            version = self.version(test)
            if known.get(test.name, {}).get("version") != version:
                before = resource.getrusage(resource.RUSAGE_CHILDREN)
                failed = self.run(test, place)
                after = resource.getrusage(resource.RUSAGE_CHILDREN)
                cpu_s = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
                known[test.name] = {"version": version, "cpu_s": cpu_s, "failed": failed}
                kept.write_text(json.dumps(known, indent=1), encoding="utf-8")
            row = known[test.name]
            test.cpu_s = row["cpu_s"]
            if row["failed"]:
                print(f"{test.name} fails on the code as it is: {row['failed']}: left out where it runs whole", flush=True)
            else:
                good.append(test)
        return good

    def version(self, test):
        """Another one when the test or what it drives was built or written anew."""
        files = [test.program] if test.program else [test.command[-1]]
        if test.drives_programs:
            files += self.programs()
        return [(self.build / file).stat().st_mtime_ns for file in files]


def object_made_by(entry):
    command = shlex.split(entry["command"])
    return command[command.index("-o") + 1]


def tests_of(build, names):
    """These entries of CTest."""
    listed = subprocess.run(["ctest", "--test-dir", str(build), "--show-only=json-v1"], check=True,
                            capture_output=True, text=True).stdout
    entries = {entry["name"]: entry for entry in json.loads(listed)["tests"]}
    unknown = [name for name in names if name not in entries]
    if unknown:
        raise SystemExit(f"no such test: {', '.join(unknown)}")
    found = []
    for name in names:
        properties = {p["name"]: p["value"] for p in entries[name]["properties"]}
        environment = dict(pair.split("=", 1) for pair in properties.get("ENVIRONMENT", []))
        found.append(Test(name, entries[name]["command"], environment, build))
    return found


def with_cases(test, cases=()):
    """The command that runs these cases of a test, or all; the first that fails ends it."""
    if not test.program:
        return [*test.command, "--failfast", *cases]
    return [*test.command, "--gtest_fail_fast", "--gtest_brief=1", *([f"--gtest_filter={':'.join(cases)}"] if cases else [])]


def judge(command, environment, place, seconds):
    """What tells that it fails, "" where it ends well; it gets so many seconds of processor time, and its own folder."""
    scratch = place / "tmp"
    scratch.mkdir(exist_ok=True)
    process = subprocess.Popen(command, cwd=place, env={**environment, "TMPDIR": str(scratch)}, text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                               errors="replace", preexec_fn=limit(seconds), start_new_session=True)
    try:
        output = communicate(process)
    finally:
        try:
            os.killpg(process.pid, 9)
        except ProcessLookupError:
            pass
    if process.wait() == 0:
        return ""
    failed = re.findall(r"\[  FAILED  \] ([\w/.]+)|^(?:FAIL|ERROR): (\w+)", output, re.MULTILINE)
    if failed:
        return next(part for part in failed[0] if part)
    return output.strip().splitlines()[-1][:200] if output.strip() else f"signal {-process.returncode}"


def limit(seconds):
    """What a process calls before it begins: so much processor time, memory that the machine has, no core files."""
    def limits():
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES_MAX, MEMORY_BYTES_MAX))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return limits


def communicate(process):
    """What it prints until it ends, or until it does nothing any more: it waits for what never comes."""
    before = -math.inf
    while True:
        try:
            return process.communicate(timeout=QUIET_S)[0]
        except subprocess.TimeoutExpired:
            used = session_cpu_s(process.pid)
            if used - before < QUIET_S / 100:  # its timers tick
                return "it waits for ever"
            before = used


def session_cpu_s(session):
    """Processor time of all processes of a session, those that ended included."""
    ticks = 0
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text(encoding="ascii", errors="replace").rpartition(")")[2].split()
        except OSError:  # it ended in the meantime
            continue
        if int(fields[3]) == session:
            ticks += sum(map(int, fields[11:15]))
    return ticks / os.sysconf("SC_CLK_TCK")


def fresh(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder
