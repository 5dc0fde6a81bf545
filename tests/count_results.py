#!/usr/bin/env python3
"""Adds up JUnit reports of CTest and, inside each test binary, the cases of GoogleTest."""
import re
import sys
import xml.etree.ElementTree as tree

passed = failed = skipped = 0
for path in sys.argv[1:]:
    for case in tree.parse(path).getroot().iter("testcase"):
        output = case.findtext("system-out") or ""
        counted = re.search(r"\[  PASSED  \] (\d+) tests?", output)
        if counted:
            passed += int(counted.group(1))
            for name, kind in ((r"\[  SKIPPED \] (\d+) tests?", "skipped"), (r"\[  FAILED  \] (\d+) tests?", "failed")):
                found = re.search(name, output)
                if found and kind == "skipped":
                    skipped += int(found.group(1))
                elif found:
                    failed += int(found.group(1))
        elif case.find("skipped") is not None or case.get("status") == "notrun":
            skipped += 1
        elif case.find("failure") is not None or case.get("status") == "fail":
            failed += 1
        else:
            passed += 1
print(f"{passed} passed, {failed} failed, {skipped} skipped")
