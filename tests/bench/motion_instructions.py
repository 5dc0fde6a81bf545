"""Instructions that the planner takes for a line, counted by callgrind: the same figure on a busy machine
as on a quiet one, so that a test can keep it. The cost of starting is taken out by the difference of two
lengths. Prints one JSON object a line; exits 1 when a figure is above its limit, 77 without valgrind.

  motion_instructions.py FOLDER_OF_MOTION_COUNT
"""
import json
import os
import sys

import instructions

# 3 % above what a line took before the planner was split by its stages and spoke Eigen (docs/decisions/0019), with g++ 12.
# The goal for acceleration-limited plans is 1,000: reached where the path is kept as it is (mill); with a curve at every
# corner (trapezoid) a line is three motions, and no stage takes more than a tenth of the count:
# docs/decisions/0009-motion-speed.md. Capped bends (short, ramps) cost the search for ramps through them:
# docs/decisions/0008-ramps-across-passages.md.
LIMITS = {"jerk": 3242, "trapezoid": 3204, "mill": 1000, "five_axis": 6930, "arcs": 194700, "short": 26500,
          "ramps": 47800}
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
