"""Programs of both families to simulate with two builds: real ones, the examples of the tests, and random ones.

A random program follows from its number alone, on every machine: Python's Random with an integer seed is the
same everywhere.
"""
import csv
import dataclasses
import random

from trials import ROOT, Trial

RANDOM_OPTIMO = 1000
RANDOM_RML1 = 1000


@dataclasses.dataclass
class Program:
    name: str  # unique: "random/optimo/17"
    file_name: str
    text: bytes
    inputs: str = ""  # an input file; empty: none
    words: tuple = ()  # further words for `simulate`
    others: tuple = ()  # further programs of the memory: (file name, bytes)

    def trial(self):
        """Findings of `check` as JSON; report, trace and exit status of `simulate` as JSON and as facts; samples, picture
        and toolpath."""
        given = [(self.file_name, self.text), *self.others]
        inputs = []
        if self.inputs:
            given.append(("inputs.txt", self.inputs.encode()))
            inputs = ["--inputs", "inputs.txt"]
        files = [self.file_name, *(name for name, _ in self.others)]
        slots = [word for name, _ in self.others for word in ("--slot", f"{name.removesuffix('.S')}={name}")]
        main = ["--main", "1"] if slots else []
        family = ["--family", "optimo" if self.file_name.upper().endswith((".S", ".SI", ".CMP")) else "rml1"]
        run = ["simulate", self.file_name, *slots, *main, *family, *inputs, *self.words]
        return Trial(self.name, tuple(given),
                     (("check", *files, "--json", *family, *inputs), (*run, "--json", "--trace"),
                      (*run, "--facts", "--samples", "20", "samples.csv", "--svg", "path.svg", "--toolpath", "path.blocks")),
                     ("samples.csv", "path.svg", "path.blocks"))


def all_programs(shared):
    yield from real_programs(shared)
    yield from example_programs()
    for number in range(RANDOM_OPTIMO):
        yield random_optimo(number)
    for number in range(RANDOM_RML1):
        yield random_rml1(number)


def real_programs(shared):
    for path in sorted((shared / "corpus").rglob("*")) if shared else ():
        if path.suffix.lower() in (".s", ".si", ".cmp", ".rml", ".prn"):
            yield Program(f"corpus/{path.parent.name}/{path.name}", path.name, path.read_bytes())


def example_programs():
    tests = ROOT / "tests" / "conformance"
    for path in sorted((tests / "optimo").rglob("*.S")):
        yield Program(f"conformance/{path.relative_to(tests)}", path.name, path.read_bytes())
    with open(tests / "rml1_examples.csv", encoding="utf-8", newline="") as file:
        for number, row in enumerate(csv.DictReader(file), 2):
            stream = row.get("input") or ""
            if stream:
                yield Program(f"conformance/rml1/line {number}", "example.rml", stream.encode())
    for path in sorted((ROOT / "deploy" / "examples").rglob("*")):
        if path.suffix in (".S", ".rml"):
            yield Program(f"examples/{path.name}", path.name, path.read_bytes())


def input_script(dice, family):
    """What happens from outside, at random times of the first half minute."""
    if dice.random() < 0.4:
        return ""
    lines = []
    for _ in range(dice.randrange(1, 9)):
        at = f"{dice.uniform(0.0, 30.0):.3f}"
        kind = dice.randrange(8)
        if kind == 0:
            lines.append(f"{at} STOP")
        elif kind == 1:
            lines.append(f"{at} HOLD")
        elif kind == 2:
            lines.append(f"{at} OVERRIDE = {dice.choice((10, 25, 40, 55, 70, 85, 100, 115, 130, 145))}")
        elif kind == 3 and family == "optimo":
            lines.append(f"{at} DOOR = {dice.choice(('OPEN', 'CLOSED'))}")
        elif kind == 4 and family == "optimo":
            lines.append(f"{at} IA[{dice.randrange(5)}] = {dice.uniform(-10.0, 10.0):.2f}")
        elif kind in (5, 6) and family == "optimo":
            lines.append(f"{at} IL[{20 + dice.randrange(3)}] = {dice.randrange(2)}")
        else:
            lines.append(f"{at} START")
    for at in range(31, 120, 8):  # what was halted goes on
        lines.append(f"{at} START")
    return "\n".join(lines) + "\n"


def run_words(dice, steps, family):
    words = ["--budget", "steps=3000,time=300"]
    if dice.random() < 0.3:
        words += ["--override", str(dice.choice((10, 40, 85, 130)))]
    if dice.random() < 0.2:
        words += ["--mode", dice.choice(("remote", "single", "repeat"))]
    if dice.random() < 0.15:
        words += ["--break", f"1/{dice.randrange(1, steps + 1)}"]
    if family == "optimo" and dice.random() < 0.15:
        words += ["--simul", f"1/{dice.randrange(1, steps + 1)}"]
    return tuple(words)


