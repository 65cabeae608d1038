# SPDX-License-Identifier: MIT
"""page.py PAGE CODE SEQUENCE FACTS FACTS_FLOAT: whether the page of `gicgen --report` says what the code is.

CODE.c and CODE.h are the emitted files, SEQUENCE what --sequence prints, FACTS what facts.c prints of the compiled
model. CODE.*.ci beside them are call graphs with stack usage (gcc -fcallgraph-info=su), CODE.*.symbols the symbols
of an object file (nm -S). Prints `good WHAT` or `bad WHAT: how`, a line each. Everything is read from the code or
from what a compiler made of it, nothing with the generator's own functions."""
import glob
import html.parser
import re
import sys

PAGE, CODE, SEQUENCE, FACTS, FACTS_FLOAT = sys.argv[1:6]
NAME = CODE.split("/")[-1]
KINDS = ["add", "multiply", "divide", "root", "function"]


def check(what, good, how=""):
    print(f"good {what}" if good else f"bad {what}: {how}")


def same(what, page, other):
    check(what, page == other, f"page {page}, code {other}")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


class Page(html.parser.HTMLParser):
    """Tables by their id: rows of cells, the titles first. Every element is closed in order."""

    void = {"meta", "br", "polygon", "path", "ellipse", "polyline"}

    def __init__(self):
        super().__init__()
        self.open, self.tables, self.text, self.rows = [], {}, "", []

    def handle_starttag(self, tag, attributes):
        if tag not in self.void:
            self.open.append(tag)
        if tag == "table":
            self.rows = self.tables.setdefault(dict(attributes)["id"], [])
        elif tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_startendtag(self, tag, attributes):
        pass

    def handle_endtag(self, tag):
        if tag not in self.void and (not self.open or self.open.pop() != tag):
            check("elements are closed", False, tag)

    def handle_data(self, data):
        self.text += data
        if self.open and self.open[-1] in ("td", "th"):
            self.rows[-1][-1] += data

    def rows_of(self, table):
        return self.tables.get(table, [[]])[1:]


# ---- operations, counted in the text of the code ---------------------------------------------------------------------

FUNCTIONS = {"GIC_SQRT": "root", "gic_table_value": "function", "road_height": "function", "road_friction": "function"}
for function in "SIN COS TAN ASIN ACOS ATAN ATAN2 EXP LOG TANH POW".split():
    FUNCTIONS["GIC_" + function] = "function"


def operations(text):
    """Operations of straight-line code, by kind: numbers and indices hold none."""
    text = re.sub(r"\b(GIC_)?R\([^()]*\)", "1", text)
    text = re.sub(r"\[[^]]*\]", "", text)
    text = re.sub(r"\bconst gic_real (?=t)|&", "", text).replace("->", ".")
    count = dict.fromkeys(KINDS, 0)
    before = ""
    text = re.sub(r"\b\w+_(road_(height|friction)\()", r"\1", text)
    for token in re.findall(r"\w+|\S", text):
        binary = re.fullmatch(r"\w+|\)", before) and before != "return"
        if token in "+-" and binary:
            count["add"] += 1
        elif token == "*":
            count["multiply"] += 1
        elif token == "/":
            count["divide"] += 1
        elif token in FUNCTIONS:
            count[FUNCTIONS[token]] += 1
        before = token
    return [count[kind] for kind in KINDS]


def functions(code):
    """Text of each function's body by its name."""
    code = re.sub(r"/\*.*?\*/", "", code, flags=re.S)
    found = {}
    for match in re.finditer(r"^(?:static )?[\w ]+?\*?(\w+)\([^;{}]*\)\n\{\n(.*?)^\}", code, re.S | re.M):
        found[match.group(1)] = match.group(2)
    return found


def blocks(body):
    """Texts between a brace that has a line for itself and the one that closes it."""
    found = []
    for match in re.finditer(r"^( +)\{\n(.*?)^\1\}", body, re.S | re.M):
        found.append(match.group(2))
    return found


def scaled(count, times):
    return [times * number for number in count]


def total(*counts):
    return [sum(numbers) for numbers in zip(*counts)]


