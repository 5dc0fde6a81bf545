#!/usr/bin/env python3
"""The house as it stands keeps its walls, and a made-up one that does not is found out."""
import os
import re
import subprocess
import sys
import tempfile
import unittest

import check_structure as structure

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.abspath(os.path.join(HERE, "..", ".."))


class TheHouse(unittest.TestCase):
    maxDiff = None

    def test_keeps_its_walls(self):
        self.assertEqual(structure.check(ROOT), [])

    def test_every_room_of_the_table_is_there(self):
        rooms = {structure.room_of(path) for path in structure.files_under(ROOT)
                 if path.endswith((".h", ".cc"))}
        self.assertEqual([room for room in structure.MAY_INCLUDE if room not in rooms], [])

    def test_dependencies_point_one_way(self):
        """No room reaches itself through others: the table has no circle."""
        state = {}

        def visit(room, way):
            self.assertNotEqual(state.get(room), "open", " -> ".join(way + [room]))
            if state.get(room) == "done":
                return
            state[room] = "open"
            for other in structure.MAY_INCLUDE.get(room, []):
                visit(other, way + [room])
            state[room] = "done"

        for room in structure.MAY_INCLUDE:
            visit(room, [])

    def test_the_engine_knows_nothing_outside(self):
        for room, others in structure.MAY_INCLUDE.items():
            if room.startswith("engine/"):
                self.assertTrue(all(other.startswith("engine/") for other in others), room)
            if room.startswith("storage"):
                self.assertTrue(all(other == "engine/core" or other.split("/")[0] == "storage" for other in others), room)
            if not room.startswith("server"):
                self.assertFalse([other for other in others if other.startswith("server")], room)

    def test_the_order_of_the_build_is_the_same(self):
        """What the root adds later is never included by what it adds before."""
        with open(os.path.join(ROOT, "CMakeLists.txt"), encoding="utf-8") as file:
            text = file.read()
        order = re.findall(r"(?:engine|storage|proto|server|clients)[\w/]*",
                           " ".join(re.findall(r"(?:set\(folders|APPEND folders)([^)]*)\)", text)))
        self.assertGreater(len(order), 10)
        place = {room: number for number, room in enumerate(order)}
        for room, others in structure.MAY_INCLUDE.items():
            for other in others:
                if room in place and other in place:
                    self.assertLess(place[other], place[room], f"{room} includes {other}")

    def test_known_long_files_are_still_so_long(self):
        """A file that became shorter leaves the list, so that it cannot grow again."""
        for path, lines in structure.LINES_KNOWN.items():
            with open(os.path.join(ROOT, path), encoding="utf-8") as file:
                count = len(file.read().splitlines())
            self.assertTrue(structure.LINES_MAX < count <= lines, f"{path} has {count} lines")


class Decisions(unittest.TestCase):
    def read(self, path):
        with open(os.path.join(ROOT, path), encoding="utf-8") as file:
            return file.read()

    def test_0019_lists_the_instructions_with_a_parse_function_of_their_own(self):
        source = self.read("engine/optimo/language/parser_instructions.cc")
        body = source[source.index("bool Parser::ParseInstruction("):source.index("bool Parser::ParseOperands(")]
        own = {word.upper() for word in re.findall(r"case Op::k(\w+):", body)}
        page = self.read("docs/decisions/0019-stages-tables-and-one-rehearsal.md")
        listed = re.findall(r"^  \| ([A-Z]+) \|", page, re.MULTILINE)
        self.assertEqual(sorted(listed), sorted(own))


