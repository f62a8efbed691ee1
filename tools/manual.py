#!/usr/bin/env python3
"""Writes the manual pages and the shell completions of the shapelight program from its own --help.

  tools/manual.py SHAPELIGHT FOLDER

FOLDER becomes a share folder: man/man1/, bash-completion/completions/, zsh/vendor-completions/, fish/vendor_completions.d/.
"""

import argparse
import gzip
import re
import subprocess
import sys
from pathlib import Path

import completions
from command_help import read_commands

DOCS = Path(__file__).resolve().parent.parent / "docs"

EXAMPLES = {
    "sample": [
        ("A tenth of the points, exactly:", "shapelight sample scan.ply -o small.ply --ratio 10%"),
        ("A ranking, of which every prefix is a good sample:",
         "shapelight sample mesh.obj -o ranked.ply --ratio 1 --order"),
        ("Evenly spread points:", "shapelight sample scan.las -o even.las --method poisson --spacing 0.5%"),
    ],
    "fields": [("Shape index, reflectance, segments and importance of every point:",
                "shapelight fields mesh.ply -o fields.ply")],
    "simplify": [
        ("A tenth of the vertices:", "shapelight simplify mesh.ply -o small.ply --ratio 10% --placement optimal"),
        ("As coarse as the measured distance allows:", "shapelight simplify mesh.obj -o small.obj --max-error 0.1%"),
    ],
    "register": [("Bring one scan onto another, from anywhere:",
                  "shapelight register scan2.ply scan1.ply -o moved.ply --transform T.txt")],
    "align": [("Poses, the merged cloud and a report of many scans:",
               "shapelight align scan_0.ply scan_1.ply scan_2.ply -o placed")],
    "metrics": [("How far a simplified mesh is from the original:",
                 "shapelight metrics mesh.ply small.ply --json -")],
    "render": [("A picture in two colourings, the sample on top:",
                "shapelight render fields.ply -o picture.png --color reflectance,segment --dots small.ply")],
    "scan": [("Twelve virtual scans around a mesh, with their poses:",
              "shapelight scan mesh.ply -o views --views 12 --noise 0.05%")],
    "info": [("What is in a file, for programs:", "shapelight info scan.pcd --json -")],
    "convert": [("Another format:", "shapelight convert scan.las scan.ply")],
    "formats": [("What can be read and written:", "shapelight formats")],
}


def roff(text):
    """Text for a page: no character has a meaning to roff, and a line cannot be taken for a request."""
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("`", "")
    return re.sub(r"^(?=[.'])", r"\\&", text, flags=re.MULTILINE)


def term(head, meaning):
    return f".TP\n{head}\n{roff(meaning)}\n"


def option_term(option):
    names = ", ".join(rf"\fB{roff(name)}\fR" for name in option.names)
    return term(names + (rf" \fI{roff(option.value)}\fR" if option.value else ""), option.meaning)


def exit_status():
    for page in sorted(DOCS.glob("*.md")):
        if table := re.search(r"^\| code \| meaning \|.*\n\|[ \-|]+\n((?:\|.*\n)+)", page.read_text(), re.MULTILINE):
            rows = [[cell.strip() for cell in row.strip("|").split("|")][:2] for row in table[1].splitlines()]
            return ".SH EXIT STATUS\n" + "".join(term(rf"\fB{code}\fR", meaning) for code, meaning in rows)
    raise ValueError(f"{DOCS}: expected a page with the table | code | meaning |")


def examples(commands):
    texts = [f"{roff(what)}\n.PP\n.nf\n.RS\n{roff(line)}\n.RE\n.fi\n"
             for command in commands for what, line in EXAMPLES[command.name]]
    return ".SH EXAMPLES\n" + ".PP\n".join(texts)


def header(title, meaning, version):
    return (f'.TH {title.upper().replace("-", chr(92) + "-")} 1 "" "shapelight {version}" "User Commands"\n'
            f".SH NAME\n{roff(title)} \\- {roff(meaning[0].lower() + meaning[1:].rstrip('.'))}\n")


def command_page(command, version):
    words = [f"shapelight {command.name}", *(name for name, _ in command.positionals)]
    words += [f"{option.names[0]} {option.value}" for option in command.options if option.required] + ["[OPTIONS]"]
    parts = [header(f"shapelight-{command.name}", command.meaning, version),
             f".SH SYNOPSIS\n\\fB{roff(' '.join(words))}\\fR\n.SH DESCRIPTION\n{roff(command.meaning)}\n"]
    parts += [f".PP\n{roff(command.notes)}\n"] if command.notes else []
    parts += [term(rf"\fI{roff(name)}\fR", meaning) for name, meaning in command.positionals]
    for title, options in command.groups.items():
        parts.append(".SH OPTIONS\n" if title == "Options" else f".SS {title}\n")
        parts += map(option_term, options)
    parts += [exit_status(), examples([command]), ".SH SEE ALSO\n.BR shapelight (1)\n"]
    return "".join(parts)


def main_page(whole, commands, version, formats):
    meaning = whole.meaning.removeprefix("shapelight ")
    parts = [header("shapelight", meaning, version),
             f".SH SYNOPSIS\n\\fB{roff(whole.usage)}\\fR\n.SH DESCRIPTION\n{roff(whole.meaning)}\n",
             "Every command has a page of its own.\n.SH COMMANDS\n",
             *(term(f".BR shapelight\\-{command.name} (1)", command.meaning) for command in commands),
             ".SH OPTIONS\n", *map(option_term, whole.options),
             f".SH FILE FORMATS\n.nf\n{roff(formats)}.fi\n", exit_status(), examples(commands)]
    return "".join(parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", metavar="SHAPELIGHT")
    parser.add_argument("folder", metavar="FOLDER", type=Path)
    arguments = parser.parse_args()

    def output_of(word):
        return subprocess.run([arguments.program, word], capture_output=True, text=True, check=True).stdout

    whole, commands = read_commands(arguments.program)
    version = output_of("--version").split()[1]
    files = {"man/man1/shapelight.1.gz": main_page(whole, commands, version, output_of("formats")),
             "bash-completion/completions/shapelight": completions.bash(whole, commands),
             "zsh/vendor-completions/_shapelight": completions.zsh(whole, commands),
             "fish/vendor_completions.d/shapelight.fish": completions.fish(whole, commands)}
    for command in commands:
        files[f"man/man1/shapelight-{command.name}.1.gz"] = command_page(command, version)
    for name, text in files.items():
        path = arguments.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        data = text.encode()
        path.write_bytes(gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)
    return 0


if __name__ == "__main__":
    sys.exit(main())
