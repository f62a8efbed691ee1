"""Scenes: what is shown of what, as a picture and as a page that can be turned."""

import base64
import builtins
import importlib.util
import re

import numpy as np
import pytest

import shapelight as sl
from shapelight import scene
from shapelight.scene import panels_of
from shapelight.thinning import thin


@pytest.fixture(scope="module")
def wave():
    """A mesh of 30 x 30 vertices."""
    y, x = np.mgrid[:30, :30].astype(float)
    vertices = np.stack([x, y, 3 * np.sin(x / 4) * np.cos(y / 5)], axis=-1).reshape(-1, 3)
    a = (np.arange(29)[:, None] * 30 + np.arange(29)).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + 31], axis=1), np.stack([a, a + 31, a + 30], axis=1)])
    return sl.Geometry(vertices, faces.astype(np.uint32), {"height": vertices[:, 2]})


def picture_in(html):
    (data,) = re.findall(r'src="data:image/png;base64,([^"]+)"', html)
    return base64.b64decode(data)


def test_without_the_extra_a_picture_is_shown(wave, monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert picture_in(sl.show(wave)._repr_html_()).startswith(b"\x89PNG")


def test_turning_without_the_extra_says_what_to_install(wave, monkeypatch):
    genuine = builtins.__import__

    def no_k3d(name, *arguments, **more):
        if name == "k3d":
            raise ImportError(name)
        return genuine(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", no_k3d)
    with pytest.raises(sl.InvalidInput, match=r"shapelight\[notebook\]"):
        sl.show(wave, interactive=True)._repr_html_()


def test_picture_has_a_panel_for_each(wave):
    shown = sl.show(wave, color=["height", "none", "z"], interactive=False)
    assert [p.color for p in shown.panels] == ["height", "none", "z"]
    picture = shown.picture(width=600, height=200)
    assert picture.shape == (200, 600, 3) and picture.dtype == np.uint8
    parts = np.split(picture, 3, axis=1)
    assert (parts[1] != parts[0]).any() and (parts[1] != parts[2]).any()
    assert all((part < 200).any() for part in parts)


def test_results_show_what_they_are_about(wave):
    sample, fields, simplified = sl.sample(wave, count=50), sl.fields(wave), sl.simplify(wave, ratio=0.3)
    (kept,) = panels_of(sample)
    np.testing.assert_array_equal(kept.dots, sample.points)
    assert [p.color for p in panels_of(fields)] == ["shape_index", "reflectance"]
    assert [len(p.geometry) for p in panels_of(simplified)] == [900, 270]
    for shown in (wave, sample, fields, simplified):
        assert "<iframe" in shown._repr_html_() or "<img" in shown._repr_html_()


def test_numbers_and_nothing_show_as_text(wave):
    assert sl.metrics(wave, wave)._repr_html_() is None
    assert sl.Geometry(np.zeros((0, 3)))._repr_html_() is None
    assert sl.Geometry(np.full((4, 3), np.nan))._repr_html_() is None


def test_registered_scans_lie_on_each_other(data):
    scans = [sl.read(data / f"scans/dragonStandRight_{angle}.ply") for angle in (24, 0)]
    result = sl.register(*scans, init=sl.read_transform(data / "scans/T_dragonStandRight_24_to_0.txt"))
    (panel,) = panels_of(result)
    n = len(scans[1])
    np.testing.assert_array_equal(panel.geometry.positions[:n], scans[1].positions)
    np.testing.assert_allclose(panel.geometry.positions[n:], result.output.positions)
    assert len(np.unique(panel.geometry.attributes["red"])) == 2


def test_overlay_keeps_triangles_of_meshes(wave):
    (both,) = sl.show(wave, wave, overlay=True).panels
    assert len(both.geometry) == 1800 and both.geometry.triangles.max() == 1799
    (mixed,) = sl.show(wave, wave.positions, overlay=True).panels
    assert len(mixed.geometry) == 1800 and len(mixed.geometry.triangles) == 0


def test_colors_and_dots_of_every_kind(wave):
    values, rgb = np.arange(900), np.zeros((900, 3), np.uint8)
    assert [p.color for p in sl.show(wave, color=[values, rgb, "z"]).panels] == ["color", "rgb", "z"]
    for dots in ([5, 7], np.array([5, 7]), wave.positions[[5, 7]]):
        np.testing.assert_array_equal(sl.show(wave, dots=dots).panels[0].dots, wave.positions[[5, 7]])
    sample = sl.sample(wave, count=9)
    assert [len(p.dots) for p in sl.show(wave, dots=[sample, [1, 2]]).panels] == [9, 2]


@pytest.mark.parametrize(
    "wrong, message",
    [
        ({"color": np.zeros(7)}, "color: shape"),
        ({"dots": [900]}, "index 900 >= 900"),
        ({"color": ["z", "x"], "titles": ["one", "two", "three"]}, "titles: 3, expected one"),
        ({"color": "heigth", "interactive": False}, "height"),
    ],
)
def test_wrong_arguments_are_told(wave, wrong, message):
    with pytest.raises(sl.InvalidInput, match=message):
        sl.show(wave, **wrong).picture()


def test_saved_files_stand_alone(wave, tmp_path):
    shown = sl.show(wave, color="height", titles=["a <wave>"])
    page, picture = tmp_path / "scene.html", tmp_path / "scene.png"
    shown.save(page)
    shown.save(picture)
    text = page.read_text()
    assert text.startswith("<!doctype html>") and "<title>a &lt;wave&gt;</title>" in text
    assert not re.search(r'(src|href)="?https?:', text)
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert sorted(tmp_path.iterdir()) == [page, picture]
    with pytest.raises(sl.WriteError, match="exists"):
        shown.save(page)
    with pytest.raises(sl.InvalidInput, match="html or .png"):
        shown.save(tmp_path / "scene.gif")


class TestViewer:
    """The page of K3D-jupyter."""

    @pytest.fixture(autouse=True)
    def viewer(self):
        pytest.importorskip("k3d")
        from shapelight import viewer

        self.viewer = viewer

    def test_one_frame_holds_all_panels(self, wave):
        html = sl.show(wave, color=["height", "none"], titles=["one", "two"], interactive=True)._repr_html_()
        assert html.count("<iframe") == 1
        assert "one" in html and "two" in html and "linear-gradient" in html
        assert "CAMERA_CHANGE" in html.split("srcdoc=")[1]

    def test_large_coordinates_keep_their_detail(self, wave):
        import k3d

        far = sl.Geometry(wave.positions + [5e6, 4e7, 100.0])
        plot = k3d.plot()
        panel = panels_of(far)[0]
        self.viewer._fill(plot, panel, self.viewer._boxes([panel])[0])
        shown = plot.objects[0].positions
        np.testing.assert_allclose(np.diff(shown[:30, 0]), 1 / far.diagonal, rtol=1e-3)


class TestThinning:
    def test_few_points_stay_as_they_are(self, wave):
        assert thin(wave, 900) is wave

    def test_many_points_are_thinned_evenly(self, wave):
        few = thin(wave, 200)
        assert 50 < len(few) <= 200
        assert len(few.triangles) > 50 and few.triangles.max() < len(few)
        gaps = np.linalg.norm(wave.positions[:, None] - few.positions, axis=2).min(axis=1)
        assert gaps.max() < 6
        np.testing.assert_array_equal(few.attributes["height"], few.positions[:, 2])

    def test_missing_points_and_their_triangles_are_left_out(self, wave):
        positions = wave.positions.copy()
        positions[0] = np.nan
        few = thin(sl.Geometry(positions, wave.triangles), 1000)
        np.testing.assert_array_equal(few.positions, positions[1:])
        np.testing.assert_array_equal(few.triangles, wave.triangles[(wave.triangles != 0).all(axis=1)] - 1)

    def test_captions_tell(self, wave, monkeypatch):
        monkeypatch.setattr(scene, "MOST_POINTS", 200)
        (panel,) = sl.show(wave).shown().panels
        assert panel.title.endswith(f"shown: {len(panel.geometry):,} of 900")
