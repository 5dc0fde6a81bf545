#!/usr/bin/env python3
"""The tools for streams of mills, from the command line."""
import json
import re
import struct
import unittest
import zlib

from command import InFolder, ask, run

STREAM = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;PD500,100,500,300;PU0,0;!MC0;\n"


class Explain(InFolder):
    def test_each_command_has_its_place_and_its_meaning(self):
        told = run("rml1", "explain", self.file("a.rml", STREAM), "--profile", "srm-20").splitlines()
        self.assertEqual(told[0].split()[:3], ["byte", "command", "text"])
        self.assertRegex(told[2], r"^ +3 +2  VS4 +cutting speed in X and Y 4 mm/s$")
        # 100 units in a mm; down from 2 mm above the work.
        self.assertIn("down into the work to Z -0.5 at 2 mm/s; cut to X 5 at 4 mm/s", told[7])
        self.assertRegex(told[8], r"^ +\d+ +7  500,300 +cut to Y 3 at 4 mm/s$")

    def test_units_are_those_of_the_machine(self):
        mdx = run("rml1", "explain", self.file("a.rml", STREAM), "--profile", "mdx-20")
        self.assertIn("cut to X 12.5 at 4 mm/s", mdx)  # 500 / 40
        own = self.file("mine.toml", 'family = "rml1"\nprofile = "mdx-20"\n[parameters]\nXY_SPEED_MAX = 3\n')
        self.assertIn("at 3 mm/s", run("rml1", "explain", self.folder / "a.rml", "--machine", own))

    def test_errors_are_said_as_check_says_them(self):
        source = self.file("a.rml", "PU100;\nQQ;PU1,1;")
        told = run("rml1", "explain", source)
        errors = [line for line in run("check", source, code=1).splitlines() if " device error " in line]
        self.assertEqual(len(errors), 2)
        for line in errors:
            self.assertIn(line, told)

    def test_json_has_a_line_for_each_phrase(self):
        lines = [json.loads(line) for line in
                 run("rml1", "explain", self.file("a.rml", "PU1,2,3,4;X"), "--json").splitlines()]
        self.assertEqual([line["offset"] for line in lines], [0, 6, 10])
        self.assertEqual([line["command"] for line in lines], [1, 1, 0])
        self.assertEqual(lines[0]["name"], "PU")

    def test_what_is_no_stream_of_a_mill_is_refused(self):
        self.assertIn("Amada", ask("rml1", "explain", self.file("12.S", "SPEED 20\n")).stderr)
        run("rml1", "explain", self.folder / "12.S", code=2)
        run("rml1", "explain", self.file("empty.rml", ""), code=2)
        run("rml1", "explain", self.folder / "missing.rml", code=2)
        run("rml1", "explain", self.file("a.rml", STREAM), "--profile", "none-of-them", code=2)
        laser = self.file("laser.toml", 'family = "optimo"\n')
        run("rml1", "explain", self.folder / "a.rml", "--machine", laser, code=2)