def check_wheels(told, body):
    """Operations of a fast step; None: there are no wheels with tires."""
    if f"{NAME}_grip" not in body:
        return None
    calls = body[f"{NAME}_grip"]
    fast = operations(blocks(calls)[0])
    # states of the model's own, those of controllers among them, are evaluated with these
    names = [name for _, name in told if name.startswith("drives")]
    same("operations of drives and brakes", told["all together", names[0]], fast + [sum(fast)])
    for name in set(re.findall(rf"= {NAME}_wheel_(\w+)\(", calls)):
        text = body[f"{NAME}_wheel_{name}"]
        tire = re.search(r"^( +)if \(contact\[0\] > \S+\) \{\n(.*?)^\1\}", text, re.S | re.M).group(2)
        wheel = total(*[operations(block) for block in blocks(text) + [tire]])
        same(f"operations of {name}", told[name, "wheel with its tire"], wheel + [sum(wheel)])
        fast = total(fast, scaled(wheel, len(re.findall(rf"= {NAME}_wheel_{name}\(", calls))))
    if f"{NAME}_drive" in body:
        drive = operations(blocks(body[f"{NAME}_drive"])[0])
        same("operations of the powertrain", told["all together", "powertrain"], drive + [sum(drive)])
        fast = total(fast, drive)
    return fast


def check_operations(page, code, header):
    body = functions(code)
    bound = {name: int(value) for name, value in re.findall(r"#define GIC_(CHORDS|PASSES|PIECES) (\d+)", code)}
    members = {}
    for row in page.rows_of("operations"):
        if row[1] in ("predict", "closed form"):
            members[row[0]] = int(row[2])
    told = {(row[0], row[1]): [int(word) for word in row[3:]] for row in page.rows_of("operations")}
    calls = functions(code)[f"{NAME}_recover_piece"]
    usual, worst = [0] * 5, [0] * 5
    for name, count in members.items():
        same(f"members of {name}", count, len(re.findall(rf"= {NAME}_solve_{name}\(", calls)))
        # a subset's function holds them in this order
        parts = [operations(block) for block in blocks(body[f"{NAME}_solve_{name}"])]
        closed = "GIC_PASSES" not in body[f"{NAME}_solve_{name}"]
        for block, found in zip(["closed form"] if closed else ["predict", "chord", "solve"], parts, strict=True):
            same(f"operations of {name}, {block}", told[name, block], found + [sum(found)])
        predict, chord, solve = [[0] * 5] * 2 + parts if closed else parts
        usual = total(usual, scaled(total(predict, chord, solve), count))
        once = total(predict, scaled(chord, bound["CHORDS"]), scaled(solve, 1 if closed else bound["PASSES"]))
        worst = total(worst, scaled(once, count))
        way = ", closed form" if closed else ""
        line = re.search(rf"subset '{name}' \((\d+) times{way}\) +([\d ]+)", header)
        same(f"header's count of {name}", [int(line.group(1))] + [int(word) for word in line.group(2).split()],
             [count] + total(predict, chord, solve))
    same("classes", sorted(members), sorted(re.findall(rf"^static int {NAME}_solve_(\w+)\(", code, re.M)))
    dynamics = operations(blocks(body[f"{NAME}_dynamics"])[0])
    outputs = operations(blocks(body[f"{NAME}_measure"])[0])
    same("operations of outputs", told.pop(("all together", "outputs")), outputs + [sum(outputs)])
    reacting = f"{NAME}_react" in body
    same("are there reactions", ("all together", "wrenches") in told, reacting)
    if reacting:
        wrenches = operations(blocks(body[f"{NAME}_react"])[0])
        same("operations of wrenches", told["all together", "wrenches"], wrenches + [sum(wrenches)])
        outputs = total(outputs, wrenches)
    for name in members:
        count = len(re.findall(rf"{NAME}_react_{name}\(", body.get(f"{NAME}_react", "")))
        row = [row[2:] for row in page.rows_of("operations") if row[:2] == [name, "react"]]
        if count:
            react = operations(blocks(body[f"{NAME}_react_{name}"])[0])
            same(f"operations of {name}, react", [int(word) for word in row[0]], [count] + react + [sum(react)])
            outputs = total(outputs, scaled(react, count))
        else:
            same(f"{name} has no reactions", row, [])
    same("operations of dynamics", told["all together", "forces and equations of motion"], dynamics + [sum(dynamics)])
    line = re.search(r"outputs, when asked for +([\d ]+)", header)
    same("header's count of outputs", [int(word) for word in line.group(1).split()], outputs)
    rhs, bounded = total(usual, dynamics), total(worst, dynamics)
    fast = check_wheels(told, body)
    if fast:
        link = operations(blocks(body[f"{NAME}_link_wheels"])[0])
        same("operations of links", told["all together", "motion of the wheels"], link + [sum(link)])
        rhs, bounded = total(rhs, link, fast), total(bounded, link, fast)
    line = re.search(r"all together +([\d ]+)", header)
    same("header's sum", [int(word) for word in line.group(1).split()], rhs)
    totals = {row[0]: [int(word) for word in row[1:]] for row in page.rows_of("totals")}
    same("a fast step", totals.get("fast step: all wheels"), fast and fast + [sum(fast)])
    four = "RK4 step or one of the first two AB3 steps, "
    for what, count in (("right-hand side, usual", rhs), ("right-hand side, worst case in one piece", bounded),
                        ("every further piece, worst case", worst), ("AB3 step, usual", rhs),
                        ("AB3 step, worst case", bounded), (four + "usual", scaled(rhs, 4)),
                        (four + "worst case", scaled(bounded, 4)), ("outputs, usual", total(rhs, outputs))):
        same(what, totals[what], count + [sum(count)])
    for name, value in bound.items():
        check(f"page names GIC_{name}", re.search(rf"GIC_{name} = {value}\b", page.text))
    pieces = re.search(rf"{NAME}_piece\[\w+\] = \{{\n(.*?)\}};", code, re.S).group(1)
    pieces = [[float(value), name] for value, name in re.findall(r"R\((.*?)\), /\* (\w+) \*/", pieces)]
    told = [[float(row[1]), row[0]] for row in page.rows_of("pieces")]
    same("coordinates with pieces", [row[1] for row in told], [row[1] for row in pieces])
    # three digits are printed
    check("pieces", all(abs(a[0] / b[0] - 1) < 0.0051 for a, b in zip(told, pieces)), f"{told} {pieces}")


