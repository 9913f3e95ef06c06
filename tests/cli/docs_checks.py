"""What docs_test.py asks of the documentation. Every check takes text and returns its complaints, so that a test can plant one."""

import functools
import os
import pathlib
import re
import shlex

import support

ROOT = support.SOURCE_DIR
README = ROOT / "README.md"

# Words of the sources that a reader cannot guess.
WORDS = ("rest", "first", "share", "optical depth", "slab depth", "facet depth", "fringe order", "scattering order", "task order",
         "place", "fold", "node", "block", "arrival", "returned", "exchange", "leg", "remainder", "frame", "binding", "encoding",
         "truth", "noise floor", "guide", "replicate")


def pages():
    """Every page of the documentation."""
    return [README, ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", ROOT / "tests" / "README.md",
            *sorted((ROOT / "docs").rglob("*.md"))]


def mentioning_files():
    """Files beside the pages and the C++ sources that may mention a page."""
    found = [path for folder in ("cmake", "docs", "tables", "tests") for path in (ROOT / folder).rglob("*")
             if path.suffix in (".sh", ".py", ".toml", ".txt", ".cmake")]
    return [path for path in found if not path.name.startswith("docs_")]


@functools.cache
def text_of(path):
    return path.read_text(encoding="utf-8", errors="replace")


# --- Names of the code


def wrong_names(text):
    """`path`: `name`, `name`: the file exists, and each name is a function or a type in it."""
    complaints = []
    for path, names in re.findall(r"`([\w./]+\.(?:h|cpp))`: ((?:`[\w:]+`(?:, )?)+)", text):
        file = ROOT / path
        if not file.is_file():
            complaints.append(f"{path}: no such file")
            continue
        for name in re.findall(r"`([\w:]+)`", names):
            complaints += [f"{path}: no {part} of {name}" for part in name.split("::") if not is_defined(part, text_of(file))]
    return complaints


def is_defined(name, source):
    code = re.sub(r"//[^\n]*", "", source)
    return bool(re.search(rf"\b{name}\s*(<[^<>;]*>\s*)?\(|\b(class|struct|enum|using)\s+{name}\b|\b{name}::", code))


def wrong_paths(text):
    """`bake/...`, with an extension or a slash at its end: the file or folder exists; * stands for anything."""
    complaints = []
    for path in re.findall(r"`((?:bake|runtime|tables|tests|cmake|docs)/[\w./*-]*)`", text):
        if not list(ROOT.glob(path.rstrip("/"))):
            complaints.append(f"{path}: no such file")
    return complaints


def rows_without_a_place(index):
    """Rows of the equation index whose third column names no function."""
    rows = [line for line in index.splitlines() if line.startswith("| ")][1:]
    return [row for row in rows if not re.search(r"`[\w./]+`: `", row.split("|")[3])]


def wrong_mentions(text):
    """docs/... with an extension, as scripts, recipes and scenes mention pages."""
    return [path for path in re.findall(r"\bdocs/[\w/]+\.(?:md|sh|py)\b", text) if not (ROOT / path).is_file()]


# --- Command lines


def code_lines(text):
    """Lines of code blocks and of inline code, continued lines joined."""
    blocks = re.findall(r"^```[^\n]*\n(.*?)^```", text, re.S | re.M)
    prose = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    blocks += re.findall(r"(?:^ {4}[^\n]*\n)+", prose, re.M)
    inline = [re.sub(r"\s+", " ", code) for code in re.findall(r"`([^`]+)`", prose)]
    lines = "\n".join(blocks).replace("\\\n", " ").splitlines()
    return [line.strip() for line in lines + inline]


def commands(text):
    """The words of every command that the checks below know."""
    for command in all_commands(text):
        if re.fullmatch(r"sunbeam|bash|sh|cmake|ctest|build/release/bin/\w+", command[0]) and len(command) > 1:
            yield command


def all_commands(text):
    """The words between pipes and the like, without assignments in front."""
    for line in code_lines(text):
        lexer = shlex.shlex(line, posix=True, punctuation_chars="|&;<>")
        lexer.whitespace_split = True
        try:
            words = list(lexer)
        except ValueError:
            continue  # text of a program, not a command
        command = []
        for word in [*words, ";"]:
            if word and set(word) <= set("|&;<>"):
                yield from filter(None, [trimmed(command)])
                command = []
            else:
                command.append(word)


def trimmed(command):
    """Without assignments, and out of the hands of GNU parallel."""
    while command and re.fullmatch(r"[A-Z_]+=.*", command[0]):
        command = command[1:]
    if command and command[0] == "parallel" and "sunbeam" in command:
        command = command[command.index("sunbeam"):]
    return command[:command.index(":::")] if ":::" in command else command


def wrong_commands(text):
    complaints = []
    for command in commands(text):
        name = command[0].removeprefix("build/release/bin/")
        if name == "sunbeam":
            complaints += wrong_sunbeam(command[1:])
        elif command[0].startswith("build/release/bin/"):
            complaints += wrong_program(name, command[1:])
        elif name in ("bash", "sh") and command[1].endswith(".sh") and not (ROOT / command[1]).is_file():
            complaints.append(f"{command[1]}: no such script")
        elif name in ("cmake", "ctest"):
            complaints += wrong_cmake(command)
    return complaints


