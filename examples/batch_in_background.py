"""Add things to every .blend file of a folder, in Blender without a window; everything else in the files stays.

    python examples/batch_in_background.py FOLDER OUT "Cup=2"
    blender --background --python examples/batch_in_background.py -- FOLDER OUT "Cup=2"

The second line is for a Blender that has the extension.
"""

import sys
from pathlib import Path

try:
    from unisg_blender import Generator, UniSGError, read_scene
    from unisg_blender.blender import open_file, save_blend, write_rows
    from unisg_blender.pretrained import find_generator
except ImportError:  # in Blender the library lies inside the extension
    from bl_ext.user_default.unisg_blender.unisg_blender import Generator, UniSGError, read_scene
    from bl_ext.user_default.unisg_blender.unisg_blender.blender import open_file, save_blend, write_rows
    from bl_ext.user_default.unisg_blender.unisg_blender.pretrained import find_generator

import bpy

words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
if len(words) != 3 or not words[2].partition("=")[2].isdecimal():
    sys.exit(__doc__)
folder, out, (category, _, number) = Path(words[0]), Path(words[1]), words[2].partition("=")
paths = sorted(folder.glob("*.blend")) or sys.exit(f"{folder}: no .blend files")
try:
    generator = Generator.load(find_generator("living_room"))
    for path in paths:
        open_file(path)
        result = generator.add(read_scene(bpy.context.scene), {category: int(number)}, seed=0)
        write_rows(result.scene, result.rows, bpy.context.scene)
        out.mkdir(parents=True, exist_ok=True)
        save_blend(out / path.name)
        print(f"{path.name}: {result.added} added, {len(result.refused)} found no place")
except UniSGError as error:
    sys.exit(str(error))