class Gcode(InFolder):
    def facts(self, stream):
        return run("simulate", stream, "--profile", "srm-20", "--facts")

    def test_the_round_trip_cuts_the_same(self):
        source = self.file("a.rml", STREAM)
        self.assertIn("a.nc: ", run("rml1", "to-gcode", source, "--profile", "srm-20"))
        gcode = (self.folder / "a.nc").read_text()
        self.assertIn("G1 X5 F240\n", gcode)
        run("rml1", "from-gcode", self.folder / "a.nc", "--profile", "srm-20", "-o", self.folder / "b.rml")
        before, after = self.facts(source), self.facts(self.folder / "b.rml")
        for name in ("rml1.cut_length", "rml1.box_mm.xmax", "rml1.box_mm.zmin", "rml1.plunges"):
            wanted = re.search(rf"^{re.escape(name)}: .*$", before, re.MULTILINE)
            self.assertIsNotNone(wanted, before)
            self.assertIn(wanted.group(), after)

    def test_standard_output_and_json(self):
        source = self.file("a.rml", STREAM)
        self.assertTrue(run("rml1", "to-gcode", source, "-o", "-").endswith("M30\n"))
        told = json.loads(run("rml1", "to-gcode", source, "-o", "-", "--json"))
        self.assertTrue(told["ok"])
        self.assertIn("G21", told["content"])
        self.assertFalse((self.folder / "a.nc").exists())

    def test_what_cannot_be_read_is_refused_with_its_place_and_nothing_is_written(self):
        source = self.file("a.nc", "G21\nG0 Z5\nG81 X1 Z-1 R1 F60\nG41 X1\n")
        done = ask("rml1", "from-gcode", source)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"a\.nc:3:1: .*RML1-E8102: G81")
        self.assertRegex(done.stderr, r"a\.nc:4:1: .*RML1-E8102: G41")
        self.assertFalse((self.folder / "a.rml").exists())
        told = json.loads(run("rml1", "from-gcode", source, "--json", code=1))
        self.assertFalse(told["ok"])

    def test_an_old_result_stays_when_there_is_no_new_one(self):
        self.file("a.rml", "PU;")
        run("rml1", "from-gcode", self.file("a.nc", "G91 X1\n"), code=1)
        self.assertEqual((self.folder / "a.rml").read_text(), "PU;")

    def test_tolerance(self):
        source = self.file("a.nc", "G1 Z0 F60\nG2 I5\n")
        rough = run("rml1", "from-gcode", source, "--tolerance", "0.5", "-o", "-").count("Z")
        fine = run("rml1", "from-gcode", source, "--tolerance", "0.01", "-o", "-").count("Z")
        self.assertGreater(fine, 5 * rough)
        run("rml1", "from-gcode", source, "--tolerance", "0", "-o", "-", code=2)


class Rewriting(InFolder):
    def test_move(self):
        source = self.file("a.rml", "PU100,100; PD200,+50 ;PR5,5;")
        self.assertEqual(run("rml1", "move", source, "--by", "1,-0.5"), "PU200,50; PD300,0 ;PR5,5;")
        told = run("rml1", "move", source, "--by", "1.004,0", "-o", self.folder / "b.rml")
        self.assertIn("moved by 1.000,0.000,0.000 mm", told)  # whole units of 0.01 mm
        self.assertEqual(run("rml1", "move", source, "--by", "-1,2", "--profile", "mdx-20"),
                         "PU60,180; PD160,130 ;PR5,5;")
        run("rml1", "move", source, code=2)
        run("rml1", "move", source, "--by", "1", code=2)
        run("rml1", "move", source, "--by", "nan,1", code=2)
        run("rml1", "move", source, "--by", "1,2,3,4", code=2)
        # The file may stand behind what is given in numbers.
        self.assertEqual(run("rml1", "move", "--by", "1,-0.5", "--origin", "0,0", source, "--profile", "srm-20"), "PU200,50; PD300,0 ;PR5,5;")

    def test_move_refuses_with_the_place_and_writes_nothing(self):
        done = ask("rml1", "move", self.file("a.rml", "PU1,1;\nPU5;"), "--by", "1,1", "-o", self.folder / "b.rml")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"a\.rml:2:1: .*RML1-E8111")
        self.assertFalse((self.folder / "b.rml").exists())
        done = ask("rml1", "move", self.file("c.rml", "PU100,100;PD20220,100;"), "--by", "2,0", "-o", "-")
        self.assertIn("RML1-E8114: 1 mm of the work would not be cut", done.stderr)

    def test_steps(self):
        source = self.file("a.rml", "VS4;!PZ-40,80;PU100,3;PR3,0,3,0;")
        self.assertEqual(run("rml1", "steps", source, "--from", 40, "--to", 100),
                         "VS4;!PZ-100,200;PU250,8;PR8,0,7,0;")
        run("rml1", "steps", source, "--from", 0, "--to", 100, code=2)
        run("rml1", "steps", source, code=2)

    def test_tile(self):
        source = self.file("a.rml", STREAM)
        told = run("rml1", "tile", source, "--columns", 2, "--rows", 3, "--gap", 2, "--profile", "srm-20",
                   "-o", self.folder / "six.rml")
        # The cuts are 4 mm and 2 mm long.
        self.assertIn("6 copies, 2 in X and 3 in Y, every 6.000 mm in X and 4.000 mm in Y", told)
        facts = {name: run("simulate", path, "--profile", "srm-20", "--facts")
                 for name, path in (("one", source), ("six", self.folder / "six.rml"))}
        plunges = [float(re.search(r"^rml1\.plunges: (.*)$", text, re.MULTILINE).group(1)) for text in facts.values()]
        self.assertEqual(plunges, [1, 6])
        lengths = [float(re.search(r"^rml1\.cut_length: (.*)$", text, re.MULTILINE).group(1))
                   for text in facts.values()]
        # Each copy goes down from 2 mm above to 0.5 mm below.
        self.assertAlmostEqual(lengths[1], 6 * lengths[0], places=3)
        self.assertIn("rml1.spindle_on_at_end: 0", facts["six"])

    def test_tile_within_a_field(self):
        source = self.file("a.rml", STREAM)
        # Cuts of 4 by 2 mm, 1 mm between: 4 + 5 + 5 = 14 and 2 + 3 = 5.
        told = run("rml1", "tile", source, "--within", "14x5", "--profile", "srm-20", "-o", self.folder / "b.rml")
        self.assertIn("6 copies, 3 in X and 2 in Y, every 5.000 mm in X and 3.000 mm in Y", told)
        self.assertEqual(run("rml1", "tile", source, "--columns", 3, "--rows", 2), (self.folder / "b.rml").read_text())
        told = run("rml1", "tile", source, "--within", "14x900", "-o", self.folder / "b.rml")
        self.assertIn("; more are not on the travel, for the srm-20: no profile was named", told)
        done = ask("rml1", "tile", source, "--within", "3x3", "-o", "-")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the paths of one copy take 4 by 2 mm, more than 3 by 3 mm", done.stderr)
        for wrong in ("14", "14x", "axb", "0x5", "-1x5"):
            run("rml1", "tile", source, f"--within={wrong}", "-o", "-", code=2)
        run("rml1", "tile", source, "--within", "14x5", "--rows", 2, "-o", "-", code=2)

    def test_tile_says_what_fits(self):
        done = ask("rml1", "tile", self.file("a.rml", STREAM), "--columns", 900, "--profile", "srm-20", "-o", "-")
        self.assertEqual(done.returncode, 1)
        # 203.2 mm; the first copy ends at 5 mm, and 5 mm are from one to the next: 1 + 39.
        self.assertIn("at most 40 columns", done.stderr)
        run("rml1", "tile", self.folder / "a.rml", "--columns", 0, "-o", "-", code=2)


