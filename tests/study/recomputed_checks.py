"""What the recomputations do with tables: read them, and hold their numbers against own ones."""
import numpy as np

outcomes = []  # of each number held against a table, whether it is as there


def check(name, table, own, low, high):
    """Prints a table's number and the own one, which is to be from `low` to `high`."""
    good = bool(low <= own <= high)
    outcomes.append(good)
    print(f"{'ok ' if good else 'OFF'} {name}: table {table:.5g}, recomputed {own:.5g} (from {low:.5g} to {high:.5g})")


def near(name, table, own, share):
    """Checks that the own number is within a share of the table's."""
    check(name, table, own, table - share * abs(table), table + share * abs(table))


def all_near(name, table, own, share, least=0):
    """Checks the largest difference of many numbers over each of the table's, or over `least`, to be within a share."""
    table, own = np.asarray(table, float), np.asarray(own, float)
    off = abs(own - table) / np.maximum(abs(table), least)
    worst = off.argmax()
    check(f"{name}, {len(off)} of them: largest difference over it ({table.flat[worst]:.5g}, {own.flat[worst]:.5g})",
          0, off.max(), 0, share)


def number(rows, column, **words):
    """That of the row with these words."""
    return float(next(row for row in rows if all(row[key] == word for key, word in words.items()))[column])


def place_of(row):
    """m: of a row."""
    return 1e-3 * np.array([float(row[f"{axis}_mm"]) for axis in "xyz"])
