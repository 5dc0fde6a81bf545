"""What a verdict adds to the simulation of a stream, by instructions for each stroke, counted by callgrind.
The cost of starting is taken out by the difference of two lengths, that of keeping the motions by counting
it alone. Prints one JSON object; exits 1 when the share is above its limit, 77 without valgrind.

  verdict_instructions.py FOLDER_OF_VERDICT_COUNT
"""
import json
import os
import re
import shutil
import subprocess
import sys

LIMIT = 0.2
SHORT, LONG = 1000, 5000


def count(program, what, strokes):
    done = subprocess.run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={os.devnull}", program, what,
                           str(strokes)], capture_output=True, text=True, timeout=300, check=True)
    return int(re.search(r"Collected : (\d+)", done.stderr).group(1))


def main():
    if shutil.which("valgrind") is None:
        print("no valgrind")
        return 77
    program = os.path.join(sys.argv[1], "verdict_count")
    each = {what: (count(program, what, LONG) - count(program, what, SHORT)) / (LONG - SHORT)
            for what in ("run", "rides", "verdict")}
    added = each["verdict"] - each["rides"]
    share = added / each["run"]
    print(json.dumps({"run": round(each["run"], 1), "verdict": round(added, 1), "share": round(share, 4),
                      "limit": LIMIT}), flush=True)
    return 1 if share > LIMIT else 0


sys.exit(main())