class WhatTheMachineLeavesOut(InFolder):
    """One rule for all tools that write: nothing is written of which the machine would do a part only."""

    # The travel of an SRM-20 is 203.2 x 152.4 x 60.5 mm; Z0 is 60 mm above its bottom with --origin 0,0,-0.5.
    WIDE = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\nPD30000,100;PU0,0;!MC0;\n"
    GOOD = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;\nPD5000,100;PU0,0;!MC0;\n"

    def refused(self, *words, output, where, code="RML1-E8114", forced_code=None):
        """Nothing is written, and the message has a place, a code and advice; forced, it is told and written."""
        words = ("rml1", *words, "--profile", "srm-20", "-o", output)
        done = ask(*words)
        self.assertEqual(done.returncode, 1, words)
        self.assertRegex(done.stderr, where + r" error " + code)
        self.assertIn("--force", done.stderr)
        self.assertFalse(output.exists(), words)
        told = json.loads(run(*words, "--json", code=1))
        self.assertFalse(told["ok"])
        self.assertFalse(output.exists(), words)
        forced = ask(*words, "--force")
        self.assertEqual(forced.returncode, 0, forced.stderr)
        self.assertRegex(forced.stderr, where + r" warning " + (forced_code or code))
        self.assertTrue(output.exists(), words)
        return done.stderr

    def test_every_tool_that_writes(self):
        wide, good, out = self.file("wide.rml", self.WIDE), self.file("good.rml", self.GOOD), self.folder
        gcode = self.file("wide.nc", "G21\nG0 Z2\nG0 X1 Y1\nG1 Z-0.5 F120\nG1 X250\nX300\nG0 Z2\nM30\n")
        told = self.refused("to-gcode", wide, output=out / "1", where=r"wide\.rml:2:1:")
        # From X 1 to 300 mm.
        self.assertIn("96.8 mm beyond the greatest X (203.2 mm); in X it is 95.8 mm too large", told)
        self.refused("from-gcode", gcode, output=out / "2", where=r"wide\.nc:5:1:")
        told = self.refused("move", good, "--by", "160,0", output=out / "3", where=r"good\.rml:2:1:")
        self.assertIn("in X it fits moved by -161 to -6.8 mm", told)  # from X 161 to 210
        self.refused("move", good, "--by", "0,-2", output=out / "4", where=r"good\.rml:2:1:")
        self.refused("steps", good, "--from", 20, "--to", 100, output=out / "5", where=r"good\.rml:2:1:")
        self.refused("tile", good, "--columns", 5, output=out / "6", where=r"good\.rml:", code="RML1-E8112",
                     forced_code="RML1-E8114")

    def test_depth(self):
        picture = FromPng.png(self, "a.png", ["   ", " # ", "   "], dpi=25.4)
        self.refused("from-png", picture, "--tool", 0.4, "--depth", 100, "--at", "5,5", output=self.folder / "7",
                     where=r"a\.png:", code="RML1-E8126")
        run("rml1", "from-png", picture, "--tool", 0.4, "--depth", 1, "--at", "5,5", "-o", "-")

    def test_origin_decides(self):
        good = self.file("good.rml", self.GOOD)
        run("rml1", "move", good, "--by", "100,0", "--profile", "srm-20")
        done = ask("rml1", "move", good, "--by", "100,0", "--profile", "srm-20", "--origin", "60,0")
        self.assertEqual(done.returncode, 1)
        self.assertIn("RML1-E8114", done.stderr)
        # Back into the travel: what counts is what is written.
        self.file("moved.rml", self.GOOD.replace("100,", "-900,"))
        run("rml1", "move", self.folder / "moved.rml", "--by", "10,0", "--profile", "srm-20")

    def test_origin_beyond_the_travel_is_refused_with_the_range(self):
        good = self.file("good.rml", self.GOOD)
        for words in (["check"], ["simulate"], ["rml1", "to-gcode", "-o", "-"]):
            done = ask(*words, good, "--profile", "srm-20", "--origin", "0,0,-90")
            self.assertEqual(done.returncode, 2, words)
            self.assertIn("--origin: Z -90.0 is beyond the travel, which is from -60.5 to 0.0 mm", done.stderr)
        done = ask("check", good, "--profile", "srm-20", "--origin", "-5,0")
        self.assertIn("--origin: X -5.0 is beyond the travel, which is from 0.0 to 203.2 mm", done.stderr)
        run("check", good, "--profile", "srm-20", "--origin", "0,0")

    def test_steps_for_a_machine_that_is_not_named(self):
        source = self.file("a.rml", self.GOOD)
        told = run("rml1", "steps", source, "--from", 100, "--to", 40, "-o", self.folder / "b.rml")
        self.assertIn("whether it fits is not known: name the machine that it is for, of 40 units", told)
        told = run("rml1", "steps", source, "--from", 100, "--to", 40, "--profile", "mdx-20", "-o", self.folder / "b.rml")
        self.assertNotIn("not known", told)

    def test_no_round_trip_makes_a_stream_better(self):
        """Streams that a check finds fault with are refused by to-gcode, or come back with the fault, or are told."""
        head, tail = "PA;VS4;!VZ2;!PZ-50,200;!MC1;PU100,100;", "PU0,0;!MC0;"
        verdicts = ("GOOD", "DOUBTFUL", "BAD")

        def verdict(path):
            return verdicts.index(re.search(rf"^{re.escape(str(path))}: (\w+)", ask(
                "check", path, "--profile", "srm-20").stdout, re.MULTILINE).group(1))

        streams = {
            "spindle": head.replace("!MC1", "!MC0") + "PD500,100;" + tail,
            "beyond": head + "PD50000,100;" + tail,
            "number": head + "PD500,100,99999999,300;" + tail,
            "height": head.replace("-50,", "-9000,") + "PD500,100;" + tail,
            "lift": head.replace(",200", ",-200") + "PD500,100;" + tail,
            "across": head.replace(",200", ",0") + "PD500,100;PU900,900;PD0,0;" + tail,
            "deep": head + "PD500,100;!MC0;",
            "on": head + "PD500,100;PU;",
            "speed": head.replace("VS4", "VS99") + "PD500,100;" + tail,
            "no speed": head.replace("VS4;!VZ2;", "") + "PD500,100;" + tail,
            "unknown": head + "PD500,100;QQ;" + tail,
            "torn": head + "PD500,100;" + tail + "PD",
            "fast down": head.replace("!VZ2", "!VZ30") + "PD500,100;" + tail,
            "halt": head + "PD500,100;!NR;" + tail,
        }
        told_alone = set()
        for name, stream in streams.items():
            with self.subTest(name):
                source, gcode, back = (self.folder / (name + end) for end in (".rml", ".nc", ".back.rml"))
                source.write_text(stream)
                before = verdict(source)
                self.assertGreater(before, 0)
                made = ask("rml1", "to-gcode", source, "--profile", "srm-20")
                if made.returncode != 0:
                    self.assertEqual(before, 2)
                    continue
                run("rml1", "from-gcode", gcode, "--profile", "srm-20", "-o", back)
                if verdict(back) < before:
                    self.assertEqual(before, 1)  # what is BAD is never told alone
                    self.assertRegex(made.stderr, r"RML1-E\d+")
                    self.assertRegex(gcode.read_text(), r"\(RML1-E\d+ in the stream: ")
                    told_alone.add(name)
        self.assertEqual(told_alone, {"speed", "no speed", "unknown", "torn", "on"})

    def test_rapids_through_the_work_are_told(self):
        gcode = self.file("a.nc", "G21\nM3\nG0 Z2\nG1 Z-1 F600\nG0 X50\nG0 Z2\nM5\n")
        done = ask("rml1", "from-gcode", gcode, "--profile", "srm-20")
        self.assertEqual(done.returncode, 0)
        self.assertIn("a.nc:5:1: warning RML1-E8110: G0 leads across below Z 0: the stream goes there at 30 mm/s",
                      done.stderr)


