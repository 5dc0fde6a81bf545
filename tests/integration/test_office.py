#!/usr/bin/env python3
"""The tools of the programming office, from the command line and over gRPC."""
import json
import math
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

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
        self.assertIn("none.S", said)
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
            self.assertIn(code, self.refused_conversion(*words))
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
        self.assertEqual([(step["step_a"], step["step_b"]) for step in diff["steps"]], [(5, 5)])
        self.assertAlmostEqual(diff["steps"][0]["target_moved_mm"], 3.0, places=6)
        figures = {figure["name"]: figure for figure in diff["figures"]}
        self.assertAlmostEqual(figures["travel_length"]["after"] - figures["travel_length"]["before"], 3.0, places=6)

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
            call(request, timeout=30)
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


if __name__ == "__main__":
    unittest.main(verbosity=2)
