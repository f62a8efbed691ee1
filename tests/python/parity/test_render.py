"""C++ and Python give the same bytes: pictures and colours."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import pictures

OPTIONS = {"width": 320, "height": 240, "view": "iso", "occlusion": 0.5, "dot_size": 3}


@pytest.fixture(scope="module")
def inputs(data):
    return [data / "meshes/fandisk.off", data / "scans/bun000_quarter.rif"]


@pytest.fixture(scope="module")
def fandisk(inputs):
    return sl.read(inputs[0])


def test_render(inputs, fandisk, cpp, same_bytes):
    dots = fandisk.positions[:40]
    same_bytes(sl.render(inputs, color=["none", "z"], dots=dots, **OPTIONS).ravel(), cpp("render_scene", np.uint8))
    alone = sl.render(fandisk, color="z", dots=dots, captions=False, **OPTIONS)
    same_bytes(alone.ravel(), cpp("render", np.uint8))
    grid = pictures.image_grid([alone] * 3, columns=2, gap=5, background=(9, 8, 7))
    same_bytes(grid.ravel(), cpp("image_grid", np.uint8))


def test_parse_view(inputs, cpp, same_bytes):
    view = pictures.parse_view("1,2,3", inputs[1])
    same_bytes(np.array([view.direction, view.up]), cpp("parse_view", np.float64))


def test_colors(fandisk, cpp, same_bytes):
    values = [-1.0, 0.0, 0.25, 3.0, 1 / 3]
    mapped = pictures.map_color("blue-yellow", values)
    lab = pictures.to_oklab(mapped)
    same_bytes(pictures.color_by_field(fandisk, "y").colors, cpp("color_by_field", np.float32))
    same_bytes(pictures.color_by_values(values, "balance").colors, cpp("color_by_values", np.float32))
    same_bytes(mapped, cpp("map_color", np.float32))
    same_bytes(pictures.distinct_color([-1, 0, 1, 1000]), cpp("distinct_color", np.float32))
    same_bytes(lab, cpp("to_oklab", np.float64))
    same_bytes(pictures.from_oklab(lab), cpp("from_oklab", np.float32))
    same_bytes(np.array(pictures.value_range(values)), cpp("value_range", np.float64))
    same_bytes(np.array([pictures.srgb_to_linear(0.3), pictures.linear_to_srgb(0.3)]), cpp("channels", np.float64))
