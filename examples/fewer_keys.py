"""A baked motion with few keys: cubic screws between them, within a millimetre and a tenth of a degree.

python examples/fewer_keys.py
"""

import numpy as np

from unisg_blender.poses import FORMS, convert, cubic_sclerp, rebuild_cubic, reduce_keyframes, third_poses

times = np.linspace(0, 2, 61)  # a door that swings open about its hinge, baked at 30 frames a second
angles = np.radians(90) * (1 - np.cos(np.pi * times / 2)) / 2
matrices = np.tile(np.eye(4), (len(times), 1, 1))
matrices[:, 0, 0] = matrices[:, 1, 1] = np.cos(angles)
matrices[:, 1, 0], matrices[:, 0, 1] = np.sin(angles), -np.sin(angles)
matrices[:, :2, 3] = 0.4 * np.stack([np.cos(angles), np.sin(angles)], axis=1)  # the door's middle, 40 cm from the hinge

motion = convert(FORMS["matrix"].encode(matrices), "matrix", "dual_quaternion")
(keys,) = reduce_keyframes(times, motion, millimetres=1.0, degrees=0.1, interpolate=cubic_sclerp)
thirds = third_poses(times, motion, keys)
again = FORMS["dual_quaternion"].decode(rebuild_cubic(times, times[keys], motion[keys], thirds))
off = np.linalg.norm((again - matrices)[:, :3, 3], axis=1).max()
print(f"{len(keys)} keys of {len(times)} frames, at most {1000 * off:.2f} mm off")
