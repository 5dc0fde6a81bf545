"""What a verdict adds to the simulation of a stream, by instructions for each stroke, counted by callgrind.
The cost of starting is taken out by the difference of two lengths, that of keeping the motions by counting
it alone. Prints one JSON object; exits 1 when the share is above its limit, 77 without valgrind.

  verdict_instructions.py FOLDER_OF_VERDICT_COUNT
"""
import json
import os
import sys

import instructions

LIMIT = 0.2
SHORT, LONG = 1000, 5000


def main():
    if not instructions.available():
        print("no valgrind")
        return instructions.NO_VALGRIND
    program = os.path.join(sys.argv[1], "verdict_count")
    each = {what: instructions.each(program, what, SHORT, LONG) for what in ("run", "rides", "verdict")}
    added = each["verdict"] - each["rides"]
    share = added / each["run"]
    print(json.dumps({"run": round(each["run"], 1), "verdict": round(added, 1), "share": round(share, 4),
                      "limit": LIMIT}), flush=True)
    return 1 if share > LIMIT else 0


sys.exit(main())
