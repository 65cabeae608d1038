# SPDX-License-Identifier: MIT
"""Places in C and JavaScript where a small semantic change can be made, and the changes. Comments, texts, preprocessor
lines, prototypes, types and sizes of arrays are left alone, and so is what only gives memory back."""
import bisect
import hashlib
import re

# comments, texts, preprocessor lines: blanked, so that places stay the same
HIDDEN = re.compile(r"""/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|`(?:\\.|[^`\\])*`
    |^[ \t]*\#(?:\\\n|[^\n])*""", re.S | re.M | re.X)
# sizes in declarations, with what is declared
TYPES = r"(?:double|float|int|bool|char|long|unsigned|size_t|u?int\d+_t|gic_real|[A-Z]\w*)"
SIZES = re.compile(r"\b" + TYPES + r"\s+[*(]*\w+\)?(?:\[[^\];]*\])+(?:,\s*\*?\w+(?:\[[^\];]*\])+)*")
DECLARED = re.compile(r"\b(double|int|size_t|bool|Ex|gic_real)\s+((?:\w+(?:\s*=\s*[^,;()]*)?\s*,\s*)*\w+)\s*[=;,)]")
OPERAND = r"[\w\])]"

TOKEN = re.compile(r"""(?P<number>(?<![\w.])(?:\d+\.?\d*(?:[eE][-+]?\d+)?|\.\d+)(?![\w.]))
    |(?P<word>[A-Za-z_]\w*)|(?P<operator><<=?|>>=?|->|\+\+|--|=>|[-+*/%<>=!]=|&&|\|\||[-+*/%<>!])""", re.X)

OPERATORS = {"+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"], "%": ["/"], "+=": ["-="], "-=": ["+="], "*=": ["/="],
             "/=": ["*="], "<": ["<=", ">"], "<=": ["<", ">="], ">": [">=", "<"], ">=": [">", "<="], "==": ["!="],
             "!=": ["=="], "&&": ["||"], "||": ["&&"], "++": ["--"]}
WORDS = {"sin": "cos", "cos": "sin", "GIC_SIN": "GIC_COS", "GIC_COS": "GIC_SIN", "OP_SIN": "OP_COS",
         "OP_COS": "OP_SIN", "fmin": "fmax", "fmax": "fmin", "min": "max", "max": "min", "floor": "ceil",
         "ceil": "floor", "true": "false", "false": "true", "break": "continue", "ex_add": "ex_sub",
         "ex_sub": "ex_add", "ex_mul": "ex_div", "ex_div": "ex_mul", "ex_add3": "ex_sub3", "ex_sub3": "ex_add3"}
UNSIGNED = {"fabs": "", "GIC_FABS": "", "ex_neg": None}  # calls of which the argument is left; None: the last argument
SYMMETRIC = {"fmin", "fmax", "vec_dot", "vec_add", "ex_add", "ex_mul", "ex_add3", "ex_dot", "hypot", "GIC_FMIN", "GIC_FMAX"}
GIVES_BACK = re.compile(r"\b\w*(?:free|close|unlink|fflush)\b\s*\(")
STATEMENT = re.compile(r"^\s*(?:else )?([*(]*\+*\w[^;{}]*;)\s*$")
NO_STATEMENT = re.compile(r"^\s*(?:return|break|continue|goto|case|default|typedef|struct|enum|static|const|let|extern|"
                          r"for|while|if|switch|do|#|\(void\)|" + TYPES + r"\s+[*(]*\w)")


class Site:
    """One change: text[start:end] becomes `new`; `what` says it."""

    def __init__(self, start, end, new, what):
        self.start, self.end, self.new, self.what = start, end, new, what


def hide(text):
    return HIDDEN.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)


def numbers(token):
    """What a constant becomes."""
    if re.fullmatch(r"\d+", token):
        n = int(token)
        return {0: ["1"], 1: ["0", "2"], 2: ["1", "3"]}.get(n, [str(n + 1), str(n - 1)])
    if float(token) == 0:
        return ["1.0"]
    if re.search("[eE]-", token):  # a tolerance
        return ["%g" % (float(token) * 1e3), "%g" % (float(token) / 1e3)]
    return ["%r" % (float(token) * 2), "%r" % (float(token) / 2)]


def closing(text, start):
    """The place after the bracket that closes the one at `start`."""
    depth = 0
    for i in range(start, len(text)):
        depth += (text[i] in "([{") - (text[i] in ")]}")
        if depth == 0:
            return i + 1
    return len(text)


def arguments(text, start):
    """Places of the arguments of a call whose bracket opens at `start`."""
    end, parts, depth, begin = closing(text, start) - 1, [], 0, start + 1
    for i in range(start + 1, end + 1):
        depth += (text[i] in "([{") - (text[i] in ")]}")
        if i == end or (text[i] == "," and depth == 0):
            parts.append((begin, i))
            begin = i + 1
    return [(a + len(text[a:b]) - len(text[a:b].lstrip()), b) for a, b in parts if text[a:b].strip()]


def bodies(text):
    """Places of what is between the outermost braces that hold code or numbers, with where their head begins."""
    found, at = [], 0
    while (start := text.find("{", at)) >= 0:
        at = closing(text, start)
        head = max(text.rfind(";", 0, start), text.rfind("}", 0, start), 0)
        if not re.search(r"\b(?:struct|enum|union)\b[^=()]*$", text[head:start]) or "=" in text[head:start]:
            found.append((head, start, at))
    return found


