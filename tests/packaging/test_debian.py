"""The Debian packages, unpacked: the tool runs, every command has a manual page, completions are offered."""

import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCAN = ROOT / "data/scans/dragonStandRight_0.ply"
SECTIONS = ["NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXIT STATUS", "EXAMPLES"]


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


@pytest.fixture(scope="module")
def tool(unpacked):
    return unpacked / "usr/bin/shapelight"


@pytest.fixture(scope="module")
def commands(tool):
    return re.findall(r"^  (\w+)  ", output_of(tool, "--help").partition("Subcommands:")[2], re.MULTILINE)


def options_of(tool, *words):
    return set(re.findall(r"(?:^  |,)(--[a-z-]+)", output_of(tool, *words, "--help"), re.MULTILINE))


def page(unpacked, name):
    return output_of("gzip", "-dc", unpacked / f"usr/share/man/man1/{name}.1.gz")


def test_tool_runs(tool, tmp_path):
    subprocess.run([tool, "sample", SCAN, "-o", tmp_path / "out.ply", "--count", "100", "-q"], check=True)
    assert (tmp_path / "out.ply").exists()


def test_dependencies_are_found_out(debs):
    tool, development = (output_of("dpkg-deb", "-f", deb, "Depends") for deb in debs)
    assert {"libtbb12", "libfmt9", "libpng16-16", "liblzf1"} <= {word.split()[0] for word in tool.split(",")}
    assert "libeigen3-dev" in development


def test_every_file_is_where_debian_wants_it(debs):
    for deb in debs:
        rows = [line.split() for line in output_of("dpkg-deb", "--contents", deb).splitlines()]
        assert all(row[1] == "root/root" and row[5].startswith("./usr/") for row in rows)
        assert [row[5] for row in rows if row[0] not in ("drwxr-xr-x", "-rw-r--r--", "-rwxr-xr-x")] == []
        assert any(row[5].endswith("/copyright") for row in rows)


def test_every_command_has_a_page_with_all_its_options(unpacked, tool, commands):
    assert len(commands) >= 11
    for command in commands:
        text = page(unpacked, f"shapelight-{command}")
        assert re.findall(r"^\.SH (.*)", text, re.MULTILINE)[:-1] == SECTIONS
        for option in options_of(tool, command):
            assert option.replace("-", r"\-") in text, f"{command} {option}"


def test_main_page_names_every_command(unpacked, commands):
    text = page(unpacked, "shapelight")
    assert set(re.findall(r"^\.BR shapelight\\-(\w+) \(1\)", text, re.MULTILINE)) == set(commands)
    assert set(SECTIONS) <= set(re.findall(r"^\.SH (.*)", text, re.MULTILINE))


def test_examples_use_options_that_exist(unpacked, tool, commands):
    for command in commands:
        examples = page(unpacked, f"shapelight-{command}").partition(".SH EXAMPLES")[2].replace("\\", "")
        used = set(re.findall(r" (--[a-z-]+)", examples))
        assert f"shapelight {command}" in examples and used <= options_of(tool, command)


def test_completions(unpacked, tool):
    script = Path(__file__).parent / "completions_test.sh"
    subprocess.run([script, unpacked / "usr/share", tool], check=True, env=os.environ)
