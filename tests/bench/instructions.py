"""Instructions of a program for each unit of its work, counted by callgrind: the same figure on a busy machine as on
a quiet one, so that a test can keep it. The cost of starting is taken out by the difference of two lengths."""
import collections
import os
import re
import shutil
import subprocess
import tempfile

NO_VALGRIND = 77  # what a test that cannot run here ends with
ROUNDS = 50  # of shares that hang on each other; a chain of calls is shorter


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
        return sum_without(costs, parts)


def sum_without(costs, parts):
    own, calls = _read(costs)
    # Of a function that both call (std::sort, malloc) the share that the parts asked for, by what it cost each: one that
    # the parts call and that calls them again must not be taken out twice.
    inside = {name: float(name.startswith(parts)) for name in own}
    callers = collections.defaultdict(list)
    for (caller, callee), cost in calls.items():
        if not callee.startswith(parts) and caller != callee and cost > 0:
            callers[callee].append((caller, cost))
    for _ in range(ROUNDS):
        for callee, each_caller in callers.items():
            whole = sum(cost for _, cost in each_caller)
            inside[callee] = sum(cost * inside.get(caller, 0.0) for caller, cost in each_caller) / whole
    return sum(cost * (1.0 - inside[name]) for name, cost in own.items())


def _read(costs):
    """What each function spends itself, and what each spends in each that it calls."""
    names, own, calls = {}, collections.Counter(), collections.Counter()
    caller, callee, of_call = "", "", False

    def name(told):  # "(12) f(int)", later "(12)" alone
        number, _, text = told.partition(" ")
        if text:
            names[number] = text
        return names[number]

    for line in costs:
        line = line.rstrip("\n")
        if line.startswith("fn="):
            caller = name(line[3:])
            own[caller] += 0
        elif line.startswith("cfn="):
            callee = name(line[4:])
            own[callee] += 0
        elif line.startswith("calls="):
            of_call = True
        elif line and line[0] in "0123456789+-*":
            cost = int(line.split()[1])
            if of_call:
                calls[caller, callee] += cost
            else:
                own[caller] += cost
            of_call = False
    return own, calls


def each_without(program, what, short, long, parts):
    return (count_without(program, what, long, parts) - count_without(program, what, short, parts)) / (long - short)
