#!/usr/bin/env python3
"""The changes that tests/mutation makes of a source."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import mutate  # noqa: E402
from areas import AREAS  # noqa: E402
from places import Finder  # noqa: E402


def changes(source, kind, error_codes=()):
    places = Finder("a.cc", source).find(error_codes)
    return [place.applied(source) for place in places if place.kind == kind]


class Areas(unittest.TestCase):
    def test_every_source_is_in_one_area(self):
        root = pathlib.Path(__file__).parents[2]
        folders = {str(source.parent.relative_to(root)) for part in ("engine", "server", "storage", "proto", "clients")
                   for source in (root / part).rglob("*.cc")}
        measured = [folder for area in AREAS.values() for folder in area.folders]
        self.assertEqual(sorted(measured), sorted(folders))


class Places(unittest.TestCase):
    def test_comparison_and_its_bound(self):
        source = "bool F(int a) { return a < 3; }"
        self.assertEqual(changes(source, "comparison"), ["bool F(int a) { return a > 3; }"])
        self.assertEqual(changes(source, "bound"), ["bool F(int a) { return a <= 3; }"])

    def test_equality_logic_and_negation(self):
        source = "bool F(bool a, int b) { return !a && b == 1; }"
        self.assertEqual(changes(source, "comparison"),
                         ["bool F(bool a, int b) { return a && b == 1; }",
                          "bool F(bool a, int b) { return !a || b == 1; }",
                          "bool F(bool a, int b) { return !a && b != 1; }"])

    def test_the_bracket_of_a_template_is_no_comparison(self):
        self.assertEqual(changes("template <typename T>\nstd::vector<int> F();", "comparison"), [])

    def test_signs(self):
        self.assertEqual(changes("double F(double a) { return -a + 2.0; }", "sign"),
                         ["double F(double a) { return a + 2.0; }", "double F(double a) { return -a - 2.0; }"])

    def test_constants_of_each_type(self):
        self.assertEqual(changes("auto a = F(9, 1'000u, 0.5, 0.0, true);", "constant"),
                         ["auto a = F(10, 1'000u, 0.5, 0.0, true);", "auto a = F(9, 1001u, 0.5, 0.0, true);",
                          "auto a = F(9, 1'000u, 1.0, 0.0, true);", "auto a = F(9, 1'000u, 0.5, 1.0, true);",
                          "auto a = F(9, 1'000u, 0.5, 0.0, false);"])

    def test_a_tolerance_changes_by_more_than_a_factor_of_two(self):
        self.assertEqual(changes("auto a = F(1e-9, 2e3);", "constant"),
                         ["auto a = F(1.0000000000000002e-06, 2e3);", "auto a = F(1e-9, 4000.0);"])

    def test_statements_that_can_be_dropped(self):
        source = "int F() {\n  int a = 1;\n  a = 2;\n  Use(a);\n  ++a;\n  if (a > 2) return 0;\n  return a;\n}"
        self.assertEqual([change.splitlines()[n] for change, n in
                          zip(changes(source, "dropped statement"), (2, 3, 4, 5), strict=True)],
                         ["  ;", "  ;", "  ;", "  if (a > 2) ;"])

    def test_a_dropped_statement_moves_no_line(self):
        source = "void F() {\n  Use(1,\n      2);\n  Other();\n}"
        self.assertEqual(changes(source, "dropped statement")[0], "void F() {\n  ;\n\n  Other();\n}")

    def test_declarations_are_not_dropped(self):
        self.assertEqual(changes("void F() { std::string a(b); Type c; const int d = 1; }", "dropped statement"), [])

    def test_room_that_is_made_beforehand_stays(self):
        source = "void F() { a.reserve(2); b->rows[n].reserve(c + 1); d.log_->reserve(3); a.clear(); }"
        self.assertEqual(changes(source, "dropped statement"),
                         [source.replace("a.clear()", "")])
        self.assertEqual(changes(source, "constant"), [])

    def test_exchanged_arguments(self):
        self.assertEqual(changes("void F() { Use(a, b.c, 3); }", "exchanged argument"),
                         ["void F() { Use(b.c, a, 3); }", "void F() { Use(a, 3, b.c); }"])
        self.assertEqual(changes("void Use(int a, const T& b) { Max(a, a); }", "exchanged argument"), [])

    def test_error_codes(self):
        source = "F(ErrorCode::kOne); F(ErrorCode::kTwo);"
        self.assertEqual(changes(source, "error code"), ["F(ErrorCode::kTwo); F(ErrorCode::kTwo);",
                                                         "F(ErrorCode::kOne); F(ErrorCode::kOne);"])
        self.assertEqual(changes("F(ErrorCode::kOne);", "error code", ["kOne", "kSix"]), ["F(ErrorCode::kSix);"])

    def test_what_stands_in_comments_texts_and_checks_stays(self):
        source = '// a < 3\nRMLCELL_CHECK(a < 3);\nstatic_assert(2 < 3);\nauto a = "b < 4";\n#if A > 2\n#endif\n'
        self.assertEqual(Finder("a.cc", source).find(), [])


class Sequence(unittest.TestCase):
    def test_a_seed_gives_the_same_places_again(self):
        def first(seed):
            places = mutate.sequence("mill", seed, mutate.error_codes(), None, None)
            return [next(places) for _ in range(50)]

        self.assertEqual(first("1"), first("1"))
        self.assertNotEqual(first("1"), first("2"))
        self.assertGreater(len({place.kind for place in first("1")}), 5)

    def test_what_is_listed_as_equivalent_still_stands_there(self):
        arguments = mutate.Arguments()
        places = {file: mutate.places_of(mutate.ROOT, file, mutate.error_codes()) for file, *_ in arguments.rows}
        for row, why in arguments.rows.items():
            file, line, change, behind = row
            meant = {place.line for place in places[file] if place.text == line and mutate.change_of(place) == change
                     and arguments.row_of(file, line, change, place.line) == row}
            self.assertTrue(meant, f"{file}: {line} behind {behind}")
            if behind != arguments.EACH:
                self.assertEqual(len(meant), 1, f"{file}: {line}: which of {sorted(meant)} is meant?")
            self.assertGreater(len(why.split()), 5, f"{file}: {line} has no argument")

    def test_an_argument_may_say_which_of_lines_that_read_the_same_it_means(self):
        arguments = mutate.Arguments()
        arguments.lines["a.cc"] = ["case 1:", "  break;", "case 2:", "  break;"]
        arguments.rows = {("a.cc", "break;", "break; => ;", "case 2:"): "the last one"}
        self.assertIsNone(arguments.of("a.cc", "break;", "break; => ;", 2))
        self.assertEqual(arguments.of("a.cc", "break;", "break; => ;", 4), "the last one")


if __name__ == "__main__":
    unittest.main()
