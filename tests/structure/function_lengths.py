#!/usr/bin/env python3
"""How long each function of a source is, from the line of its opening brace to that of its closing one.

    function_lengths.py [ROOT]     the functions above the limit, longest first

C++ is not parsed but scanned: outside of functions an opening brace behind a bracket of parameters begins one.
Python is parsed.
"""
import ast
import os
import pathlib
import re
import sys

LINES_MAX = 70

TOKEN = re.compile(r"""
    (?P<skipped>//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:\\\n|[^\n])*|\b\d(?:'?[\w.])*)
  | (?P<text>(?:u8|L)?R"(?P<fence>[^(\s]*)\(.*?\)(?P=fence)"|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
  | (?P<word>[A-Za-z_~][\w]*)
  | (?P<sign>::|->|[^\s\w])
""", re.VERBOSE | re.DOTALL | re.MULTILINE)
QUALIFIERS = {"const", "noexcept", "override", "final", "mutable", "try"}
HOLDERS = {"namespace", "class", "struct", "enum", "union", "extern"}


def without_template(head):
    """The words behind `template <...>`."""
    while head and head[0] == "template":
        depth, at = 0, 1
        while at < len(head) and (depth > 0 or at == 1):
            depth += {"<": 1, ">": -1}.get(head[at], 0)
            at += 1
        head = head[at:]
    return head


def name_of(head):
    """`Class::Name` of the words before a body; of a test its suite and name."""
    if "operator" in head:
        return "".join(head[head.index("operator"):head.index("(", head.index("operator") + 2)])
    opening = head.index("(")
    if re.match(r"[A-Z]{3,}(_[A-Z]+)*$", head[opening - 1]):  # TEST_F(Suite, Name)
        return "".join(head[opening - 1:head.index(")", opening) + 1])
    begin = opening - 1
    while begin >= 2 and head[begin - 1] == "::":
        begin -= 2
    return "".join(head[begin:opening])


def is_body(head):
    """Whether a brace behind these words holds the statements of a function."""
    if "(" not in head or head[0] == "(":
        return False
    before = head[:head.index("(")]
    return not HOLDERS & set(before) and ("=" not in before or "operator" in before)


def initialises_member(head):
    """`S() : a_{1}, b_(2) {`: whether the brace is that of a member."""
    return ":" in head[head.index("("):] and re.match(r"\w", head[-1]) and head[-1] not in QUALIFIERS


def functions_of_cpp(text):
    """(name, first line, lines) of each function, lambdas inside of one not by themselves."""
    found, open_brackets, head, inside = [], [], [], None
    line, at = 1, 0
    for match in TOKEN.finditer(text):
        line += text.count("\n", at, match.start())
        at = match.start()
        token = match.group()
        if match.group("skipped") is not None:
            continue
        holds_more = all(bracket == "{" for bracket in open_brackets)  # not in an expression
        if token == "{" and inside is None and holds_more:
            head = without_template(head)
            if is_body(head):
                if initialises_member(head):
                    open_brackets.append("initialiser")
                    continue
                inside = (len(open_brackets), name_of(head), line)
            # A table is an expression: its lambdas are no functions of their own.
            open_brackets.append("=" if "=" in head and not inside else token)
            head = []
        elif token in "([{":
            open_brackets.append(token)
            head.append(token)
        elif token in ")]}" and open_brackets:
            bracket = open_brackets.pop()
            head.append(token)
            if token == "}" and inside and inside[0] == len(open_brackets):
                found.append((inside[1], inside[2], line - inside[2] + 1))
                inside = None
            if bracket in ("{", "=") and all(other == "{" for other in open_brackets):
                head = []
        elif token == ";" and holds_more:
            head = []
        else:
            head.append(token)
    return found


def functions_of_python(text):
    return [(node.name, node.lineno, node.end_lineno - node.lineno + 1) for node in ast.walk(ast.parse(text))
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef))]


def long_functions(root):
    """{(path, name): lines} of those above the limit; of several of a name the longest."""
    found = {}
    for top in ("engine", "storage", "proto", "server", "clients", "tests"):
        for path in sorted((pathlib.Path(root) / top).rglob("*")):
            if path.suffix not in (".cc", ".h", ".py") or "build" in path.parts or "node_modules" in path.parts:
                continue
            text = path.read_text(encoding="utf-8", errors="replace")
            functions = functions_of_python(text) if path.suffix == ".py" else functions_of_cpp(text)
            for name, _, lines in functions:
                key = (os.path.relpath(path, root), name)
                if lines > max(LINES_MAX, found.get(key, 0)):
                    found[key] = lines
    return found


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
    for (path, name), lines in sorted(long_functions(root).items(), key=lambda item: -item[1]):
        print(lines, path, name)


if __name__ == "__main__":
    main()
