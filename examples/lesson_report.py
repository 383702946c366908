"""Which lessons of a folder can be played to their end, and how long each takes, as CSV.

python examples/lesson_report.py rooms/ > lessons.csv
"""

import csv
import sys
from pathlib import Path

from unisg_blender import UniSGError, read_scene_file
from unisg_blender.behaviour import check_scene, moments, prepare, rehearse, simulate

if len(sys.argv) != 2:
    sys.exit(__doc__)
paths = sorted(Path(sys.argv[1]).glob("*.blend")) or sys.exit(f"{sys.argv[1]}: no .blend files")
writer = csv.writer(sys.stdout)
writer.writerow(["file", "finished", "seconds", "problem"])
for path in paths:
    try:
        scene, _ = read_scene_file(path)
    except UniSGError as error:
        writer.writerow([path.name, False, "", error])
        continue
    problems = [problem.message for problem in check_scene(scene) if problem.severe]
    if problems:
        writer.writerow([path.name, False, "", problems[0]])
        continue
    lesson = prepare(scene)
    timeline = simulate(lesson, moments(scene, rehearse(lesson)))
    writer.writerow([path.name, timeline.finished, f"{timeline.end - timeline.start:.1f}", ""])
