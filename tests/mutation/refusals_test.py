import collections
import pathlib
import tempfile
import unittest

from refusals import Refusals, numbers_of, text_of

Place = collections.namedtuple("Place", "begin end kind after")
PLACES = [Place(3, 4, "sign", "-"), Place(9, 10, "bound", "<")]


class Kept(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name) / "refused.txt"

    def test_numbers_stand_in_ranges(self):
        for numbers, text in ((set(), ""), ({7}, "7"), ({0, 1, 2, 3, 7, 9, 10}, "0-3,7,9-10")):
            self.assertEqual(text_of(numbers), text)
            self.assertEqual(numbers_of(text), numbers)

    def test_an_answer_is_found_again(self):
        first = Refusals(self.path)
        key = first.key("source", PLACES)
        self.assertIsNone(first.get(key))
        first.put(key, {1})
        self.assertEqual(Refusals(self.path).get(key), {1})

    def test_another_source_or_place_is_another_question(self):
        asked = Refusals(self.path)
        keys = {asked.key("source", PLACES), asked.key("Source", PLACES), asked.key("source", PLACES[:1]),
                asked.key("source", [PLACES[0], Place(9, 10, "bound", ">")]), asked.key("source", [PLACES[0], Place(9, 11, "bound", "<")])}
        self.assertEqual(len(keys), 5)

    def test_what_nobody_asks_for_any_more_goes(self):
        first = Refusals(self.path)
        first.put("old", {1})
        first.put("new", set())
        second = Refusals(self.path)
        second.get("new")
        second.keep()
        self.assertEqual(self.path.read_text(), "new\n")

    def test_a_new_answer_replaces_the_old_one(self):
        first = Refusals(self.path)
        first.put("key", {1})
        first.put("key", {2})
        self.assertEqual(Refusals(self.path).get("key"), {2})


if __name__ == "__main__":
    unittest.main(verbosity=2)
