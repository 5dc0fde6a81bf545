"""Where a line of C++ can be given another meaning by a small change, and what the change is.

The text is cut into tokens, no more: what is no C++ afterwards is refused by the compiler and does not count.
Relied on is the format of the house: a binary operator has a blank on both sides, a template's bracket has not.
"""
import bisect
import dataclasses
import pathlib
import re

KINDS = ("comparison", "bound", "sign", "constant", "dropped statement", "exchanged argument", "error code")

TOKEN = re.compile(r"""
    (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<directive>(?<![^\n])[ \t]*\#(?:\\\n|[^\n])*)
  | (?P<string>(?:u8|L)?R"(?P<fence>[^(\s]*)\(.*?\)(?P=fence)"|"(?:\\.|[^"\\\n])*")
  | (?P<char>'(?:\\.|[^'\\\n])+')
  | (?P<number>(?:0[xX][0-9a-fA-F']+|(?:\d[\d']*\.?[\d']*|\.\d+)(?:[eE][-+]?\d+)?)[uUlLfFzZ]*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<sign><=>|<<=|>>=|->|::|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|[^\s\w])
""", re.VERBOSE | re.DOTALL)

# An assertion of the program about itself never acts, a log is read by nobody's rule, room reserved changes
# nothing but time.
SILENT = re.compile(r"static_assert|RMLCELL_\w+|spdlog|reserve|shrink_to_fit|log_\w*|Log\w*")
COMPARISONS = {"==": "!=", "!=": "==", "<": ">", ">": "<", "<=": ">=", ">=": "<=", "&&": "||", "||": "&&"}
BOUNDS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
SIGNS = {"+": "-", "-": "+", "+=": "-=", "-=": "+=", "++": "--", "--": "++"}
# The order of their arguments is no matter.
SYMMETRIC = {"min", "max", "hypot", "swap", "tie", "Near", "Dot", "Distance", "DistanceXYZ", "Same", "SameXY", "Equal",
             "EqualIgnoringCase", "RampLength", "RampTime", "SlipOf"}
KEYWORDS = {"if", "for", "while", "switch", "return", "case", "do", "else", "throw", "using", "goto", "delete", "new",
            "const", "constexpr", "static", "auto", "struct", "class", "enum", "namespace", "template", "typedef",
            "public", "private", "protected", "default", "friend", "extern", "explicit", "inline", "operator", "try"}
ASSIGNMENTS = {"=", "+=", "-=", "*=", "/=", "%=", "|=", "&=", "^=", "<<=", ">>="}
OPEN, CLOSE = {"(": ")", "[": "]", "{": "}"}, {")", "]", "}"}


@dataclasses.dataclass(frozen=True)
class Place:
    """One change: the characters from begin to end of the file become `after`."""
    file: str
    line: int
    column: int
    kind: str
    begin: int
    end: int
    before: str
    after: str
    text: str  # the whole line, trimmed: what finds the place again when lines have moved

    def applied(self, source):
        # A change never moves a line: messages and assertions keep their numbers.
        gap = "\n" * (self.before.count("\n") - self.after.count("\n"))
        return source[:self.begin] + self.after + gap + source[self.end:]


@dataclasses.dataclass(frozen=True)
class Token:
    kind: str
    text: str
    begin: int

    @property
    def end(self):
        return self.begin + len(self.text)


def tokens(source):
    found = []
    for match in TOKEN.finditer(source):
        kind = next(name for name in ("comment", "directive", "string", "char", "number", "name", "sign")
                    if match.group(name) is not None)
        if kind not in ("comment", "directive"):
            found.append(Token(kind, match.group(), match.start()))
    return found


def partners(found):
    """Of each opening bracket the place of its closing one, and the reverse."""
    pairs, waiting = {}, []
    for index, token in enumerate(found):
        if token.kind != "sign":
            continue
        if token.text in OPEN:
            waiting.append(index)
        elif token.text in CLOSE and waiting:
            pairs[index] = waiting.pop()
            pairs[pairs[index]] = index
    return pairs


