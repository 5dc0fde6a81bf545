"""What report, toolpath and picture of a run cost beside reading and planning the program (row R1 of the goals), by
instructions for each move of a walk, counted by callgrind: for a mill, a laser whose head stands, and one whose head
turns. Prints one JSON object; exits 1 when they are above their
limit, 77 without valgrind.

  report_instructions.py FOLDER_OF_REPORT_COUNT [--parts]     the parts one by one, too
"""
import json
import os
import sys

import instructions

GOAL = 0.5
# path: moves of the two programs, and what may be added to each move: of 27 November 2026, on the way to the goal. Who
# makes a report cheaper lowers it. No limit of the share: who makes planning cheaper must not break this.
PATHS = {"mill": (1000, 4000, 6900), "laser": (250, 1000, 93000), "five_axis": (200, 800, 183000)}


def main():
    if not instructions.available():
        print("no valgrind")
        return instructions.NO_VALGRIND
    program = os.path.join(sys.argv[1], "report_count")
    told, missed = {}, False
    for path, (short, long, limit) in PATHS.items():
        def each(stage):
            return instructions.each(program, f"{path}-{stage}", short, long)
        text, plan = each("text"), each("plan")
        added = each("all") - plan
        share = added / (plan - text)
        told[path] = {"plan": round(plan - text, 1), "added": round(added, 1), "limit": limit,
                      "share": round(share, 4), "goal": GOAL}
        if "--parts" in sys.argv:
            report = each("report")
            told[path] |= {"report": round(report - plan, 1), "toolpath": round(each("toolpath") - report, 1),
                           "picture": round(each("picture") - report, 1)}
        missed = missed or added > limit
    print(json.dumps(told), flush=True)
    return 1 if missed else 0


sys.exit(main())
