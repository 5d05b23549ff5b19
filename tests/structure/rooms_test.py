"""The house keeps its order:

- a room of src includes itself, the rooms before it in the list src/rooms.txt, and nothing after it;
- every folder of src that has sources is in that list;
- no room has more lines of C++ than its budget in that list;
- no source of src has a name that ends in _test, and there are at most 450 of them;
- IPS and ISW are compared with numbers by their owners alone, the room kinds and the table settings/problem_type;
- what kind of solution something is, nobody asks but its owner, the room kinds: no questions by name (has_ring,
  is_torus, is_point), no comparison of families, no cast to a class of equations, conditions or problem types.

    rooms_test.py SOURCE_FOLDER
"""
import os
import re
import sys
import tempfile

OWNER = "kinds"
TABLE = os.path.join("settings", "problem_type.")
NOT_ROOMS = ("cmake", "docs")  # templates and examples of the pages


def rooms(source):
    lines = open(os.path.join(source, "rooms.txt"), encoding="utf-8").read().splitlines()
    return [line.split("|")[0].strip() for line in lines if line and not line.startswith("#")]


def sources(source):
    for folder, _, names in os.walk(source):
        for name in sorted(names):
            if name.endswith((".cpp", ".hpp", ".h", ".inc", ".in")):
                path = os.path.join(folder, name)
                yield os.path.relpath(path, source), open(path, encoding="utf-8").read()


def over_budget(source):
    """Rooms whose sources have more lines than the column of budgets allows."""
    budgets = {}
    for line in open(os.path.join(source, "rooms.txt"), encoding="utf-8"):
        cells = [cell.strip() for cell in line.split("|")]
        if not line.startswith("#") and len(cells) > 5:
            budgets[cells[0]] = int(cells[4])
    lines = dict.fromkeys(budgets, 0)
    for path, text in sources(source):
        room = path.split(os.sep)[0]
        if room in lines and not path.endswith(".in"):
            lines[room] += len(text.splitlines())
    return [f"room {room} has {lines[room]} lines of C++, its budget in rooms.txt is {budgets[room]}: shorten it, or "
            "raise the budget in a commit of its own that says what users get for it"
            for room in budgets if lines[room] > budgets[room]]


def names_and_count(source, most=450):
    paths = [path for path, _ in sources(source) if path.split(os.sep)[0] not in NOT_ROOMS and not path.endswith(".in")]
    faults = [f"{path} is named like a test" for path in paths if os.path.splitext(path)[0].endswith("_test")]
    if len(paths) > most:
        faults.append(f"src has {len(paths)} files of C++, more than {most}")
    return faults


def includes_up(source):
    order = rooms(source)
    faults = []
    for path, text in sources(source):
        room = path.split(os.sep)[0]
        if room in NOT_ROOMS:
            continue
        if room not in order:
            faults.append(f"{path} is in no room of rooms.txt")
            continue
        for included in re.findall(r'#include "([^"]+)"', text):
            other = "contract" if included.startswith("tchat/") else included.split("/")[0]
            if other in order and order.index(other) > order.index(room):
                faults.append(f"{path} includes {included}, of a room above it")
    return faults


def known_types(source):
    """The names of problem types that other rooms may write into constants: periodic_orbit, ..."""
    path = os.path.join(source, TABLE + "hpp")
    text = open(path, encoding="utf-8").read() if os.path.exists(path) else ""
    return re.findall(r"constexpr ProblemId (\w+)\{", text) or ["periodic_orbit"]


def comparisons(source):
    number = re.compile(r"\b(problem_type|branch_mode)(\(\))?\s*(==|!=|<=?|>=?)\s*(-?\d|[\w:]+\.(number|branch_mode)\b)"
                        r"|(-?\b\d+|\b\w+\.(number|branch_mode))\s*(==|!=)\s*[\w.>-]*\b(problem_type|branch_mode)\b"
                        r"|\bswitch \([^)]*\b(problem_type|branch_mode)\b"
                        rf"|\b({'|'.join(known_types(source))})\.(number|branch_mode)\s*(==|!=)"
                        rf"|(==|!=)\s*(tchat::)?({'|'.join(known_types(source))})\.(number|branch_mode)\b")
    return [f"{path}: {line.strip()}" for path, text in sources(source) if path.split(os.sep)[0] != OWNER and not path.startswith(TABLE)
            for line in text.splitlines() if number.search(line)]


