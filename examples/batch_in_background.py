"""Add things to every .blend file of a folder, in Blender without a window; everything else in the files stays.

    python examples/batch_in_background.py FOLDER OUT "Cup=2"
    blender --background --python examples/batch_in_background.py -- FOLDER OUT "Cup=2"

The second line is for a Blender that has the extension.
"""

import sys
from pathlib import Path

try:
    from unisg_blender import Generator, read_scene
    from unisg_blender.blender import open_file, save_blend, write_rows
    from unisg_blender.pretrained import find_generator
except ImportError:  # in Blender the library lies inside the extension
    from bl_ext.user_default.unisg_blender.unisg_blender import Generator, read_scene
    from bl_ext.user_default.unisg_blender.unisg_blender.blender import open_file, save_blend, write_rows
    from bl_ext.user_default.unisg_blender.unisg_blender.pretrained import find_generator

import bpy

folder, out, wanted = (sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])[:3]
counts = {name: int(number) for name, number in (part.split("=") for part in wanted.split(","))}
generator = Generator.load(find_generator("living_room"))
Path(out).mkdir(parents=True, exist_ok=True)

for path in sorted(Path(folder).glob("*.blend")):
    open_file(path)
    result = generator.add(read_scene(bpy.context.scene), counts, seed=0)
    write_rows(result.scene, result.rows, bpy.context.scene)
    save_blend(Path(out) / path.name)
    print(f"{path.name}: {result.added} added, {len(result.refused)} found no place")
