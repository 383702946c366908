"""What the user has chosen for generating: a model, and how many objects of each category.

The choices live in the window manager: they belong to the person, not to the
file, and undo leaves them alone.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

from ...unisg_blender.errors import UniSGError
from ..base import redraw_views
from ..preferences import own_models, preference, when_models_change
from ..room.background import Background
from ..room.corrections import rooms_to_choose
from ..window_wording import in_window
from .sampling_choices import SamplingChoices

if TYPE_CHECKING:
    from ...unisg_blender.generate import Generator
    from ...unisg_blender.scene import SceneGraph

OWN_FILE = "FILE"
_one_at_a_time = threading.Lock()
_loading_model: Background[Generator] = Background()  # `Background[...]()` would be kept by typing, see there
_threads = [1]  # of the preferences: a thread must not look there
_generators: dict[tuple[str, float], Generator] = {}
_model_items: list[tuple[str, str, str]] = []


def shipped_models() -> list[Path]:
    """The generative models that came with the extension: those with assets beside them."""
    from ...unisg_blender.pretrained import shipped_generators

    return shipped_generators()


def load_generator(path: str) -> Generator:
    """The generator of a model file, loaded once; raises UniSGError if the file is no such model."""
    return opened_generator(bpy.path.abspath(path))


def opened_generator(path: str) -> Generator:
    """The same of a path that is absolute, or the name of a shipped model; from any thread."""
    from ...unisg_blender.generate import Generator
    from ...unisg_blender.generate.propose.trained_model import load_model

    key = _key(path)
    with _one_at_a_time:
        if key not in _generators:
            generator = Generator(load_model(key[0], _threads[0]))
            _generators.clear()
            _generators[key] = generator
        return _generators[key]


def forget_models() -> None:
    """Load models anew: their folder, or how many threads they may use, was changed."""
    with _one_at_a_time:
        _threads[0] = int(str(preference("threads")))
        _generators.clear()
    bpy.context.window_manager.unisg.listed = ""


def _key(path: str) -> tuple[str, float]:
    """A model's file, and when it was written."""
    from ...unisg_blender.pretrained import find_generator

    file = find_generator(path)
    return str(file), file.stat().st_mtime if file.is_file() else 0.0


def choose_model(context: bpy.types.Context, name: str) -> None:
    """Choose the shipped model of some name in the panel, if there is one."""
    settings = context.window_manager.unisg
    path = next((str(path) for path in shipped_models() if path.stem == name), "")
    if path and settings.model not in (path, OWN_FILE):
        settings.model = path


def read_words(path: str) -> dict[str, dict[str, str]]:
    """What a mapping file says of names and words, by section; nothing without a path."""
    from ...unisg_blender.words import read_mapping

    return read_mapping(bpy.path.abspath(path)) if path else {}


def scene_in_words(scene: bpy.types.Scene, mapping: dict[str, dict[str, str]]) -> SceneGraph:
    """The scene as it is read, with the categories that a mapping gives to its names."""
    from ...unisg_blender.blender import read_scene
    from ...unisg_blender.words import apply_mapping

    graph = read_scene(scene, details=False, instances="kept")  # what they show is in the way
    return apply_mapping(graph, mapping) if mapping else graph


def _models(settings: object, context: bpy.types.Context | None) -> list[tuple[str, str, str]]:
    first = str(preference("first")).lower().replace(" ", "_")
    paths = sorted([*shipped_models(), *own_models()], key=lambda path: path.stem.lower() != first)
    found = [(str(path), path.stem.replace("_", " ").capitalize(), str(path)) for path in paths]
    _model_items[:] = [*found, (OWN_FILE, "Own model", "A model of your own, trained with 'unisg train cgvae'")]
    return _model_items  # Blender keeps no reference to the strings of a computed enum: we must


def _model_changed(settings: UNISG_GenerationSettings, context: bpy.types.Context) -> None:
    settings.listed = ""


class UNISG_CategoryCount(bpy.types.PropertyGroup):
    """How many objects of one category are wanted; ``name`` is the category."""

    count: bpy.props.IntProperty(name="Count", description="How many to add", min=0, soft_max=20, max=1000)


class GenerationChoices(SamplingChoices):
    """What the operator and the panel both ask for.

    An operator must not take what a button leaves out from the time before: hence ``SKIP_SAVE``.
    """

    seed: bpy.props.IntProperty(
        name="Seed",
        description="The same seed gives the same result; -1 gives another one each time",
        default=-1,
        min=-1,
        options={"SKIP_SAVE"},
    )
    bulk: bpy.props.BoolProperty(
        name="All at once",
        description="Propose all places together instead of one after another: faster, less tidy",
        options={"SKIP_SAVE"},
    )
    words: bpy.props.StringProperty(
        name="Words",
        description="A mapping file, JSON or TOML: what names and words for things mean, where the table of words errs",
        subtype="FILE_PATH",
        options={"SKIP_SAVE"},
    )
    behaviour: bpy.props.BoolProperty(
        name="With actions",
        description="Give the objects the actions that the lesson lacks, and extend it by them; spare things get none",
        default=True,
        options={"SKIP_SAVE"},
    )


