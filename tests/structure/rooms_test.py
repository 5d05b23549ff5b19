"""The house keeps its order:

- a room of src includes itself, the rooms before it in the list src/rooms.txt, and nothing after it;
- every folder of src that has sources is in that list;
- IPS and ISW are compared with numbers by their owner alone, the room kinds;
- what kind of solution something is, nobody asks but its owner, the room kinds: no questions by name (has_ring,
  is_torus, is_point), no comparison of families, no cast to a class of equations, conditions or problem types.

    rooms_test.py SOURCE_FOLDER
"""
import os
import re
import sys
import tempfile

OWNER = "kinds"
NOT_ROOMS = ("cmake", "docs")  # templates and examples of the pages


def rooms(source):
    lines = open(os.path.join(source, "rooms.txt"), encoding="utf-8").read().splitlines()
    return [line.split("|")[0].strip() for line in lines if line and not line.startswith("#")]


def sources(source):
    for folder, _, names in os.walk(source):
        for name in sorted(names):
            if name.endswith((".cpp", ".hpp", ".h", ".in")):
                path = os.path.join(folder, name)
                yield os.path.relpath(path, source), open(path, encoding="utf-8").read()


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


def comparisons(source):
    number = re.compile(r"\b(problem_type|branch_mode)(\(\))?\s*(==|!=|<=?|>=?)\s*-?\d"
                        r"|-?\d+\s*(==|!=)\s*[\w.]*\b(problem_type|branch_mode)\b")
    return [f"{path}: {line.strip()}" for path, text in sources(source) if path.split(os.sep)[0] != OWNER
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
        for room in ("orbit", "base", "attic"):
            os.mkdir(os.path.join(folder, room))
        with open(os.path.join(folder, "rooms.txt"), "w") as file:
            file.write("# The rooms.\nbase | core\ncontract | headers\norbit  | core\n")
        with open(os.path.join(folder, "base", "words.cpp"), "w") as file:
            file.write('#include "orbit/orbit.hpp"\nbool f(int problem_type) { return problem_type == 180; }\n')
        with open(os.path.join(folder, "orbit", "orbit.hpp"), "w") as file:
            file.write('#include "base/words.hpp"\n#include "tchat/problem.h"\n')
        assert includes_up(folder) == ["base/words.cpp includes orbit/orbit.hpp, of a room above it"]
        with open(os.path.join(folder, "attic", "chair.cpp"), "w") as file:
            file.write("int chairs = 1;\n")
        assert "attic/chair.cpp is in no room of rooms.txt" in includes_up(folder)
        assert len(comparisons(folder)) == 1
        with open(os.path.join(folder, "orbit", "orbit.cpp"), "w") as file:
            file.write("bool g(int n) { return is_torus(n); }\n"
                       "auto& h(const DefiningSystem& x) { return static_cast<const TorusSystem&>(x); }\n")
        assert len(questions_about_families(folder)) == 2


check_that_faults_are_found()
found = includes_up(sys.argv[1]) + comparisons(sys.argv[1]) + questions_about_families(sys.argv[1])
print("\n".join(found))
sys.exit(1 if found else 0)
