"""What a mill leaves of a block: rmlcell simulate --stock and all that goes with it (docs/material.md)."""
import json
import struct
import unittest
import urllib.error
import zlib

import grpc
from cell import awaited, detail_of, eventually, inline_job, job_pb2, processor_ticks, submit, wait_for_end, wait_until_it_runs
from command import ask, run
from material import BLOCK, GROOVE, Material, WithServer


class Stl(Material):
    def triangles(self, *words, program=None):
        path = self.folder / "a.stl"
        self.good("--stl", path, *words, program=program)
        data = path.read_bytes()
        count = struct.unpack_from("<I", data, 80)[0]
        self.assertEqual(len(data), 84 + 50 * count)
        return [struct.unpack_from("<12f", data, 84 + 50 * k) for k in range(count)]

    # An untouched plate of 60 x 30 mm is a box: 12 triangles, less than a kilobyte.
    def test_a_plate_is_a_box(self):
        up = self.folder / "up.rml"
        up.write_text("PA;PU0,0;")
        found = self.triangles(program=up)
        self.assertEqual(len(found), 12)
        corners = {t[3 * k:3 * k + 3] for t in found for k in (1, 2, 3)}
        self.assertEqual(corners, {(x, y, z) for x in (0.0, 60.0) for y in (0.0, 30.0) for z in (-5.0, 0.0)})

    # What is missing is what the report says was taken off: 20 mm x 3 mm x 1 mm and two half discs.
    def test_the_body_lacks_what_was_taken_off(self):
        volume = 0.0
        for t in self.triangles("--stl-tolerance", "0"):
            (ax, ay, az), (bx, by, bz), (cx, cy, cz) = t[3:6], t[6:9], t[9:12]
            volume += (ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)) / 6
        self.assertAlmostEqual(60 * 30 * 5 - volume, 20 * 3 + 7.07, delta=0.7)

    def test_a_coarser_body_has_fewer_triangles(self):
        self.assertLess(len(self.triangles("--stl-tolerance", "2")), len(self.triangles()))

    def test_refusals(self):
        for words, text in ((("--stl-tolerance", "0.1"), "--stl"), ((*BLOCK, "--stl", "a.stl", "--stl-tolerance", "-1"), "tolerance"),
                            (("--stl", "a.stl"), "--stock")):
            done = self.simulate(*words)
            self.assertEqual(done.returncode, 2, done.stdout)
            self.assertIn(text, done.stderr)

    def test_a_file_that_cannot_be_written(self):
        for option in ("--stl", "--relief", "--height-map"):
            for path in ("/dev/full", self.folder / "no" / "x"):
                self.refused("CELL-E9023", f"{path}: cannot be written", *BLOCK, option, path)


def chunks(data):
    at = 8
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        yield kind.decode(), data[at + 8:at + 8 + length]
        at += 12 + length


