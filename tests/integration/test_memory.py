#!/usr/bin/env python3
"""What a stream takes of memory has a bound, whatever its length: 16 MiB to check, run and explain it, and to make
G-code or another stream of it."""
import os
import subprocess
import unittest

from cell import Cell
from command import BIN, InFolder

MIB = 1024  # ru_maxrss and /proc count in KiB
BOUND = 16 * MIB


def zigzag(size):
    """Cuts to and fro over 80 x 60 mm, no two lines alike, until there are `size` bytes."""
    parts, length, row = ["PA;VS10;!VZ5;!PZ-50,200;!MC1;PU0,0;"], 0, 0
    while length < size:
        row += 1
        y = row * 7 % 6000
        parts.append(f"PD{row % 500},{y},{8000 - row % 300},{y + 3};")
        length += len(parts[-1])
    return "".join(parts) + "PU0,0;!MC0;"


def gcode(size):
    """The same to and fro in G-code."""
    parts, length, row = ["G21 G90\nM3 S6000\nG0 Z2\nG1 Z-0.5 F300\n"], 0, 0
    while length < size:
        row += 1
        y = row * 7 % 6000 / 100
        parts.append(f"G1 X{row % 500 / 100} Y{y} F600\nX{80 - row % 300 / 100} Y{y + 0.03}\n")
        length += len(parts[-1])
    return "".join(parts) + "G0 Z2\nM5\nM30\n"


class Memory(InFolder):
    def setUp(self):
        super().setUp()
        self.short = self.file("short.rml", zigzag(100))
        self.long = self.file("long.rml", zigzag(24_000_000))

    def peak(self, *words):
        """KiB that a call of the command held at most."""
        process = subprocess.Popen([BIN / "rmlcell", *map(str, words)], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        status, usage = os.wait4(process.pid, 0)[1:]
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertIn(process.returncode, (0, 1))
        return usage.ru_maxrss

    def test_the_command(self):
        for words in (["check"], ["simulate"], ["rml1", "explain"],
                      ["simulate", "--toolpath", self.folder / "a.path"],
                      ["simulate", "--samples", "1", self.folder / "a.csv"]):
            with self.subTest(words):
                more = ["--profile", "srm-20"]
                least = self.peak(*words, self.short, *more)
                self.assertLess(self.peak(*words, self.long, *more) - least, BOUND)

    def test_tools_that_write(self):
        short_gcode = self.file("short.nc", gcode(100))
        long_gcode = self.file("long.nc", gcode(24_000_000))
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

    # A third of the size and the whole: what it takes has a bound that length does not move.
    def test_pictures_and_json(self):
        third = self.file("third.rml", zigzag(8_000_000))
        for words in (["--svg", self.folder / "a.svg"], ["--json"]):
            with self.subTest(words):
                more = ["--profile", "srm-20"]
                least = self.peak("simulate", *words, third, *more)
                self.assertLess(self.peak("simulate", *words, self.long, *more) - least, 2 * MIB)

    def test_a_job(self):
        cell = Cell(workers=1)
        self.addCleanup(cell.close)
        cell.start()
        found = subprocess.run(["pgrep", "-P", str(cell.process.pid), "rmlcell-worker"], capture_output=True, text=True)
        [worker] = found.stdout.split()

        def peak():
            for line in open(f"/proc/{worker}/status"):
                if line.startswith("VmHWM:"):
                    return int(line.split()[1])

        def run(file):
            cell.command("put", "mill-1", "9", file)
            cell.command("submit", "mill-1", "--slot", "9", "--watch", check=False)
            return peak()

        run(self.short)
        third = run(self.file("third.rml", zigzag(8_000_000)))
        self.assertLess(run(self.long) - third, 8 * MIB)


if __name__ == "__main__":
    unittest.main(verbosity=2)
