#!/usr/bin/env python3
"""The off-line tools, from the command line and over gRPC."""
import datetime
import json
import math
import os
import re
import unittest
import xml.etree.ElementTree

from command import InFolder, ask, run
from optimo_text import LINE, first_move



class CommandLine(InFolder):
    # OPT-8.72: compiling what was decompiled gives the same object.
    def test_compile_decompile_compile_is_the_same_object(self):
        source = self.file("12.S", LINE)
        run("compile", source)
        first = (self.folder / "12.O").read_bytes()
        again = self.file("13.S", run("decompile", self.folder / "12.O"))
        run("compile", again, "-o", self.folder / "x.O")
        self.assertEqual((self.folder / "x.O").read_bytes(), first)

    # OPT-8.70: the text of the programmer while the object is the one that was made of it.
    def test_a_source_map_gives_the_own_text_back(self):
        own = "; mine\nspeed   20   ; slow\n"
        source = self.file("12.S", own)
        run("compile", source, "--map")
        self.assertEqual(run("decompile", self.folder / "12.O"), own)
        source.write_text("SPEED 21\n")
        run("compile", source)  # another object beside the old map
        self.assertIn("SPEED 21", run("decompile", self.folder / "12.O"))
        (self.folder / "12.MAP").write_bytes(b"LMS damaged")
        self.assertIn("SPEED 21", run("decompile", self.folder / "12.O"))
        run("compile", source, "--map", "-o", "-", code=2)

    def test_a_source_with_errors_leaves_the_old_object(self):
        source = self.file("12.S", LINE)
        run("compile", source)
        before = (self.folder / "12.O").read_bytes()
        self.file("12.S", "SPEED 101\n")
        run("compile", source, code=1)
        self.assertEqual((self.folder / "12.O").read_bytes(), before)

    # OPT-9.02: the executable holds the FUNCTIONs that the program needs.
    def test_link_appends_functions_and_names_what_is_missing(self):
        main = self.file("12.S", "FUNCTION 44\n")
        self.file("44.S", "VR[0] = 1.\nENDTASK\n")
        done = run("link", main, "--slot", f"44={self.folder / '44.S'}", "-o", self.folder / "112.X")
        self.assertIn("FUNCTION 44", done)
        self.assertGreater((self.folder / "112.X").stat().st_size, 0)
        run("link", main, "-o", self.folder / "no.X", code=1)
        self.assertFalse((self.folder / "no.X").exists())

    def test_link_without_a_name_writes_beside_the_program(self):
        main = self.file("12.S", "FUNCTION 44\n")
        self.file("44.S", "VR[0] = 1.\nENDTASK\n")
        run("link", main, self.folder)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["12.S", "12.X", "44.S"])
        run("link", main, self.folder, "-o", self.folder / "named.X")
        self.assertEqual((self.folder / "12.X").read_bytes(), (self.folder / "named.X").read_bytes())

    # OPT-9.02: only what is called is compiled, near and far.
    def test_link_leaves_programs_alone_that_nobody_calls(self):
        main = self.file("90.S", "FUNCTION 44\n")
        self.file("44.S", "FUNCTION 45\n")
        self.file("45.S", "VR[0] = 1.\n")
        self.file("64.S", "SPEED 101\n")
        self.file("65.S", "VR[50] = 1.\n")  # has a warning
        self.file("66.S", "")
        done = ask("link", main, self.folder, "-o", self.folder / "190.X")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("FUNCTION 44, 45", done.stdout)
        self.file("45.S", "SPEED 101\n")
        done = ask("link", main, self.folder, "-o", self.folder / "no.X")
        self.assertEqual(done.returncode, 1)
        self.assertIn("45.S", done.stderr)
        self.assertNotIn("no object", done.stderr)
        self.assertFalse((self.folder / "no.X").exists())
        self.file("45.S", "")
        done = ask("link", main, self.folder, "-o", self.folder / "no.X")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"45\.S: .*CELL-E9017.*program 45 is called")
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    # OPT-B.40
    def test_format_keeps_comments_and_comes_to_rest(self):
        source = self.file("a.S", "speed   20   ; slow\n\n; alone\nMOVE(1.,2.,3.,0.,0.)\n")
        run("format", "--check", source, code=1)
        self.assertIn("speed   20", source.read_text())
        run("format", source)
        text = source.read_text()
        self.assertIn("SPEED 20", text)
        self.assertIn("; slow", text)
        self.assertIn("; alone", text)
        run("format", "--check", source)

    # OPT-8.54, OPT-8.56
    def test_convert_there_and_back(self):
        source = self.file("part.SI", "MOVE (1.,2.,-3.,90.,0.)  ; inches\n")
        run("convert", source)
        metric = (self.folder / "part.S").read_text()
        for got, wanted in zip(first_move(metric), [25.4, 50.8, -76.2, math.pi / 2, 0.0]):
            self.assertAlmostEqual(got, wanted, places=5)
        self.assertIn("; inches", metric)
        run("convert", self.folder / "part.S", self.folder / "back")
        for got, wanted in zip(first_move((self.folder / "back.SI").read_text()), [1, 2, -3, 90, 0]):
            self.assertAlmostEqual(got, wanted, places=4)

    # OPT-8.54: 1 in is 25.4 mm; to a file of another name, and to standard output, with nothing else written.
    def test_convert_writes_where_it_is_told(self):
        source = self.file("part.SI", "MOVE (1.,2.,-3.,0.,0.)\n")
        run("convert", source, "-o", self.folder / "there.S")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["part.SI", "there.S"])
        told = run("convert", source, "-o", "-")
        # The first line has the name of the file that it was made for.
        body = told.split("\n", 1)[1]
        self.assertEqual(body, (self.folder / "there.S").read_text().split("\n", 1)[1])
        for got, wanted in zip(first_move(body), [25.4, 50.8, -76.2], strict=False):
            self.assertAlmostEqual(got, wanted, places=5)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["part.SI", "there.S"])

    # OPT-8.58, OPT-8.66
    def test_convert_refuses_contradictions_and_writes_nothing(self):
        source = self.file("part.S", LINE)
        run("convert", source, "/m", code=2)
        self.assertEqual(os.listdir(self.folder), ["part.S"])

    def refused_conversion(self, *words):
        """The message of a call of convert that must end as wrong use."""
        done = ask("convert", *words)
        self.assertEqual(done.returncode, 2, done)
        self.assertEqual(done.stdout, "")
        return done.stderr

    # OPT-8.60, OPT-8.66, OPT-E.7703
    def test_convert_says_that_the_input_cannot_be_opened(self):
        said = self.refused_conversion(self.folder / "none.S")
        self.assertIn("OPT-E7703", said)
        self.assertIn("Input File Could Not be Opened", said)
        self.assertEqual(said.count("none.S"), 1, said)
        self.assertEqual(os.listdir(self.folder), [])

    # OPT-8.63, OPT-8.66, OPT-E.7706
    def test_convert_says_that_the_output_cannot_be_opened(self):
        source = self.file("part.S", LINE)
        said = self.refused_conversion(source, self.folder / "no-such-folder" / "part.SI")
        self.assertIn("OPT-E7706", said)
        self.assertIn("Output File Could Not be Opened", said)
        self.assertEqual(os.listdir(self.folder), ["part.S"])

    # OPT-8.59, OPT-8.61, OPT-8.62, OPT-8.64, OPT-8.66
    def test_convert_names_each_wrong_call(self):
        source, old = self.file("part.S", LINE), self.file("part.old", LINE)
        for words, code in [([source, "/x"], "OPT-E7702"), ([old], "OPT-E7704"), (["/i"], "OPT-E7705"),
                            ([source, self.folder / "b.SI", "c"], "OPT-E7707")]:
            said = self.refused_conversion(*words)
            self.assertIn(code, said)
            catalogue = re.search(r"'(.+?)'", said).group(1)
            self.assertEqual(said.count(catalogue), 1, said)
        self.assertEqual(sorted(os.listdir(self.folder)), ["part.S", "part.old"])

    # OPT-8.11, OPT-8.15
    def test_compensate_moves_the_cut_by_the_radius(self):
        source = self.file("part.S", ";$dia=0.508\n;$left\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\n"
                                     "MOVE (10.,0.,0.,0.,0.)\nWORK 0,0/OFF\n")
        run("compensate", source)
        cut = re.findall(r"MOVE \(([^)]*)\)", (self.folder / "part.CMP").read_text())[1]
        self.assertEqual([float(value) for value in cut.split(",")][:2], [10.0, 0.254])

    # OPT-8.76
    def test_transform_moves_and_turns(self):
        source = self.file("part.S", LINE)
        self.assertEqual(first_move(run("transform", source, "--move", "1,2,3"))[:3], [1001.0, 902.0, -497.0])
        turned = first_move(run("transform", source, "--turn", f"{math.pi / 2},0,0"))
        self.assertAlmostEqual(turned[0], -900.0, places=3)
        self.assertAlmostEqual(turned[1], 1000.0, places=3)

    # OPT-8.74, OPT-8.76: what is no number is refused, and so are two ways of moving at once.
    def test_transform_refuses_what_makes_no_sense(self):
        source = self.file("part.S", "VR[86] = 1.\n" + LINE)
        for words in [("--move", "nan,0,0"), ("--move", "0,inf,0"), ("--turn", "nan,0,0"), ("--shift", "nan,0,0,0,0,0"),
                      ("--shift", "0,0,-inf,0,0,0"), ("--shift", "1,0,0,0,0,0", "--move", "1,2,3"),
                      ("--shift", "1,0,0,0,0,0", "--turn", "0,0,1")]:
            self.assertEqual(run("transform", source, *words, "-o", self.folder / "out.S", code=2), "")
        self.assertFalse((self.folder / "out.S").exists())
        self.assertIn("VR[86] = 2.0", run("transform", source, "--shift", "1,0,0,0,0,0"))

    # OPT-8.73
    def test_list_counts_lines_and_steps(self):
        lines = run("list", self.file("part.S", LINE)).splitlines()
        self.assertRegex(lines[0], r"^    1     1  +COORD ABSOL$")
        self.assertRegex(lines[3], r"^    4     4  +MOVE \(")

    def test_diff_sees_what_a_program_does_not_how_it_is_written(self):
        a = self.file("a.S", LINE)
        same = self.file("b.S", "; another comment\n" + LINE.replace("   ; here", "").replace("SPEED 10", "SPEED   10"))
        self.assertEqual(run("diff", a, same), "they do the same\n")
        other = self.file("c.S", LINE.replace("1010.", "1013."))
        diff = json.loads(run("diff", a, other, "--json", code=1))
        self.assertEqual([(step["stepBefore"], step["stepAfter"]) for step in diff["steps"]], [(5, 5)])
        self.assertAlmostEqual(diff["steps"][0]["targetMovedMm"], 3.0, places=6)
        self.assertEqual(diff["aspects"], ["DIFF_ASPECT_PATH"])
        figures = {figure["name"]: figure for figure in diff["figures"]}
        self.assertAlmostEqual(figures["travel_length"]["after"] - figures["travel_length"]["before"], 3.0, places=6)

    # OPT-3.46; figures as people write them, not as a double holds them.
    def test_diff_for_people(self):
        a = self.file("a.S", "SPEED 5\n")
        self.assertEqual(run("diff", a, self.file("b.S", "SPEED 5\nENDTASK\n")), "they do the same\n")
        slow, fast = self.file("c.S", LINE), self.file("d.S", LINE.replace("SPEED 10", "SPEED 7"))
        text = run("diff", slow, fast, code=1)
        figures = re.findall(r"^([a-z_]+)  (\S+) -> (\S+)", text, re.MULTILINE)
        self.assertGreater(len(figures), 0, text)
        for name, before, after in figures:
            for value in (before, after):
                self.assertRegex(value, r"^-?[0-9]+(\.[0-9]{1,3})?$", name)

    def test_diff_draws_both_paths(self):
        a = self.file("a.S", LINE)
        other = self.file("c.S", LINE.replace("1010.", "1013."))
        picture = self.folder / "d.svg"
        self.assertIn("step 5 -> 5  path", run("diff", a, other, "--svg", picture, code=1))
        svg = xml.etree.ElementTree.fromstring(picture.read_text())
        texts = ["".join(text.itertext()) for text in svg.iter("{http://www.w3.org/2000/svg}text")]
        self.assertIn("0.000 mm cut, 3.000 mm travel", texts)  # added
        self.assertTrue({"removed", "added", "common"} <= set(texts), texts)
        self.assertEqual(run("diff", a, other, "--svg", "-", code=1), picture.read_text())
        run("diff", a, self.file("m.rml", "IN;"), code=2)

    # One object an answer: where the result is, or the result, and the findings as check --json gives them.
    def test_json_of_the_tools(self):
        source, bad = self.file("12.S", LINE), self.file("13.S", "SPEED 101\n")
        target = self.folder / "12.O"

        def answer(*words, code=0):
            out = run(*words, "--json", code=code)
            self.assertEqual(out.count("\n"), 1, out)
            return json.loads(out)

        made = answer("compile", source)
        self.assertEqual((made["file"], made["ok"], made["output"]), (str(source), True, str(target)))
        self.assertEqual(made["bytes"], target.stat().st_size)
        self.assertTrue(made["findings"]["ok"])
        for words in (["compile", bad], ["list", bad]):
            wrong = answer(*words, code=1)
            self.assertEqual((wrong["ok"], wrong["findings"]["diagnostics"][0]["code"]), (False, "OPT-E7004"))
            self.assertNotIn("output", wrong)
        run("compile", source, "-o", "-", "--json", code=2)
        self.assertEqual(answer("decompile", target)["content"], run("decompile", target))
        self.assertEqual(answer("list", source)["content"], run("list", source))
        self.assertEqual(answer("transform", source, "--move", "1,2,3")["content"],
                         run("transform", source, "--move", "1,2,3"))
        self.assertEqual(answer("convert", source)["output"], str(self.folder / "12.SI"))
        self.assertEqual(answer("convert", source)["text"], "inches and degrees")
        slot = self.file("slot.S", ";$rad=1\n;$left\nCOORD ABSOL\nPATH LIN\nMOVE (0,0,0,0,0)\nWORK 0,0/ON\n"
                                   "MOVE (10,0,0,0,0)\nMOVE (10,1.2,0,0,0)\nMOVE (0,1.2,0,0,0)\nWORK 0,0/OFF\n")
        cut = answer("compensate", slot)
        self.assertEqual({finding["code"] for finding in cut["findings"]["diagnostics"]}, {"OPT-E7812"})
        self.assertEqual(answer("link", source, "-o", self.folder / "112.X")["bytes"],
                         (self.folder / "112.X").stat().st_size)
        caller = self.file("14.S", "FUNCTION 44\n")
        missing = answer("link", caller, "-o", self.folder / "114.X", code=1)
        self.assertEqual([finding["code"] for finding in missing["findings"]["diagnostics"]], ["OPT-E7103"])
        crooked = self.file("crooked.S", "speed   20\n")
        self.assertFalse(answer("format", "--check", crooked, code=1)["ok"])
        self.assertEqual(answer("format", crooked)["text"], f"{crooked}: formatted")
        families = answer("parameters")["families"]
        self.assertEqual([family["family"] for family in families], ["optimo", "rml1"])
        values = {one["name"]: one for one in answer("parameters", "optimo")["parameters"]}
        self.assertEqual(values["OBJECT_LIMIT"]["value"], 34000)

    # OPT-7.91, OPT-2.61
    def test_check_fix_repairs_in_place_and_comes_to_rest(self):
        wrong = "\tspede   20\t; slow\r\nMOVE (1000.,900.,-500.,0.,0.)/INF ; x\r\n"
        source = self.folder / "a.S"
        source.write_bytes(wrong.encode())
        source.chmod(0o640)
        patch = run("check", "--fix", "--dry-run", source, code=1)
        self.assertEqual(source.read_bytes(), wrong.encode())
        self.assertIn("+\tSPEED   20\t; slow", patch)
        done = run("check", "--fix", source)
        self.assertIn("a.S: 2 fixed, GOOD\n", done)
        self.assertEqual(done.count("fixed  "), 2)
        self.assertEqual(source.read_bytes(), b"\tSPEED   20\t; slow\r\nMOVE (1000.,900.,-500.,0.,0.) ; x\r\n")
        self.assertEqual(source.stat().st_mode & 0o777, 0o640)
        before = source.stat()
        self.assertIn("0 fixed", run("check", "--fix", source))
        self.assertEqual((source.stat().st_ino, source.stat().st_mtime_ns), (before.st_ino, before.st_mtime_ns))

    def test_check_fix_leaves_what_it_cannot_repair_and_refuses_binaries(self):
        source = self.file("a.S", "SPEDE 20\nSPEED 101\n")
        left = run("check", "--fix", source, code=1)
        self.assertIn("1 fixed, BAD, 1 finding\n", left)
        self.assertIn("(OPT-E7004, step 2 line 2)", left)
        self.assertEqual(source.read_text(), "SPEED 20\nSPEED 101\n")
        answer = json.loads(run("check", "--fix", "--json", self.file("b.S", "SPEDE 20\n")))
        self.assertEqual([finding["place"]["line"] for finding in answer["fixed"]], [1])
        self.assertTrue(answer["findings"]["ok"])
        self.assertEqual(answer["findings"]["verdict"], "VERDICT_GOOD")
        # What is judged of the motion is judged of what was repaired: 400 mm beyond the travel.
        far = self.file("c.S", "COORD ROBOT\nSPEDE 20\nMOVE (4000.,0.,0.,0.,0.)\n")
        self.assertIn("1 fixed, BAD, 1 finding\n", run("check", "--fix", far, code=1))
        doubt = "COORD ABSOL\nSPEDE 20\nMOVE (4000.,0.,0.,0.,0.)\n"
        self.assertIn("1 fixed, DOUBTFUL, 1 finding\n", run("check", "--fix", self.file("d.S", doubt)))
        run("check", "--fix", "--strict", self.file("e.S", doubt), code=1)
        run("compile", self.file("12.S", LINE))
        for name in ["12.O", "m.rml", "zero.S"]:
            path = self.folder / name
            if not path.exists():
                path.write_bytes(b"SPEDE 20\n\0")
            before = path.read_bytes()
            run("check", "--fix", path, code=2)
            self.assertEqual(path.read_bytes(), before)
        run("check", "--dry-run", source, code=2)  # means nothing by itself

    # OPT-B.77: one date for the command and the server, that of where it runs.
    def test_headers_have_the_local_time(self):
        source = self.file("part.SI", "MOVE (1.,2.,-3.,90.,0.)\n")
        env = {**os.environ, "TZ": "XXX-9:30"}
        here = datetime.timezone(datetime.timedelta(hours=9, minutes=30))
        begin = datetime.datetime.now(here).replace(tzinfo=None, microsecond=0)
        run("convert", source, env=env)
        end = datetime.datetime.now(here).replace(tzinfo=None)
        header = (self.folder / "part.S").read_text().splitlines()[0]
        shown = datetime.datetime.strptime(header.rsplit(" - ", 1)[1], "%a %b %d %H:%M:%S %Y")
        self.assertLessEqual(begin, shown)
        self.assertLessEqual(shown, end)

    def test_the_place_of_a_failed_run_has_its_line(self):
        source = self.file("hole.S", "COORD ABSOL\n; a comment\nPATH HOLE (0.)\nMOVE (1000.,900.,-500.,0.,0.)\n")
        report = json.loads(run("simulate", source, "--json", code=1))
        self.assertEqual(report["outcome"]["code"], "OPT-E348")
        place = report["outcome"]["place"]
        self.assertEqual((place["step"], place["line"]), (3, 4))


if __name__ == "__main__":
    unittest.main(verbosity=2)
