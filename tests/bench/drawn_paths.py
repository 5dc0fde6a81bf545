#!/usr/bin/env python3
"""The figures of the goals on programs that nobody tuned for: three of each family, drawn by a seed from the corpus.
Instructions for each move are counted by callgrind; the longest of a thousand segments is timed.

    drawn_paths.py FOLDER_OF_DRAWN_COUNT SEED [--rs274 PROGRAM]

A program is carried out again and again until it has 2,000 moves, and twice as often: their difference is told, so that
what starts once is not in it. Drawn are those that run to their end without an error of theirs; of mills those with a
hundred moves, for the few lines at the head of a stream are read another way than its moves. Ends with 1 when a goal is
missed, 77 without valgrind or corpus. With --rs274 LinuxCNC's interpreter reads the places of the mills as G-code in
turns with ours (rs274_ratio.sh brings one)."""
import argparse
import json
import os
import pathlib
import random
import resource
import statistics
import subprocess
import sys
import tempfile

import instructions

CORPUS = pathlib.Path(os.environ.get("RMLCELL_SHARED", pathlib.Path(__file__).resolve().parents[3] / "shared")) / "corpus"
DRAWN, MOVES = 3, 2000
FAMILIES = {"mill": (("rml1/*.rml", "rml1/*.prn"), 100), "laser": (("optimo/*.S",), 1)}  # files, moves at least
OF_PLANNER = ("rmlcell::motion::",)
OF_MOTIONS = OF_PLANNER + ("rmlcell::optimo::Ride::", "rmlcell::optimo::Travel::")

# Row of performance.md, what is told, goal: at most, of rs274 at least.
GOALS = {"mill": {"read": ("I3", 600), "planner": ("P3", 1000), "p99.9_us": ("P4", 20), "share": ("R1", 0.5),
                  "rs274_ratio": ("I1", 40)},
         "laser": {"without_planner": ("I5", 1400), "planner": ("P2", 4500), "p99.9_us": ("P4", 20),
                   "share": ("R1", 0.5)}}
AT_LEAST = ("rs274_ratio",)


def moves_of(program, file):
    """Of one round; 0: it does not run to its end."""
    for stage in ("moves", "plan"):
        done = subprocess.run([program, f"{file}:{stage}", "1"], capture_output=True, text=True, timeout=300, check=False)
        if done.returncode != 0:
            return 0
        if stage == "moves":
            moves = int(done.stdout)
    return moves


def draw(program, dice, patterns, least):
    files = sorted(str(file) for pattern in patterns for file in CORPUS.glob(pattern))
    able = [(file, moves) for file in files if (moves := moves_of(program, file)) >= least]
    return dice.sample(able, min(DRAWN, len(able)))


def seconds(command, output=subprocess.DEVNULL):
    begin = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, stdout=output, stderr=subprocess.DEVNULL, timeout=300, check=False)
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime


def rs274_ratio(program, rival, file, moves):
    """How many times as many moves a second ours reads; both without what starts once."""
    few, many = max(1, 20000 // moves), max(1, 1000000 // moves)
    with tempfile.TemporaryDirectory() as folder:
        texts = {times: os.path.join(folder, f"{times}.ngc") for times in (0, few)}
        for times, text in texts.items():
            with open(text, "wb") as gcode:
                seconds([program, f"{file}:gcode", str(times)], gcode)
        ratios = []
        for _ in range(5):
            theirs = (seconds([rival, texts[few]]) - seconds([rival, texts[0]])) / few
            ours = (seconds([program, f"{file}:read", str(many)]) - seconds([program, f"{file}:text", str(many)])) / many
            ratios.append(theirs / ours)
    return statistics.median(ratios)


def figures(program, family, file, moves):
    times = -(-MOVES // moves)
    per_move = moves  # instructions.each is for each round

    def each(stage):
        return instructions.each(program, f"{file}:{stage}", times, 2 * times) / per_move

    def each_without(parts):
        return instructions.each_without(program, f"{file}:plan", times, 2 * times, parts) / per_move

    text, plan, told = each("text"), each("plan"), {}
    if family == "mill":
        told |= {"read": each("read") - text, "check": each("check") - text}
    told |= {"run": plan - text, "planner": plan - each_without(OF_PLANNER)}
    if family == "laser":
        told["without_planner"] = each_without(OF_MOTIONS) - text
    report = each("report")
    told |= {"report": report - plan, "toolpath": each("toolpath") - report, "picture": each("picture") - report}
    told["share"] = (each("all") - plan) / told["run"]
    tail = subprocess.run([program, f"{file}:tail", str(10 * times)], capture_output=True, text=True, timeout=300, check=True)
    return told | {"p99.9_us": json.loads(tail.stdout)["p99.9_us"]}


def missed_of(family, told):
    return [row for what, (row, goal) in GOALS[family].items()
            if what in told and (told[what] < goal if what in AT_LEAST else told[what] > goal)]


def main():
    options = argparse.ArgumentParser()
    options.add_argument("folder")
    options.add_argument("seed", type=int)
    options.add_argument("--rs274")
    options = options.parse_args()
    if not instructions.available() or not CORPUS.is_dir():
        print("no valgrind" if CORPUS.is_dir() else f"no corpus at {CORPUS}")
        return instructions.NO_VALGRIND
    program, dice, failed = os.path.join(options.folder, "drawn_count"), random.Random(options.seed), False
    for family, (patterns, least) in FAMILIES.items():
        for file, moves in draw(program, dice, patterns, least):
            told = figures(program, family, file, moves)
            if options.rs274 and family == "mill":
                told["rs274_ratio"] = rs274_ratio(program, options.rs274, file, moves)
            missed = missed_of(family, told)
            failed = failed or bool(missed)
            print(json.dumps({"family": family, "program": os.path.basename(file), "moves": moves}
                             | {what: round(value, 2 if value < 100 else 0) for what, value in told.items()}
                             | {"missed": missed}), flush=True)
    print(json.dumps({"seed": options.seed, "load": round(os.getloadavg()[0], 1)}))
    return 1 if failed else 0


sys.exit(main())
