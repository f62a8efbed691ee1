"""Everything public in C++ is there in Python."""

import inspect
import re

import numpy
import pytest

import shapelight
from shapelight import _core, geometry, pictures, stages

# What has another name in Python, and why: expressions that must have a value.
ELSEWHERE = {
    # jobs, called as the command calls them
    "measure": "shapelight.metrics",
    "distances_to_surface": "shapelight.metrics",
    "point_fields": "shapelight.fields",
    "register_scans": "shapelight.register, stages.register_prepared",
    "align_scans": "shapelight.align",
    "merge_scans": "shapelight.AlignResult.__dataclass_fields__['merged']",
    "render_scene": "shapelight.render",
    "make_panels": "shapelight.render",
    # files
    "read_geometry": "shapelight.read",
    "write_geometry": "shapelight.write",
    "supported_formats": "shapelight.formats",
    "check_writable_format": "shapelight.write",
    # batch queries are the trees' own
    "nearest": "stages.KdTree.nearest",
    "within": "stages.KdTree.within",
    "first_hits": "stages.TriangleTree.first_hit",
    # presets are a keyword
    "sample_preset": "inspect.signature(shapelight.sample).parameters['preset']",
    "fields_preset": "inspect.signature(shapelight.fields).parameters['preset']",
    "simplify_preset": "inspect.signature(shapelight.simplify).parameters['preset']",
    # members of Geometry
    "AttributeTable": "geometry.Geometry.__dataclass_fields__['attributes']",
    "geometry_kind_name": "geometry.Geometry.kind",
    "select_points": "geometry.Geometry.select",
    "transform_geometry": "geometry.Geometry.transformed",
    "bounding_box": "geometry.Geometry.bounding_box",
    "views_of": "geometry.Geometry._view",
    # what numpy has
    "scalar_type_name": "numpy.dtype('float32').name",
    "scalar_type_size": "numpy.dtype('float32').itemsize",
    "make_column": "numpy.zeros(0, numpy.float32)",
    "paste": "numpy.copyto",
    # options are keywords, checked when they are given
    "enum_names": "_core.option_tables['sample'][0]['choices']",
    "enum_name": "_core.option_tables['sample'][0]['default']",
    "check_range": "_core.option_tables['sample'][0]['min']",
    "validate_options": "shapelight.InvalidInput",
    "stop_reason_name": "stages.RegistrationResult.__dataclass_fields__['stop']",
}

PLACES = (shapelight, stages, pictures)


def without_comments(text):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", " ", text, flags=re.DOTALL)
    return re.sub(r"^\s*#[^\n]*", " ", text, flags=re.MULTILINE)


def statements(text):
    """Those directly in namespace shapelight, bodies left out."""
    kept, depth, parentheses = [], 0, 0
    for c in text:
        if c == "{":
            depth += 1
        elif c == "}":
            depth -= 1
            if depth == 1 and parentheses == 0:
                kept.append(";")
        elif depth == 1:
            parentheses += (c == "(") - (c == ")")
            kept.append(c)
        elif depth == 0:
            kept.append(c)
    return [" ".join(s.split()) for s in "".join(kept).split(";")]


def declared(headers):
    """Names of free functions and of classes."""
    functions, classes = set(), set()
    for header in headers:
        for statement in statements(without_comments(header.read_text())):
            if found := re.search(r"(?:^|> |shapelight )class (\w+)", statement):
                classes.add(found[1])
            elif "=" not in (head := statement.split("(")[0]) and head != statement:
                functions.add(re.search(r"(\w+)\s*$", head)[1])
    return functions - {"static_assert"}, classes


@pytest.fixture(scope="module")
def headers(data):
    return sorted((data.parent / "include/shapelight").glob("**/*.hpp"))


@pytest.fixture(scope="module")
def public(headers):
    return declared(headers)


def test_the_parser_sees_what_there_is(public):
    functions, classes = public
    print(f"{len(functions)} functions: {', '.join(sorted(functions))}")
    print(f"{len(classes)} classes: {', '.join(sorted(classes))}")
    assert len(functions) > 90
    assert {"sample", "curvedness", "write_png", "check_range", "validate", "register_format"} <= functions
    assert {"TriangleTree", "Cancelled", "AttributeTable", "KdTree"} <= classes


def test_every_function_and_class_is_reachable(public):
    functions, classes = public
    names = {name for name in functions | classes if not any(hasattr(place, name) for place in PLACES)}
    missing = sorted(names - ELSEWHERE.keys() - vars(shapelight.errors).keys())
    assert not missing, f"public in C++ and not to be found in Python: {', '.join(missing)}"


@pytest.mark.parametrize("name", ELSEWHERE)
def test_what_has_another_name_is_there(name, public):
    functions, classes = public
    assert name in functions | classes, "gone from C++: take it out of the table"
    assert eval(ELSEWHERE[name]) is not None


def test_every_option_is_a_keyword(headers):
    names = {name for header in headers for name in re.findall(r'OptionInfo\{"([\w-]+)"', header.read_text())}
    keywords = {row["name"].rstrip("_") for table in _core.option_tables.values() for row in table}
    assert len(names) > 60
    missing = sorted(names - {keyword.replace("_", "-") for keyword in keywords})
    assert not missing, f"options in C++ that no Python function takes: {', '.join(missing)}"
