"""The lesson of an operating room: a knee is to get an implant, from the checks to doffing."""

from __future__ import annotations

import numpy as np

from ..scene.action_data import ActionData
from ..scene.lesson_node import LessonNode
from .behaviour_script import Script, Thing, choices, turned
from .layout import Layout


class Cast:
    """Who plays in the lesson: objects of the room by their part in it, None where the room has none."""

    def __init__(self, layout: Layout) -> None:
        self.layout = layout
        self.patient, self.knee = layout.named("Patient")[0], layout.named("Knee")[0]
        self.table = layout.named("Operating Table")[0]
        self.mayo, self.back = self.first("Mayo Stand"), self.first("Instrument Table")
        self.machine, self.mask = self.first("Anaesthesia Machine"), self.first("Bag Mask")
        self.lamp, self.pole, self.bag = self.first("Surgical Lamp"), self.first("IV Pole"), self.first("IV Bag")
        self.scalpel, self.retractor = self.first("Scalpel"), self.first("Retractor")
        self.forceps, self.syringe, self.vial = self.first("Forceps"), self.last("Syringe"), self.first("Vial")
        self.implant, self.mallet = self.first("Implant"), self.first("Mallet")
        self.holder, self.suction = self.first("Needle Holder") or self.first("Clamp"), self.first("Suction Unit")
        self.electrosurgery, self.laryngoscope = self.first("Electrosurgical Unit"), self.first("Laryngoscope")
        self.bucket, self.dish = self.first("Kick Bucket"), self.first("Kidney Dish")
        clean = [swab for swab in layout.named("Swab") if swab.relation == "on_top_of"]
        self.swabs, self.swab = clean, clean[0] if clean else None

    def knee_is_right(self) -> bool:
        """Is it the patient's right knee? The patient lies on the back with the head at +y: right is at -x."""
        return bool(self.patient.seen(self.knee.pose)[0] < 0)

    def first(self, category: str) -> Thing:
        """The first object of a category."""
        found = self.layout.named(category)
        return found[0] if found else None

    def last(self, category: str) -> Thing:
        """The last object of a category."""
        found = self.layout.named(category)
        return found[-1] if found else None


def surgery_lesson(layout: Layout) -> tuple[dict[str, list[ActionData]], LessonNode]:
    """Actions by owner, and the operation; limits, counts, order and extras differ from room to room."""
    script, cast = Script(layout), Cast(layout)
    side = "right" if cast.knee_is_right() else "left"
    prepare = script.lesson("Prepare", [_checks(script, cast), _anaesthesia(script, cast), _light(script, cast)])
    operate = script.lesson("Operate", _operate(script, cast))
    finish = script.lesson("Finish", [_count_again(script, cast), _doff(script, cast)])
    return script.actions, script.operation(f"Knee implant, {side}", [prepare, operate, finish])


def _checks(script: Script, cast: Cast) -> LessonNode:
    rng = script.layout.rng
    swabs, right = choices(rng, len(cast.swabs))
    knees = ["Left", "Right"]
    actions = [
        script.ask("Is the anaesthesia machine ready?", cast.machine, ["Ready", "No oxygen", "Not checked"], 0),
        script.ask("How many swab packs are laid out?", cast.swab, swabs, right),
        script.ask("Which knee is to be operated?", cast.knee, knees, int(cast.knee_is_right())),
    ]
    if rng.random() < 0.6:
        tools, right = choices(rng, len(script.layout.named("Scalpel")), 1)
        actions.append(script.ask("How many scalpels are there?", cast.scalpel, tools, right))
    return script.stage("Checks", actions, ordered=bool(rng.random() < 0.5))


def _anaesthesia(script: Script, cast: Cast) -> LessonNode:
    rng = script.layout.rng
    face = cast.patient.asset.surfaces["face"].center
    over_face = turned(face[0], face[1], face[2] + 0.13, 0.0, -np.pi / 2)
    draw = script.use(
        "Draw up the drug", cast.syringe, cast.vial, round(float(rng.uniform(1.0, 3.0)), 1), distance=0.02
    )
    give = script.use("Give the drug into the line", cast.syringe, cast.bag, 1.0, distance=0.05, trigger=True)
    mask = script.insert("Put on the mask", cast.mask, cast.patient, over_face, _limit(rng, 0.03), 20.0, hold=2.0)
    look = script.use("Look with the laryngoscope", cast.laryngoscope, cast.patient, 1.5) if rng.random() < 0.4 else ""
    actions = [draw, give, mask, look] if rng.random() < 0.7 else [mask, draw, give, look]
    return script.stage("Anaesthesia", actions, optional=[look])


