"""The tools that work on texts and streams, the editor's server, what is milled out of a block, texts for people, and
wrong use: each with random input that follows from its number alone."""
import json
import random
import re

from programs import OptimoWriter, example_programs, random_optimo, random_rml1
from tool_programs import BYTES, TOKENS, broken, changed, contour, gcode, loose, picture
from trials import Trial

EACH = 250
MILLS = ("srm-20", "mdx-20", "mdx-15", "mdx-40a", "mdx-540", "pnc-3200", "mdx-50")


def all_tool_trials():
    makers = {"text": text_tools, "difference": differences, "contour": allowances, "stream": stream_tools, "gcode": from_gcode, "board": boards,
              "material": material, "editor": editor, "broken": broken_programs, "shown": shown}
    for name, make in makers.items():
        for number in range(EACH):
            dice = random.Random(f"{name} {number}")
            files, runs, products, *spoken = make(dice)
            yield Trial(f"{name}/{number}", tuple(files), tuple(tuple(map(str, words)) for words in runs), tuple(products), *spoken)
    yield from wrong_use()


def source(dice):
    return loose(dice, OptimoWriter(dice, dice.randrange(3, 30), True).program())


def text_tools(dice):
    text = source(dice)
    if dice.random() < 0.2:
        text = broken(dice, text, TOKENS)
    function = OptimoWriter(dice, 6, False).program()
    vector = [f"{dice.uniform(-200, 200):.3f}" for _ in range(3)]
    turn = [f"{dice.uniform(-2, 2):.4f}" if dice.random() < 0.6 else "0" for _ in range(3)]
    return ([("1.S", text.encode()), ("plain.S", text.encode()), ("fixed.S", text.encode()),
             *((f"{n}.S", function.encode()) for n in (2, 3, 4))],
            [("format", "--check", "1.S"), ("format", "plain.S"), ("compile", "1.S", "--map"), ("compile", "plain.S", "-o", "2.O", "--json"),
             ("decompile", "1.O"), ("decompile", "2.O"), ("link", "1.S", "--slot", "2=2.S", "--slot", "3=3.S", "--slot", "4=4.S", "--main", "1"),
             ("convert", "1.S"), ("convert", "1.SI", "back.S"), ("list", "1.S"), ("transform", "1.S", "--move", ",".join(vector), "--turn", ",".join(turn)),
             ("transform", "1.S", "--shift", ",".join(vector + turn)), ("check", "1.S", "--fix", "--dry-run"), ("check", "fixed.S", "--fix")],
            ("plain.S", "1.O", "1.MAP", "2.O", "1.X", "1.SI", "back.S", "fixed.S"))


def differences(dice):
    text = straight(source(dice))
    later = straight(changed(dice, text))
    return ([("old.S", text.encode()), ("new.S", later.encode())],
            [("diff", "old.S", "new.S", "--svg", "diff.svg"), ("diff", "old.S", "new.S", "--json"), ("diff", "new.S", "old.S")], ("diff.svg",))


def straight(text):
    """Without what jumps or calls: it ends."""
    return "\n".join(line for line in text.splitlines() if not re.search(r"GOTO|THEN|GOSUB|CALL|FUNCTION|TIME|SETERR|WAIT", line.upper())) + "\n"


def allowances(dice):
    text = contour(dice)
    if dice.random() < 0.1:
        text = broken(dice, text, TOKENS)
    return ([("part.S", text.encode())], [("compensate", "part.S"), ("compensate", "part.S", "-o", "-", "--json"), ("check", "part.S", "--json")],
            ("part.CMP",))


def stream_tools(dice):
    one = random_rml1(dice.randrange(1 << 30)).text
    lines = one.split(b";")
    other = b";".join(line for line in lines if dice.random() > 0.05)
    mill = ("--profile", dice.choice(MILLS))
    force = ("--force",) if dice.random() < 0.5 else ()
    by = ",".join(f"{dice.uniform(-20, 30):.2f}" for _ in range(dice.choice((2, 3))))
    tile = ("--columns", dice.randrange(1, 4), "--rows", dice.randrange(1, 3)) if dice.random() < 0.6 else \
        ("--within", f"{dice.randrange(60, 250)}x{dice.randrange(60, 250)}")
    return ([("a.rml", one), ("b.rml", other)],
            [("rml1", "explain", "a.rml", *mill), ("rml1", "explain", "b.rml", "--json", *mill),
             ("rml1", "to-gcode", "a.rml", *mill, *force, "-o", "-"), ("rml1", "move", "a.rml", "--by", by, *mill, *force),
             ("rml1", "steps", "a.rml", "--from", 40, "--to", 100), ("rml1", "steps", "a.rml", "--from", 100, "--to", 40, "--json"),
             ("rml1", "tile", "a.rml", *tile, "--gap", dice.randrange(5), *mill, *force, "-o", "tiles.rml"),
             ("diff", "a.rml", "b.rml", *mill, "--svg", "diff.svg"), ("diff", "a.rml", "b.rml", "--json", *mill)],
            ("tiles.rml", "diff.svg"))