class UNISG_GenerationSettings(GenerationChoices, bpy.types.PropertyGroup):
    """The choices in the Generate panel."""

    model: bpy.props.EnumProperty(
        name="Model", description="What was learned from which scenes", items=_models, update=_model_changed
    )
    path: bpy.props.StringProperty(
        name="File", description="An ONNX file from 'unisg train cgvae'", subtype="FILE_PATH", update=_model_changed
    )
    counts: bpy.props.CollectionProperty(type=UNISG_CategoryCount)
    active: bpy.props.IntProperty()
    listed: bpy.props.StringProperty(description="The model whose categories are listed")
    problem: bpy.props.StringProperty(description="Why there is no list")
    where: bpy.props.EnumProperty(
        name="Where",
        description="Where the new objects are wanted",
        items=(
            ("ANYWHERE", "Anywhere", "Where the model thinks they belong"),
            ("ON", "On", "On the active object"),
            ("BESIDE", "Beside", "Beside the active object, within half a metre if there is room"),
            ("IN", "In Room", "In one of the rooms that are recognised in the scene"),
        ),
    )
    room: bpy.props.StringProperty(
        name="Room", description='Which room: what it is, such as "kitchen", or its number',
        search=rooms_to_choose, search_options={"SUGGESTION"},
    )  # fmt: skip

    def model_file(self) -> str:
        """Path of the chosen model, "" for none."""
        return bpy.path.abspath(self.path) if self.model == OWN_FILE else self.model

    def wanted(self) -> dict[str, int]:
        """The categories of which at least one is wanted."""
        return {item.name: item.count for item in self.counts if item.count}

    def lacks(self, active: bpy.types.Object | None) -> str:
        """What a user has to do before the choices can be followed, "" for nothing."""
        if not self.wanted():
            return "Set a count"
        if self.where in ("ON", "BESIDE") and active is None:
            return "Select an object"
        return "Choose a room" if self.where == "IN" and not self.room.strip() else ""

    def hand_over(self, generate: bpy.types.OperatorProperties, active: bpy.types.Object | None) -> None:
        """Write the choices into a button's, or the operator's own, properties."""
        for name in ("seed", "bulk", "behaviour", "words", "variety", "candidates"):
            setattr(generate, name, getattr(self, name))
        generate.model = self.model_file()
        generate.add = ",".join(f"{name}={count}" for name, count in self.wanted().items())
        generate.on = active.name if active and self.where == "ON" else ""
        generate.beside = active.name if active and self.where == "BESIDE" else ""
        generate.within = self.room if self.where == "IN" else ""


def list_categories(settings: UNISG_GenerationSettings) -> None:
    """List the categories of the chosen model, keeping the counts of those that were listed before."""
    before, settings.listed, settings.problem = settings.wanted(), settings.model_file() or "-", ""
    settings.counts.clear()
    if not settings.model_file():
        settings.problem = "Choose a model file"
        return
    try:
        categories = load_generator(settings.model_file()).categories
    except UniSGError as error:
        settings.problem = in_window(str(error))
        return
    for category in categories:
        item = settings.counts.add()
        item.name, item.count = category, before.get(category, 0)


def list_categories_soon() -> None:
    """List them when Blender has finished drawing: a panel must not change anything while it draws."""
    if not bpy.app.timers.is_registered(_list_now):
        bpy.app.timers.register(_list_now, first_interval=0.01)


def _list_now() -> None:
    settings = bpy.context.window_manager.unisg
    file = settings.model_file()
    if _loading_model.busy:
        return  # the panel is drawn again at its end
    if file and not is_loaded(file) and not bpy.app.background:
        load_soon(file, list_categories_soon, lambda text: _tell(file, text))
        return
    list_categories(settings)
    redraw_views(bpy.context)


def _tell(file: str, problem: str) -> None:
    """Say why a model has no list."""
    settings = bpy.context.window_manager.unisg
    settings.counts.clear()
    settings.listed, settings.problem = file, problem


def chosen_model(context: bpy.types.Context) -> str:
    """The model that is chosen in the panel, else the first that came with the extension.

    Raises
    ------
    UniSGError
        If there is none.
    """
    file = context.window_manager.unisg.model_file() or str(next(iter(shipped_models()), ""))
    if not file:
        raise UniSGError("no model came with this installation: choose one in the panel")
    return str(file)


def is_loaded(path: str) -> bool:
    """Whether the generator of a model file is there at once."""
    return _key(bpy.path.abspath(path)) in _generators


def load_soon(path: str, done: Callable[[], object], failed: Callable[[str], object]) -> None:
    """Load the generator of a model file in the background; what a user has to mend is given to ``failed``."""
    file = bpy.path.abspath(path)
    if not _loading_model.busy:
        _loading_model.start(lambda: opened_generator(file), lambda generator: done(), failed)


def loading() -> bool:
    """Whether a model is being loaded."""
    return _loading_model.busy


CLASSES = (UNISG_CategoryCount, UNISG_GenerationSettings)
PROPERTIES = ((bpy.types.WindowManager, "unisg", bpy.props.PointerProperty(type=UNISG_GenerationSettings)),)


def register() -> None:
    """Take over how many threads models may use, now and later."""
    _threads[0] = int(str(preference("threads")))
    when_models_change.append(forget_models)


def unregister() -> None:
    """Let the model go."""
    when_models_change.clear()
    if bpy.app.timers.is_registered(_list_now):
        bpy.app.timers.unregister(_list_now)
    _loading_model.end()
    _generators.clear()
