"""Every command of the documents runs, and prints what stands below it.

A block ```sh is run by bash, in a folder of its own for each page, with a fresh server; the addresses of
the page stand for those of that server. A block ```text right below it lists lines, or parts of
lines, that the output must have in this order; "..." stands for any. `grpcurl` stands for itself where it is installed, else
for `buf curl`; where there is neither, blocks with it are skipped and counted. `sqlite3` stands for
Python's own module where it is missing.

Environment: RMLCELL_BIN, the folder of the binaries; RMLCELL_BUF, buf, when it is not on the path.
"""
import csv
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import time
import unittest
import urllib.error
import urllib.request

BIN = pathlib.Path(os.environ["RMLCELL_BIN"])
ROOT = pathlib.Path(__file__).resolve().parents[2]
BUF = os.environ.get("RMLCELL_BUF") or shutil.which("buf")

# grpcurl as the documents use it, by buf.
GRPCURL_BY_BUF = r"""
grpcurl() {
  local data= host= method=
  while [ $# -gt 0 ]; do
    case $1 in
      -plaintext) ;;
      -d) data=$2; shift ;;
      *) if [ -z "$host" ]; then host=$1; else method=$1; fi ;;
    esac
    shift
  done
  if [ "$method" = list ]; then
    "$RMLCELL_BUF" curl --protocol grpc --http2-prior-knowledge "http://$host" --list-services
  else
    "$RMLCELL_BUF" curl --protocol grpc --http2-prior-knowledge ${data:+-d "$data"} "http://$host/$method"
  fi
}
"""


# sqlite3 FILE ".backup 'COPY'" by Python.
SQLITE_BY_PYTHON = r"""
sqlite3() {
  /usr/bin/python3 -c 'import sqlite3, sys
sqlite3.connect(sys.argv[1]).backup(sqlite3.connect(sys.argv[2].split("\x27")[1]))' "$@"
}
"""


class Server:
    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="rmlcell-"))
        log = self.folder / "log"
        log.write_text("")
        self.process = subprocess.Popen(
            [BIN / "rmlcelld", "--state.directory", self.folder / "store", "--listen.grpc", "127.0.0.1:0",
             "--listen.web", "127.0.0.1:0", "--workers.count", "1", "--log.file", log])
        until = time.monotonic() + 60
        while "is ready" not in log.read_text():
            if self.process.poll() is not None or time.monotonic() > until:
                raise RuntimeError("the server did not start:\n" + log.read_text()[-3000:])
            time.sleep(0.02)
        self.grpc = re.search(r"gRPC on (\S+)", log.read_text()).group(1)
        self.web = re.search(r"web on http://(\S+)/", log.read_text()).group(1)

    def close(self):
        self.process.terminate()
        try:
            self.process.wait(timeout=60)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def examples(page):
    """(line, commands, expected lines) of each ```sh block."""
    found = []
    pattern = re.compile(r"^```sh\n(.*?)^```\n(?:```text\n(.*?)^```\n)?", re.DOTALL | re.MULTILINE)
    text = page.read_text()
    for match in pattern.finditer(text):
        line = text.count("\n", 0, match.start()) + 1
        found.append((line, match.group(1), (match.group(2) or "").splitlines()))
    return found