def from_gcode(dice):
    mill = ("--profile", dice.choice(MILLS), *(("--force",) if dice.random() < 0.5 else ()))
    if dice.random() < 0.3:
        mill += ("--tolerance", dice.choice((0.001, 0.002, 0.05, 0.5)))
    if dice.random() < 0.2:
        mill += ("--origin", dice.choice(("10,10", "0,0", "20,5,-3")))
    return ([("part.nc", gcode(dice).encode())],
            [("rml1", "from-gcode", "part.nc", *mill), ("rml1", "from-gcode", "part.nc", *mill, "--json", "-o", "other.rml"),
             ("rml1", "to-gcode", "part.rml", *mill[:2], "--force", "-o", "-")], ("part.rml",))


def boards(dice):
    words = ["--profile", dice.choice(MILLS), "--tool", dice.choice((0.1, 0.2, 0.4, 0.8, 1)), "--depth", dice.choice((0.05, 0.1, 1.7))]
    words += ["--outline", "--step", 0.6] if dice.random() < 0.3 else ["--passes", dice.randrange(1, 5)] if dice.random() < 0.7 else []
    for name, values in (("--feed", (1, 8)), ("--plunge", (0.5, 2)), ("--rpm", (3000, 8000)),
                         ("--clearance", (0.5, 3)), ("--tolerance", (0.001, 0.02)), ("--dpi", (30, 100, 300))):
        if dice.random() < 0.3:
            words += [name, dice.choice(values)]
    words += ["--at", dice.choice(("10,10", "10,10", "3.5,2"))] if dice.random() < 0.85 else []
    if dice.random() < 0.3:
        words.append("--invert")
    return ([("traces.png", picture(dice))], [("rml1", "from-png", "traces.png", *words, "--force"),
                                              ("rml1", "from-png", "traces.png", *words, "--json", "-o", "other.rml")], ("traces.rml",))


def material(dice):
    one, other = (random_rml1(dice.randrange(1 << 30)).text for _ in range(2))
    other = other.replace(b"!NR;", b"")  # nobody is there to go on
    tool = dice.choice(("flat:3", "ball:2", "vee:6:60", "vee:6:30:0.2", "flat:6:flutes=2:flute=4:shank=8", "ball:3:flutes=2",
                        "flat:2:flute=3:shank=3:holder=20@12"))
    words = ["--profile", dice.choice(MILLS), "--stock", dice.choice(("200x150x20", "80x60x5@10,5,-1", "100x100x2")), "--tool", tool, "--cell", 1,
             "--target", "b.rml", "--target-tolerance", dice.choice((0.01, 0.5)), "--stl-tolerance", dice.choice((0.01, 1))]
    if "flutes" in tool:
        words += ["--material", dice.choice(("foam", "wax", "plastic", "wood", "pcb", "aluminium"))]
    for name, values in (("--rpm", (3000, 12000)), ("--clamps", (5, 20)), ("--origin", ("10,10", "30,20,-5"))):
        if dice.random() < 0.3:
            words += [name, dice.choice(values)]
    return ([("a.rml", one), ("b.rml", other)],
            [("simulate", "a.rml", *words, "--budget", "steps=3000,time=300", "--stl", "a.stl", "--relief", "r.png", "--height-map", "h.png",
              "--target-png", "t.png", "--facts", "--svg", "a.svg"),
             ("simulate", "a.rml", *words[:2], "--budget", "steps=3000,time=300", "--json", "--plot", "speed,power,axes", "plot.svg")],
            ("a.stl", "r.png", "h.png", "t.png", "a.svg", "plot.svg"))