class OptimoWriter:
    """Statements that are right in their form; what they do together is left to chance."""

    def __init__(self, dice, lines, main):
        self.dice, self.lines, self.main = dice, lines, main

    def number(self, low, high):
        return f"{self.dice.uniform(low, high):.{self.dice.randrange(4)}f}".rstrip("0").rstrip(".") + "."

    def real(self, low, high):
        text = f"{self.dice.uniform(low, high):.3f}"
        return text

    def point(self):
        head = f"{self.real(-0.4, 0.4)},{self.real(-0.3, 0.3)}" if self.dice.random() < 0.3 else "0.,0."
        return f"({self.real(900, 1100)},{self.real(900, 1100)},{self.real(-450, -400)},{head})"

    def condition(self):
        return self.dice.choice((f"IL[{20 + self.dice.randrange(3)}]", "NOT IL[95]",
                                 f"VI[7] > {self.dice.randrange(4)}", "VL[1] XOR IL[87]",
                                 f"VR[1] / VR[{1 + self.dice.randrange(3)}] < 2.", "ON"))

    def expression(self, depth=0):
        if depth > 2 or self.dice.random() < 0.4:
            return self.dice.choice((self.real(-9, 9), f"VR[{self.dice.randrange(5)}]", "PI",
                                     f"VI[{2 + self.dice.randrange(6)}]", str(self.dice.randrange(9)),
                                     f"IA[{self.dice.randrange(5)}]"))
        one, other = self.expression(depth + 1), self.expression(depth + 1)
        return self.dice.choice((f"({one})", f"({one})+({other})", f"({one})-({other})", f"({one})*({other})",
                                 f"({one})/({other})", f"({one}) MOD ({other})", f"SIN({one})", f"COS({one})",
                                 f"ATAN({one})", f"SQRT(ABS({one}))", f"INT({one})", f"EXP(SIN({one}))"))

    def label(self):
        return 10 * (1 + self.dice.randrange(self.lines // 4 + 2))

    def move(self):
        text = f"MOVE {self.point()}"
        if self.dice.random() < 0.15:
            text += f"/VIA {self.point()}"
        if self.dice.random() < 0.55:
            text += "/FLY"
        for attribute in (f"/START ({self.condition()})", f"/END ({self.condition()})",
                          f"/TIME (.{1 + self.dice.randrange(9)},800)", "/NEXT"):
            if self.dice.random() < 0.08:
                text += attribute
        return text

    def work(self):
        text = f"WORK {self.dice.randrange(3)},0/{self.dice.choice(('ON', 'OFF'))}"
        for attribute, share in ((f"/START ({self.condition()})", 0.15), (f"/END ({self.condition()})", 0.15), ("/NEXT", 0.3)):
            if self.dice.random() < share:
                text += attribute
        return text

    def work_definition(self, kind=None):
        kind = self.dice.randrange(3) if kind is None else kind
        if kind == 0:
            return "WORKDEF 0,0"
        if kind == 2:
            return f"WORKDEF 2,0 ({self.dice.randrange(11, 64)})"
        return f"WORKDEF 1,0 ({self.real(1, 20)},{self.real(10, 100)},{self.real(0, 2)},{self.real(50, 100)})"

    def statement(self):
        dice = self.dice
        kinds = [(10, self.move), (3, self.work),
                 (1, lambda: f"SPEED {dice.randrange(1, 101)}"), (1, lambda: f"OVERSH {dice.randrange(101)}"),
                 (1, lambda: f"ACCEL {dice.randrange(1, 101)}"),
                 (2, lambda: "PATH " + dice.choice(("LIN", "LIN", "CIR", "HOLE (8.)", "PTP"))),
                 (0.5, lambda: "COORD " + dice.choice(("ROBOT", "ABSOL", "ABSOL", "ABSOL"))),
                 (1, lambda: f"DELAY .{dice.randrange(9)}"),
                 (2, lambda: f"VR[{dice.randrange(5)}]={self.expression()}"),
                 (1, lambda: f"VI[{2 + dice.randrange(6)}]=INT({self.expression()})"),
                 (1, lambda: f"OL[16]={dice.choice(('ON', 'OFF', 'NOT OL[16]'))}"),
                 (1, lambda: f"VL[{dice.randrange(3)}]={self.condition()}"),
                 (1, lambda: f"IF {self.condition()} THEN {self.label()}"), (1, lambda: "GOSUB 800"),
                 (0.5, lambda: f"GOTO {self.label()}"),
                 (0.5, lambda: f"TIMER (.{1 + dice.randrange(9)},800)" + dice.choice(("", "/AUTO"))),
                 (0.5, lambda: f"SYSDEF ({self.real(0, 50)},0,0,{self.real(-0.2, 0.2)},0,0)"),
                 (0.5, lambda: f"TCP (0,0,{self.real(0, 20)}/0,0,0)"),
                 (0.3, lambda: "STOP"), (0.3, lambda: f"WAIT ({self.condition()})"),
                 (0.3, self.work_definition),
                 (0.3, lambda: "UPDATE OL /" + dice.choice(("ON", "OFF"))), (0.2, lambda: "ZERO"),
                 (0.3, lambda: "SETERR 800")]
        if self.main:
            kinds += [(0.5, lambda: f"CALL {2 + dice.randrange(3)}"), (0.5, lambda: f"FUNCTION {2 + dice.randrange(3)}")]
        return dice.choices([make for _, make in kinds], [weight for weight, _ in kinds])[0]()

    def program(self):
        out = ["COORD ABSOL", "PATH LIN", f"SPEED {self.dice.randrange(5, 101)}"]
        out += [self.work_definition(kind) for kind in range(3)]
        out += [f"VR[{n}]={n + 1}." for n in range(5)]  # a division finds something
        for n in range(self.lines):
            label = f"{10 * (n // 4)} " if n % 4 == 0 and n > 0 else ""
            out.append(label + self.statement())
        out += ["ENDTASK" if self.main else "RETURN", "800 VI[3]=VI[3]+1", "RETURN"]
        return "\n".join(out) + "\n"


def random_optimo(number):
    dice = random.Random(f"optimo {number}")
    lines = dice.randrange(3, 40)
    text = OptimoWriter(dice, lines, True).program()
    others = tuple((f"{slot}.S", OptimoWriter(dice, dice.randrange(2, 10), False).program().encode()) for slot in (2, 3, 4))
    return Program(f"random/optimo/{number}", "1.S", text.encode(), input_script(dice, "optimo"),
                   run_words(dice, lines, "optimo"), others)


def random_rml1(number):
    dice = random.Random(f"rml1 {number}")
    mode1 = dice.random() < 0.3
    out = ["^IN;" if mode1 else "IN;", f"!MC{dice.randrange(2)};"]

    def xy():
        return f"{dice.randrange(0, 8000)},{dice.randrange(0, 6000)}"

    def some(make, most=4):
        return ",".join(make() for _ in range(dice.randrange(1, most)))

    for _ in range(dice.randrange(3, 60)):
        common = [lambda: f"!DW{dice.randrange(2000)};", lambda: f"!PZ{dice.randrange(-500, 0)},{dice.randrange(0, 500)};",
                  lambda: f"!RC{dice.randrange(0, 16)};", lambda: f"!VZ{dice.uniform(0.1, 15):.1f};",
                  lambda: f"!ZM{dice.randrange(-600, 0)};", lambda: f"!ZO{dice.randrange(-300, 1)};",
                  lambda: f"!MC{dice.randrange(2)};", lambda: "!NR;", lambda: f"!ZZ{xy()},{dice.randrange(-400, 300)};"]
        if mode1:
            own = [lambda: f"D{some(xy)};", lambda: f"M{some(xy)};", lambda: f"Z{xy()},{dice.randrange(-400, 300)};",
                   lambda: f"I{dice.randrange(-300, 300)},{dice.randrange(-300, 300)};",
                   lambda: f"R{dice.randrange(-300, 300)},{dice.randrange(-300, 300)};", lambda: f"V{dice.uniform(0.5, 20):.1f};",
                   lambda: f"F{dice.uniform(0.5, 20):.1f};", lambda: f"W{dice.randrange(1000)};", lambda: "H;",
                   lambda: f"@{dice.randrange(100)},{dice.randrange(100)};"]
        else:
            own = [lambda: f"PD{some(xy)};", lambda: f"PU{some(xy)};", lambda: f"PA{xy()};", lambda: "PR;", lambda: "PA;",
                   lambda: f"PR{dice.randrange(-300, 300)},{dice.randrange(-300, 300)};", lambda: f"VS{dice.uniform(0.5, 20):.1f};",
                   lambda: f"Z{xy()},{dice.randrange(-400, 300)};", lambda: "DF;"]
        out.append(dice.choice(own + own + own + common)())
        if dice.random() < 0.01:
            out.append(dice.choice(("QX9;", "PD1,;", "VS999;", "\x1b.(", "PD" + "9" * 12 + ",1;")))
    out.append("!MC0;" + ("H;" if mode1 else "PU0,0;"))
    words = run_words(dice, len(out), "rml1")
    if dice.random() < 0.4:
        words += ("--profile", dice.choice(("srm-20", "mdx-20", "mdx-15", "mdx-540")))
    if dice.random() < 0.3:
        words += ("--stock", "200x150x20", "--tool", dice.choice(("flat:3", "ball:2", "vee:6:60")), "--cell", "1")
    return Program(f"random/rml1/{number}", "p.rml", dice.choice(("", "\n", " ")).join(out).encode("latin-1"),
                   input_script(dice, "rml1"), words)