def questions_about_families(source):
    question = re.compile(r"\b(has_ring|is_torus|is_point|is_equilibrium|is_ring)\b"
                          r"|(==|!=)\s*&?\w+_family\(\)|&\w+_family\(\)\s*(==|!=)"
                          r"|(static|dynamic)_cast<(const )?\w*(System|Condition|Problem|Family|Multiplier|Pair|Fold)\s*[&*]>"
                          r"|(static|dynamic)_cast<const DefiningSystem&>")
    own_object = re.compile(r"static_cast<const \w+\s*\*>\(\w+\)")  # from the void* of an interface in C
    return [f"{path}: {line.strip()}" for path, text in sources(source) if path.split(os.sep)[0] != OWNER
            for line in text.splitlines() if question.search(line) and not own_object.search(line)]


def check_that_faults_are_found():
    with tempfile.TemporaryDirectory() as folder:
        for room in ("orbit", "base", "attic", "settings"):
            os.mkdir(os.path.join(folder, room))
        with open(os.path.join(folder, TABLE + "hpp"), "w") as file:
            file.write("inline constexpr ProblemId equilibrium{1, 1};\n")
        with open(os.path.join(folder, "rooms.txt"), "w") as file:
            file.write("# The rooms.\nbase | core | texts | quick | 2 | words\ncontract | headers\nsettings | core | - | - | 9 | tables\norbit  | core | - | - | 9 | orbits\n")
        with open(os.path.join(folder, "base", "words.cpp"), "w") as file:
            file.write('#include "orbit/orbit.hpp"\nbool f(int problem_type) { return problem_type == 180; }\n')
        with open(os.path.join(folder, "orbit", "orbit.hpp"), "w") as file:
            file.write('#include "base/words.hpp"\n#include "tchat/problem.h"\n')
        assert includes_up(folder) == ["base/words.cpp includes orbit/orbit.hpp, of a room above it"]
        with open(os.path.join(folder, "attic", "chair.cpp"), "w") as file:
            file.write("int chairs = 1;\n")
        assert "attic/chair.cpp is in no room of rooms.txt" in includes_up(folder)
        assert len(comparisons(folder)) == 1
        with open(os.path.join(folder, "attic", "chair.cpp"), "w") as file:
            file.write("bool a(int x) { return x == equilibrium.number; }\n"
                       "bool b(const Settings& s) { return s.problem_type != tchat::equilibrium.number; }\n"
                       "bool c(const Settings& s) { return equilibrium.number == s.problem_type; }\n"
                       "int d(const Settings& s) { switch (s.problem_type) { default: return 0; } }\n"
                       "s.problem_type = equilibrium.number;\n")
        assert len(comparisons(folder)) == 5, comparisons(folder)
        assert over_budget(folder) == []
        with open(os.path.join(folder, "base", "words_test.cpp"), "w") as file:
            file.write("int words = 1;\n")
        assert len(over_budget(folder)) == 1 and "base has 3 lines" in over_budget(folder)[0]
        assert names_and_count(folder, most=5) == [os.path.join("base", "words_test.cpp") + " is named like a test"]
        assert len(names_and_count(folder, most=4)) == 2
        with open(os.path.join(folder, "orbit", "orbit.cpp"), "w") as file:
            file.write("bool g(int n) { return is_torus(n); }\n"
                       "auto& h(const DefiningSystem& x) { return static_cast<const TorusSystem&>(x); }\n")
        assert len(questions_about_families(folder)) == 2


check_that_faults_are_found()
found = [fault for check in (includes_up, over_budget, names_and_count, comparisons, questions_about_families)
         for fault in check(sys.argv[1])]
print("\n".join(found))
sys.exit(1 if found else 0)
