"""Random input of the tools: sources in a layout of their own, contours with an allowance, G-code, pictures of circuit
boards, and programs that somebody broke. All follow from the dice."""
import math
import re
import struct
import zlib

from programs import OptimoWriter

COMMENTS = ("", "", "", " ; cut", " ;x", "; (Y-10)", " ; -- 100 %")
TOKENS = ("MOVE", "WORK", "/FLY", "/NEXT", "THEN", "IF", "(", ")", ",", "[", "]", "=", "+", "-", "*", "/", ".5", "1e9",
          "VR[1]", "VI[0]", "VL[120]", "OL[300]", "IA[9]", "ON", "\t", ";", "\"", "_", "99999999999", "-32769", "GOTO", "CALL 100",
          "ENDTASK", "RETURN", "PATH CIR", "COORD", "#", "$", "NOT", "MOD", "0.", "SYSDEF", "WORKDEF 2,0 (64)", "DELAY", "/TIME")
BYTES = (";", ",", "-", "PD", "PU", "!", "^", "9999999", "Z", "VS0;", "!VZ", "^IN;", "H;", "0.5", "!MC", "\x1b.(", " ", "\x00",
         "!ZZ1,2;", "PA", "PR", "M", "D10;", "!PZ;", "!RC99;", "@", "W70000;")


def loose(dice, text):
    """The same program as somebody might type it."""
    out = []
    for line in text.splitlines():
        if dice.random() < 0.15:
            line = line.lower() if dice.random() < 0.5 else line.title()
        if dice.random() < 0.2:
            line = re.sub(r"([,+*=])", r" \1  " if dice.random() < 0.5 else r"\1 ", line)
        if dice.random() < 0.2:
            line = " " * dice.randrange(1, 5) + line
        out.append(line + dice.choice(COMMENTS))
        if dice.random() < 0.08:
            out.append(dice.choice(("", "  ", "; ----", ";$name=part 1")))
    return dice.choice(("\n", "\n", "\r\n")).join(out) + dice.choice(("\n", ""))


def broken(dice, text, tokens):
    """With one to three slips of the hand."""
    for _ in range(dice.randrange(1, 4)):
        at = dice.randrange(len(text))
        kind = dice.randrange(5)
        if kind == 0:
            text = text[:at] + text[at + 1:]
        elif kind == 1:
            text = text[:at] + dice.choice(tokens) + text[at:]
        elif kind == 2:
            text = text[:at] + text[at:at + 6] + text[at:]
        elif kind == 3:
            lines = text.splitlines(keepends=True)
            one, other = dice.randrange(len(lines)), dice.randrange(len(lines))
            lines[one], lines[other] = lines[other], lines[one]
            text = "".join(lines)
        else:
            numbers = list(re.finditer(r"\d+", text))
            if numbers:
                found = dice.choice(numbers)
                number = dice.choice(("0", "1", "7", "64", "99", "100", "127", "128", "255", "800", "32767", "32768", "1000000"))
                text = text[:found.start()] + number + text[found.end():]
        text = text or ";"
    return text


def changed(dice, text):
    """A later state of a program: lines that went, came, or have another number."""
    lines = text.splitlines()
    for _ in range(dice.randrange(1, 5)):
        at = dice.randrange(len(lines))
        kind = dice.randrange(3)
        if kind == 0 and len(lines) > 2:
            del lines[at]
        elif kind == 1:
            lines.insert(at, OptimoWriter(dice, 8, False).statement())
        else:
            lines[at] = re.sub(r"\d+\.\d+", lambda m: f"{float(m.group()) + dice.choice((0.5, 1e-4, -3.0)):.4f}", lines[at], count=1)
    return "\n".join(lines) + "\n"


def contour(dice):
    """A contour with an allowance to one side."""
    def number(low, high):
        return f"{dice.uniform(low, high):.{dice.randrange(1, 4)}f}"

    head = f"{dice.choice((0, 0, 1.570796, 0.3))},{dice.choice((0, 0, 1.570796, -0.2))}"
    out = [f";${dice.choice(('dia', 'rad', 'DIA'))}={number(0.05, 3)}", f";${dice.choice(('left', 'right', 'Sleft', 'none'))}",
           "PATH LIN", f"MOVE (0.,0.,{number(-5, 5)},{head})", "WORK 0,0/ON"]
    x, y, way = 0.0, 0.0, dice.uniform(0, 6.28)
    for _ in range(dice.randrange(1, 14)):
        chance = dice.random()
        if chance < 0.07:
            out.append(dice.choice(("PATH LIN", "PATH CIR", f"PATH HOLE ({number(1, 20)})")))
        elif chance < 0.1:
            out.append(dice.choice((";$left", ";$right", ";$none", f";$rad={number(0.1, 2)}", "VR[1]=5.", "DELAY .2", "PATH PTP")))
        else:
            way += dice.gauss(0, 0.8)
            length = dice.uniform(4, 40)
            between = f"({x + 0.4 * length * math.cos(way):.3f},{y + 0.6 * length * math.sin(way):.3f},0.,{head})"
            x, y = x + length * math.cos(way), y + length * math.sin(way)
            spot = f"({x:.3f},{y:.3f},{number(-3, 3)},{head})"
            via = f"/VIA {between}" if dice.random() < 0.25 else ""
            out.append(f"MOVE {spot}{via}" + dice.choice(("/FLY", "/FLY", "")) + dice.choice(COMMENTS))
    out.append(dice.choice(("WORK 0,0/OFF", "WORK 0,0/OFF", "ENDTASK")))
    return "\n".join(out) + "\n"