def operator_sites(text, match):
    token, start, end = match.group(), match.start(), match.end()
    before, after = text[:start].rstrip()[-1:], text[end:end + 1]
    binary = bool(re.match(OPERAND, before)) and not re.search(r"\b(?:return|case)\s*$", text[max(start - 9, 0):start])
    if token == "!":
        return [Site(start, end, "", "'!' dropped")]
    if token == "-" and not binary:
        return [Site(start, end, "", "sign dropped")]
    if token not in OPERATORS or (token in "+-*/%<>" and not (binary and after in " \n")):
        return []
    if token == "++" and re.search(r"for \([^)]*$", text[max(start - 120, 0):start]):
        return []
    return [Site(start, end, new, f"'{token}' is '{new}'") for new in OPERATORS[token]]


def word_sites(text, match, same):
    word, start, end = match.group(), match.start(), match.end()
    sites = []
    if word in WORDS:
        sites.append(Site(start, end, WORDS[word], f"{word} is {WORDS[word]}"))
    if text[end:end + 1] == "(" and word not in ("if", "for", "while", "switch", "sizeof", "return"):
        parts = arguments(text, end)
        if word in UNSIGNED:
            begin = parts[-1][0] if parts else end + 1
            sites.append(Site(start, closing(text, end), f"({text[begin:closing(text, end) - 1]})", f"{word}() dropped"))
        for (a, b), (c, d) in zip(parts, parts[1:]):
            first, second = text[a:b], text[c:d]
            if first != second and word not in SYMMETRIC and len(first + second) < 60 and "\n" not in text[a:d]:
                sites.append(Site(a, d, f"{second}, {first}", f"arguments of {word}() swapped: {second}, {first}"))
    if word == "if" and text[end:end + 2] == " (":
        stop = closing(text, end + 1)
        sites.append(Site(end + 1, stop, f"(!{text[end + 1:stop]})", "condition negated"))
    others = same.get(word, [])
    if others and text[end:end + 1] != "(" and not re.search(r"(?:\.|->|" + TYPES + r"\s+\**)$", text[:start][-20:]):
        sites += [Site(start, end, other, f"{word} is {other}") for other in others]
        if re.search(r"\w\[$", text[:start][-2:]) and text[end:end + 1] == "]":
            sites.append(Site(start, end, word + " + 1", f"index {word} is {word} + 1"))
    return sites


def declared(text):
    """For each number that a function declares the others of the same type."""
    types = {}
    for kind, names in DECLARED.findall(text):
        for name in re.findall(r"(?:^|,)\s*(\w+)", names):
            types.setdefault(kind, []).append(name)
    same = {}
    for names in types.values():
        names = sorted(set(names) - set("double int size_t bool Ex gic_real const".split()))
        for i, name in enumerate(names):
            same[name] = [names[(i + k) % len(names)] for k in (1, 2) if k < len(names)]
    return same


def statement_sites(text, start, end):
    """Whole statements on a line of their own."""
    line = text[start:end]
    match = STATEMENT.match(line)
    opened = text[:start].rstrip()[-1:]
    if not match or NO_STATEMENT.match(line) or GIVES_BACK.search(line) or opened not in ";{})" or \
            not re.search(r"[=(]|\+\+|--", line):
        return []
    return [Site(start + match.start(1), start + match.end(1), "{}", "statement removed")]


def sites_of(whole):
    """All changes of a file's text, as a list for each line that has any: {line number: [Site]}."""
    text = hide(whole)
    skipped = [match.span() for match in SIZES.finditer(text)]
    lines = [0] + [match.end() for match in re.finditer("\n", text)]
    found = {}
    for head, start, end in bodies(text):
        same = declared(text[head:end])
        sites = []
        for match in TOKEN.finditer(text, start, end):
            if any(a <= match.start() < b for a, b in skipped):
                continue
            if match.group("number"):
                sites += [Site(*match.span(), new, f"{match.group()} is {new}") for new in numbers(match.group())]
            elif match.group("word"):
                sites += word_sites(text, match, same)
            else:
                sites += operator_sites(text, match)
        for line in range(bisect.bisect(lines, start), bisect.bisect(lines, end - 1)):
            sites += statement_sites(text, lines[line], lines[line + 1] if line + 1 < len(lines) else end)
        for site in sites:
            # an expression that is put in another place must be what stands in the file, texts and all
            if whole[site.start:site.end] != text[site.start:site.end]:
                continue
            found.setdefault(bisect.bisect(lines, site.start), []).append(site)
    return found


def draw(files, seed):
    """(key, file, line, Site) in an order drawn at random, one change a line. The key of a line follows from its text
    and the seed, so that a change elsewhere leaves the order of the others as it is. files: {name: text}"""
    drawn, seen = [], {}
    for name in sorted(files):
        for line, sites in sites_of(files[name]).items():
            text = (name, files[name].splitlines()[line - 1].strip())
            seen[text] = seen.get(text, 0) + 1
            key = hashlib.sha256(repr((seed, text, seen[text])).encode()).hexdigest()
            drawn.append((key[:12], name, line, sites[int(key[12:24], 16) % len(sites)]))
    return sorted(drawn, key=lambda mutant: mutant[0])
