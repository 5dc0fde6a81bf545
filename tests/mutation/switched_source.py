"""A source with all its changes at once, each asleep until the environment names it (changes.h)."""
import collections

from operands import RANK, Operands

ORDERS = {"<": "kLess", ">": "kGreater", "<=": "kLessEqual", ">=": "kGreaterEqual", "==": "kEqual", "!=": "kUnequal"}
CALLS = {"+": "Add", "-": "Subtract", "+=": "AddTo", "-=": "SubtractFrom"}
STEPS = {"++": ("Next", "ThenNext"), "--": ("Previous", "ThenPrevious")}


class SwitchedSource:
    """`numbers` gives the number of each place that is to be switched. `text` is the source made of it, `switched`
    holds the numbers of those that could be, `marks` says where in the text each stands."""

    def __init__(self, source, numbers):
        self.source = source
        self.operands = Operands(source)
        self.around = []  # (begin, end, text before, text behind, number): what is put around a stretch
        self.instead = {}  # begin: (end, text, number): what stands in place of a token
        self.switched = set()
        self.orders = collections.defaultdict(dict)
        self.arguments = collections.defaultdict(list)
        for place, number in numbers.items():
            if place.begin in self.operands.at:
                self.switch(place, number, self.operands.at[place.begin])
        self.compare()
        self.exchange()
        self.text, self.marks = self.written()

    def switch(self, place, number, index):
        text = self.operands.tokens[index].text
        if text in ORDERS and place.kind in ("comparison", "bound"):
            self.orders[index][place.kind] = number
        elif place.kind == "comparison":
            self.both_or_either(index, number) if text != "!" else self.negate(index, number)
        elif place.kind == "sign":
            self.sign(index, number)
        elif place.kind == "constant":
            self.replace(index, f"({on(number)} ? {place.after} : {place.before})", number)
        elif place.kind == "error code":
            self.error_code(place, index, number)
        elif place.kind == "dropped statement":
            self.put_around(place.begin, place.end, f"{{ if (!{on(number)}) ", " }", number)
        else:
            self.argument(place, index, number)

    def put_around(self, begin, end, before, behind, number):
        self.around.append((begin, end, before, behind, number))
        self.switched.add(number)

    def replace(self, index, text, number):
        token = self.operands.tokens[index]
        self.instead[token.begin] = (token.end, text, number)
        self.switched.add(number)

    def stretch(self, first, last):
        """From the first character of one token to behind the last of another; None where one is not known."""
        if first is None or last is None:
            return None
        return self.operands.tokens[first].begin, self.operands.tokens[last].end

    def of_binary(self, index, rank):
        return self.stretch(self.operands.begin_of_left(index, rank), self.operands.end_of_right(index, rank))

    def call(self, stretch, index, begin, number, between=","):
        if stretch:
            self.put_around(*stretch, f"changes::{begin}", ")", number)
            self.replace(index, between, number)

    def of_both(self, stretch, index, method, number):
        # In braces what stands left is evaluated first, as with the operator; arguments have no order.
        if stretch:
            self.put_around(*stretch, "changes::Operands{", f"}}.{method}", number)
            self.replace(index, ",", number)

    def compare(self):
        for index, kinds in self.orders.items():
            text = self.operands.tokens[index].text
            stretch = self.of_binary(index, RANK[text])
            contrary, bound = kinds.get("comparison", 0), kinds.get("bound", 0)
            self.of_both(stretch, index, f"Compare(changes::Is<changes::Order::{ORDERS[text]}>(), {contrary}, {bound})", max(kinds.values()))
            if stretch:
                self.switched.update(kinds.values())

    def both_or_either(self, index, number):
        # a || b is !(!a && !b): with all three turned the one becomes the other.
        text = self.operands.tokens[index].text
        stretch = self.of_binary(index, RANK[text])
        if stretch:
            turned = f"({on(number)} != static_cast<bool>("
            self.put_around(*stretch, f"({on(number)} != ({turned}", "))))", number)
            self.replace(index, f")) {text} {turned}", number)

    def negate(self, index, number):
        stretch = self.stretch(index, self.operands.end_of_unary(index))
        if stretch:
            self.put_around(*stretch, f"({on(number)} == static_cast<bool>(", "))", number)
            self.replace(index, "", number)

    def sign(self, index, number):
        token = self.operands.tokens[index]
        if token.text in STEPS:
            before = self.operands.tokens[index - 1]
            behind = before.end == token.begin and (before.kind == "name" or before.text in (")", "]"))
            name = STEPS[token.text][behind]
            stretch = self.stretch(self.operands.begin_of_postfix(index), index) if behind else \
                self.stretch(index, self.operands.end_of_unary(index))
            self.call(stretch, index, f"{name}({number}, ", number, "")
        elif token.text in ("+=", "-="):
            self.call(self.of_binary(index, 0), index, f"{CALLS[token.text]}({number}, ", number)
        elif self.operands.is_binary(index):
            self.of_both(self.of_binary(index, RANK[token.text]), index, f"{CALLS[token.text]}({number})", number)
        else:
            stretch = self.stretch(index, self.operands.end_of_unary(index))
            self.call(stretch, index, f"Negative({number}, ", number, "")

    def error_code(self, place, index, number):
        first = index - 2
        while self.operands.tokens[first - 1].text == "::":
            first -= 2
        begin = self.operands.tokens[first].begin
        scope = self.source[begin:place.begin]
        self.put_around(begin, place.end, f"({on(number)} ? {scope}{place.after} : ", ")", number)

    def argument(self, place, index, number):
        """Two neighbouring arguments, each of which may stand for the other."""
        tokens = self.operands.tokens
        while tokens[index].text != ",":
            if index in self.operands.pairs and self.operands.pairs[index] > index:
                index = self.operands.pairs[index]
            index += 1
            if index >= len(tokens) or tokens[index].begin >= place.end:
                return
        one, other = (place.begin, tokens[index - 1].end), (tokens[index + 1].begin, place.end)
        self.arguments[one].append((number, other))
        self.arguments[other].append((number, one))
        self.switched.add(number)

    def exchange(self):
        for (begin, end), others in self.arguments.items():
            choice = "".join(f"{on(number)} ? {self.source[slice(*other)]} : " for number, other in others)
            self.around.append((begin, end, "(" + choice, ")", others[0][0]))

    def written(self):
        """The text, and (begin, end, number) of what was put into it."""
        before, behind = collections.defaultdict(list), collections.defaultdict(list)
        # The wider stretch stands outside; of equal ones the last, since arguments are put around what is in them.
        for order, (begin, end, opening, closing, number) in enumerate(self.around):
            before[begin].append((-end, -order, opening, number))
            behind[end].append((-begin, order, closing, number))
        points = sorted({0, len(self.source), *before, *behind, *self.instead})
        parts, marks, size = [], [], 0
        for point, following in zip(points, [*points[1:], len(self.source)]):
            put = [*sorted(behind[point]), *sorted(before[point])]
            begin = point
            if point in self.instead:
                begin, text, number = self.instead[point]
                put.append((0, 0, text, number))
            for _, _, text, number in put:
                marks.append((size, size + len(text), number))
                parts.append(text)
                size += len(text)
            parts.append(self.source[begin:max(begin, following)])
            size += len(parts[-1])
        return "".join(parts), [mark for mark in marks if mark[0] < mark[1]]


def on(number):
    return f"changes::On({number})"