@functools.cache
def options_of(command):
    """From --help: for each option whether it takes a value, what must be given, and how many positionals there are."""
    result = support.run_command([support.BINARY, command, "--help"], ROOT)
    if result.code != 0:
        return None
    takes_value, required, positionals, many = {}, [], 0, False
    section = ""
    for line in result.out.splitlines():
        section = line if re.match(r"\w+:$", line) else section
        entry = re.match(r"  (\S+)(?: ([^ ].*?))?(?:  |$)", line)
        if not entry:
            continue
        names, kind = entry.group(1).split(","), entry.group(2) or ""
        if section == "Positionals:":
            positionals += 1
            many = many or "..." in kind
        elif section == "Options:" and names[0].startswith("-"):
            names = [re.sub(r"\{.*|:.*", "", name) for name in names]
            takes_value.update({name: bool(re.match(r"(TEXT|INT|UINT|FLOAT)", kind)) for name in names})
            if "REQUIRED" in kind:
                required.append(names)
    return takes_value, required, positionals, many


def wrong_sunbeam(words):
    """Whether the command takes these words; placeholders in capitals stand for files."""
    said = "sunbeam " + " ".join(words)
    if words[0] in ("COMMAND", "help", "--version", "--help"):
        return []
    known = options_of(words[0])
    if known is None:
        return [f"{said}: no such command"]
    takes_value, required, positionals, many = known
    given, seen, rest = 0, set(), list(words[1:])
    complaints = []
    while rest:
        word = rest.pop(0)
        if not word.startswith("-") or word == "-":
            given += 1
            if word.startswith("tables/") and not (ROOT / word).exists():
                complaints.append(f"{said}: no {word}")
            continue
        name = word.split("=")[0]
        seen.add(name)
        if name not in takes_value:
            complaints.append(f"{said}: no option {name}")
        elif takes_value[name] and "=" not in word:
            complaints += [] if rest else [f"{said}: {name} takes a value"]
            rest = rest[1:]
    is_mention = given == 0 or "--help" in seen or (given < positionals and not many)
    if given > positionals and not many:
        complaints.append(f"{said}: {given} arguments in place of {positionals}")
    if not is_mention and len(words) > given + 1:
        complaints += [f"{said}: {names[-1]} is missing" for names in required if not seen & set(names)]
    return complaints or refused_values(words)


def refused_values(words):
    """--help is obeyed only after option names and values have been checked."""
    if any(re.fullmatch(r"[A-Z][A-Z_]*|.*[#{].*", word) for word in words):
        return []
    result = support.run_command([support.BINARY, *words, "--help"], ROOT)
    return [] if result.code == 0 else [f"sunbeam {' '.join(words)}: {result.err.strip()}"]


@functools.cache
def cmake_text():
    files = [*ROOT.glob("CMake*"), *(ROOT / "cmake").glob("*.cmake")]
    files += [file for folder in ("bake", "runtime", "tests") for file in (ROOT / folder).rglob("CMakeLists.txt")]
    return "\n".join(text_of(file) for file in files if file.is_file())


@functools.cache
def test_names():
    sources = [text_of(file) for file in (ROOT / "tests").rglob("*.cpp")]
    return {".".join(pair) for source in sources
            for pair in re.findall(r"\bTEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)|INSTANTIATE_TEST_SUITE_P\(\s*(\w+),\s*(\w+)",
                                   source) for pair in [tuple(filter(None, pair))]}


def wrong_program(name, words):
    complaints = [] if re.search(rf"\b{name}\b", cmake_text()) else [f"{name}: no such program"]
    for filters in [word.split("=", 1)[1] for word in words if word.startswith("--gtest_filter=")]:
        for each in filters.split(":"):
            start = each.split("*")[0]
            if not any(test.startswith(start) or test.split(".")[0] == start for test in test_names()):
                complaints.append(f"{name} {each}: no such test")
    return complaints


def wrong_cmake(words):
    complaints = []
    for option, value in zip(words, words[1:]):
        if option in ("--preset", "--target") and value.islower() and not re.search(rf"\b{value}\b", cmake_text()):
            complaints.append(f"{' '.join(words)}: no {option[2:]} {value}")
    for word in words:
        name = re.match(r"-D(SUNBEAM_\w+)=", word)
        if name and name.group(1) not in cmake_text():
            complaints.append(f"{' '.join(words)}: no option {name.group(1)}")
    return complaints


# --- Links


def links(text):
    """Targets of links and pictures that lie in the tree."""
    prose = re.sub(r"^```.*?^```", "", text, flags=re.S | re.M)
    return [target for target in re.findall(r"\]\(([^)\s]+)\)", prose) if not re.match(r"[a-z]+:", target)]


def anchors(text):
    """As the headings of a page get them on the web."""
    titles = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def wrong_links(page, text):
    complaints = []
    for target in links(text):
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        if not file.exists():
            complaints.append(f"{page.relative_to(ROOT)}: {target}")
        elif anchor and anchor not in anchors(text if file == page else text_of(file)):
            complaints.append(f"{page.relative_to(ROOT)}: {target}: no such heading")
    return complaints


def unreachable(texts):
    """Pages, a mapping of paths to texts, that no chain of links from the README leads to."""
    reached, next_pages = set(), [README]
    while next_pages:
        page = next_pages.pop()
        if page in texts and page not in reached:
            reached.add(page)
            next_pages += [pathlib.Path(os.path.normpath(page.parent / target.partition("#")[0])) for target in links(texts[page])]
    return sorted(str(page.relative_to(ROOT)) for page in texts if page not in reached)


def missing_words(text):
    """A glossary defines a word in a row that begins with it, in bold."""
    return [word for word in WORDS if not re.search(rf"^\| \*\*{word}\*\*", text, re.M)]
