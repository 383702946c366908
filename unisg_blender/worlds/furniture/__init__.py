"""The objects that stand in the worlds: low-poly meshes made by code, in real sizes.

Every function returns an :class:`~.kit.Asset` and remembers it: the same
arguments give the same object, so that a process stores each mesh once however
many rooms it builds. Lengths are metres. An asset's origin is the centre of its
bottom (of its top for objects that hang from above), z points up and its front
faces -y.
"""
