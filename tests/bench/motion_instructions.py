"""Instructions that the planner takes for a line, counted by callgrind: the same figure on a busy machine
as on a quiet one, so that a test can keep it. The cost of starting is taken out by the difference of two
lengths. Prints one JSON object a line; exits 1 when a figure is above its limit, 77 without valgrind.

  motion_instructions.py FOLDER_OF_MOTION_COUNT
"""
import json
import os
import sys

import instructions

# mill is at its goal. jerk (a contour at cruise, the easy case) is below that of the walk, 4,000, and must stay there.
# The others are on the way to theirs, set on 27 November 2026 at what docs/decisions/0047-work-with-each-move.md reached,
# to be lowered by who works on the planner next: arcs, short, ramps, zigzag and walk to 4,000; five_axis and
# walk_five_axis to 4,500; trapezoid, walk_trapezoid and walk_mill to 1,000. What bounds them stands there and in
# tests/results/engine.txt.
LIMITS = {"jerk": 3200, "trapezoid": 3160, "mill": 1000, "five_axis": 6700, "arcs": 78900, "short": 20200,
          "ramps": 33100, "zigzag": 20000, "walk": 14350, "walk_trapezoid": 4670, "walk_mill": 2070,
          "walk_five_axis": 22700}
SHORT, LONG = 2400, 8400


def main():
    if not instructions.available():
        print("no valgrind")
        return instructions.NO_VALGRIND
    program = os.path.join(sys.argv[1], "motion_count")
    failed = False
    for what, limit in LIMITS.items():
        each = instructions.each(program, what, SHORT, LONG)
        print(json.dumps({"path": what, "instructions_per_line": round(each, 1), "limit": limit}), flush=True)
        failed = failed or each > limit
    return 1 if failed else 0


sys.exit(main())
