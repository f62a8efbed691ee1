"""render(): the command's pictures as arrays."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import pictures

SMALL = {"width": 160, "height": 120}


@pytest.fixture(scope="module")
def cube():
    corners = np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)])
    return sl.Geometry(corners, attributes={"label": np.arange(8, dtype=np.int32)})


def test_a_picture_is_rows_of_pixels(cube):
    image = sl.render(cube, **SMALL)
    assert image.shape == (120, 160, 3) and image.dtype == np.uint8
    assert (image != 255).any() and (image[-1, -1] == 255).all()


def test_panels_are_geometries_times_colours_times_dots(cube):
    dots = [cube.positions[:2], cube.positions[:3]]
    titles = [f"panel {i}" for i in range(8)]
    sl.render([cube, cube], color=["none", "label"], dots=dots, titles=titles, width=640, height=640)
    with pytest.raises(sl.InvalidInput, match="titles: 1, expected one for each of 8 panels"):
        sl.render([cube, cube], color=["none", "label"], dots=dots, titles="alone", width=640, height=640)


def test_titles_colours_and_dots_change_the_picture(cube):
    plain = sl.render(cube, **SMALL)
    for change in ({"titles": "a cube"}, {"color": "label"}, {"dots": cube.positions[:1]}, {"view": "top"},
                   {"point_size": 20}, {"captions": False, "color": "x"}):
        assert (sl.render(cube, **SMALL, **change) != plain).any(), change


def test_a_list_of_points_is_one_cloud(cube):
    expected = sl.render(cube.positions, **SMALL)
    np.testing.assert_array_equal(sl.render(cube.positions.tolist(), **SMALL), expected)


def test_errors_say_what_there_is(cube):
    with pytest.raises(sl.InvalidInput, match="expected one of: x, y, z, label"):
        sl.render(cube, color="height", **SMALL)
    with pytest.raises(sl.InvalidInput, match="color: expected the name of a field"):
        sl.render(cube, color=np.zeros(len(cube)), **SMALL)
    with pytest.raises(sl.InvalidInput, match="view"):
        sl.render(cube, view="below", **SMALL)
    with pytest.raises(sl.InvalidInput, match="expected 0 or more"):
        sl.render(cube, dot_size=-1, **SMALL)
    with pytest.raises(sl.InvalidInput, match="panels, expected one"):
        sl.render([cube, cube], captions=False, **SMALL)
    with pytest.raises(sl.InvalidInput):
        sl.render([], **SMALL)


def test_write_png_takes_what_render_gives(cube, tmp_path):
    image = sl.render(cube, **SMALL)
    sl.write_png(tmp_path / "a.png", image)
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(sl.WriteError):
        sl.write_png(tmp_path / "a.png", image)
    with pytest.raises(sl.InvalidInput, match="expected uint8"):
        sl.write_png(tmp_path / "b.png", image.astype(float))


def test_grids_keep_the_pictures(cube):
    image = sl.render(cube, **SMALL)
    grid = pictures.image_grid([image, image[::-1]], columns=2, gap=4, background=(1, 2, 3))
    np.testing.assert_array_equal(grid[:, :160], image)
    np.testing.assert_array_equal(grid[:, -160:], image[::-1])
    assert grid.shape == (120, 324, 3) and (grid[0, 161] == (1, 2, 3)).all()


def test_colours(cube):
    field = pictures.color_by_field(cube, "label")
    assert field.map == "categorical" and field.name == "label"
    np.testing.assert_array_equal(field.colors, pictures.distinct_color(range(8)))
    ramp = pictures.map_color("sequential", np.linspace(0, 1, 20))
    assert (np.diff(pictures.to_oklab(ramp)[:, 0]) > 0).all()
    np.testing.assert_allclose(pictures.from_oklab(pictures.to_oklab(ramp)), ramp, atol=1e-5)
    values = pictures.color_by_values([-1.0, 0.0, 2.0], "balance")
    assert values.map == "diverging" and values.min == -values.max
    assert pictures.value_range([3.0, 3.0, np.nan]) == (2.5, 3.5)


def test_views(cube):
    view = pictures.parse_view("front", cube)
    np.testing.assert_array_equal(view.direction, [0, 0, -1])
    np.testing.assert_array_equal(view.up, [0, 1, 0])


def test_a_tuple_is_one_mesh_and_a_list_is_several_things(data):
    fandisk = sl.read(data / "meshes/fandisk.off")
    mesh = (fandisk.positions, fandisk.triangles)
    same = {"width": 160, "height": 120, "captions": False}
    np.testing.assert_array_equal(sl.render(mesh, **same), sl.render(fandisk, **same))
    two = sl.render([mesh, fandisk], width=320, height=160)
    assert two.shape == (160, 320, 3)
    assert (two != sl.render(mesh, width=320, height=160)).any()
