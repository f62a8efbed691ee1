"""The commands and options of the shapelight program, as its own --help tells them. No other source: nothing goes stale."""

import re
import subprocess
from dataclasses import dataclass, field

FLAGS = re.compile(r"^  (?P<flags>-\S.*?)(?:\s{2,}(?P<meaning>\S.*))?$")
ROW = re.compile(r"^  (?P<name>\S.*?)\s{2,}(?P<meaning>\S.*)$")
CHOICES = re.compile(r"^[\w-]+(\|[\w-]+)+$")


def parse(text):
    """{heading: [[flags, meaning], ...]} of a help text; a meaning may stand on the line below its flags."""
    groups, rows = {}, []
    for line in text.splitlines():
        if re.fullmatch(r"\S[^:]*:", line):
            rows = groups.setdefault(line[:-1], [])
        elif found := FLAGS.match(line):
            rows.append([found["flags"], found["meaning"] or ""])
        elif rows and line.startswith("     "):
            rows[-1][1] = (rows[-1][1] + " " + line.strip()).strip()
    return groups


def plain(flags):
    """The flags without what only the parser of the program needs to know: types, ranges, defaults of switches."""
    return re.sub(r"\{false\}|:\{.*?\}|:INT in \[.*?\]| REQUIRED| TEXT| \.\.\.", "", flags)


@dataclass
class Option:
    names: list  # "-o", "--output"
    value: str  # "OUT", "a|b|c", or "" of a switch
    meaning: str
    required: bool

    @property
    def choices(self):
        return self.value.split("|") if CHOICES.match(self.value) else []


@dataclass
class Command:
    name: str
    meaning: str = ""
    usage: str = ""
    notes: str = ""
    positionals: list = field(default_factory=list)  # (name, meaning)
    groups: dict = field(default_factory=dict)  # heading: [Option, ...]

    @property
    def options(self):
        return [option for group in self.groups.values() for option in group]


def option(flags, meaning):
    names, _, value = flags.partition(" ")
    listed = re.search(r"\{([^}]*,[^}]*)\}", value)  # TEXT:{a,b}
    value = listed[1].replace(",", "|") if listed else value.replace(" REQUIRED", "").replace(" ...", "").split(":")[0]
    names = [re.sub(r"\{.*\}", "", name) for name in names.split(",")]
    return Option(names, value, meaning, " REQUIRED" in flags)


def positional(row, meaning):
    """(name, meaning); the name is the value's, SCAN, where it has one."""
    name, _, value = row.partition(" ")
    words = [word for word in value.split() if word not in ("REQUIRED", "...", "TEXT")]
    return words[0] if words else name.upper(), meaning


def help_of(program, *words):
    return subprocess.run([program, *words, "--help"], capture_output=True, text=True, check=True).stdout


def rows_of(text, heading):
    block = re.search(rf"^{heading}:\n((?:  .*\n)+)", text, re.MULTILINE)
    return [(row["name"], row["meaning"]) for row in map(ROW.match, block[1].splitlines()) if row] if block else []


def read_command(program, name):
    text = help_of(program, name)
    lines = text.splitlines()
    positionals = [positional(*row) for row in rows_of(text, "Positionals")]
    groups = {title: [option(*row) for row in rows] for title, rows in parse(text).items() if title != "Positionals"}
    notes = re.search(r"\n\n+((?:[^ \n].*[^:\n]\n?)+)\s*$", text)  # what the program says below its options
    return Command(name, lines[0], lines[1].removeprefix("Usage: "), notes[1].strip() if notes else "", positionals, groups)


def read_commands(program):
    """(the program itself, its subcommands)."""
    text = help_of(program)
    groups = {"Options": [option(*row) for row in parse(text)["Options"]]}
    whole = Command("", text.splitlines()[0], "shapelight COMMAND [OPTIONS]", groups=groups)
    return whole, [read_command(program, name) for name, _ in rows_of(text, "Subcommands")]
