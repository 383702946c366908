"""Structure from geometry: floors, rooms, walls, openings and surfaces, without names."""

from __future__ import annotations

from dataclasses import replace
from weakref import WeakKeyDictionary

import numpy as np

from ...geometry.arrays import Floats
from ...geometry.column_raster import cells_on
from ...geometry.mask_outline import boxes_of, components, meets, outlines, snapped
from ...geometry.polygon import area
from ...geometry.traced_outlines import simplified_all
from ...scene.categories import STRUCTURE, has_category
from ...scene.graph import SceneGraph
from ...scene.structure_marks import PART_MARK, ROOM_MARK, marks
from ..object_rows import shown
from .looks import EYE, FAR_ROOFED, FARTHEST
from .named_openings import with_named_openings
from .region import Region
from .room_marks import without_marked
from .scan import FINEST, HEADROOM, LEVEL, Scan
from .stages import backdrop, is_stage
from .storeys import LEAST_OPEN, find_regions
from .structure import Room, Structure
from .surfaces import holding_surfaces
from .walls import Cuts, walls_along

COARSE, FINER = 3.0, 1.5
"""Times the finest cell from which on the rooms that were found are scanned again, and how much finer that must be."""

AROUND, MOST_PLACES = 3.0, 4
"""Of a large scene places where walls stand are scanned again, so many metres around them, and so many of them."""

UPRIGHT = 0.2
"""Upward part of the unit normal of a wall at most."""

FEW_WALLS = 4
"""Upright triangles as high as people of which a scene without a floor has so many, at least, where it has walls."""

SMALL, LARGEST = 6.0, 500.0
"""Square metres of a scene without a floor up to which, and metres of one from which on, its unit is asked for."""

BEHIND = 1.0
"""Metres around a room in which lines are looked for: the far sides of its walls are there."""

SIMPLER = 1.5
"""Cells by which an outline may leave the traced one before it is moved onto lines."""


_known: WeakKeyDictionary[SceneGraph, Structure] = WeakKeyDictionary()


def recognise_structure(graph: SceneGraph) -> Structure:
    """What is building in a scene, told by where people can stand and what is around them.

    The scene is scanned by columns through a grid, of 5 cm in rooms, coarser in halls. A floor is a height at which
    much has 1.8 m free above; a place on it is inside where there is a roof and walls on most sides, or walls all
    around; rooms are what walls, and the lintels over doors, part from each other. Outlines are then moved onto the
    very edges of walls and floors. What the user gave a category that is not of a building does not count, and what
    the user called a floor is the floor, a door or a window an opening; marks (:mod:`...scene.structure_marks`) say
    what is no building, or no room.

    A scene too large for the finest cells is scanned coarsely, and again where most walls stand. What was recognised of
    a scenegraph is kept as long as that is, also for others that look the same, such as one in other words.
    """
    if graph not in _known:
        alike = next((known for known in list(_known.keys()) if look_alike(known, graph)), None)
        _known[graph] = _recognised(graph) if alike is None else _known[alike]
    return _known[graph]


def look_alike(one: SceneGraph, two: SceneGraph) -> bool:
    """Do two scenegraphs have the same meshes at the same places, and the same that is building by category or mark?"""
    if len(one) != len(two) or len(one.meshes) != len(two.meshes):
        return False
    return (
        all(first is second for first, second in zip(one.meshes, two.meshes, strict=True))
        and all(np.array_equal(getattr(one, name), getattr(two, name)) for name in ("mesh", "parent", "world"))
        and np.array_equal(shown(one), shown(two))
        and np.array_equal(one.category >= 0, two.category >= 0)
        and all(np.array_equal(has_category(one, [kind]), has_category(two, [kind])) for kind in STRUCTURE)
        and all(marks(one, key) == marks(two, key) for key in (PART_MARK, ROOM_MARK))
    )


def _recognised(graph: SceneGraph) -> Structure:
    scan = Scan.of(graph)
    if scan is None:
        return Structure((), (), FINEST, ("the scene has no faces: there is no floor to be found",))
    scan, regions = _closer(graph, scan) if scan.grid.cell > COARSE * FINEST else (scan, find_regions(scan))
    if regions and not any(region.indoors for region in regions):
        scan, regions = _before_backdrop(graph, scan) or (scan, regions)
    cuts = {id(region.cuts): region.cuts for region in regions}
    together = {key: Cuts.of(some) for key, some in cuts.items()}
    rooms = [_room(scan, region, together[id(region.cuts)]) for region in regions]
    rooms = with_named_openings(rooms, scan, graph)
    heights = sorted({room.floor for room in rooms})
    storeys = np.cumsum(np.diff(heights, prepend=-np.inf) >= HEADROOM) - 1
    of_height = dict(zip(heights, storeys.tolist(), strict=True))
    rooms = [replace(room, storey=of_height[room.floor]) for room in rooms]
    order = sorted(range(len(rooms)), key=lambda number: (rooms[number].storey, -rooms[number].area))
    surfaces = holding_surfaces(scan, [regions[number] for number in order])
    ordered, notes = tuple(rooms[number] for number in order), _notes(graph, scan, rooms)
    return without_marked(Structure(ordered, tuple(surfaces), scan.grid.cell, notes), graph)


def _closer(graph: SceneGraph, scan: Scan) -> tuple[Scan, list[Region]]:
    """A finer scan of where a large scene is built up, with the rooms found there; the whole where that finds none."""
    for low, high in _built_up(scan):
        finer = Scan.of(graph, (low, high))
        if finer is not None and finer.grid.cell < scan.grid.cell / FINER:
            found = find_regions(finer)
            if any(region.indoors for region in found):
                return finer, found
    return scan, find_regions(scan)


