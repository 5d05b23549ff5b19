"""Thresholds have one owner, the module of scales: base/levels.hpp and model/scales.

All floating-point literals of src between 0 and 1e-3 outside that module must be in thresholds.txt, each with a
sentence of its own; the list has at most 60 entries, and none that is no longer in src. Literals in comments, in
strings and in src/docs are not counted.

    thresholds_test.py SOURCE_FOLDER [LIST]
"""
import collections
import os
import re
import sys
import tempfile

MODULE = ("base/levels.hpp", "model/scales.hpp", "model/scales.cpp")
BELOW = 1e-3
MOST_ENTRIES = 60
LIST = os.path.join(os.path.dirname(os.path.abspath(__file__)), "thresholds.txt")

TOKEN = re.compile(r"""
      (?:u8|[uUL])?R"(?P<delimiter>[^()\\\s]{0,16})\(.*?\)(?P=delimiter)"
    | "(?:\\.|[^"\\\n])*"
    | //(?:\\\n|[^\n])* | /\*.*?\*/
    | '(?:\\.|[^'\\\n])+'
    | (?P<number>\.?[0-9](?:[eEpP][+-]|'[0-9a-zA-Z_]|[0-9a-zA-Z_.])*)
    | [A-Za-z_]\w*""", re.VERBOSE | re.DOTALL)


def value(literal):
    """Of a floating-point literal; None for another number."""
    text = literal.replace("'", "").lower()
    try:
        if text.startswith("0x"):
            return float.fromhex(text.rstrip("fl")) if "p" in text else None
        if not re.search("[.e]", text):
            return None
        return float(text.rstrip("fl"))
    except ValueError:  # 1.0_km, 0b1
        return None


def small_literals(text):
    """The literals between 0 and BELOW, with their lines."""
    for token in TOKEN.finditer(text):
        number = value(token["number"]) if token["number"] else None
        if number is not None and 0.0 < number < BELOW:
            yield token["number"], text.count("\n", 0, token.start()) + 1


def sources(source):
    for folder, folders, names in os.walk(source):
        if folder == source and "docs" in folders:
            folders.remove("docs")
        for name in sorted(names):
            if name.endswith((".cpp", ".hpp", ".h", ".inc")):
                path = os.path.join(folder, name)
                yield os.path.relpath(path, source).replace(os.sep, "/"), open(path, encoding="utf-8").read()


def entries(text):
    """(file, literal, sentence) of each line `file | literal | sentence`."""
    for line in text.splitlines():
        if line and not line.startswith("#"):
            cells = [cell.strip() for cell in line.split("|", 2)]
            yield tuple(cells + [""] * (3 - len(cells)))


def faults_of(source, listed):
    listed = list(entries(listed))
    faults = []
    if len(listed) > MOST_ENTRIES:
        faults.append(f"the list has {len(listed)} entries, more than {MOST_ENTRIES}")
    sentences = collections.Counter(sentence for _, _, sentence in listed)
    for path, literal, sentence in listed:
        if len(sentence.split()) < 4 or not sentence.endswith("."):
            faults.append(f"{path}, {literal}: the list needs a sentence that says what it is")
        elif sentences[sentence] > 1:
            faults.append(f"{path}, {literal}: another entry of the list has the same sentence")
    left = collections.Counter((path, literal) for path, literal, _ in listed)
    for path, text in sources(source):
        for literal, line in small_literals(text) if path not in MODULE else ():
            left[path, literal] -= 1
            if left[path, literal] < 0:
                faults.append(f"{path}:{line}: {literal} is a threshold of its own: take a level of base/levels.hpp, "
                              "and compare it with a quantity divided by its size")
    for (path, literal), count in left.items():
        if count > 0:
            faults.append(f"{path}, {literal}: the list has an entry that is not in src")
    return faults


def check_that_faults_are_found():
    counted = "1e-4 1.e-5 .0001 0.0005 1E-4f 0x1p-11 0x1.8p-20L 1'0.0e-6 0.000'1 9.99e-4"
    assert [literal for literal, _ in small_literals(counted)] == counted.split(), list(small_literals(counted))
    others = ("1e-3 0.001 0.0 0e-9 1 5e3 0x1p-9 0xe-4 x1e-5 a.b1e-5 // 1e-4\n/* 1e-5\n1e-6 */ \"1e-7 \\\" 1e-8\" '\"' "
              "R\"x(\"1e-9)\" )x\" u8R\"(1e-9)\" '\\'' 1'000 .5")
    assert not list(small_literals(others)), list(small_literals(others))
    assert list(small_literals("a\n\n  1e-4")) == [("1e-4", 3)]
    with tempfile.TemporaryDirectory() as folder:
        for room in ("base", "docs", "orbit"):
            os.mkdir(os.path.join(folder, room))
        for path, text in (("base/levels.hpp", "1e-4"), ("docs/clock.cpp", "1e-4"), ("orbit/a.cpp", "1e-4 + 1e-4 + 1e-5")):
            with open(os.path.join(folder, path), "w") as file:
                file.write(text)
        first, second = "# A list.\norbit/a.cpp | 1e-4 | This is one of them.\n", "orbit/a.cpp | 1e-5 | This is another one.\n"
        third = "orbit/a.cpp | 1e-4 | This is the last one.\n"
        assert faults_of(folder, first + second + third) == []
        assert len(faults_of(folder, first + second)) == 1 and "orbit/a.cpp:1: 1e-4" in faults_of(folder, first + second)[0]
        assert len(faults_of(folder, "")) == 3
        stale = "orbit/a.cpp | 1e-6 | This one is not there.\n"
        assert faults_of(folder, first + second + third + stale) == ["orbit/a.cpp, 1e-6: the list has an entry that is not in src"]
        assert len(faults_of(folder, first + second + "orbit/a.cpp | 1e-4 |\n")) == 1
        assert len(faults_of(folder, first + second + first)) == 2
        many = "".join(f"orbit/b.cpp | 1e-6 | This is number {k}.\n" for k in range(MOST_ENTRIES + 1))
        assert "the list has 61 entries, more than 60" in faults_of(folder, many)


check_that_faults_are_found()
found = faults_of(sys.argv[1], open(sys.argv[2] if len(sys.argv) > 2 else LIST, encoding="utf-8").read())
print("\n".join(found))
sys.exit(1 if found else 0)
