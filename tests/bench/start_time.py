#!/usr/bin/env python3
"""How long the command takes for one small file, and for the largest programs of the corpus: the whole of what a user
or an editor waits for. Beside it a process that does nothing, turn by turn, so that a slow machine is seen.

    start_time.py RMLCELL [ROUNDS]

Medians of wall time; ends with 1 when a goal is missed (row E2)."""
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

CORPUS = pathlib.Path(os.environ.get("RMLCELL_SHARED", pathlib.Path(__file__).resolve().parents[3] / "shared")) / "corpus"
SMALL_MILL = "PA;PA;VS10;!VZ5;!PZ-50,100;!MC1;PU200,0;PD400,0;PU0,0;!MC0;H;"
SMALL_OPTIMO = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (1300., 900., -200., 0., 0.)\nDELAY 1\n"


def took_ms(command):
    begin = time.perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    return (time.perf_counter() - begin) * 1e3


def main():
    rmlcell, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 40
    with tempfile.TemporaryDirectory() as folder:
        mill, optimo = os.path.join(folder, "small.rml"), os.path.join(folder, "small.S")
        pathlib.Path(mill).write_text(SMALL_MILL)
        pathlib.Path(optimo).write_text(SMALL_OPTIMO)
        picture = os.path.join(folder, "picture.svg")
        asked = [("simulate, a small program of a mill", [rmlcell, "simulate", mill], 5.0),
                 ("simulate, a small program of the laser", [rmlcell, "simulate", optimo], 5.0)]
        for pattern in ("rml1/*", "optimo/*.S"):
            files = sorted(CORPUS.glob(pattern), key=lambda file: file.stat().st_size)
            if files:
                largest = str(files[-1])
                asked += [(f"check {files[-1].name}", [rmlcell, "check", largest], 10.0),
                          (f"simulate --svg {files[-1].name}", [rmlcell, "simulate", largest, "--svg", picture], 50.0)]
        times = {name: [] for name, _, _ in asked}
        bare = []
        for _ in range(rounds):
            bare.append(took_ms(["/bin/true"]))
            for name, command, _ in asked:
                times[name].append(took_ms(command))
        print(f"a process that does nothing: {statistics.median(bare):.2f} ms; load {os.getloadavg()[0]:.1f}")
        missed = 0
        for name, _, goal in asked:
            median = statistics.median(times[name])
            missed += median > goal
            print(f"E2: {name:<48} {median:8.2f} ms   goal: at most {goal:.0f}{'   MISSED' if median > goal else ''}")
        return 1 if missed else 0


sys.exit(main())