class Families(InFolder):
    """A stream is no text of another machine, whatever tool is given it."""

    def test_tools_for_texts_refuse_streams(self):
        source = self.file("a.rml", STREAM)
        for words in (["list"], ["format"], ["format", "--check"], ["convert"], ["compensate"], ["compile"],
                      ["decompile"], ["transform", "--move", "1,0,0"], ["link", "-o", self.folder / "x"]):
            done = ask(*words, source)
            self.assertEqual(done.returncode, 2, words)
            self.assertIn("a.rml is a program for Roland mill or engraver, RML-1", done.stderr, words)
        self.assertEqual(source.read_text(), STREAM)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["a.rml"])

    def test_simulate_refuses_two_streams(self):
        a, b = self.file("a.rml", STREAM), self.file("b.rml", "PU1,1;")
        done = ask("simulate", a, b)
        self.assertEqual(done.returncode, 2)
        self.assertIn("2 programs for a machine whose programs call no others", done.stderr)
        seven = self.file("7.rml", STREAM)
        run("simulate", seven, self.file("8.rml", "PU1,1;"), "--main", 7)

    def test_diff_says_what_the_tool_does_differently(self):
        a = self.file("a.rml", STREAM)
        same = self.file("b.rml", STREAM.replace("PD500,100,500,300", "D500,100;PD500,300").replace(";", "\n"))
        self.assertIn("same", run("diff", a, same, "--profile", "srm-20").lower())
        deeper = self.file("c.rml", STREAM.replace("-50", "-80").replace("VS4", "VS6"))
        told = run("diff", a, deeper, "--profile", "srm-20", code=1)
        self.assertIn("Z -0.5 -> -0.8", told)
        self.assertIn("mm/s 4 -> 6", told)
        self.assertIn("cut_length  8.5 -> 8.8 mm", told)  # 0.3 mm deeper
        message = json.loads(run("diff", a, deeper, "--json", code=1))
        self.assertEqual(message["steps"][0]["aspects"], ["DIFF_ASPECT_PATH"])
        self.assertTrue(message["comparedRuns"])
        run("diff", a, deeper, "--svg", self.folder / "d.svg", "--profile", "srm-20", code=1)
        self.assertIn("<svg", (self.folder / "d.svg").read_text())

    # What is known is said, with a note of what is not.
    def test_diff_of_streams_that_do_not_get_to_their_end(self):
        a = self.file("a.rml", "VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;PD400,0;PU;!MC0;")
        torn = ask("diff", a, self.file("b.rml", "VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;PD200,0;PU;!MC"))
        self.assertEqual(torn.returncode, 1)
        self.assertIn("cut_length  7 -> 5 mm", torn.stdout)  # 3 mm down, and 4 or 2 mm across
        self.assertIn("b.rml: the data ends inside a command", torn.stderr)
        halted = ask("diff", a, self.file("c.rml", "VS10;!VZ10;!PZ-100,200;!MC1;PU0,0;PD400,0;!NR;PU;!MC0;"))
        self.assertIn("no figures: c.rml: stopped at 1/7, CELL-E9308; what they do is compared to the end of both",
                      halted.stderr)

    def test_diff_refuses_what_cannot_be_compared(self):
        a = self.file("a.rml", STREAM)
        done = ask("diff", a, self.file("12.S", "SPEED 20\n"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("programs for different machines", done.stderr)
        run("diff", a, self.file("b.rml", "$" * 300), code=2)
        run("diff", a, a, "--profile", "none-of-them", code=2)


class FromPng(InFolder):
    def png(self, name, rows, dpi=None):
        """Lines of '#' for white; the uppermost first."""
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        data = b"".join(b"\0" + bytes(255 if c == "#" else 0 for c in row) for row in rows)
        content = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 0, 0, 0, 0))
        if dpi:
            content += chunk(b"pHYs", struct.pack(">IIB", round(dpi / 0.0254), round(dpi / 0.0254), 1))
        path = self.folder / name
        path.write_bytes(content + chunk(b"IDAT", zlib.compress(data)) + chunk(b"IEND", b""))
        return path

    # Two pads of 3 mm by 2 mm, 2 mm apart, 2 mm from the edges of the picture; a pixel is 0.1 mm.
    PADS = [" " * 120] * 20 + [" " * 20 + "#" * 30 + " " * 20 + "#" * 30 + " " * 20] * 20 + [" " * 120] * 20

    def test_milling_leaves_the_pads_and_takes_the_gap(self):
        picture = self.png("traces.png", self.PADS, dpi=254)
        told = run("rml1", "from-png", picture, "--profile", "srm-20", "--tool", 0.8, "--depth", 0.2)
        self.assertIn("2 lines, picture of 12.00 by 6.00 mm", told)
        stream, stl = self.folder / "traces.rml", self.folder / "left.stl"
        simulated = run("simulate", stream, "--profile", "srm-20", "--stock", "12x6x1", "--tool", "flat:0.8",
                        "--cell", 0.05, "--stl", stl, "--stl-tolerance", 0)
        self.assertIn("verdict       GOOD", simulated)
        content = stl.read_bytes()
        count = struct.unpack_from("<I", content, 80)[0]
        triangles = [struct.unpack_from("<9f", content, 84 + 50 * n + 12) for n in range(count)]
        top = max(max(one[2::3]) for one in triangles)

        def height(x, y):
            """Of the highest surface over a place."""
            heights = []
            for ax, ay, az, bx, by, bz, cx, cy, cz in triangles:
                twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
                if abs(twice) < 1e-9:
                    continue  # a wall
                v = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / twice
                w = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / twice
                if min(v, w, 1 - v - w) >= -1e-9:
                    heights.append(az + v * (bz - az) + w * (cz - az))
            return max(heights) - top

        ways = [0.05 + 0.1 * n for n in range(20)]
        pads = [height(left + 1.4 * x, 2 + y) for left in (2, 7) for x in ways for y in ways]
        self.assertAlmostEqual(min(pads), 0.0, places=3, msg="copper was cut")
        # In the middle of the line right of the first pad: 0.4 mm from its edge, and a little more.
        gap = [height(x, 2.2 + 0.8 * y) for x in (5.35, 5.45, 5.55) for y in ways]
        self.assertAlmostEqual(max(gap), -0.2, places=3)

    def test_sizes_and_places(self):
        picture = self.png("a.png", self.PADS)
        words = ("--profile", "srm-20", "--tool", 0.4, "--depth", 0.1, "-o", "-")
        done = ask("rml1", "from-png", picture, *words)
        self.assertEqual(done.returncode, 1)
        self.assertIn("RML1-E8123", done.stderr)
        near = run("rml1", "from-png", picture, "--dpi", 254, *words)
        far = run("rml1", "from-png", picture, "--dpi", 254, "--at", "10,5", *words)
        self.assertNotEqual(near, far)
        self.assertEqual(run("rml1", "move", self.file("n.rml", near), "--by", "10,5").count("Z"), far.count("Z"))
        # Lines go around the copper, here left of the travel and below it.
        full = self.png("full.png", ["#" * 19 + " "] * 20, dpi=254)
        done = ask("rml1", "from-png", full, *words)
        self.assertEqual(done.returncode, 1)
        self.assertIn("RML1-E8126: the picture is 2 by 2 mm: ", done.stderr)
        self.assertIn("give the picture another place with --at", done.stderr)
        self.assertNotIn("copies", done.stderr)
        run("rml1", "from-png", full, "--at", "5,5", *words)
        white = self.png("white.png", ["#" * 20] * 20, dpi=254)
        done = ask("rml1", "from-png", white, "--at", "5,5", *words)
        self.assertEqual(done.returncode, 1)
        self.assertIn("RML1-E8124: all of the picture is copper", done.stderr)
        run("rml1", "from-png", white, "--at", "5,5", "--outline", *words)

    def test_traces_that_stay_joined_are_written_by_force_alone(self):
        # The pads are 2 mm apart: a tool of 3 mm does not fit between them.
        picture = self.png("joined.png", self.PADS, dpi=254)
        words = ("rml1", "from-png", picture, "--profile", "srm-20", "--tool", 3, "--depth", 0.1, "--at", "5,5")
        done = ask(*words)
        self.assertEqual(done.returncode, 1)
        self.assertIn("RML1-E8125: of 2 traces 2 stay joined with a neighbour", done.stderr)
        self.assertIn("--force", done.stderr)
        self.assertFalse((self.folder / "joined.rml").exists())
        done = ask(*words, "--force")
        self.assertEqual(done.returncode, 0)
        self.assertIn("RML1-E8125", done.stderr)
        self.assertTrue((self.folder / "joined.rml").exists())

    def test_outline_goes_down_in_steps(self):
        board = self.png("o.png", [" " * 60] * 10 + [" " * 10 + "#" * 40 + " " * 10] * 40 + [" " * 60] * 10, dpi=254)
        stream = run("rml1", "from-png", board, "--profile", "srm-20", "--tool", 0.8, "--depth", 1.5, "--step", 0.5,
                     "--outline", "-o", "-")
        for depth in (",-50;", ",-100;", ",-150;"):
            self.assertIn(depth, stream)
        run("rml1", "from-png", board, "--tool", 1, "--depth", 1, "--outline", "--passes", 2, code=2)

    def test_refusals(self):
        words = ("--tool", 0.4, "--depth", 0.1, "--dpi", 254, "-o", self.folder / "x.rml")
        done = ask("rml1", "from-png", self.file("no.png", "no picture"), *words)
        self.assertEqual(done.returncode, 1)
        self.assertIn("RML1-E8121", done.stderr)
        done = ask("rml1", "from-png", self.png("black.png", ["   "]), *words)
        self.assertIn("RML1-E8124", done.stderr)
        run("rml1", "from-png", self.png("dot.png", [" # "]), "--tool", 0, "--depth", 0.1, "--dpi", 254, code=2)
        run("rml1", "from-png", self.folder / "dot.png", "--depth", 0.1, code=2)
        self.assertFalse((self.folder / "x.rml").exists())


if __name__ == "__main__":
    unittest.main()
