"""Instructions of a program for each unit of its work, counted by callgrind: the same figure on a busy machine as on
a quiet one, so that a test can keep it. The cost of starting is taken out by the difference of two lengths."""
import os
import re
import shutil
import subprocess

NO_VALGRIND = 77  # what a test that cannot run here ends with


def available():
    return shutil.which("valgrind") is not None


def count(program, what, length):
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={os.devnull}", program, what,
                           str(length)], capture_output=True, text=True, timeout=300, check=True)
    return int(re.search(r"Collected : (\d+)", done.stderr).group(1))


def each(program, what, short, long):
    return (count(program, what, long) - count(program, what, short)) / (long - short)