def silent_tokens(found, pairs):
    """Tokens inside the brackets of what SILENT names."""
    silent = set()
    for index, token in enumerate(found[:-1]):
        if token.kind == "name" and SILENT.fullmatch(token.text):
            end = index
            while end + 1 < len(found) and found[end + 1].text not in ("(", ";", "{", "}"):
                end += 1
            if end + 1 in pairs and found[end + 1].text == "(":
                silent.update(range(start_of_chain(found, pairs, index), pairs[end + 1] + 1))
    return silent


def start_of_chain(found, pairs, index):
    """The first token of `a.b[1]->name`, for that of `name`."""
    while index > 1 and found[index - 1].text in (".", "->", "::"):
        index -= 2
        while index > 0 and found[index].text in ("]", ")") and index in pairs:
            index = pairs[index] - 1
    return index


def number_after(text):
    """Another number of the same type."""
    digits = re.fullmatch(r"([\d']+)([uUlLzZ]*)", text)
    if digits:
        return str(int(digits.group(1).replace("'", "")) + 1) + digits.group(2)
    real = re.fullmatch(r"([\d.']+(?:[eE][-+]?\d+)?)([fF]?)", text)
    if not real:
        return None
    value = float(real.group(1).replace("'", ""))
    # A number written as 1e-9 is what rounding may do: twice as much is the same statement.
    factor = 1000 if "e-" in text.lower() else 2
    return repr(value * factor if value else 1.0) + real.group(2)


