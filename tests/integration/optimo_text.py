"""A small program of the laser, and how the tests read one."""
import re

LINE = "COORD ABSOL\nPATH LIN\nSPEED 10\nMOVE (1000.,900.,-500.,0.,0.)   ; here\nMOVE (1010.,900.,-500.,0.,0.)\n"


def first_move(text):
    """The numbers of the first MOVE."""
    move = re.search(r"MOVE \(([^)]*)\)", text).group(1)
    return [float(value) for value in move.split(",")]