def gcode(dice):
    """What a post processor writes, and now and then what it should not."""
    def place(low=0.0, high=120.0):
        return f"{dice.uniform(low, high):.{dice.randrange(4)}f}"

    def arc():
        way = dice.choice(("G2", "G3", "G02", "g3"))
        if dice.random() < 0.3:
            x, y, to_x, to_y = (dice.choice(here) for _ in range(4))
            radius = math.hypot(to_x - x, to_y - y) / 2 + dice.choice((0.01, 1, 1, 20, 20, -1))
            return f"G17\nG1 X{x} Y{y}\n{way} X{to_x} Y{to_y} R{dice.choice(('', '', '-'))}{radius:.3f}"
        x, y, radius = dice.choice(here), dice.choice(here), dice.uniform(0.5, 30)
        begin, turn = dice.uniform(0, 6.28), dice.choice((1.5707963, 3.1415926, 6.2831853, dice.uniform(0.1, 6)))
        i, j = -radius * math.cos(begin), -radius * math.sin(begin)
        end = begin + (turn if "3" in way else -turn)
        to = f"X{x + i + radius * math.cos(end):.3f} Y{y + j + radius * math.sin(end):.3f}"
        if dice.random() < 0.05:
            to = dice.choice((f"X{x} Y{y}", to + f" Z-{place(0, 3)}", f"X{place()}"))
        return f"G17\nG1 X{x} Y{y}\n{way} {to} I{i:.3f} J{j:.3f}"

    here = (10, 20, 30, 40)
    out = ["%"] if dice.random() < 0.3 else []
    out += [dice.choice(("G21", "G21 G90 G94", "G20", "G90")), f"S{dice.randrange(500, 15000)} M3", f"G0 Z{place(1, 10)}",
            f"G0 X{dice.choice(here)} Y{dice.choice(here)}", f"F{dice.randrange(30, 900)}"]
    for _ in range(dice.randrange(4, 40)):
        out.append(dice.choice((
            lambda: f"G1 X{place()} Y{place()}", lambda: f"G1 X{place()}\nX{place()}", lambda: f"G1 Z-{place(0, 3)} F{dice.randrange(20, 400)}",
            lambda: f"G0 X{dice.choice(here)} Y{dice.choice(here)}", arc, arc, lambda: f"G1 X{place()} Y{place()} Z-{place(0, 4)}",
            lambda: f"G0 Z{place(0, 20)}", lambda: f"G4 P{place(0, 3)}", lambda: dice.choice(("G17", "G18", "G19")),
            lambda: f"N{dice.randrange(9999)} G1 Y{place()} (side)", lambda: f"S{dice.randrange(500, 15000)}",
            lambda: dice.choice(("M0", "M5", "M3", "M8", "M9", "G54", "G64 P0.01", "G28 G91 Z0\nG90")),
            lambda: "; " + place()))())
        if dice.random() < 0.006:
            out.append(dice.choice(("G41 D1", "G91", "G81 R2 Z-3", "X1 X2", "M98 P4", "T1 M6", "G1 X#1", "G2 X1 Y1", "Q4", "G1 X", "G28", "(open")))
    out.append(dice.choice(("M30", "M2", "M5\nM30", "%")))
    return "\n".join(out) + "\n"


def picture(dice):
    """A small PNG, grey or black and white: rectangles, discs and lines on black."""
    width, height = dice.randrange(20, 90), dice.randrange(20, 90)
    rows = [bytearray(width) for _ in range(height)]
    for _ in range(dice.randrange(1, 7)):
        x, y, size = dice.randrange(width), dice.randrange(height), dice.randrange(2, 30)
        kind, value = dice.randrange(3), 255 if dice.random() < 0.8 else dice.randrange(256)
        for row in range(height):
            for column in range(width):
                dx, dy = column - x, row - y
                inside = (0 <= dx < size and 0 <= dy < 12) if kind == 0 else \
                    dx * dx + dy * dy < size * size / 4 if kind == 1 else abs(dx - dy) < 4 and abs(dx) < size
                if inside:
                    rows[row][column] = value
    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    out = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0))
    if dice.random() < 0.7:
        metre = dice.choice((1000, 1969, 3937, 11811))
        out += chunk(b"pHYs", struct.pack(">IIB", metre, metre, 1))
    return out + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b"")
