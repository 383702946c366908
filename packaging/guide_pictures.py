"""Make the pictures of README.md, the guide and the page on worlds that need no window of Blender -> docs/.

python packaging/guide_pictures.py        # `make pictures` makes those of Blender's window too
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from architecture import ROOT
from PIL import Image
from small_pictures import save_small

from unisg_blender import Generator, SceneGraph, cli
from unisg_blender.blender.blend_files import new_scene
from unisg_blender.blender.render.picture import render_picture
from unisg_blender.commands.room_picture import room_view
from unisg_blender.pretrained import find_generator
from unisg_blender.scene import take
from unisg_blender.scene.categories import STRUCTURE
from unisg_blender.worlds import living_room, operating_room

PICTURES = ROOT / "docs" / "pictures"
SEED = 11
WANTED = {
    "Rug": 1, "Sofa": 1, "Armchair": 1, "Coffee Table": 1, "Television Stand": 1, "Television": 1, "Dining Table": 1,
    "Chair": 4, "Bookshelf": 1, "Book": 12, "Plant": 1, "Floor Lamp": 1, "Picture": 2, "Cup": 2, "Cushion": 2,
    "Vase": 1,
}  # fmt: skip


def main() -> None:
    """Render, shrink, and put side by side."""
    with tempfile.TemporaryDirectory() as folder:
        _before_and_after(Path(folder))
        _fuller_room(Path(folder))
        _timeline(Path(folder))
        _worlds(Path(folder))


def _before_and_after(folder: Path) -> None:
    """A room with its walls only, and what the model for living rooms makes of it."""
    room = living_room(SEED)
    shell = take(room, [row for row in range(len(room)) if room.category_name(row) in STRUCTURE])
    result = Generator.load(find_generator("living_room")).add(shell, WANTED, seed=1)
    view = room_view(result)
    for name, scene in (("before", shell), ("after", result.scene)):
        _render(scene, folder / f"{name}.png", view)
    both = [Image.open(folder / f"{name}.png").convert("RGB") for name in ("before", "after")]
    pair = Image.new("RGB", (2 * both[0].width + 12, both[0].height), "white")
    pair.paste(both[0], (0, 0))
    pair.paste(both[1], (both[0].width + 12, 0))
    save_small(pair, PICTURES / "before-after.png")


def _render(scene: SceneGraph, path: Path, view: object) -> None:
    new_scene(scene)
    render_picture(path, room=view, size=(720, 540))


def _fuller_room(folder: Path) -> None:
    """The picture of the page "First scene", by its own commands."""
    words = ["--add", "Scalpel=2,Monitor=1", "--scene", str(folder / "operating-room-00007.blend"), "--seed", "1"]
    cli.main(["world", "operating-room", "--seed", "7", "--out", str(folder), "-q"])
    cli.main(["generate", *words, "--out", str(folder / "a.usda"), "--render", str(folder / "fuller.png"), "-q"])
    save_small(Image.open(folder / "fuller.png"), PICTURES / "guide-fuller.png")


def _timeline(folder: Path) -> None:
    """How a room's own lesson is played."""
    room = str(folder / "operating-room-00007.blend")
    cli.main(["simulate", room, "--rehearse", "--out", str(folder / "timeline"), "-q"])
    save_small(Image.open(folder / "timeline" / "timeline.png"), PICTURES / "guide-timeline.png")


def _worlds(folder: Path) -> None:
    """The rooms of the page "Worlds", from above and from a corner."""
    path = folder / "world.png"
    for scene, view, name in (
        (operating_room(7), "top", "operating-room-top"),
        (operating_room(7), "perspective", "operating-room"),
        (living_room(3), "top", "living-room-top"),
    ):
        new_scene(scene)
        render_picture(path, view=view, size=(760, 640))
        save_small(Image.open(path), ROOT / "docs" / f"worlds-{name}.png")


if __name__ == "__main__":
    main()