def _before_backdrop(graph: SceneGraph, scan: Scan) -> tuple[Scan, list[Region]] | None:
    """A scan without a backdrop, with the rooms or the stage that are before it; None where there is none."""
    inner = Scan.of(graph, without=row) if (row := backdrop(scan)) >= 0 else None
    regions = [] if inner is None else find_regions(inner)
    if inner is None or not any(region.indoors or is_stage(region, inner, region.floor + EYE) for region in regions):
        return None
    return inner, regions


def _built_up(scan: Scan) -> list[tuple[Floats, Floats]]:
    """Rectangles (low, high) around the places where most walls stand, the largest first."""
    from scipy.ndimage import binary_dilation, find_objects

    low, high = scan.ends
    walls = scan.triangles[(np.abs(scan.slope) < UPRIGHT) & (high - low > HEADROOM / 2) & scan.building][:, :, :2]
    cells, _ = cells_on(np.concatenate([walls[:, [0, 1]], walls[:, [1, 2]]]), scan.grid)
    mask = scan.grid.mask(cells)
    near = max(round(AROUND / scan.grid.cell), 1)
    number, count = components(binary_dilation(mask, iterations=near))
    size = np.bincount(number[mask], minlength=count + 1)
    windows = find_objects(number.astype(np.int32))
    found = []
    for part in np.argsort(-size[1:], kind="stable")[:MOST_PLACES]:
        first, last = (np.array([getattr(side, end) for side in windows[part]]) for end in ("start", "stop"))
        found.append((first * scan.grid.cell + scan.grid.origin, last * scan.grid.cell + scan.grid.origin))
    return found


def _room(scan: Scan, region: Region, cuts: Cuts) -> Room:
    """A room as polygons; ``cuts`` are those of its storey."""
    grid = region.grid
    traced = outlines(region.mask, grid)
    cuts = cuts.near(traced[0], BEHIND)
    lines = np.concatenate([_floor_edges(scan, region.floor, traced[0]), cuts.segments])
    way = lines[:, 1] - lines[:, 0]
    lines = lines[np.hypot(way[:, 0], way[:, 1]) > grid.cell]
    fitted = [snapped(loop, lines, grid.cell) for loop in simplified_all(traced, SIMPLER * grid.cell)]
    outline = fitted[0] if area(fitted[0]) > 0 else traced[0]
    holes = tuple(loop for loop in fitted[1:] if len(loop) > 2 and area(loop) < 0)
    walls, openings = walls_along(outline, region, cuts)
    return Room(
        outline, holes, region.floor, region.ceiling, 0, region.indoors, region.floor_row, region.ceiling_row, walls,
        openings,
    )  # fmt: skip


def _floor_edges(scan: Scan, floor: float, outline: Floats) -> Floats:
    """Edges (S, 2, 2) of a floor's triangles around an outline (K, 2), seen from above."""
    least, most = scan.flat_boxes
    near = meets(least, most, outline, BEHIND)
    mine = near[(least[2, near] >= floor - LEVEL) & (most[2, near] <= floor + LEVEL)]
    corners = scan.triangles[scan.flat[mine], :, :2]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    return edges[meets(*boxes_of(edges), outline, BEHIND)]


def _notes(graph: SceneGraph, scan: Scan, rooms: list[Room]) -> tuple[str, ...]:
    coarse, notes = scan.grid.cell > COARSE * FINEST, []
    size = np.ptp(scan.triangles.reshape(-1, 3), axis=0) if coarse or not rooms else np.zeros(3)
    if not rooms:
        notes.append(_why_nothing(scan, size))
    elif not any(room.indoors for room in rooms):
        notes.append(_why_open(graph, scan, rooms))
    if coarse:
        unit = "; is its unit right?" if size.max() > LARGEST else ""
        notes.append(
            f"the scene is {size[0]:.0f} x {size[1]:.0f} m: it was looked at every {scan.grid.cell:.2f} m only{unit}"
        )
    return tuple(notes)


def _why_open(graph: SceneGraph, scan: Scan, rooms: list[Room]) -> str:
    """Why what was found is no room, in a sentence."""
    for room in rooms:
        low, _ = scan.ends
        beneath = (scan.row == room.floor_row) & ~scan.up & (low <= room.floor - HEADROOM)
        if np.abs(scan.normals[beneath, 2]).sum() / 2 >= room.area / 2:
            return (
                f"no room was found, only the top of {graph.name[room.floor_row]}, whose faces look outwards as those "
                "of a block do: if it is the room, turn its normals round (Blender: Edit Mode, Mesh > Normals > Flip)"
            )
    if any(room.walls for room in rooms):
        return "no room was found, only an open place: walls are on too few of its sides"
    return (
        f"no room was found, only open ground: no walls are around it within {FARTHEST:.0f} m, or under a roof within "
        f"{FAR_ROOFED:.0f} m"
    )


def _why_nothing(scan: Scan, size: Floats) -> str:
    """Why there is no floor, in a sentence."""
    low, high = scan.ends
    if size[:2].prod() < SMALL:
        return f"the scene is {size[0]:.2f} x {size[1]:.2f} m: no room, but a thing; is its unit right?"
    if (np.abs(scan.slope) < UPRIGHT)[high - low > HEADROOM].sum() >= FEW_WALLS:
        return "no floor was found, though walls stand there: a plane under them makes a room of it"
    return f"no floor was found: nowhere are {LEAST_OPEN:.0f} m2 level with {HEADROOM} m free above"
