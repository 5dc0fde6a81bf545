#!/usr/bin/env python3
"""Adds up JUnit reports of CTest, counting the cases inside each GoogleTest and unittest program."""
import re
import sys
import xml.etree.ElementTree as tree


def number(pattern, text):
    found = re.findall(pattern, text)
    return int(found[-1]) if found else 0


def cases(entry):
    """(passed, failed, skipped) of one entry of CTest."""
    output = entry.findtext("system-out") or ""
    if "[  PASSED  ]" in output:
        return (number(r"\[  PASSED  \] (\d+) test", output), number(r"\[  FAILED  \] (\d+) test", output),
                number(r"\[  SKIPPED \] (\d+) test", output))
    ran = number(r"(?m)^Ran (\d+) tests? in", output)
    if ran:
        failed = number(r"failures=(\d+)", output) + number(r"errors=(\d+)", output)
        skipped = number(r"(?m)^(?:OK|FAILED) \(.*?skipped=(\d+)", output)
        return ran - failed - skipped, failed, skipped
    if entry.find("skipped") is not None or entry.get("status") == "notrun":
        return 0, 0, 1
    if entry.find("failure") is not None or entry.get("status") == "fail":
        return 0, 1, 0
    return 1, 0, 0


passed = failed = skipped = 0
skipping = []
for path in sys.argv[1:]:
    for entry in tree.parse(path).getroot().iter("testcase"):
        counts = cases(entry)
        if counts[1] == 0 and (entry.find("failure") is not None or entry.get("status") == "fail"):
            counts = (counts[0], 1, counts[2])  # it died before it could say so
        passed, failed, skipped = passed + counts[0], failed + counts[1], skipped + counts[2]
        if counts[2]:
            skipping.append(f"{entry.get('name')}: {counts[2]}")
if skipping:
    print("skipped in " + ", ".join(skipping))
print(f"{passed} passed, {failed} failed, {skipped} skipped")
