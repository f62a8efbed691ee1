"""Extension of mkdocstrings: our docstrings as Markdown, and the option tables that functions get when they run.

Aligned lines ("name  what it is") become a table, and so do the fields of a dataclass. A function that is
@described("table") gets the rows of that table of shapelight._core, the same that --help prints.
"""

import ast
import re

import griffe

from shapelight.describe import option_table

ROW = re.compile(r"(?P<name>[\w*][\w*, ]*?) {2,}(?P<text>\S.*)")


def cell(text):
    return str(text).replace("|", "\\|")


def as_table(paragraph):
    """A paragraph of aligned lines as a table, any other as it is. Indented lines go on with the row above."""
    rows = []
    for line in paragraph.splitlines():
        if found := ROW.fullmatch(line):
            rows.append([found["name"], found["text"]])
        elif rows and line.startswith("  "):
            rows[-1][1] += " " + line.strip()
        else:
            return paragraph
    cells = [f"| `{name}` | {cell(text)} |" for name, text in rows]
    return "\n".join(["| argument | meaning |", "| --- | --- |", *cells])


def options_as_table(rows):
    lines = ["**Options**", "", "| option | meaning | unit | default |", "| --- | --- | --- | --- |"]
    for row in rows:
        choices = f" One of {', '.join(f'`{c}`' for c in row['choices'])}." if row["choices"] else ""
        unit = "" if row["unit"] == "1" else row["unit"]
        default = f"{row['default']:g}" if row["type"] == "float" else row["default"]
        lines.append(f"| `{row['name']}` | {cell(row['meaning'])}{choices} | {unit} | {default} |")
    return "\n".join(lines)


def fields_as_table(attributes):
    lines = ["| field | type | meaning |", "| --- | --- | --- |"]
    for attribute in attributes:
        meaning = attribute.docstring.value.replace("\n", " ") if attribute.docstring else ""
        lines.append(f"| `{attribute.name}` | `{attribute.annotation}` | {cell(meaning)} |")
    return "\n".join(lines)


class Tables(griffe.Extension):
    def on_instance(self, *, obj, **kwargs):
        if obj.is_alias or obj.docstring is None:
            return
        paragraphs = obj.docstring.value.split("\n\n")
        obj.docstring.value = "\n\n".join(as_table(paragraph) for paragraph in paragraphs)

    def on_function(self, *, func, **kwargs):
        for decorator in func.decorators:
            call = ast.parse(str(decorator.value), mode="eval").body
            if isinstance(call, ast.Call) and getattr(call.func, "id", "") == "described" and func.docstring:
                func.docstring.value += "\n\n" + options_as_table(option_table(ast.literal_eval(call.args[0])))

    def on_class_members(self, *, cls, **kwargs):
        if cls.docstring is None or not any("dataclass" in str(decorator.value) for decorator in cls.decorators):
            return
        attributes = [member for member in cls.members.values() if member.is_attribute and member.is_public]
        if missing := [a for a in attributes if f"| `{a.name}` |" not in cls.docstring.value]:
            cls.docstring.value += "\n\n" + fields_as_table(missing)
        for attribute in attributes:
            attribute.docstring = None  # so that it is not shown a second time, by itself