# ---- sequence, signals -----------------------------------------------------------------------------------------------

def check_sequence(page, sequence):
    stage, subsets, label = "", [], None
    for line in sequence.split("\nclasses of")[0].splitlines():
        head = re.match(r" {2} *(\d+)  (\d+) x (\d+)  (.*)", line)
        if re.match(r"stage \d+$", line):
            stage = line.split()[1]
        elif head:
            subsets.append({"subset": head.group(1), "stage": stage, "size": [head.group(2), head.group(3)]})
        elif re.match(r" {8}\S", line):
            label, words = re.match(r" {8}(bodies|joints|coordinates|known before) +(.*)", line).groups()
            subsets[-1][label] = words
        elif re.match(r" {23}\S", line):
            subsets[-1][label] += " " + line.strip()
    told = []
    for row in page.rows_of("sequence"):
        entry = {"subset": row[0], "stage": row[1], "size": row[7:9]}
        lists = ("bodies", "joints", "coordinates", "known before")
        entry.update({what: word for what, word in zip(lists, row[3:7]) if word})
        told.append(entry)
    # of joints and coordinates that could change places either way is good: chains of subsets take their own
    for entry in told + subsets:
        for label in ("joints", "coordinates"):
            if label in entry:
                entry[label] = ", ".join(sorted(re.split(r", (?![^(]*\))", entry[label])))
    same("sequence", told, subsets)


def check_signals(page, facts):
    for kind in ("states", "inputs", "parameters"):
        rows = page.rows_of(kind)
        compiled = [line[1:] for line in facts if line[0] == kind]
        same(f"names of {kind}", [row[:3] for row in rows], [line[:3] for line in compiled])
        # 15 digits on either side
        check(f"values of {kind}", all(abs(float(row[3]) - float(line[3])) <= 1e-14 * abs(float(line[3]))
                                       for row, line in zip(rows, compiled)))
    same("outputs", [row[:3] for row in page.rows_of("outputs")], [line[1:4] for line in facts if line[0] == "outputs"])
    ports = [line[1:3] for line in facts if line[0] == "ports" and line[2].endswith(".force.x")]
    same("ports", [row[:2] for row in page.rows_of("ports")], [[place, name[:-8]] for place, name in ports])
    steps = {line[1]: int(line[2]) for line in facts if line[0] == "step"}
    # the first step of all begins with a sample of each controller, which is one more
    sampled = any(row[1].endswith(".samples") for row in page.rows_of("states"))
    same("right-hand sides a step", {"rk4": 4 + sampled, "ab3 first": 4, "ab3 second": 4, "ab3 third": 1}, steps)