def shown(dice):
    """What people read, and the state that one run leaves to the next."""
    if dice.random() < 0.5:
        program = random_rml1(dice.randrange(1 << 30))
        files, words = [("p.rml", program.text)], ["p.rml", *program.words]
    else:
        program = random_optimo(dice.randrange(1 << 30))
        files = [("1.S", program.text), *program.others]
        words = ["1.S", *(name for name, _ in program.others), "--main", "1", *program.words]
    if program.inputs:
        files.append(("inputs.txt", program.inputs.encode()))
        words += ["--inputs", "inputs.txt"]
    return (files, [("check", *(name for name, _ in files if name != "inputs.txt"), *(("--errors-only",) if dice.random() < 0.2 else ())),
                    ("simulate", *words, "--vars", "VR[0..4],VI[2..7],VL[0..2]", "--state-out", "state"),
                    ("simulate", *words, "--state-in", "state", "--state-out", "later", "--trace"),
                    ("simulate", *words, "--machine-coordinates", "--strict", "--plot", "speed,power", "plot.svg")],
            ("state", "later", "plot.svg"))


def broken_programs(dice):
    examples = [program for program in example_programs()]
    files = []
    for number in range(4):
        if dice.random() < 0.3:
            files.append((f"{number}.rml", broken(dice, random_rml1(dice.randrange(1 << 30)).text.decode("latin-1"), BYTES).encode("latin-1")))
            continue
        text = dice.choice(examples).text.decode("latin-1") if dice.random() < 0.5 else source(dice)
        files.append((f"{number}.S", broken(dice, text, TOKENS).encode("latin-1")))
    runs = [("check", name, "--json") for name, _ in files]
    runs += [("simulate", name, "--json", "--budget", "steps=2000,time=100") for name, _ in files]
    return files, runs, ()


def editor(dice):
    """A session: a text that is opened, asked about at many places, and changed."""
    messages, number = [], 0

    def send(method, params, answer=True):
        nonlocal number
        message = {"jsonrpc": "2.0", "method": method, "params": params}
        if answer:
            number += 1
            message["id"] = number
        messages.append(message)

    text = source(dice)
    if dice.random() < 0.4:
        text = broken(dice, text, TOKENS)
    document = {"uri": "file:///part/1.S"}
    send("initialize", {"processId": None, "rootUri": None, "capabilities": {}})
    send("initialized", {}, False)
    send("textDocument/didOpen", {"textDocument": {**document, "languageId": "rml", "version": 1, "text": text}}, False)
    for version in (2, 3):
        lines = text.splitlines() or [""]
        for _ in range(14):
            line = dice.randrange(len(lines))
            place = {"line": line, "character": dice.randrange(len(lines[line]) + 2)}
            what = dice.choice(("hover", "definition", "references", "documentHighlight", "completion", "completion", "prepareRename", "rename",
                                "hover", "codeAction"))
            params = {"textDocument": document, "position": place}
            if what == "rename":
                params["newName"] = dice.choice(("speed2", "VR[9]", "1x", "a_b"))
            if what == "references":
                params["context"] = {"includeDeclaration": dice.random() < 0.5}
            if what == "codeAction":
                params = {"textDocument": document, "range": {"start": {"line": 0, "character": 0}, "end": {"line": len(lines), "character": 0}},
                          "context": {"diagnostics": []}}
            send(f"textDocument/{what}", params)
        for what in ("documentSymbol", "foldingRange"):
            send(f"textDocument/{what}", {"textDocument": document})
        send("textDocument/formatting", {"textDocument": document, "options": {"tabSize": 2, "insertSpaces": True}})
        text = changed(dice, text)
        send("textDocument/didChange", {"textDocument": {**document, "version": version}, "contentChanges": [{"text": text}]}, False)
    send("shutdown", None)
    send("exit", None, False)
    spoken = b""
    for message in messages:
        body = json.dumps(message).encode()
        spoken += b"Content-Length: %d\r\n\r\n" % len(body) + body
    return [], [("lsp",)], (), spoken