class AMadeUpHouse(unittest.TestCase):
    """One good tree; each test puts one breach into it."""

    GOOD = {
        "engine/core/result.h": "#pragma once\n#include <string>\n",
        "engine/motion/geometry/path.h": '#pragma once\n#include "engine/core/result.h"\n',
        "engine/motion/geometry/path.cc": '#include "engine/motion/geometry/path.h"\n// std::cout is not used here\n'
                                 'const char* kText = "printf";\nstatic const int kOne = 1;\n'
                                 "static constexpr double kTwo = 2.0;\nstatic_assert(kOne == 1);\n"
                                 "static int Sum(int a, int b) { return a + b; }\n",
        "storage/store.h": '#pragma once\n#include "engine/core/result.h"\n',
        "server/jobs/dispatcher.h": '#pragma once\n#include "rmlcell/v1/job.pb.h"\n#include "storage/store.h"\n',
        "server/jobs/dispatcher.cc": '#include "server/jobs/dispatcher.h"\n#include <boost/asio/post.hpp>\n'
                                     "#include <thread>\n",
        "server/services/call.h": "#pragma once\n#include <grpcpp/grpcpp.h>\n",
        "server/cell/cell.cc": '#include "storage/opening/open_store.h"\n',
        "tests/CMakeLists.txt": "add_executable(motion_test motion_test.cc)\n",
        "tests/motion_test.cc": "#include <thread>\n",
    }

    def breaches(self, path=None, text="", as_program=False):
        with tempfile.TemporaryDirectory() as root:
            for name, content in {**self.GOOD, **({path: text} if path else {})}.items():
                os.makedirs(os.path.dirname(os.path.join(root, name)), exist_ok=True)
                with open(os.path.join(root, name), "w", encoding="utf-8") as file:
                    file.write(content)
            found = structure.check(root)
            if not as_program:
                return found
            ended = subprocess.run([sys.executable, "-B", os.path.join(HERE, "check_structure.py"), root],
                                   capture_output=True, text=True, check=False)
            self.assertEqual(ended.returncode, 1 if found else 0)
            self.assertEqual(ended.stdout.splitlines(), found)
            return found

    def assert_breach(self, path, text, says):
        found = self.breaches(path, text)
        self.assertEqual(len(found), 1, found)
        self.assertTrue(found[0].startswith(path), found)
        self.assertIn(says, found[0])

    def test_a_good_one_has_none(self):
        self.assertEqual(self.breaches(as_program=True), [])

    def test_the_program_prints_breaches_and_fails(self):
        found = self.breaches("engine/core/a.h", '#include "storage/store.h"\n', as_program=True)
        self.assertEqual(len(found), 1)

    def test_wrong_directions(self):
        for path, header in [
            ("engine/core/a.h", "engine/motion/geometry/path.h"),
            ("engine/motion/geometry/a.cc", "storage/store.h"),
            ("engine/machine/a.cc", "engine/rml1/device.h"),
            ("engine/rml1/a.cc", "engine/optimo/language/ast.h"),
            ("engine/optimo/language/a.cc", "engine/machine/run.h"),
            ("engine/simulation/run/a.cc", "rmlcell/v1/job.pb.h"),
            ("storage/a.h", "engine/motion/geometry/path.h"),
            ("storage/a.h", "storage/sqlite/sqlite_store.h"),
            ("proto/bridge/a.cc", "server/base/names.h"),
            ("server/jobs/a.cc", "storage/sqlite/sqlite_store.h"),
            ("server/jobs/a.cc", "server/services/call.h"),
            ("server/programs/a.cc", "server/services/call.h"),
            ("server/base/names.h", "server/jobs/dispatcher.h"),
            ("server/worker/a.cc", "storage/sqlite/sqlite_store.h"),
            ("clients/cli/a.cc", "server/base/names.h"),
            ("clients/cli/a.cc", "tests/a.h"),
        ]:
            with self.subTest(path=path, header=header):
                self.assert_breach(path, f'// a\n#include "{header}"\n', f"may not include {header}")

    def test_what_is_private_to_a_room(self):
        self.assert_breach("engine/motion/ride/a.cc", '#include "engine/motion/planner/motion_chain.h"\n',
                           "is private to its room")
        self.assertEqual(self.breaches("engine/motion/planner/a.cc", '#include "engine/motion/planner/motion_chain.h"\n'),
                         [])
        self.assert_breach("engine/motion/profile/a.cc", '#include "engine/motion/planner/motion_chain.h"\n',
                           "may not include")

    def test_what_is_public_is_there(self):
        for room, headers in structure.PUBLIC.items():
            for header in headers:
                made = os.path.join(ROOT, room, header)  # or made by the build out of .in
                self.assertTrue(os.path.isfile(made) or os.path.isfile(made + ".in"), f"{room}/{header}")

    def test_every_room_of_several_headers_says_which_are_public(self):
        for room in structure.MAY_INCLUDE:
            folder = os.path.join(ROOT, room)
            headers = [name for name in os.listdir(folder) if name.endswith(".h")] if os.path.isdir(folder) else []
            if len(headers) >= 2:
                self.assertIn(room, structure.PUBLIC)

    def test_what_is_public_is_used(self):
        """A header that no other room includes, by itself or by another public one, is private."""
        used = set()
        public = {f"{room}/{header}" for room, headers in structure.PUBLIC.items() for header in headers}
        for path in structure.files_under(ROOT):
            if path.endswith((".h", ".cc")):
                with open(os.path.join(ROOT, path), encoding="utf-8", errors="replace") as file:
                    for found in re.finditer(r'#\s*include\s*"([^"]+)"', file.read()):
                        if os.path.dirname(found.group(1)) != os.path.dirname(path) or path in public:
                            used.add(found.group(1))
        for room, headers in structure.PUBLIC.items():
            for header in headers:
                self.assertIn(f"{room}/{header}", used)

    def test_a_door_between_neighbours_is_no_door_for_others(self):
        line = '#include "engine/motion/geometry/corner_curve.h"\n'
        self.assertEqual(self.breaches("engine/motion/corner/a.cc", line), [])
        self.assert_breach("engine/motion/planner/a.cc", line, "is not for engine/motion/planner")

    def test_every_door_between_neighbours_is_used_by_each_of_them(self):
        includes = {}
        for path in structure.files_under(ROOT):
            if path.endswith((".h", ".cc")):
                with open(os.path.join(ROOT, path), encoding="utf-8", errors="replace") as file:
                    includes.setdefault(os.path.dirname(path), "")
                    includes[os.path.dirname(path)] += file.read()
        for room, headers in structure.ONLY_FOR.items():
            for header, others in headers.items():
                self.assertIn(header, structure.PUBLIC[room])
                if others is structure.MOTION:  # the rooms of one house
                    continue
                for other in others:
                    self.assertIn(f'"{room}/{header}"', includes[other])

    def test_an_error_is_handed_on_in_one_form(self):
        says = "write if (const Status done = F(); !done) return done.error();"
        for text in ("Status A() {\n  if (const Status a = B(); !a) return a;\n}\n",
                     "Status A() {\n  if (const Status a = B(1,\n      2);\n      !a) {\n    return a;\n  }\n}\n",
                     "Status A() {\n  if (Status a = B(); !a) return a.error();\n}\n",
                     "Status A() {\n  const Status a = B();\n  if (!a) return a.error();\n}\n"):
            with self.subTest(text=text):
                self.assert_breach("server/jobs/a.cc", text, says)
        for text in ("if (const Status a = B(); !a) return a.error();\n", "const Status a = B();\nif (!a) Log(a.error());\n",
                     "if (const Status a = B(); !a) return Refuse(a.error());\n"):
            with self.subTest(text=text):
                self.assertEqual(self.breaches("server/jobs/a.cc", text), [])

    def test_a_finding_knows_its_numbers(self):
        says = "write Told(name, number ...), so that the finding knows its number"
        for text in ('return Error{ErrorCode::kA, "label " + std::to_string(n), {}};\n',
                     'return InvalidArgument("radius " +\n    ShortestText(r));\n',
                     'return Corrupt(Told("line", 1) + std::to_string(n));\n',
                     'Warn(ErrorCode::kA,\n     FixedText(v, 1) + " mm/s", "OPT-1");\n'):
            with self.subTest(text=text):
                self.assert_breach("engine/core/a.cc", text, says)
        for text in ('return Error{ErrorCode::kA, "label " + Told("label", n), {}};\n',
                     'return Bad(Told("speed", v, "mm/s", FixedText(v, 1) + " mm/s"));\n',
                     'text += std::to_string(n);\nreturn Error{ErrorCode::kA, {}, {}};\n'):
            with self.subTest(text=text):
                self.assertEqual(self.breaches("engine/core/a.cc", text), [])
        self.assertEqual(self.breaches("server/jobs/a.cc", "InvalidArgument(std::to_string(n));\n"), [])

    def test_an_include_with_blanks_counts_too(self):
        self.assert_breach("engine/core/a.h", '  #  include   "engine/motion/geometry/path.h"\n', "may not include")
        self.assert_breach("engine/core/a.h", "#include <engine/motion/geometry/path.h>\n", "may not include")

    def test_a_number_of_a_machine_stays_in_its_folder(self):
        self.GOOD = {**self.GOOD, "engine/core/catalogue.def":
                     'RMLCELL_ERROR(Optimo, 348, HoleRadiusZero, Program, "a", "b")\n'
                     'RMLCELL_ERROR(Cell, 9004, CellNotFound, Request, "a", "b", NotFound)\n'}
        line = "Error a{ErrorCode::kHoleRadiusZero, {}, {}};  // ErrorCode::kHoleRadiusZero\n"
        for path in ("engine/motion/geometry/a.cc", "engine/machine/a.h", "engine/rml1/a.cc", "server/jobs/a.cc",
                     "clients/cli/a.cc"):
            with self.subTest(path=path):
                self.assert_breach(path, line, "kHoleRadiusZero is a number of engine/optimo")
        self.assert_breach("server/jobs/a.cc", "using enum rmlcell::ErrorCode;\n", "write ErrorCode::kName")
        for path, text in (("engine/optimo/language/a.cc", line), ("engine/core/a.cc", line), ("tests/a.cc", line),
                           ("server/jobs/a.cc", "return ErrorCode::kCellNotFound;\n"),
                           ("server/jobs/a.cc", "// as ErrorCode::kHoleRadiusZero\n")):
            with self.subTest(path=path):
                self.assertEqual(self.breaches(path, text), [])

    def test_the_numbers_of_both_machines_are_known(self):
        folders = structure.machine_codes(ROOT)
        self.assertEqual(set(folders.values()), {"engine/optimo", "engine/rml1"})
        self.assertEqual((folders["HoleRadiusZero"], folders["Rml1WrongParameters"]), ("engine/optimo", "engine/rml1"))

    def test_a_room_that_is_not_in_the_table(self):
        self.assert_breach("engine/plasma/torch.h", "#pragma once\n", "does not stand in the table")

    def test_heavy_headers(self):
        for header in ("grpcpp/grpcpp.h", "grpc++/grpc++.h", "boost/beast/http.hpp", "boost/asio.hpp",
                       "boost/asio/ip/tcp.hpp", "Eigen/Core"):
            with self.subTest(header=header):
                self.assert_breach("server/jobs/a.h", f"#include <{header}>\n", "a header may not include")
        self.assertEqual(self.breaches("server/jobs/a.cc", "#include <boost/beast/http.hpp>\n"), [])
        self.assert_breach("server/services/a.h", "#include <boost/asio/post.hpp>\n", "a header may not")

    def test_the_engine_stays_pure(self):
        for line in ("#include <thread>", "#include <iostream>", "#include <fstream>", "#include <ctime>",
                     "auto now = std::chrono::steady_clock::now();", "std::jthread worker;", 'std::cout << "a";',
                     'std::FILE* file = fopen("a", "r");', "thread_local int count;", "std::mutex lock;",
                     "static int calls = 0;", "  static std::map<int, int> seen;", "static std::string last{};",
                     'const char* home = std::getenv("HOME");'):
            with self.subTest(line=line):
                self.assert_breach("engine/motion/geometry/a.cc", line + "\n", "the engine may not")
        self.assertEqual(self.breaches("server/jobs/a.cc", "std::mutex lock;\nstatic int calls = 0;\n"), [])

    def test_long_files(self):
        self.assertEqual(self.breaches("engine/core/a.cc", "\n" * 600), [])
        self.assert_breach("engine/core/a.cc", "\n" * 601, "601 lines, at most 600")
        self.assert_breach("tests/a.cc", "\n" * 601, "601 lines")

    def test_tests_that_nobody_builds(self):
        self.assert_breach("tests/clients/cli/lonely_test.cc", "\n", "no CMakeLists.txt names it")

    def test_names_that_say_nothing(self):
        for path in ("engine/core/utils.h", "engine/core/string_util.cc", "server/jobs/job_manager.h",
                     "tests/utils/README.md", "deploy/helpers.sh"):
            with self.subTest(path=path):
                found = self.breaches(path, "")
                self.assertTrue(any("does not say what it does" in breach for breach in found), found)
        self.assert_breach("engine/core/a.h", "class ProgramManager {\n", "ProgramManager")
        self.assertEqual(self.breaches("engine/core/utilisation.h", "struct Utilisation {\n"), [])


if __name__ == "__main__":
    unittest.main()