class Documents(unittest.TestCase):
    maxDiff = None

    def run_page(self, page):
        server = Server()
        self.addCleanup(server.close)
        folder = pathlib.Path(tempfile.mkdtemp(prefix="rmlcell-page-"))
        self.addCleanup(shutil.rmtree, folder, ignore_errors=True)
        shutil.copytree(ROOT / "deploy" / "examples", folder, dirs_exist_ok=True)
        if page.name == "README.md":
            shutil.copy(folder / "bracket.S", folder / "part.S")
            shutil.copy(folder / "coaster.rml", folder / "part.rml")
            (folder / "32.S").write_text("CALL 44\n")
            (folder / "progs").mkdir()
            (folder / "progs" / "44.S").write_text("VI[2] = 1\n")
        environment = {"PATH": f"{BIN}:{os.environ['PATH']}", "HOME": str(folder), "NO_COLOR": "1",
                       "RMLCELL_SERVER": server.grpc}
        prelude = "set -euo pipefail\n"
        if shutil.which("grpcurl") is None and BUF:
            environment["RMLCELL_BUF"] = BUF
            prelude += GRPCURL_BY_BUF
        if shutil.which("sqlite3") is None:
            prelude += SQLITE_BY_PYTHON
        for line, commands, expected in examples(page):
            with self.subTest(page=page.name, line=line):
                if "grpcurl" in commands and not (shutil.which("grpcurl") or BUF):
                    self.skipTest("neither grpcurl nor buf is here")
                # The server of the page runs already.
                script = re.sub(r"^rmlcelld  .*\n", "", commands, flags=re.MULTILINE)
                script = script.replace("/var/lib/rmlcell", str(server.folder / "store"))
                script = script.replace("127.0.0.1:50051", server.grpc).replace("127.0.0.1:50080", server.web)
                done = subprocess.run(["bash", "-c", prelude + script], cwd=folder, env=environment, text=True,
                                      capture_output=True, timeout=120, errors="replace")
                self.assertEqual(done.returncode, 0, commands + done.stdout + done.stderr)
                # A log says when: any time stands for any other one there, and "..." for the rest of a line.
                dated = any(re.match(r"\d{4}-\d\d-\d\d ", wanted) for wanted in expected)

                def fold(text):
                    return re.sub(r"\d{4}-\d\d-\d\d \d\d:\d\d:|\d+\.\d{3}\b", "0", text) if dated else text

                told, at = fold(done.stdout), 0
                for wanted in expected:
                    pattern = ".*".join(re.escape(part) for part in fold(wanted.strip()).split("..."))
                    found = re.compile(pattern).search(told, at)
                    self.assertIsNotNone(found, f"'{wanted}' does not stand where it should in\n{done.stdout}{done.stderr}")
                    at = found.end()

    def test_readme(self):
        self.run_page(ROOT / "README.md")

    def test_files(self):
        self.run_page(ROOT / "docs" / "files.md")

    def test_material(self):
        self.run_page(ROOT / "docs" / "material.md")

    def test_api(self):
        self.run_page(ROOT / "docs" / "api.md")

    def test_operations(self):
        self.run_page(ROOT / "docs" / "operations.md")

    def test_every_link_leads_somewhere(self):
        links = 0
        for page in [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("[a-z]*/**/README.md")]:
            if "build" in page.parts or "node_modules" in page.parts:
                continue
            text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
            for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
                links += 1
                self.assertTrue((page.parent / target).exists(), f"{page.relative_to(ROOT)}: {target}")
        self.assertGreater(links, 10)

    def test_every_document_that_the_code_names_is_there(self):
        named = 0
        for folder in ("clients", "cmake", "deploy", "engine", "proto", "server", "storage", "tests"):
            for path in (ROOT / folder).rglob("*"):
                if path.suffix not in (".h", ".cc", ".proto", ".py", ".sh", ".cmake", ".md", ".1", ".8") or \
                        "node_modules" in path.parts:
                    continue
                for document in re.findall(r"\bdocs/[\w./-]+\.md\b", path.read_text(errors="replace")):
                    named += 1
                    self.assertTrue((ROOT / document).exists(), f"{path.relative_to(ROOT)} names {document}")
        self.assertGreater(named, 5)

    def test_the_table_lists_the_methods_that_the_web_port_lacks_and_no_others(self):
        server = Server()
        self.addCleanup(server.close)
        lacking = set()
        methods, there = 0, set()
        for proto in sorted((ROOT / "proto" / "rmlcell" / "v1").glob("*.proto")):
            service = re.search(r"^service (\w+) ", proto.read_text(), re.MULTILINE)
            if not service or service.group(1) in ("WorkerService", "HostService"):
                continue
            for method, client_stream in re.findall(r"^  rpc (\w+)\((stream )?", proto.read_text(), re.MULTILINE):
                if client_stream:
                    continue  # not on the web port
                methods += 1
                there.add(f"{service.group(1)}.{method}")
                request = urllib.request.Request(
                    f"http://{server.web}/rmlcell.v1.{service.group(1)}/{method}", data=b"{}",
                    headers={"Content-Type": "application/json"})
                try:
                    with urllib.request.urlopen(request, timeout=30) as answer:
                        # A stream that is refused has begun: its first event is the error.
                        stream = answer.headers.get_content_type() == "text/event-stream"
                        if stream and answer.readline() == b"event: error\n" and b"CELL-E9014" in answer.readline():
                            lacking.add(f"{service.group(1)}.{method}")
                except urllib.error.HTTPError as error:
                    if error.code == 501:
                        lacking.add(f"{service.group(1)}.{method}")
        self.assertGreater(methods, 50)
        with open(ROOT / "tests/conformance/later_methods.csv", encoding="utf-8", newline="") as file:
            table = {f"{row['service']}.{row['method']}" for row in csv.DictReader(file)}
        self.assertEqual(lacking, table & there)
        self.assertIn("later_methods.csv", (ROOT / "CHANGELOG.md").read_text())

    def test_the_block_of_the_toolpath_page_is_read_by_its_reader(self):
        page = (ROOT / "docs" / "toolpath.md").read_text()
        reader = {}
        exec(re.search(r"```python\n(.*?)```", page, re.DOTALL).group(1), reader)
        section = page[page.index("## A block by hand"):page.index("## A reader")]
        block = bytes.fromhex("".join(re.findall(r"^    ((?:[0-9a-f]{2} )+) ", section, re.MULTILINE)))
        self.assertEqual(list(reader["runs"](block)), [
            {"program": 2, "step": 5, "use": "cut", "beam_on": True, "speed_class": 4, "power_class": 15,
             "reached_class": 0, "start_s": 300e-6, "end_s": 310e-6,
             "points_mm": [(0.001, -0.001, 0.0), (0.003, -0.001, 0.0)],
             "turned_rad": [(0.0, -2e-6), (1e-6, -2e-6)], "times_s": [300e-6, 310e-6]}])
        with self.assertRaises(ValueError):
            list(reader["runs"](block + b"\0"))
        with self.assertRaises(ValueError):
            list(reader["runs"](b"T\1" + block[2:]))

    def test_the_reader_finds_the_lengths_of_the_report_in_the_toolpath_of_a_job(self):
        reader = {}
        exec(re.search(r"```python\n(.*?)```", (ROOT / "docs" / "toolpath.md").read_text(), re.DOTALL).group(1),
             reader)
        server = Server()
        self.addCleanup(server.close)
        for machine, program in (("mill-1", "coaster.rml"), ("optimo-1", "bracket.S")):
            done = subprocess.run([BIN / "rmlcell", "submit", machine, ROOT / "deploy" / "examples" / program,
                                   "--server", server.grpc, "--watch"], capture_output=True, text=True,
                                  env={"PATH": os.environ["PATH"]}, timeout=60)
            job = done.stdout.splitlines()[0]
            get = lambda name: urllib.request.urlopen(f"http://{server.web}/v1/{job}/artifacts/{name}").read()
            whole = json.loads(get("report"))
            report = whole["total"]
            surface_z = whole.get("workOrigin", {"z": math.inf})["z"]  # of a mill; a stroke along it cuts nothing
            length = {"travel": 0.0, "cut": 0.0, "plunge": 0.0, "retract": 0.0}
            end_s = 0.0
            for block in reader["frames"](get("toolpath")):
                for run in reader["runs"](block):
                    points = run["points_mm"]
                    use = run["use"] if min(point[2] for point in points) < surface_z else "travel"
                    length[use] += sum(math.dist(a, b) for a, b in zip(points, points[1:]))
                    self.assertGreaterEqual(run["start_s"], end_s)
                    end_s = run["end_s"]
            # Chords are shorter than arcs: 0.01 mm off a radius of 6 mm is 0.06 % of its length.
            self.assertAlmostEqual(length["cut"] + length["plunge"], report["cutLengthMm"],
                                   delta=6e-4 * report["cutLengthMm"])
            self.assertAlmostEqual(length["travel"] + length["retract"], report["travelLengthMm"],
                                   delta=6e-4 * report["travelLengthMm"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