def wrong_use():
    files = (("p.rml", b"IN;PA;PD100,100;!MC0;"), ("1.S", b"COORD ABSOL\nENDTASK\n"), ("no.toml", b"family = \"rml1\"\nprofile = \"t1\"\nx = 1\n"),
             ("own.toml", b"family = \"rml1\"\nprofile = \"srm-20\"\nname = \"bench\"\n[parameters]\nX_MAX = 100.0\n"), ("keys.txt", b"0.5 IL[20] = 1\n1 NONE\n"))
    lines = ("", "simulate", "simulate nothing.rml", "check", "check nothing.S 1.S", "check 1.S --family mill", "check p.rml --profile srm20",
             "check p.rml --profile none", "check 1.S --profile srm-20", "check p.rml --machine no.toml", "check p.rml --machine own.toml",
             "check p.rml --machine nothing.toml", "check p.rml --origin 1", "check p.rml --origin 10,10,10", "check p.rml --origin a,b",
             "check p.rml --clamps -1", "check 1.S --clamps 5", "check 1.S --origin 1,2", "check 1.S --dry-run", "check 1.S --inputs keys.txt",
             "simulate 1.S --mode none", "simulate 1.S --override 0", "simulate 1.S --override 145", "simulate 1.S --override x",
             "simulate 1.S --simul 1", "simulate 1.S --simul 0/1", "simulate 1.S --break 1/x", "simulate p.rml --simul 1/1", "simulate 1.S --budget none",
             "simulate 1.S --budget steps=0", "simulate 1.S --budget steps=-1", "simulate 1.S --budget time=1,time=2", "simulate 1.S --vars VR[1",
             "simulate 1.S --vars VX[1]", "simulate 1.S --vars VR[9..1]", "simulate p.rml --vars VR[1]", "simulate 1.S --samples 0 s.csv",
             "simulate 1.S --samples x s.csv", "simulate 1.S --plot none p.svg", "simulate 1.S --plot speed,speed p.svg", "simulate p.rml --stock 10x10x1",
             "simulate p.rml --stock 10x10 --tool flat:3", "simulate p.rml --stock 10x10x1 --tool round:3", "simulate p.rml --stock 10x10x0 --tool flat:3",
             "simulate p.rml --stock 10x10x1 --tool flat:-3", "simulate p.rml --stock 10x10x1 --tool vee:3", "simulate p.rml --stock 10x10x1 --tool vee:3:180",
             "simulate p.rml --stock 10x10x1 --tool flat:3:flutes=0", "simulate p.rml --stock 10x10x1 --tool flat:3 --material iron",
             "simulate p.rml --stock 10x10x1 --tool flat:3 --material wood", "simulate p.rml --stock 10x10x1 --tool flat:3 --cell 0",
             "simulate p.rml --stock 10x10x1 --tool flat:3 --cell 0.00001", "simulate p.rml --stock 10x10x1 --tool flat:3 --rpm 0",
             "simulate p.rml --stock 10x10x1 --tool flat:3 --target nothing.rml", "simulate p.rml --stock 10x10x1 --tool flat:3 --target keys.txt",
             "simulate p.rml --stock 10x10x1 --tool flat:3 --stl no/where.stl", "simulate 1.S --stock 10x10x1 --tool flat:3", "simulate p.rml --svg no/where.svg",
             "simulate 1.S --slot 100=1.S", "simulate 1.S --slot x", "simulate 1.S --main 100", "simulate 1.S --state-in keys.txt", "simulate p.rml --facts --json",
             "simulate 1.S --executable 1=keys.txt", "simulate 1.S --executable 5", "compile p.rml", "compile keys.txt", "decompile 1.S", "link 1.S --main 2",
             "format p.rml", "format", "convert 1.S x", "convert keys.txt", "convert 1.S 2.S 3.S 4.S", "convert 1.S x.S /q", "compensate p.rml", "transform 1.S",
             "transform 1.S --move 1,2", "transform 1.S --turn 1,2,x", "transform 1.S --shift 1,2,3", "transform p.rml --move 1,2,3", "list p.rml",
             "diff 1.S", "diff 1.S p.rml", "diff p.rml p.rml --profile none", "rml1", "rml1 none", "rml1 explain 1.S", "rml1 move p.rml", "rml1 move p.rml --by 1",
             "rml1 move p.rml --by 1,2,3,4", "rml1 move p.rml --by 1000,0", "rml1 steps p.rml --from 40", "rml1 steps p.rml --from 0 --to 1",
             "rml1 tile p.rml --columns 0", "rml1 tile p.rml --columns 2 --within 10x10", "rml1 tile p.rml --columns 900", "rml1 tile p.rml --within x",
             "rml1 tile p.rml --gap -1", "rml1 from-png p.rml --tool 1 --depth 1", "rml1 from-png p.rml --tool 0 --depth 1", "rml1 from-gcode p.rml",
             "rml1 from-gcode 1.S --tolerance 0", "rml1 to-gcode p.rml -o no/where.nc", "parameters none", "parameters rml1 --profile none", "parameters", "parameters optimo",
             "parameters optimo --json", "parameters rml1", "explain", "explain --json", "explain 348 0 99999 NONE HOLE_RADIUS_ZERO CELL-E9003 opt-e7410",
             "none", "--none", "--version --x", "machines --server", "jobs --server 127.0.0.1:1", "check --help", "simulate --help", "--help")
    lines += tuple(f"parameters rml1 --profile {mill}" for mill in MILLS)
    for number, line in enumerate(lines):
        yield Trial(f"use/{number}", files, (tuple(line.split()),))
