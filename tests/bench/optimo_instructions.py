"""Instructions of an Optimo program, counted by callgrind: for a round of a loop of seven operations (row I4 of the
goals), and for a call with two arguments that makes one move (I5), there without what plans and rides the motion: the
calls of engine/motion and engine/optimo/ride. Prints one JSON object; exits 1 when a figure is above its limit, 77
without valgrind.

  optimo_instructions.py FOLDER_OF_OPTIMO_COUNT
"""
import json
import os
import sys

import instructions

LOOP_LIMIT = 400
CALL_LIMIT = 2650  # of 27 November 2026, on the way to 1,400: who makes MOVE cheaper lowers it
OF_MOTIONS = ("rmlcell::motion::", "rmlcell::optimo::Ride::", "rmlcell::optimo::Travel::")


def main():
    if not instructions.available():
        print("no valgrind")
        return instructions.NO_VALGRIND
    program = os.path.join(sys.argv[1], "optimo_count")
    loop = instructions.each(program, "loop", 10000, 30000)
    planned = instructions.each(program, "call", 200, 600)
    call = instructions.each_without(program, "call", 200, 600, OF_MOTIONS)
    print(json.dumps({"loop": round(loop, 1), "loop_limit": LOOP_LIMIT, "call": round(call, 1), "call_limit": CALL_LIMIT,
                      "call_with_motion": round(planned, 1)}), flush=True)
    return 1 if loop > LOOP_LIMIT or call > CALL_LIMIT else 0


sys.exit(main())
