#!/usr/bin/env python3
"""What a stream takes of memory has a bound, whatever its length: 16 MiB in command and jobs, with all that a
job makes of it, and for G-code or another stream made of it."""
import subprocess
import sys
import unittest

from cell import Cell, awaited
from command import BIN, InFolder

MIB = 1024  # ru_maxrss and /proc count in KiB
BOUND = 16 * MIB
# A process of its own, smaller than what it measures: the system counts what a process held before it became another.
MEASURE = """
import os, sys
null = os.open(os.devnull, os.O_WRONLY)
pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ,
                     file_actions=[(os.POSIX_SPAWN_DUP2, null, 1), (os.POSIX_SPAWN_DUP2, null, 2)])
status, usage = os.wait4(pid, 0)[1:]
print(usage.ru_maxrss, os.waitstatus_to_exitcode(status))
"""


def zigzag(size):
    """Cuts to and fro over 8 x 60 mm, no two lines alike, until there are `size` bytes: piece by piece. They are
    short, so that the longest ends before the thirty days do that a run may take."""
    yield "PA;VS15;!VZ5;!PZ-50,200;!MC1;PU0,0;"
    length, row = 0, 0
    while length < size:
        row += 1
        y = row * 7 % 6000
        piece = f"PD{row % 500},{y},{800 - row % 300},{y + 3};"
        length += len(piece)
        yield piece
    yield "PU0,0;!MC0;"


def strays(lines):
    """Motions in all directions, most of them far beyond the travel, each with a speed of its own."""
    yield "IN;PA;!PZ-100,200;VS10;!VZ5;!MC1;PU100,100;\n"
    place = 1
    for _ in range(lines):
        place = place * 48271 % 2147483647
        yield f"Z{place % 41000},{place // 41 % 42000 - 6000},{-(place // 977 % 5000)};V{place // 7 % 50 + 5};\n"
    yield "PU0,0;!MC0;\n"


def gcode(size):
    """The same to and fro in G-code."""
    yield "G21 G90\nM3 S6000\nG0 Z2\nG1 Z-0.5 F300\n"
    length, row = 0, 0
    while length < size:
        row += 1
        y = row * 7 % 6000 / 100
        piece = f"G1 X{row % 500 / 100} Y{y} F600\nX{8 - row % 300 / 100} Y{y + 0.03}\n"
        length += len(piece)
        yield piece
    yield "G0 Z2\nM5\nM30\n"


class Memory(InFolder):
    def setUp(self):
        super().setUp()
        self.short = self.stream("short.rml", zigzag(100))
        self.long = self.stream("long.rml", zigzag(20_000_000))

    def stream(self, name, pieces):
        with open(self.folder / name, "w", encoding="ascii") as file:
            file.writelines(pieces)
        return self.folder / name

    def peak(self, *words):
        """KiB that a call of the command held at most."""
        process = subprocess.run([sys.executable, "-I", "-S", "-c", MEASURE, BIN / "rmlcell", *map(str, words)],
                                 capture_output=True, text=True)
        peak, exit_code = map(int, process.stdout.split())
        self.assertIn(exit_code, (0, 1))
        return peak

    def test_the_command(self):
        # All that a run makes has the bound together, and so has each of it.
        for words in (["check"], ["rml1", "explain"], ["simulate", "--json"],
                      ["simulate", "--toolpath", self.folder / "a.path", "--samples", "1", self.folder / "a.csv",
                       "--svg", self.folder / "a.svg"]):
            with self.subTest(words):
                more = ["--profile", "srm-20"]
                least = self.peak(*words, self.short, *more)
                self.assertLess(self.peak(*words, self.long, *more) - least, BOUND)

    # Each way beyond the travel is a finding.
    def test_findings_without_end(self):
        strays_short, strays_long = self.stream("few.rml", strays(10)), self.stream("strays.rml", strays(1_000_000))
        for words in (["check"], ["simulate"], ["simulate", "--svg", self.folder / "a.svg", "--toolpath", self.folder / "a.path"]):
            with self.subTest(words):
                least = self.peak(*words, strays_short, "--profile", "srm-20")
                self.assertLess(self.peak(*words, strays_long, "--profile", "srm-20") - least, BOUND)

    def test_tools_that_write(self):
        short_gcode = self.stream("short.nc", gcode(100))
        long_gcode = self.stream("long.nc", gcode(20_000_000))
        for words, short, long in ((["to-gcode"], self.short, self.long),
                                   (["from-gcode"], short_gcode, long_gcode),
                                   (["move", "--by", "1,2"], self.short, self.long),
                                   (["move", "--by", "0,0"], self.short, self.long),  # copied as it is
                                   (["steps", "--from", "100", "--to", "100"], self.short, self.long),
                                   (["tile", "--columns", "2"], self.short, self.long)):
            with self.subTest(words):
                made = self.folder / "made"
                more = ["--profile", "srm-20", "-o", made]
                least = self.peak("rml1", *words, short, *more)
                self.assertLess(self.peak("rml1", *words, long, *more) - least, BOUND)
                self.assertGreater(made.stat().st_size, 10_000_000)
                if "move" in words:  # to standard output, too
                    self.assertLess(self.peak("rml1", *words, long, "-o", "-") - least, BOUND)

    def test_a_job(self):
        cell = Cell("--workers.paced", "0", workers=1)
        self.addCleanup(cell.close)
        cell.start()
        # The server is ready before a thread of it has started its worker, which has its name a moment later.
        [worker] = awaited(lambda: subprocess.run(["pgrep", "-P", str(cell.process.pid), "rmlcell-worker"],
                                                  capture_output=True, text=True).stdout.split())

        def peak():
            with open(f"/proc/{worker}/status", encoding="ascii") as status:
                return next(int(line.split()[1]) for line in status if line.startswith("VmHWM:"))

        def run(file):
            cell.command("put", "mill-1", "9", file)
            cell.command("submit", "mill-1", "--slot", "9", "--watch", check=False)
            return peak()

        least = run(self.short)
        self.assertLess(run(self.long) - least, BOUND)


if __name__ == "__main__":
    unittest.main(verbosity=2)
