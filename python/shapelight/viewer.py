"""Scenes that can be turned, by K3D-jupyter: a page of one megabyte that needs no network and no notebook extension,
so that a saved notebook still shows it. trimesh's viewer draws points of one pixel."""

from __future__ import annotations

import base64
import html
from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from .errors import InvalidInput
from .pictures import FieldColors, View, color_by_field, map_color, parse_view
from .scene import Panel

FINE = 30_000  # triangles of a mesh that is drawn smooth
WIDTH = 1000  # [pixels]
FIELD_OF_VIEW = 20.0  # [deg] as the pictures have
NEUTRAL = 0xC9C0B4
DOTS = 0xDB381A

Points = NDArray[np.float64]

# All panels turn as one: those that the mouse is not over follow the one that it is over.
LINK_PANELS = """
const share = 100 / PANELS, boxes = [document.getElementById('canvasTarget')], plots = [];
let leader = 0;
const join = (plot, i) => {
  plots[i] = plot;
  boxes[i].addEventListener('pointerenter', () => { leader = i; });
  plot.on(plot.events.CAMERA_CHANGE, camera => {
    if (i === leader) plots.forEach((other, k) => { if (k !== i) other.setCamera(camera); });
  });
};
boxes[0].style.width = share + '%';
window.dispatchEvent(new Event('resize'));
join(K3DInstance, 0);
[OTHERS].forEach((data, k) => {
  const box = document.createElement('div');
  box.style.cssText = `position:absolute;top:0;height:100%;left:${(k + 1) * share}%;width:${share}%`;
  boxes[k + 1] = document.body.appendChild(box);
  lib.CreateK3DAndLoadBinarySnapshot(_base64ToArrayBuffer(data), box).then(plot => join(plot, k + 1));
});
"""


def interactive_html(panels: Sequence[Panel], view: str, height: int) -> str:
    """A frame that holds the whole viewer, and the captions and colour bars under it. Pre: all points are finite."""
    try:
        import k3d
    except ImportError:
        raise InvalidInput("interactive: needs K3D-jupyter, as in: pip install 'shapelight[notebook]'") from None

    boxes = _boxes(panels)
    aspect = WIDTH / len(panels) / height
    camera = _camera(parse_view(view, panels[0].geometry), panels[0], boxes[0], aspect)
    plots, captions = [], []
    for panel, box in zip(panels, boxes):
        plot = k3d.plot(
            grid_visible=False, axes_helper=0, menu_visibility=False, camera_auto_fit=False, grid_auto_fit=False,
            camera=camera, camera_fov=FIELD_OF_VIEW,
        )  # fmt: skip
        captions.append(_fill(plot, panel, box))
        plots.append(plot)
    others = ",".join(f"'{base64.b64encode(plot.get_binary_snapshot(6)).decode()}'" for plot in plots[1:])
    link = LINK_PANELS.replace("PANELS", str(len(plots))).replace("OTHERS", others)
    page = plots[0].get_snapshot(6, additional_js_code=link if len(plots) > 1 else "")
    page = page.replace("background-color: #F5F5F5", "background-color: #FFFFFF")
    return (
        f'<div style="max-width:{WIDTH}px"><iframe srcdoc="{html.escape(page)}" loading="lazy" '
        f'style="width:100%;height:{height}px;border:0"></iframe>'
        f'<div style="display:flex;font:13px sans-serif">{"".join(captions)}</div></div>'
    )


def _boxes(panels: Sequence[Panel]) -> List[Tuple[Points, float]]:
    """Middle and diagonal of each panel: the same ones for all where that lets them be compared."""
    boxes = []
    for panel in panels:
        low, high = panel.geometry.positions.min(axis=0), panel.geometry.positions.max(axis=0)
        boxes.append(((low + high) / 2, float(np.linalg.norm(high - low)) or 1.0))
    middle, diagonal = boxes[0]
    alike = all(np.linalg.norm(m - middle) < 0.1 * diagonal and 0.8 < d / diagonal < 1.25 for m, d in boxes)
    return [boxes[0]] * len(boxes) if alike else boxes


def _camera(eye: View, panel: Panel, box: Tuple[Points, float], aspect: float) -> List[float]:
    """Eye, target and up: as near as the panel's points allow, where the diagonal is 1 and the middle 0."""
    axes = np.stack([np.cross(eye.direction, eye.up), eye.up, eye.direction])
    wide, high, deep = np.abs((panel.geometry.positions - box[0]) / box[1] @ axes.T).max(axis=0)
    distance = max(high, wide / aspect) / np.tan(np.radians(FIELD_OF_VIEW / 2)) + deep
    return [*(-1.05 * distance * eye.direction), 0.0, 0.0, 0.0, *eye.up]


def _fill(plot: Any, panel: Panel, box: Tuple[Points, float]) -> str:
    """Adds a panel's objects to its plot. Returns its caption."""
    import k3d

    middle, diagonal = box
    shown = ((panel.geometry.positions - middle) / diagonal).astype(np.float32)
    triangles = panel.geometry.triangles
    colors = None if panel.color == "none" else color_by_field(panel.geometry, panel.color)
    look: Dict[str, Any] = {"color": NEUTRAL, "roughness": 0.9}
    if colors is not None:
        look.update(color=0xFFFFFF, colors=_packed(colors.colors))
    if len(triangles):
        flat = len(triangles) < FINE  # creases show
        plot += k3d.mesh(shown, triangles, flat_shading=flat, side="double", **look)
    else:
        plot += k3d.points(shown, point_size=1.6 * _spacing(shown), shader="3d", **look)
    if panel.dots is not None and len(panel.dots):
        dots = ((panel.dots - middle) / diagonal).astype(np.float32)
        size = min(0.008, 0.6 * _spacing(dots))
        plot += k3d.points(dots, point_size=size, color=DOTS, shader="3d", roughness=0.9)
    return _caption(panel.title, colors)


def _spacing(points: NDArray[np.float32]) -> float:
    """Of points on a surface: half of their box's surface is taken for its area."""
    x, y, z = points.max(axis=0) - points.min(axis=0)
    return float(np.sqrt((x * y + y * z + z * x) / len(points))) or 0.01


def _packed(colors: NDArray[np.float32]) -> NDArray[np.uint32]:
    red, green, blue = np.clip(np.rint(colors * 255), 0, 255).astype(np.uint32).T
    return np.asarray(red << 16 | green << 8 | blue)


def _caption(title: str, colors: Optional[FieldColors]) -> str:
    bar = ""
    if colors is not None and colors.name and colors.map != "categorical":
        stops = _packed(map_color(colors.map, np.linspace(0, 1, 17)))
        gradient = ", ".join(f"#{c:06x}" for c in stops)
        bar = (
            f"<div>{html.escape(colors.name)}</div><div>{colors.min:.3g} <span style=\"display:inline-block;width:50%;"
            f'height:10px;background:linear-gradient(to right, {gradient})"></span> {colors.max:.3g}</div>'
        )
    elif colors is not None and colors.name:
        bar = f"<div>{html.escape(colors.name)}</div>"
    return f'<div style="flex:1;text-align:center">{html.escape(title)}{bar}</div>'
