"""Instructions that a move of RML-1 takes to be read, checked and run, counted by callgrind: the same figure on a busy
machine as on a quiet one, so that a test can keep it. The cost of starting is taken out by the difference of two
lengths, that of writing the text by counting it alone. Prints one JSON object a line; exits 1 when a figure is above its
limit, 77 without valgrind.

  rml1_instructions.py FOLDER_OF_RML1_COUNT
"""
import json
import os
import sys

import instructions

# The goal of reading is 600 (I3); the bare scan takes 206. The limits are the way to it, set on 2026-11-27, for who works
# on the reading next to lower: 180 of the reading
# are the numbers of a set, 220 what the set does (counts of the program, place, travel, action), 190 lines, names and the hand-over,
# 40 who asks. Of a run 2,400 are the planner, whose limits stand in motion_instructions.py.
LIMITS = {"read": 655, "check": 1150, "run": 5650}
GOALS = {"read": 600}
FORMS = ("sets", "pairs", "list", "steps")
SHORT, LONG = 1000, 6000


def main():
    if not instructions.available():
        print("no valgrind")
        return instructions.NO_VALGRIND
    program = os.path.join(sys.argv[1], "rml1_count")
    failed = False
    for form in FORMS:
        written = instructions.each(program, f"{form}-text", SHORT, LONG)
        for stage, limit in LIMITS.items():
            each = instructions.each(program, f"{form}-{stage}", SHORT, LONG) - written
            print(json.dumps({"form": form, "stage": stage, "instructions_per_move": round(each, 1),
                              "limit": limit, "goal": GOALS.get(stage)}), flush=True)
            failed = failed or each > limit
    return 1 if failed else 0


sys.exit(main())