def _light(script: Script, cast: Cast) -> LessonNode:
    rng = script.layout.rng
    lamp = script.use("Position the lamp over the knee", cast.lamp, cast.knee, 1.0, distance=_limit(rng, 0.7))
    clean = script.work("Disinfect the knee", cast.swab, cast.knee, int(rng.integers(3, 6)))
    return script.stage("Light and field", [lamp, clean], ordered=False)


def _operate(script: Script, cast: Cast) -> list[LessonNode]:
    rng = script.layout.rng
    beside = turned(0.0, 0.09, 0.02, float(rng.uniform(-0.2, 0.2)))
    incise = script.stage(
        "Incise",
        [
            script.remove("Take the scalpel", cast.scalpel, 0.10),
            script.use("Incise the knee", cast.scalpel, cast.knee, round(float(rng.uniform(1.0, 2.5)), 1)),
            _put_back(script, "Put the scalpel back", cast.scalpel),
        ],
    )
    stop = ""
    if rng.random() < 0.7:
        stop = script.use("Coagulate", cast.forceps, cast.knee, 1.0, trigger=True)
    expose = script.stage(
        "Expose",
        [
            script.remove("Take the retractor", cast.retractor, 0.10),
            script.insert("Insert the retractor", cast.retractor, cast.knee, beside, _limit(rng, 0.02), 20.0),
            stop,
        ],
        optional=[stop],
        requires=[incise],
    )
    seat = turned(0.0, 0.0, 0.008, float(rng.uniform(-0.1, 0.1)))
    implant = script.stage(
        "Insert the implant",
        [
            script.remove("Take the implant out of its box", cast.implant, 0.15),
            script.insert("Insert the implant", cast.implant, cast.knee, seat, 0.01, 10.0, hold=1.0),
            script.work(
                "Drive it home", cast.mallet, cast.implant, int(rng.integers(2, 5)), float(rng.integers(2, 6) * 10)
            ),
        ],
        requires=[expose],
    )
    close = script.stage(
        "Close",
        [
            script.remove("Remove the retractor", cast.retractor, 0.20),
            script.work("Close the wound", cast.holder, cast.knee, int(rng.integers(4, 8))),
            script.use("Cover the wound with a swab", cast.swab, cast.knee, 1.0),
        ],
        requires=[implant],
    )
    return [incise, expose, implant, close]


def _count_again(script: Script, cast: Cast) -> LessonNode:
    answers, right = choices(script.layout.rng, len(cast.swabs))
    count = script.ask("Count again: how many swab packs must there be?", cast.swab, answers, right)
    return script.stage("Final count", [count])


def _doff(script: Script, cast: Cast) -> LessonNode:
    """In any order: waste away, lamp up, mask off."""
    rng = script.layout.rng
    inside = None if cast.bucket is None else turned(0, 0, cast.bucket.asset.surfaces["inside"].center[2] + 0.02)
    waste = "" if inside is None else script.insert("Throw the swab away", cast.swab, cast.bucket, inside, 0.12, 180.0)
    members = [
        waste,
        script.remove("Take the mask off", cast.mask, 0.2),
        script.remove("Move the lamp away", cast.lamp, 0.3),
        script.remove("Move the Mayo stand away", cast.mayo, 0.4),
    ]
    kept = [member for member in members if member]
    mode = "all" if rng.random() < 0.8 or len(kept) < 3 else "any"
    return script.stage("Doff", [script.group("Clear the table", cast.table, kept, mode)])


def _put_back(script: Script, name: str, obj: Thing) -> str:
    """Back to where it lay, in the frame of what it lay on."""
    if obj is None or obj.parent is None:
        return ""
    x, y, z, yaw = obj.parent.seen(obj.pose)
    return script.insert(name, obj, obj.parent, turned(x, y, z, yaw), 0.06, 45.0)


def _limit(rng: np.random.Generator, around: float) -> float:
    """A limit within 30 % of a usual one, metres."""
    return round(float(around * rng.uniform(0.8, 1.3)), 3)