class Pictures(Material):
    def written(self, option, name="a.png", *words):
        path = self.folder / name
        self.good(option, path, *words)
        return path.read_bytes()

    # 60 x 30 mm in cells of 0.2 mm: 300 x 150 pixels, 5000 a metre. The floor is 1 mm below the top of 5 mm: 4/5 of 65535.
    def test_a_height_map(self):
        data = self.written("--height-map")
        found = list(chunks(data))
        self.assertEqual(struct.unpack(">IIBBBBB", found[0][1]), (300, 150, 16, 0, 0, 0, 0))
        self.assertEqual(struct.unpack(">IIB", dict(found)["pHYs"]), (5000, 5000, 1))
        texts = dict(content.decode().split("\0") for kind, content in found if kind == "tEXt")
        self.assertEqual((texts["Bottom mm"], texts["Top mm"], texts["Cell mm"]), ("-5", "0", "0.2"))
        self.assertEqual(set(self.heights(data)), {65535, 52428})

    @staticmethod
    def heights(data):
        """Pixels of a grey PNG of 16 bits, by the format: filters of rows undone."""
        width, height = struct.unpack_from(">II", next(content for kind, content in chunks(data) if kind == "IHDR"))
        raw = zlib.decompress(b"".join(content for kind, content in chunks(data) if kind == "IDAT"))
        before = bytearray(2 * width)
        for y in range(height):
            kind, line = raw[y * (2 * width + 1)], bytearray(raw[y * (2 * width + 1) + 1:(y + 1) * (2 * width + 1)])
            for k in range(2 * width):
                a, b, c = line[k - 2] if k > 1 else 0, before[k], before[k - 2] if k > 1 else 0
                p = a + b - c
                paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
                line[k] = (line[k] + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
            yield from struct.unpack(f">{width}H", line)
            before = line

    def test_a_relief(self):
        found = list(chunks(self.written("--relief")))
        self.assertEqual(struct.unpack(">IIBBBBB", found[0][1]), (300, 150, 8, 2, 0, 0, 0))

    def test_the_same_bytes_each_time(self):
        for option in ("--relief", "--height-map", "--stl"):
            self.assertEqual(self.written(option, "a"), self.written(option, "b"))


# The same groove, 1.5 mm deep.
DEEPER = GROOVE.replace("-100", "-150")


class Tools(Material):
    def test_a_shank_in_material_is_bad(self):
        for tool, code, wanted in (("flat:3:flute=1", 0, "0.0"), ("flat:3:flute=0.5", 1, "0.5"), ("flat:3:flute=0.5:shank=2", 1, "0.5"),
                                   ("flat:3:holder=20@0.75", 1, "0.25"), ("flat:3", 0, "0.0")):
            with self.subTest(tool):
                done = self.simulate("--stock", "60x30x5", "--tool", tool, "--facts")
                self.assertEqual(done.returncode, code, done.stdout)
                self.assertIn(f"shank_depth_mm: {wanted}\n", done.stdout)
                self.assertEqual("CELL-E9611" in self.simulate("--stock", "60x30x5", "--tool", tool).stdout, code == 1)

    # 1 mm deep with a tool of 0.8 mm.
    def test_a_deep_pass_is_doubtful(self):
        words = ("--stock", "60x30x5", "--tool", "flat:0.8")
        self.assertEqual(self.simulate(*words).returncode, 0)
        done = self.simulate(*words, "--strict")
        self.assertEqual(done.returncode, 1)
        self.assertIn("one pass is as deep as 125.0 % of the width of the tool (CELL-E9612", done.stdout)

    # 4500 rpm are 75 turns a second: two edges take 10/150 = 0.067 mm each, more than twice 0.03 mm.
    def test_chip_load_by_material_and_spindle(self):
        edges = ("--stock", "60x30x5", "--tool", "flat:3:flutes=2")

        def judged(*words):
            return self.simulate(*edges, *words, "--strict")

        self.assertEqual(judged("--material", "wax").returncode, 0)
        hard = judged("--material", "aluminium")
        self.assertEqual(hard.returncode, 1)
        self.assertIn("an edge takes off 222.2 % of the most that is usual (CELL-E9615", hard.stdout)
        # As much as is usual across, and down, at the same 10 mm/s, 0.03 mm where 0.33 of that is.
        down = judged("--material", "aluminium", "--rpm", "10000")
        self.assertEqual(down.returncode, 1)
        self.assertIn("an edge takes off 303.0 % of the most that is usual straight down (CELL-E9615", down.stdout)
        self.assertEqual(judged("--material", "aluminium", "--rpm", "20000").returncode, 0)
        self.refused("CELL-E", "no material: aluminium, foam", *edges, "--material", "cheese")
        self.refused("CELL-E", "flutes=2", *BLOCK, "--material", "wax")

    # The tool comes and goes 2 mm above the block: clamps of 2 mm are no higher, those of 3 mm are.
    def test_clamps_in_the_way(self):
        self.assertEqual(self.simulate("--clamps", "2", "--strict").returncode, 0)
        high = self.simulate("--clamps", "3", "--strict")
        self.assertEqual(high.returncode, 1)
        self.assertIn("RML1-E8018", high.stdout)
        self.assertIn("RML1-E8018", run("check", self.groove, "--profile", "t1", "--clamps", "3", "--strict", code=1))
        laser = self.folder / "a.S"
        laser.write_text("EXIT\n")
        refused = self.simulate("--clamps", "3", program=laser)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("knows of no clamps", refused.stderr)
        self.refused("CELL-E", "CLAMP_HEIGHT", "--clamps", "-1")

    def test_figures_of_the_cut(self):
        facts = self.facts()
        self.assertAlmostEqual(float(facts["removed_volume_mm3"]) + float(facts["remaining_volume_mm3"]), 60 * 30 * 5, places=3)
        self.assertEqual((facts["deepest_cut_mm"], facts["deepest_pass_mm"], facts["target_left_mm"]), ("1.0", "1.0", "none"))

    def test_refusals(self):
        for tool, text in (("flat:3:neck=2", "'flat:3:neck=2' is no tool"), ("flat:3:shank=6", "say flute=LENGTH"),
                           ("ball:3:flute=1", "make flute longer"), ("drill:3", "is no tool: write flat:3, ball:3")):
            self.refused("CELL-E9003", text, "--stock", "60x30x5", "--tool", tool)


class Targets(Material):
    def setUp(self):
        super().setUp()
        self.deeper = self.folder / "deeper.rml"
        self.deeper.write_text(DEEPER)

    def targets(self, program):
        """The three forms of what `program` leaves."""
        self.good("--stl", self.folder / "t.stl", "--height-map", self.folder / "t.png", program=program)
        return self.folder / "t.stl", self.folder / "t.png", program

    # A program beside what it leaves itself: all good. Heights of the map are half a grey value off at most.
    def test_itself(self):
        for target in self.targets(self.groove):
            facts = self.facts("--target", target, "--target-tolerance", "0.02")
            self.assertEqual(facts["target_good_share"], "1.0", target)
            self.assertLess(float(facts["target_deep_mm"]), 0.011)
            self.assertEqual(facts["verdict"], "GOOD")

    # 0.5 mm are left of about 20 x 3 mm and two half discs; that is doubtful, and an exit code of 0.
    def test_too_much_left(self):
        for target in self.targets(self.deeper):
            with self.subTest(target.name):
                facts = self.facts("--target", target)
                self.assertAlmostEqual(float(facts["target_left_mm"]), 0.5, delta=0.011)
                self.assertEqual((facts["target_deep_mm"] < "0.011", facts["verdict"]), (True, "DOUBTFUL"))
                self.assertAlmostEqual(float(facts["target_left_volume_mm3"]), 0.5 * 67, delta=6)
                self.assertIn("CELL-E9614", self.simulate(*BLOCK, "--target", target).stdout)
                self.assertEqual(self.simulate(*BLOCK, "--target", target, "--strict").returncode, 1)
                self.assertEqual(self.facts("--target", target, "--target-tolerance", "0.52")["verdict"], "GOOD")

    def test_too_deep(self):
        for target in self.targets(self.groove):
            with self.subTest(target.name):
                done = self.simulate(*BLOCK, "--target", target, program=self.deeper)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertIn("CELL-E9613", done.stdout)
                self.assertRegex(done.stdout, r"too deep by up to 0.[45]\d\d mm at X \d+\.\d+, Y 1[3-6]")
                self.assertNotIn("too much left", done.stdout)

    def test_the_picture(self):
        path = self.folder / "d.png"
        self.simulate(*BLOCK, "--target", self.groove, "--target-png", path, program=self.deeper)
        found = list(chunks(path.read_bytes()))
        self.assertEqual(struct.unpack(">IIBBBBB", found[0][1]), (300, 150, 8, 2, 0, 0, 0))
        raw = zlib.decompress(b"".join(content for kind, content in found if kind == "IDAT"))
        self.assertEqual(raw[1:4], bytes([214, 214, 214]))  # a corner: good

    def test_the_report_as_json(self):
        milling = json.loads(self.simulate(*BLOCK, "--target", self.deeper, "--json").stdout)["milling"]
        self.assertEqual(milling["target"]["leftMm"], 0.5)
        self.assertEqual(milling["target"]["toleranceMm"], 0.1)
        self.assertEqual(milling["toolDiameterMm"], 3)

    def test_refusals(self):
        def file(name, data):
            (self.folder / name).write_bytes(data)
            return self.folder / name
        rows = (("CELL-E9022", "none.stl", self.folder / "none.stl"),
                ("CELL-E9024", "no STL: it neither begins", file("a.stl", b"no body")),
                ("CELL-E9024", "line 2: 'faced'", file("b.stl", b"solid\nfaced\n")),
                ("CELL-E9024", "no height map", file("c.png", b"\x89PNG\r\n\x1a\n")),
                ("CELL-E9003", "lies beside the block", file("d.stl", b"solid\nfacet normal 0 0 1\nvertex 900 0 0\n"
                                                             b"vertex 901 0 0\nvertex 900 1 0\nendfacet\n")),
                ("CELL-E9017", "e.rml", file("e.rml", b"")))
        for code, text, target in rows:
            with self.subTest(text):
                self.refused(code, text, *BLOCK, "--target", target)
        self.assertIn("--stock", self.simulate("--target", self.groove).stderr)
        self.assertIn("--target", self.simulate(*BLOCK, "--target-png", "x.png").stderr)
        self.assertEqual(self.simulate(*BLOCK, "--target", self.groove, "--target-tolerance", "-1").returncode, 2)
        self.refused("CELL-E9023", "/dev/full", *BLOCK, "--target", self.groove, "--target-png", "/dev/full")


class Jobs(WithServer):
    """The same as products of jobs: each file has the bytes that simulate writes."""

    FILES = {"relief.png": ("--relief", "image/png"), "height.png": ("--height-map", "image/png"),
             "left.stl": ("--stl", "model/stl")}

    def submitted(self, *words):
        done = self.cell.command("submit", "mill-1", self.groove, *words, "--watch", check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout.splitlines()[0]

    def test_the_products_are_the_files_of_simulate(self):
        words = (*BLOCK, "--products", "relief,height-map,stl", "--stl-tolerance", "0.05")
        job = self.submitted(*words)
        self.assertLessEqual(set(self.FILES), self.products(job))
        for name, (option, media_type) in self.FILES.items():
            path = self.folder / name
            more = ("--stl-tolerance", "0.05") if option == "--stl" else ()
            run("simulate", self.groove, "--profile", "srm-20", *BLOCK, option, path, *more)
            got = self.folder / "got"
            self.cell.command("artifact", job, name, "-o", got)
            self.assertEqual(got.read_bytes(), path.read_bytes(), name)
            with self.fetched(job, name) as answer:
                self.assertEqual(answer.headers["Content-Type"], media_type)
                etag = answer.headers["ETag"]
                self.assertEqual(answer.read(), path.read_bytes(), name)
            with self.assertRaises(urllib.error.HTTPError) as caught:
                self.fetched(job, name, **{"If-None-Match": etag})
            self.assertEqual(caught.exception.code, 304)

    # Who looks on has at the end what is stored, and saw it before.
    def test_the_heights_are_followed_while_the_job_runs(self):
        stub = self.cell.jobs()
        wanted = inline_job("mill-1", "groove.rml", GROOVE)
        wanted.simulation.pace = 5.0
        milling = wanted.simulation.milling
        milling.stock.size_x_mm, milling.stock.size_y_mm, milling.stock.size_z_mm = 60, 30, 5
        milling.tool.shape, milling.tool.diameter_mm = 1, 3
        milling.cell_mm, milling.height_grid = 0.2, True

        def heights(name, **request):
            parts = list(stub.StreamJobHeights(job_pb2.StreamJobHeightsRequest(name=name, **request), timeout=60))
            self.assertEqual({p.WhichOneof("part") for p in parts[1:]}, {"tiles"})
            tiles = [tile for part in parts[1:] for tile in part.tiles.tiles]
            return parts[0].grid, tiles, {(t.row, t.column): t.heights for t in tiles}

        def seen_changing():
            """Some come again as they change. Whoever is late to look at it sees its end alone: then at another one."""
            name = submit(stub, wanted).name
            seen = heights(name, follow=True)
            return (name, *seen) if len(seen[1]) > len(seen[2]) else None
        name, grid, _, followed = awaited(seen_changing)
        self.assertEqual((grid.columns, grid.rows, grid.level, grid.cell_mm), (300, 150, 0, 0.2))
        again, _, stored = heights(name)
        self.assertEqual(again, grid)
        self.assertEqual(len(stored), 5 * 3)
        self.assertEqual({place: row for place, row in stored.items() if row.strip(b"\xff")}, followed)
        # The cell in the middle of the groove: 1 mm of 5 mm are gone.
        numbers = struct.unpack("<4096H", stored[64, 128])
        self.assertAlmostEqual(numbers[(75 - 64) * 64 + 150 - 128], 65535 * 4 / 5, delta=1)
        self.assertEqual(len(heights(name, level=2)[1]), 2)  # 75 by 38 squares

    # 20 mm x 3 mm x 1 mm and two half discs of 1.5 mm.
    def test_the_report_has_the_figures(self):
        job = self.submitted(*BLOCK)
        report = json.loads(self.cell.command("report", job, "--json").stdout)
        self.assertAlmostEqual(report["milling"]["removedMm3"], 67.07, delta=0.7)
        self.assertTrue({"relief.png"} <= self.products(job))
        self.assertFalse({"height.png", "left.stl"} & self.products(job))

    def test_what_is_refused_and_where(self):
        for words, code, text in (((*BLOCK, "--products", "svg"), 2, "--products"),
                                  (("--stock", "60x30x5"), 2, "--tool"),
                                  (("--stock", "60x30", "--tool", "flat:3"), 2, "is no block"),
                                  (("--stock", "6000x3000x5", "--tool", "flat:3"), 2, "make the cells larger"),
                                  ((*BLOCK, "--project", "coaster"), 2, "--project")):
            done = self.cell.command("submit", "mill-1", self.groove, *words, check=False)
            self.assertEqual((done.returncode, done.stdout), (code, ""), done.stderr)
            self.assertIn(text, done.stderr)
        program = self.folder / "a.S"
        program.write_text("STOP\n")
        done = self.cell.command("submit", "optimo-1", program, *BLOCK, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("job.simulation.milling is for mills", done.stderr)

    # 5000 by 5000 cells of 4 bytes are 100 MB. The job ends, and its worker takes the next one.
    def test_a_block_beyond_the_memory_of_the_job(self):
        stub = self.cell.jobs()
        wanted = inline_job("mill-1", "groove.rml", GROOVE)
        milling = wanted.simulation.milling
        milling.stock.size_x_mm = milling.stock.size_y_mm = 50
        milling.stock.size_z_mm = 5
        milling.tool.shape = 1
        milling.tool.diameter_mm = 3
        milling.cell_mm = 0.01
        wanted.budget.memory_bytes = 64 << 20
        self.assertTrue(eventually(lambda: len(self.cell.worker_processes()) == 4))
        workers = sorted(self.cell.worker_processes())
        ended = self.ended(stub, wanted)
        self.assertEqual((ended.state, ended.outcome.code), (job_pb2.Job.STATE_FAILED, "CELL-E9302"))
        self.assertEqual(sorted(self.cell.worker_processes()), workers)
        milling.cell_mm = 0.2
        self.assertEqual(self.ended(stub, wanted).state, job_pb2.Job.STATE_SUCCEEDED)

    # Block and tool of the project's program of the same slot; the job keeps them when the project changes.
    def test_a_project_has_block_and_tool(self):
        folder = self.folder / "coaster"
        folder.mkdir()
        (folder / "7.rml").write_text(GROOVE)
        milling = {"stock": {"sizeXMm": 60, "sizeYMm": 30, "sizeZMm": 5}, "cellMm": 0.2, "relief": True,
                   "tool": {"shape": "SHAPE_FLAT", "diameterMm": 3}}
        program = {"slot": 7, "source": {"fileName": "7.rml"}, "milling": milling}
        (folder / "project.json").write_text(json.dumps({"programs": [program]}))
        self.cell.command("projects", "create", "coaster", folder)
        self.cell.command("projects", "transfer", "coaster", "mill-1")
        job = self.cell.command("submit", "mill-1", "--slot", 7, "--project", "coaster", "--watch").stdout.splitlines()[0]
        report = json.loads(self.cell.command("report", job, "--json").stdout)
        self.assertAlmostEqual(report["milling"]["removedMm3"], 67.07, delta=0.7)
        self.assertIn("relief.png", self.products(job))
        done = self.cell.command("submit", "mill-1", self.groove, "--slot", 8, "--project", "coaster", check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("projects/coaster has no milling for slot 8", done.stderr)
        milling["tool"]["diameterMm"] = 0
        (folder / "project.json").write_text(json.dumps({"programs": [program]}))
        done = self.cell.command("projects", "update", "coaster", folder, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("program 7: milling.tool", done.stderr)

    def test_an_artifact_that_is_not_there(self):
        job = self.submitted()
        done = self.cell.command("artifact", job, "relief.png", check=False)
        self.assertEqual((done.returncode, done.stdout), (3, ""))
        self.assertIn("has no relief.png", done.stderr)


def layers(count):
    """A binary STL of so many triangles that each lie over all of the block."""
    triangle = struct.pack("<12fH", 0, 0, 1, -1, -1, 0, 200, -1, 0, -1, 200, 0, 0)
    return bytes(80) + struct.pack("<I", count) + count * triangle


class JobTargets(WithServer):
    """A job beside its target, and the chips of its tool: what simulate says of the same inputs."""

    def setUp(self):
        super().setUp()
        self.deeper = self.file("deeper.rml", DEEPER)

    def command_says(self, program, *words):
        done = ask("simulate", program, "--profile", "srm-20", *BLOCK, *words, "--json")
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(done.stdout)

    def ended_job(self, *words, program=None):
        done = self.cell.command("submit", "mill-1", *([program] if program else []), *words, "--watch", check=False)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return done.stdout.splitlines()[0]

    def same(self, job, wanted):
        report = json.loads(self.cell.command("report", job, "--json").stdout)
        self.assertEqual(report["milling"], wanted["milling"])
        self.assertEqual(report["outcome"], wanted["outcome"])
        return report

    def test_figures_verdict_and_picture_are_those_of_simulate(self):
        run("simulate", self.groove, "--profile", "srm-20", *BLOCK, "--stl", self.folder / "t.stl", "--height-map", self.folder / "t.png")
        picture, got = self.folder / "d.png", self.folder / "got.png"
        for program, target, verdict in ((self.deeper, self.folder / "t.stl", "BAD"), (self.deeper, self.folder / "t.png", "BAD"),
                                         (self.deeper, self.groove, "BAD"), (self.groove, self.deeper, "DOUBTFUL"),
                                         (self.groove, self.groove, "GOOD")):
            with self.subTest(f"{program.name} beside {target.name}"):
                words = ("--target", target, "--target-tolerance", "0.02")
                wanted = self.command_says(program, *words, "--target-png", picture)
                job = self.ended_job(*BLOCK, *words, "--products", "relief,target", program=program)
                report = self.same(job, wanted)
                self.assertEqual(report["milling"]["target"]["toleranceMm"], 0.02)
                self.assertEqual(report["outcome"]["verdict"], "VERDICT_" + verdict)
                self.cell.command("artifact", job, "target.png", "-o", got)
                self.assertEqual(got.read_bytes(), picture.read_bytes())
                with self.fetched(job, "target.png") as answer:
                    self.assertEqual(answer.headers["Content-Type"], "image/png")

    # 0.5 mm too deep, as the file says that was stored when the job was submitted.
    def test_a_stored_program(self):
        self.cell.command("put", "mill-1", 21, self.groove)
        job = self.ended_job(*BLOCK, "--target-slot", 21, program=self.deeper)
        report = self.same(job, self.command_says(self.deeper, "--target", self.groove))
        self.assertEqual(report["milling"]["target"]["deepMm"], 0.5)
        self.assertNotIn("target.png", self.products(job))
        done = self.cell.command("submit", "mill-1", self.groove, *BLOCK, "--target-slot", 22, check=False)
        self.assertEqual((done.returncode, done.stdout), (3, ""), done.stderr)
        self.assertIn("machines/mill-1/programs/22", done.stderr)

    # 10 mm/s at 4500 rpm and two edges are 0.067 mm, 222.2 % of 0.03 mm; at 10000 rpm it is the usual. Down it goes at a tenth of that.
    def test_chips_are_judged_as_by_simulate(self):
        groove = self.file("slow.rml", GROOVE.replace("!VZ10", "!VZ1"))
        edges = ("--stock", "60x30x5", "--tool", "flat:3:flutes=2", "--material", "aluminium")
        for rpm, codes in (("4500", ["CELL-E9615"]), ("10000", [])):
            wanted = json.loads(ask("simulate", groove, "--profile", "srm-20", *edges, "--rpm", rpm, "--json").stdout)
            report = self.same(self.ended_job(*edges, "--rpm", rpm, program=groove), wanted)
            self.assertEqual([reason["code"] for reason in report["outcome"].get("reasons", [])], codes)

    def test_what_the_command_refuses(self):
        wrong = self.file("a.stl", "no body")
        for words, code, text in ((("--target", wrong), "CELL-E9024", "no STL"),
                                  (("--target", self.folder / "none.stl"), "CELL-E9022", "none.stl"),
                                  (("--target", self.file("e.rml", "")), "CELL-E9017", "e.rml"),
                                  (("--products", "target"), "CELL-E9026", "--target or --target-slot"),
                                  (("--target-tolerance", "1"), "CELL-E9026", "--target or --target-slot"),
                                  (("--material", "wax"), "CELL-E9003", "flutes=2"),
                                  (("--material", "cheese"), "CELL-E9003", "aluminium, foam")):
            with self.subTest(text):
                done = self.cell.command("submit", "mill-1", self.groove, *BLOCK, *words, check=False)
                self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
                self.assertIn(code, done.stderr)
                self.assertIn(text, done.stderr)
        for words in (("--target", self.groove), (*BLOCK, "--target", self.groove, "--target-slot", "3"),
                      (*BLOCK, "--target-slot", "100"), (*BLOCK, "--rpm", "0.5")):
            self.assertEqual(self.cell.command("submit", "mill-1", self.groove, *words, check=False).returncode, 2, words)

    def wanted(self, cell_mm=0.2):
        job = inline_job("mill-1", "groove.rml", GROOVE)
        milling = job.simulation.milling
        milling.stock.size_x_mm, milling.stock.size_y_mm, milling.stock.size_z_mm = 60, 30, 5
        milling.tool.shape, milling.tool.diameter_mm, milling.cell_mm = 1, 3, cell_mm
        return job, milling

    # What a server knows at once it refuses; what takes reading ends the job, with code and advice.
    def test_what_the_server_refuses(self):
        stub = self.cell.jobs()
        for change, code, text in ((lambda t: t.file.SetInParent(), "CELL-E9003", "target.file.content is empty"),
                                   (lambda t: setattr(t.file, "content", b"PA;"), "CELL-E9024", "target.file: no STL"),
                                   (lambda t: setattr(t, "slot", 100), "CELL-E9003", "target.slot is 100"),
                                   (lambda t: setattr(t, "tolerance_mm", -1), "CELL-E9003", "target.tolerance_mm is -1"),
                                   (lambda t: setattr(t.inline_program, "file_name", "a.S"), "CELL-E9017", "target.inline_program")):
            job, milling = self.wanted()
            change(milling.target)
            with self.subTest(text), self.assertRaises(grpc.RpcError) as caught:
                submit(stub, job)
            self.assertEqual(detail_of(caught.exception).code, code)
            self.assertIn("job.simulation.milling." + text, caught.exception.details())
        far = b"solid\nfacet normal 0 0 1\nvertex 900 0 0\nvertex 901 0 0\nvertex 900 1 0\nendfacet\n"
        for content, code, text in ((b"\x89PNG\r\n\x1a\n", "CELL-E9024", "no height map"), (b"solid\nfaced\n", "CELL-E9024", "line 2: 'faced'"),
                                    (far, "CELL-E9003", "lies beside the block")):
            job, milling = self.wanted()
            milling.target.file.content = content
            ended = self.ended(stub, job)
            self.assertEqual((ended.state, ended.outcome.code), (job_pb2.Job.STATE_FAILED, code))
            self.assertIn(text, ended.outcome.message)
            self.assertTrue(ended.outcome.advice)

    # 4 MiB is what a call may be.
    def test_a_target_that_is_too_large_for_a_call(self):
        large = self.folder / "large.stl"
        large.write_bytes(layers(100_000))
        done = self.cell.command("submit", "mill-1", self.groove, *BLOCK, "--target", large, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("one call takes 4194304 (limits.message_bytes)", done.stderr)

    def processor_ticks(self):
        return sum(map(processor_ticks, self.cell.worker_processes()))

    # 25,000 layers over 18 million cells take many minutes; the job ends as soon as it is asked to: without a hundredth of them, which
    # is more than goes by while its worker has not heard of it.
    def test_a_cancel_is_obeyed_before_the_run_begins(self):
        stub = self.cell.jobs()
        job, milling = self.wanted(cell_mm=0.01)
        milling.target.file.content = layers(25)
        before = self.processor_ticks()
        self.ended(stub, job)
        a_hundredth = 10 * (self.processor_ticks() - before)
        milling.target.file.content = layers(25_000)
        name = submit(stub, job).name
        wait_until_it_runs(stub, name)
        before = self.processor_ticks()
        stub.CancelJob(job_pb2.CancelJobRequest(name=name))
        wait_for_end(stub, name)
        self.assertLess(self.processor_ticks() - before, a_hundredth)
        ended = stub.GetJob(job_pb2.GetJobRequest(name=name))
        self.assertEqual((ended.state, ended.outcome.code), (job_pb2.Job.STATE_CANCELLED, "CELL-E9307"))
        self.assertEqual({product.name for product in ended.artifacts}, {"program", "target"})

    # Heights, body and pictures of 18 million cells take seconds; the run itself is over at once.
    def test_a_cancel_is_obeyed_between_the_products(self):
        stub = self.cell.jobs()
        job, milling = self.wanted(cell_mm=0.01)
        milling.height_map = milling.relief = milling.stl = True

        def ended_otherwise():
            """Where the cancel comes too late there is another one."""
            name = submit(stub, job).name
            awaited(lambda: stub.GetJob(job_pb2.GetJobRequest(name=name)).state != job_pb2.Job.STATE_QUEUED)
            stub.CancelJob(job_pb2.CancelJobRequest(name=name))
            wait_for_end(stub, name)
            ended = stub.GetJob(job_pb2.GetJobRequest(name=name))
            return ended if ended.state != job_pb2.Job.STATE_SUCCEEDED else None
        ended = awaited(ended_otherwise)
        self.assertEqual(ended.state, job_pb2.Job.STATE_CANCELLED)
        self.assertFalse({product.name for product in ended.artifacts} & {"left.stl", "height.png", "relief.png"})

    def test_a_project_has_a_target(self):
        folder = self.folder / "beside"
        folder.mkdir()
        (folder / "9.rml").write_text(DEEPER)
        (folder / "parts").mkdir()
        (folder / "parts" / "old.rml").write_text(GROOVE)
        milling = {"stock": {"sizeXMm": 60, "sizeYMm": 30, "sizeZMm": 5}, "cellMm": 0.2, "tool": {"shape": "SHAPE_FLAT", "diameterMm": 3},
                   "target": {"inlineProgram": {"fileName": "parts/old.rml"}, "picture": True}}
        program = {"slot": 9, "source": {"fileName": "9.rml"}, "milling": milling}

        def write():
            (folder / "project.json").write_text(json.dumps({"programs": [program]}))
        write()
        self.cell.command("projects", "create", "beside", folder)
        self.cell.command("projects", "transfer", "beside", "mill-1")
        wanted = self.command_says(self.deeper, "--target", self.groove, "--target-png", self.folder / "d.png")
        # The job has its program at 9, the command at 1.
        wanted = json.loads(json.dumps(wanted).replace('"program": 1,', '"program": 9,'))
        got = self.folder / "got.png"

        def submitted():
            job = self.ended_job("--slot", 9, "--project", "beside")
            self.same(job, wanted)
            self.cell.command("artifact", job, "target.png", "-o", got)
            self.assertEqual(got.read_bytes(), (self.folder / "d.png").read_bytes())
        submitted()
        # The same by a stored program of the machine.
        self.cell.command("put", "mill-1", 10, self.groove)
        milling["target"] = {"slot": 10, "picture": True}
        write()
        self.cell.command("projects", "update", "beside", folder)
        submitted()
        (folder / "a.stl").write_text("no body")
        milling["target"] = {"file": {"fileName": "a.stl"}}
        write()
        done = self.cell.command("projects", "update", "beside", folder, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("program 9: milling.target.file: no STL", done.stderr)


if __name__ == "__main__":
    unittest.main()
