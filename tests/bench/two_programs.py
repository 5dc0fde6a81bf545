#!/usr/bin/env python3
"""Two programs on two cores beside one (I7): how many times as many a second, rounds in turns.

    two_programs.py PROGRAM ARGUMENT...      such as build/release/bin/rml1_count sets-run 300000

By the clock, which other work on the machine spoils, and by what the second one costs the first in processor time
(shared caches, memory, clock rate): 2.0 where it costs nothing. Ends with 1 when the latter is below the goal."""
import os
import resource
import statistics
import subprocess
import sys
import time

GOAL, ROUNDS = 1.9, 7


def run(command, count):
    begin, used = time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    running = [subprocess.Popen(command, stdout=subprocess.DEVNULL) for _ in range(count)]
    for each in running:
        each.wait()
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.perf_counter() - begin, end.ru_utime + end.ru_stime - used.ru_utime - used.ru_stime


def main():
    clock, processor = [], []
    for _ in range(ROUNDS):
        one, two = run(sys.argv[1:], 1), run(sys.argv[1:], 2)
        clock.append(2.0 * one[0] / two[0])
        processor.append(2.0 * (2.0 * one[1]) / two[1])
    print(f"I7: {statistics.median(processor):.2f} by processor time, {statistics.median(clock):.2f} by the clock "
          f"({min(clock):.2f} to {max(clock):.2f}); goal {GOAL}; load {os.getloadavg()[0]:.1f}")
    return 1 if statistics.median(processor) < GOAL else 0


sys.exit(main())