# ---- memory ----------------------------------------------------------------------------------------------------------

def stack_of(graph, function, above=()):
    """Deepest stack below a call, by what the compiler says of each function."""
    own, callees = graph[function]
    deepest = max((stack_of(graph, callee, above + (function,)) for callee in callees if callee in graph), default=0)
    return own + deepest


def call_graph(paths):
    """Bytes and callees of each function; what clones a compiler makes counts as the function itself."""
    bytes_of, calls = {}, {}

    def plain(title):
        return re.sub(r"\..*", "", title.split(":")[-1])

    for path in paths:
        text = read(path)
        for title, label in re.findall(r'node: \{ title: "([^"]*)" label: "([^"]*)"', text):
            used = re.search(r"(\d+) bytes", label)
            if used:
                bytes_of[plain(title)] = max(int(used.group(1)), bytes_of.get(plain(title), 0))
        for source, target in re.findall(r'edge: \{ sourcename: "([^"]*)" targetname: "([^"]*)"', text):
            target = plain(target)
            if target == "__indirect_call":
                # through the descriptor; in the model itself those are road and input, which are the user's
                if plain(source).startswith("gic_") or plain(source) in ("advance", "evaluate"):
                    calls.setdefault(plain(source), set()).update({f"{NAME}_any_rhs", f"{NAME}_any_settle"})
            elif target != plain(source):
                calls.setdefault(plain(source), set()).add(target)
    return {name: (used, calls.get(name, ())) for name, used in bytes_of.items()}


def check_memory(page, facts, facts_float):
    memory = {row[0]: [int(row[1]), int(row[2])] for row in page.rows_of("memory")}
    same("size of an instance", memory["instance"], [int(facts[0][1]), int(facts_float[0][1])])
    for column, real in enumerate(("double", "float")):
        for path in glob.glob(f"{CODE}.{real}.symbols"):
            symbols = [line.split() for line in read(path).splitlines()]
            symbols = [line for line in symbols if len(line) == 4 and line[2] in "rRdD"]
            constants = memory["constants of the code, without the texts of names"]
            same(f"constants in {real}", constants[column], sum(int(line[1], 16) for line in symbols))
            same(f"numbers of the subsets in {real}", memory["of it numbers of the subsets"][column],
                 sum(int(line[1], 16) for line in symbols if line[3].startswith(f"{NAME}_k_")))
    stack = {row[0]: [int(row[1]), int(row[2])] for row in page.rows_of("stack")}
    compared = 0
    for column, real in enumerate(("double", "float")):
        for how in sorted({path.split(".")[-2] for path in glob.glob(f"{CODE}.{real}.*.ci")}):
            graph = call_graph([f"{CODE}.{real}.{how}.ci", f"{CODE.rsplit('/', 1)[0]}/gic_runtime.{real}.{how}.ci"])
            for function, bound in stack.items():
                used = stack_of(graph, function)
                compared += 1
                check(f"stack of {function}, {real}, {how}", used <= bound[column], f"{used} > {bound[column]}")
                # a bound to build with: for places that no two temporaries share, a few times what is used
                if how == "O0":
                    check(f"stack bound of {function}, {real}", bound[column] <= 4 * used + 2048,
                          f"{bound[column]} for {used}")
    check("stacks compared", compared >= 2 * len(stack), compared)


def main():
    page = Page()
    text = read(PAGE)
    page.feed(text)
    page.close()
    same("elements are closed", page.open, [])
    check("no foreign parts", not re.search(r"<script|<link|<img|src=|url\(|href=\"http", text))
    alone = [row[3] for row in page.rows_of("sequence") if "," not in row[3]]
    check("graph", "<svg" in text and all(f">{body}<" in text for body in alone), alone)
    code, header = read(CODE + ".c"), read(CODE + ".h")
    facts, facts_float = [[line.split("\t") for line in read(path).splitlines()] for path in (FACTS, FACTS_FLOAT)]
    same("model hash", *(re.search(r"model hash (\w+)", one).group(1) for one in (page.text, code)))
    check_operations(page, code, header)
    check_sequence(page, read(SEQUENCE))
    check_signals(page, facts)
    check_memory(page, facts, facts_float)


main()
