#!/usr/bin/env python3
"""The off-line tools, from the command line and over gRPC."""
import datetime
import json
import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree

from cell import BIN, Cell, detail_of, grpc, program_pb2


def run(*words, code=0, text=True):
    done = subprocess.run([BIN / "rmlcell", *map(str, words)], capture_output=True, text=text, timeout=120,
                          env={**os.environ, "NO_COLOR": "1"})
    assert done.returncode == code, (words, done.returncode, done.stdout, done.stderr)
    return done.stdout


def numbers(text):
    """The numbers of the first MOVE."""
    move = re.search(r"MOVE \(([^)]*)\)", text).group(1)
    return [float(value) for value in move.split(",")]


LINE = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (1000.,900.,-500.,0.,0.)   ; here\nMOVE (1010.,900.,-500.,0.,0.)\n"


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, content):
        path = self.folder / name
        path.write_text(content)
        return path

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
        done = subprocess.run([BIN / "rmlcell", "link", main, self.folder, "-o", self.folder / "190.X"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("FUNCTION 44, 45", done.stdout)
        self.file("45.S", "SPEED 101\n")
        done = subprocess.run([BIN / "rmlcell", "link", main, self.folder, "-o", self.folder / "no.X"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 1)
        self.assertIn("45.S", done.stderr)
        self.assertNotIn("no object", done.stderr)
        self.assertFalse((self.folder / "no.X").exists())
        self.file("45.S", "")
        done = subprocess.run([BIN / "rmlcell", "link", main, self.folder, "-o", self.folder / "no.X"],
                              capture_output=True, text=True, timeout=60)
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
        for got, wanted in zip(numbers(metric), [25.4, 50.8, -76.2, math.pi / 2, 0.0]):
            self.assertAlmostEqual(got, wanted, places=5)
        self.assertIn("; inches", metric)
        run("convert", self.folder / "part.S", self.folder / "back")
        for got, wanted in zip(numbers((self.folder / "back.SI").read_text()), [1, 2, -3, 90, 0]):
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
        for got, wanted in zip(numbers(body), [25.4, 50.8, -76.2], strict=False):
            self.assertAlmostEqual(got, wanted, places=5)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["part.SI", "there.S"])

    # OPT-8.58, OPT-8.66
    def test_convert_refuses_contradictions_and_writes_nothing(self):
        source = self.file("part.S", LINE)
        run("convert", source, "/m", code=2)
        self.assertEqual(os.listdir(self.folder), ["part.S"])

    def refused_conversion(self, *words):
        """The message of a call of convert that must end as wrong use."""
        done = subprocess.run([BIN / "rmlcell", "convert", *map(str, words)], capture_output=True, text=True,
                              timeout=120, env={**os.environ, "NO_COLOR": "1"})
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
        self.assertEqual(numbers(run("transform", source, "--move", "1,2,3"))[:3], [1001.0, 902.0, -497.0])
        turned = numbers(run("transform", source, "--turn", f"{math.pi / 2},0,0"))
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
        subprocess.run([BIN / "rmlcell", "convert", source], env=env, check=True, capture_output=True)
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


class Services(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cell = Cell(workers=0)
        cls.addClassCleanup(cls.cell.close)
        cls.cell.start()
        cls.stub = cls.cell.programs()

    def text(self, name, content):
        return program_pb2.ProgramText(file_name=name, content=content.encode())

    def refused(self, call, request, code, ours):
        with self.assertRaises(grpc.RpcError) as caught:
            call(request, timeout=60)
        self.assertEqual(caught.exception.code(), code)
        self.assertEqual(detail_of(caught.exception).code, ours)

    def test_format(self):
        answer = self.stub.FormatProgram(program_pb2.FormatProgramRequest(program=self.text("a.S", "speed   20 ; slow\n")))
        self.assertIn(b"SPEED 20", answer.content)
        self.assertIn(b"; slow", answer.content)
        self.refused(self.stub.FormatProgram, program_pb2.FormatProgramRequest(), grpc.StatusCode.INVALID_ARGUMENT,
                     "CELL-E9017")

    def test_convert(self):
        answer = self.stub.ConvertProgram(program_pb2.ConvertProgramRequest(
            program=self.text("part.SI", "MOVE (1.,2.,-3.,90.,0.)\n"), date="Thu Mar 04 08:52:34 1993"))
        self.assertEqual(answer.file_name, "part.S")
        self.assertIn("Thu Mar 04 08:52:34 1993", answer.content.decode().splitlines()[0])
        self.assertAlmostEqual(numbers(answer.content.decode())[0], 25.4, places=5)
        self.refused(self.stub.ConvertProgram,
                     program_pb2.ConvertProgramRequest(program=self.text("part.txt", "MOVE (1.,2.,-3.,90.,0.)\n")),
                     grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7704")

    def test_compensate(self):
        source = ";$dia=0.508\n;$left\nPATH LIN\nMOVE (0.,0.,0.,0.,0.)\nWORK 0,0/ON\nMOVE (10.,0.,0.,0.,0.)\nWORK 0,0/OFF\n"
        answer = self.stub.CompensateProgram(program_pb2.CompensateProgramRequest(program=self.text("part.S", source)))
        self.assertIn(b"MOVE (10.00000,0.25400,", answer.content)
        broken = self.stub.CompensateProgram(program_pb2.CompensateProgramRequest(program=self.text("part.S", "MOVE (\n")))
        self.assertEqual(broken.content, b"")
        self.assertGreater(len(broken.findings.diagnostics), 0)

    def test_transform(self):
        request = program_pb2.TransformProgramRequest(program=self.text("part.S", LINE))
        request.translation.x = 1.5
        self.assertEqual(numbers(self.stub.TransformProgram(request).content.decode())[0], 1001.5)
        request.rotation.extend([1.0, 2.0])
        self.refused(self.stub.TransformProgram, request, grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")

    def test_listing(self):
        put = program_pb2.PutProgramRequest(name="machines/optimo-1/programs/12")
        put.program.file_name, put.program.content = "12.S", LINE.encode()
        self.stub.PutProgram(put)
        answer = self.stub.GetProgramContent(program_pb2.GetProgramContentRequest(
            name="machines/optimo-1/programs/12", form=program_pb2.PROGRAM_FORM_LISTING))
        self.assertRegex(answer.content.decode(), r"^    1     1  +COORD ABSOL\n")

    def put(self, slot, name, content):
        put = program_pb2.PutProgramRequest(name=f"machines/optimo-1/programs/{slot}")
        put.program.file_name = name
        put.program.content = content if isinstance(content, bytes) else content.encode()
        return self.stub.PutProgram(put, timeout=60)

    # OPT-8.74, OPT-8.75
    def test_shift(self):
        request = program_pb2.ShiftProgramRequest(program=self.text("part.S", "VR[86] = 0.\nVR[89] = 1.\n"))
        request.translation.x = 30.0
        request.rotation.extend([0.5, 0.0, 0.0])
        self.assertEqual(self.stub.ShiftProgram(request).content, b"VR[86] = 30.0\nVR[89] = 1.5\n")
        none = self.stub.ShiftProgram(program_pb2.ShiftProgramRequest(program=self.text("part.S", "STOP\n")))
        self.assertEqual((none.content, none.findings.ok), (b"", False))
        self.assertEqual(none.findings.diagnostics[0].code, "OPT-E7852")
        request.rotation.extend([1.0])
        self.refused(self.stub.ShiftProgram, request, grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")

    # OPT-8.73: of a text and of its object the same but for the layout.
    def test_list_a_text(self):
        answer = self.stub.MakeListing(program_pb2.MakeListingRequest(program=self.text("a.S", LINE)))
        self.assertRegex(answer.content.decode(), r"^    1     1  +COORD ABSOL\n")
        compiled = self.stub.CompileProgram(program_pb2.CompileProgramRequest(program=self.text("a.S", LINE)))
        request = program_pb2.MakeListingRequest()
        request.program.content, request.program.form = compiled.object, program_pb2.PROGRAM_FORM_OBJECT
        self.assertEqual(self.stub.MakeListing(request).content, answer.content)
        wrong = self.stub.MakeListing(program_pb2.MakeListingRequest(program=self.text("a.S", "SPEED 101\n")))
        self.assertEqual((wrong.content, wrong.findings.ok), (b"", False))

    def test_fix(self):
        answer = self.stub.FixProgram(program_pb2.FixProgramRequest(program=self.text("a.S", "SPEDE 20 ; slow\n")))
        self.assertEqual(answer.content, b"SPEED 20 ; slow\n")
        self.assertEqual([finding.code for finding in answer.fixed], ["OPT-E7011"])
        self.assertTrue(answer.findings.ok)

    # OPT-1.13, OPT-1.15: the query, the command and the warning of the run agree.
    def test_link_and_staleness(self):
        self.put(74, "74.S", "VI[2]=1\n")
        self.put(72, "72.S", "FUNCTION 74\n")
        linked = self.stub.LinkProgram(program_pb2.LinkProgramRequest(slot=72, machine="machines/optimo-1"))
        self.assertEqual(list(linked.functions), [74])
        with tempfile.NamedTemporaryFile(suffix=".X") as file:
            file.write(linked.executable)
            file.flush()
            said = self.cell.command("put", "optimo-1", "172", file.name).stdout
        self.assertIn("programs/172 stored", said)
        request = program_pb2.ListStaleExecutablesRequest(parent="machines/optimo-1")
        self.assertEqual(len(self.stub.ListStaleExecutables(request).executables), 0)
        self.assertIn("every executable", self.cell.command("stale", "optimo-1").stdout)
        self.put(74, "74.S", "VI[2]=2\n")
        stale = self.stub.ListStaleExecutables(request).executables
        self.assertEqual([(one.name, [(part.program, part.reason) for part in one.parts]) for one in stale],
                         [("machines/optimo-1/programs/172",
                           [("machines/optimo-1/programs/74", program_pb2.StaleExecutable.REASON_FUNCTION_CHANGED)])])
        self.assertRegex(self.cell.command("stale", "optimo-1").stdout, r"172 +74 +FUNCTION 74 was altered")
        self.cell.command("delete", "optimo-1", "172")
        self.assertIn("every executable", self.cell.command("stale", "optimo-1").stdout)

    # OPT-10.17, OPT-E.7413: stored, and told of.
    def test_reserved_numbers_are_told_of(self):
        codes = [finding.code for finding in self.put(5, "5.S", "VI[2]=1\n").findings.diagnostics]
        self.assertEqual(codes, ["OPT-E7413"])
        self.assertEqual(len(self.put(8, "8.S", "VI[2]=1\n").findings.diagnostics), 0)
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder) / "5.S"
            source.write_text("VI[2]=1\n")
            done = self.cell.command("put", "optimo-1", "5", source)
        self.assertIn("OPT-E7413", done.stdout + done.stderr)

    # OPT-1.15: the executable of another program is none of this one.
    def test_a_foreign_executable_is_refused(self):
        self.put(64, "64.S", "VI[2]=1\n")
        self.put(65, "65.S", "VI[2]=2\n")
        linked = self.stub.LinkProgram(program_pb2.LinkProgramRequest(slot=65, machine="machines/optimo-1"))
        request = program_pb2.PutProgramRequest(name="machines/optimo-1/programs/164")
        request.program.content = linked.executable
        self.refused(self.stub.PutProgram, request, grpc.StatusCode.INVALID_ARGUMENT, "CELL-E9003")
        request.name = "machines/optimo-1/programs/165"
        self.stub.PutProgram(request)

    # OPT-8.70: comments, names and layout come back while the object is the one that was made of them.
    def test_own_text_comes_back_until_the_object_is_replaced(self):
        own = "; mine\nDECLARE   FEED = VR[5]\nfeed  =  20. ; slow\n"
        self.put(75, "slow.S", own)
        name = "machines/optimo-1/programs/75"
        request = program_pb2.DecompileProgramRequest(name=name)
        answer = self.stub.DecompileProgram(request)
        self.assertEqual((answer.content.decode(), answer.own_text, answer.file_name), (own, True, "slow.S"))
        self.assertEqual(self.cell.command("get", "optimo-1", "75").stdout, own)
        content = self.stub.GetProgramContent(
            program_pb2.GetProgramContentRequest(name=name, form=program_pb2.PROGRAM_FORM_OBJECT)).content
        self.put(75, "other.O", content)
        answer = self.stub.DecompileProgram(request)
        self.assertFalse(answer.own_text)
        self.assertNotIn(b"mine", answer.content)
        again = self.stub.CompileProgram(program_pb2.CompileProgramRequest(
            program=program_pb2.ProgramText(file_name="75.S", content=answer.content)))
        self.assertEqual(again.object, content)

    # OPT-8.70: a program that was stored as an object is shown as text; a terminal gets no bytes.
    def test_get_of_an_object_is_text(self):
        compiled = self.stub.CompileProgram(program_pb2.CompileProgramRequest(program=self.text("a.S", LINE))).object
        self.put(77, "77.O", compiled)
        source = self.cell.command("get", "optimo-1", "77").stdout
        self.assertIn("COORD ABSOL\n", source)
        self.assertEqual(source.encode(), self.stub.DecompileProgram(
            program_pb2.DecompileProgramRequest(object=compiled)).content)
        with tempfile.TemporaryDirectory() as folder:
            target = pathlib.Path(folder) / "77.O"
            self.cell.command("get", "optimo-1", "77", "-o", target)
            self.assertEqual(target.read_bytes(), compiled)
            self.cell.command("get", "optimo-1", "77", "-o", target.with_suffix(".S"))
            self.assertEqual(target.with_suffix(".S").read_text(), source)
        terminal, inside = os.openpty()
        try:
            done = subprocess.run([BIN / "rmlcell", "get", "optimo-1", "77", "--form", "object"], stdout=inside,
                                  stderr=subprocess.PIPE, text=True, timeout=60,
                                  env={**os.environ, "RMLCELL_SERVER": self.cell.address})
        finally:
            os.close(inside)
            os.close(terminal)
        self.assertEqual(done.returncode, 2, done)
        self.assertTrue(done.stderr.startswith("rmlcell: CELL-E9026: "), done.stderr)
        self.assertIn("-o FILE", done.stderr)

    def test_diff(self):
        self.put(76, "76.S", LINE)
        request = program_pb2.DiffProgramsRequest(picture=True)
        request.before.name = "machines/optimo-1/programs/76"
        request.after.text.CopyFrom(self.text("new.S", LINE.replace("1010.", "1013.")))
        diff = self.stub.DiffPrograms(request)
        self.assertEqual([(step.step_before, step.step_after) for step in diff.steps], [(5, 5)])
        self.assertAlmostEqual(diff.steps[0].target_moved_mm, 3.0, places=6)
        self.assertIn("travel_length", [figure.name for figure in diff.figures])
        xml.etree.ElementTree.fromstring(diff.picture_svg)
        request.after.text.content = b"SPEED 101\n"
        self.refused(self.stub.DiffPrograms, request, grpc.StatusCode.INVALID_ARGUMENT, "OPT-E7004")


if __name__ == "__main__":
    unittest.main(verbosity=2)
