#!/usr/bin/env python3
"""Writes tests/conformance/rml1_examples.csv from the example column of the RML-1 specification.

    python3 tests/conformance/rml1_extract.py SPEC.md > tests/conformance/rml1_examples.csv

One row per example: rule ID, number within the rule, tags, input as printed (escapes untouched),
facts. Rows of the specification without an example in backquotes have none here.
"""
import csv
import re
import sys

ROW = re.compile(r"^\| (RML1-[1-7][A-E]?\.\d+) \|(.*)\|$")
EXAMPLE = re.compile(r"^`([^`]*)` -> (.*)$")
TAGS = re.compile(r"^((?:\{(?!resume)[^}]*\} )*)(.*)$")


def main() -> None:
    out = csv.writer(sys.stdout, lineterminator="\n")
    out.writerow(["id", "number", "tags", "input", "facts"])
    with open(sys.argv[1], encoding="utf-8") as spec:
        for line in spec:
            row = ROW.match(line.rstrip("\n"))
            if not row:
                continue
            example = row.group(2).rsplit("|", 1)[0].rsplit(" | ", 1)[-1].strip()
            number = 0
            for part in example.split("<br>"):
                match = EXAMPLE.match(part.strip())
                if not match:
                    continue
                number += 1
                tags, text = TAGS.match(match.group(1)).groups()
                out.writerow([row.group(1), number, tags.strip(), text, match.group(2)])


if __name__ == "__main__":
    main()
