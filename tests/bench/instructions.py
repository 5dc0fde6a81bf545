"""Instructions of a program for each unit of its work, counted by callgrind: the same figure on a busy machine as on
a quiet one, so that a test can keep it. The cost of starting is taken out by the difference of two lengths."""
import os
import re
import shutil
import subprocess
import tempfile

NO_VALGRIND = 77  # what a test that cannot run here ends with


def available():
    return shutil.which("valgrind") is not None


def count(program, what, length):
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={os.devnull}", program, what,
                           str(length)], capture_output=True, text=True, timeout=300, check=True)
    return int(re.search(r"Collected : (\d+)", done.stderr).group(1))


def each(program, what, short, long):
    return (count(program, what, long) - count(program, what, short)) / (long - short)


def count_without(program, what, length, parts):
    """Those that are not spent in functions whose names begin with one of `parts`, nor in what these call."""
    with tempfile.NamedTemporaryFile("r", encoding="utf-8") as costs:
        subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={costs.name}", program, what, str(length)],
                       capture_output=True, timeout=300, check=True)
        return _sum_without(costs, parts)


def _sum_without(costs, parts):
    names, caller, callee, of_call, total = {}, "", "", False, 0

    def name(told):  # "(12) f(int)", later "(12)" alone
        number, _, text = told.partition(" ")
        if text:
            names[number] = text
        return names[number]

    for line in costs:
        line = line.rstrip("\n")
        if line.startswith("fn="):
            caller = name(line[3:])
        elif line.startswith("cfn="):
            callee = name(line[4:])
        elif line.startswith("calls="):
            of_call = True
        elif line and line[0] in "0123456789+-*":
            cost = int(line.split()[1])
            if not of_call:
                total += cost
            elif callee.startswith(parts) and not caller.startswith(parts):
                total -= cost
            of_call = False
    return total


def each_without(program, what, short, long, parts):
    return (count_without(program, what, long, parts) - count_without(program, what, short, parts)) / (long - short)
