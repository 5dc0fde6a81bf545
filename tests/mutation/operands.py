"""Where the operands of an operator begin and end, found in the tokens of a source.

As in places.py the format of the house is relied on: a binary operator has a blank on both sides.
"""
import places

# As C++ ranks them; assignments bind last.
RANK = {"*": 10, "/": 10, "%": 10, "+": 9, "-": 9, "<<": 8, ">>": 8, "<=>": 7.5, "<": 7, ">": 7, "<=": 7, ">=": 7,
        "==": 6, "!=": 6, "&": 5, "^": 4, "|": 3, "&&": 2, "||": 1}
ENDS = {";", ",", ")", "]", "}"}
WORDS = ("name", "number", "string", "char")
UNARY = {"-", "!", "*", "&", "~", "+", "++", "--"}


class Operands:
    """Of one source. Operators and operands are given by the indices of their tokens."""

    def __init__(self, source):
        self.source = source
        self.tokens = places.tokens(source)
        self.pairs = places.partners(self.tokens)
        self.at = {token.begin: index for index, token in enumerate(self.tokens)}
        for index, token in enumerate(self.tokens):
            if token.text == "<" and index and self.tokens[index - 1].kind == "name" and not self.blank_before(index):
                self.pair_angles(index)

    def blank_before(self, index):
        return self.source[self.tokens[index].begin - 1] in " \n"

    def is_binary(self, index):
        token = self.tokens[index]
        after = self.source[token.end:token.end + 1]
        return token.kind == "sign" and token.text in RANK and self.blank_before(index) and after in (" ", "\n")

    def pair_angles(self, opening):
        """The bracket that closes the arguments of a template."""
        depth, index = 0, opening
        while index < len(self.tokens):
            text = self.tokens[index].text
            if text == "<":
                depth += 1
            elif text in (">", ">>") and not self.blank_before(index):
                depth -= len(text)
                if depth <= 0:
                    self.pairs[opening] = index
                    self.pairs[index] = min(self.pairs.get(index, opening), opening)
                    return
            elif text in places.OPEN and index in self.pairs:
                index = self.pairs[index]
            elif text in ENDS - {","}:
                return
            index += 1

    def closes_group(self, index):
        return self.tokens[index].text in (")", "]", "}") or self.tokens[index].text in (">", ">>") and index in self.pairs

    def begin_of_left(self, operator, rank):
        """The first token of what stands left of a binary operator or assignment; None: not found."""
        first, index = operator, operator - 1
        while index >= 0:
            token = self.tokens[index]
            if first < operator and self.stands_before(index, first):
                break
            if token.kind == "name" and token.text in places.KEYWORDS:
                break
            if self.closes_group(index):
                if index not in self.pairs:
                    return None
                index = self.pairs[index]
            elif token.text in ENDS or token.text in "?:{([" or token.text in places.ASSIGNMENTS:
                break
            elif self.is_binary(index) and RANK[token.text] < rank:
                break
            first = index
            index -= 1
        return first if first < operator else None

    def stands_before(self, index, first):
        """Whether the token ends what comes before the expression that begins with `first`."""
        token, begin = self.tokens[index], self.tokens[first]
        if begin.kind in WORDS:
            return token.kind in WORDS and {token.kind, begin.kind} != {"string"} or self.closes_group(index)
        if token.text == "}":
            return begin.text in ("(", "*", "++", "--", "[", "{", "!")
        return token.text == ")" and begin.text in ("*", "++", "--", "!") and not self.is_binary(first)

    def end_of_right(self, operator, rank):
        """The last token of what stands right of a binary operator; of an assignment with rank 0."""
        last, index = None, operator + 1
        while index < len(self.tokens):
            text = self.tokens[index].text
            if text in ENDS:
                break
            if rank and (text in ("?", ":") or text in places.ASSIGNMENTS
                         or self.is_binary(index) and RANK[text] <= rank):
                break
            if text in places.OPEN or text == "<" and index in self.pairs:
                if index not in self.pairs:
                    return None
                index = self.pairs[index]
            last = index
            index += 1
        return last

    def end_of_unary(self, operator):
        """The last token of what a sign or ! in front of it applies to."""
        index, last = operator + 1, None
        while self.tokens[index].text in UNARY:
            index += 1
        while index < len(self.tokens):
            token = self.tokens[index]
            if token.kind in WORDS and (last is None or self.tokens[last].text in ("::", ".", "->")):
                last = index
            elif token.text in ("::", ".", "->"):
                last = index
            elif token.text in places.OPEN and self.belongs_to_unary(index, last) or \
                    token.text == "<" and index in self.pairs:
                index = last = self.pairs[index]
            else:
                break
            index += 1
        return last

    def belongs_to_unary(self, index, last):
        if index not in self.pairs or last is None:
            return self.tokens[index].text == "(" and index in self.pairs
        return not self.blank_before(index)

    def begin_of_postfix(self, operator):
        """The first token of what ++ or -- behind it applies to."""
        index = operator - 1
        while True:
            token = self.tokens[index]
            if token.text in (")", "]") and index in self.pairs:
                index = self.pairs[index] - 1
                if self.tokens[index].kind != "name" and self.tokens[index].text not in (")", "]"):
                    return index + 1
            elif token.kind != "name":
                return None
            elif self.tokens[index - 1].text in (".", "->", "::"):
                index -= 2
            else:
                return index