class Finder:
    def __init__(self, file, source):
        self.file = file
        self.source = source
        self.tokens = tokens(source)
        self.pairs = partners(self.tokens)
        self.silent = silent_tokens(self.tokens, self.pairs)
        self.places = []
        self.lines = source.split("\n")
        self.line_starts = [0] + [match.end() for match in re.finditer("\n", source)]
        self.codes = sorted({self.tokens[i + 2].text for i in range(len(self.tokens) - 2) if self.is_code(i)})

    def is_code(self, index):
        first, second, third = self.tokens[index:index + 3]
        return first.text == "ErrorCode" and second.text == "::" and third.text.startswith("k")

    def add(self, kind, begin, end, after):
        line = bisect.bisect_right(self.line_starts, begin)
        start = self.line_starts[line - 1]
        self.places.append(Place(self.file, line, begin - start + 1, kind, begin, end, self.source[begin:end], after,
                                 self.lines[line - 1].strip()))

    def find(self, error_codes=()):
        for index, token in enumerate(self.tokens):
            if index in self.silent:
                continue
            if token.kind == "sign":
                self.operator(token)
            elif token.kind == "number":
                after = number_after(token.text)
                if after:
                    self.add("constant", token.begin, token.end, after)
            elif token.text in ("true", "false"):
                self.add("constant", token.begin, token.end, "false" if token.text == "true" else "true")
            elif token.kind == "name" and index + 1 < len(self.tokens) and self.tokens[index + 1].text == "(":
                self.call(index)
            if index + 2 < len(self.tokens) and self.is_code(index):
                self.code(self.tokens[index + 2], error_codes)
            if self.begins_statement(index):
                self.statement(index)
        return self.places

    def operator(self, token):
        left, right = self.source[token.begin - 1], self.source[token.end:token.end + 1]
        if left in " \n" and right in " \n":
            if token.text in COMPARISONS:
                self.add("comparison", token.begin, token.end, COMPARISONS[token.text])
            if token.text in BOUNDS:
                self.add("bound", token.begin, token.end, BOUNDS[token.text])
            if token.text in ("+", "-", "+=", "-="):
                self.add("sign", token.begin, token.end, SIGNS[token.text])
        elif token.text == "-" and left in " (,=[{" and right not in " \n":
            self.add("sign", token.begin, token.end, "")
        elif token.text == "!" and right not in " \n=":
            self.add("comparison", token.begin, token.end, "")
        elif token.text in ("++", "--"):
            self.add("sign", token.begin, token.end, SIGNS[token.text])

    def code(self, token, error_codes):
        # Another code of the same file where it has one: what is near is what is mistaken.
        others = [code for code in self.codes if code != token.text] or [c for c in error_codes if c != token.text]
        if others:
            later = [code for code in others if code > token.text]
            self.add("error code", token.begin, token.end, (later or others)[0])

    def arguments(self, opening):
        """(first, last) token of each argument between the brackets."""
        found, first, index, closing = [], opening + 1, opening + 1, self.pairs[opening]
        while index < closing:
            if self.tokens[index].text in OPEN and index in self.pairs:
                index = self.pairs[index]
            elif self.tokens[index].text == ",":
                found.append((first, index - 1))
                first = index + 1
            index += 1
        if first <= closing - 1:
            found.append((first, closing - 1))
        return found

    def call(self, index):
        name = self.tokens[index].text
        if name in KEYWORDS or name in SYMMETRIC or index + 1 not in self.pairs:
            return
        found = [(self.tokens[a].begin, self.tokens[b].end) for a, b in self.arguments(index + 1) if a <= b]
        texts = [self.source[a:b] for a, b in found]
        # `Type name` and `Type& name`: a declaration.
        if any(re.search(r"^\s*const\b|[\w>][&*]*\s+[&*]?\w+$|[&*]$", text) for text in texts):
            return
        for at in range(len(found) - 1):
            if texts[at] != texts[at + 1] and "\n" not in self.source[found[at][0]:found[at + 1][1]]:
                between = self.source[found[at][1]:found[at + 1][0]]
                self.add("exchanged argument", found[at][0], found[at + 1][1], texts[at + 1] + between + texts[at])

    def begins_statement(self, index):
        if index == 0:
            return False
        before = self.tokens[index - 1].text
        if before in (";", "{", "}", "else"):
            return True
        return before == ")" and self.heads(index - 1)

    def heads(self, closing):
        """Whether the bracket belongs to an if, for or while."""
        opening = self.pairs.get(closing)
        if not opening:
            return False
        before = self.tokens[opening - 1].text
        return before in ("if", "for", "while") or (before == "constexpr" and self.tokens[opening - 2].text == "if")

    def statement(self, index):
        first = self.tokens[index]
        end = self.end_of_statement(index)
        if end is None:
            return
        if first.text in ("return", "break", "continue"):
            # Behind an if it is a guard; else the function would end without a value.
            if self.tokens[index - 1].text == ")" or first.text != "return":
                self.add("dropped statement", first.begin, self.tokens[end].end, ";")
        elif self.is_expression(index, end):
            self.add("dropped statement", first.begin, self.tokens[end].end, ";")

    def end_of_statement(self, index):
        while index < len(self.tokens):
            text = self.tokens[index].text
            if text == ";":
                return index
            if text in OPEN and index in self.pairs and text != "{":
                index = self.pairs[index]
            elif text == "{" and self.tokens[index - 1].text not in ("=", "return", ">") \
                    and self.tokens[index - 1].kind != "name":
                return None
            elif text == "{" and index in self.pairs:
                index = self.pairs[index]
            elif text == "}":
                return None
            index += 1
        return None

    def is_expression(self, index, end):
        if self.tokens[index].text in ("++", "--"):
            return True
        if self.tokens[index].text in KEYWORDS or self.tokens[index].kind != "name" or index in self.silent:
            return False
        # A chain of names, members, calls and subscripts, then an assignment or the end behind a call.
        while index < end:
            text = self.tokens[index].text
            if self.tokens[index].kind == "name":
                if self.tokens[index + 1].kind == "name":
                    return False
            elif text in ("(", "[") and index in self.pairs:
                index = self.pairs[index]
                if self.tokens[index + 1].text == ";":
                    return self.tokens[index].text == ")"
            elif text in ASSIGNMENTS or text in ("++", "--"):
                return True
            elif text not in ("::", ".", "->"):
                return False
            index += 1
        return False


def places_of(root, file, error_codes=()):
    source = (pathlib.Path(root) / file).read_text(encoding="utf-8")
    return Finder(file, source).find(error_codes)
