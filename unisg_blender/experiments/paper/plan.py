"""Which trainings make up the two sets of tables."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain, product
from typing import Any

from ...learn.paper.experiment_scenes import FULL, QUICK, Sizes
from .runs import Run

PAPER_FORMS = {
    "matrix 4x4": "trs_matrix", "CGA": "cga_similarity", "PGA": "pga", "vector + angle-axis": "axis_angle",
    "dual quaternion": "dual_quaternion",
}  # fmt: skip
"""The paper's five forms by the names of its figures. CGA with dilator: T R D."""

ALL_FORMS = (
    "trs_matrix", "axis_angle", "quaternion", "sixd", "dual_quaternion", "pga", "pga_even", "cga", "cga_even",
)  # fmt: skip
NARROW_FORMS = tuple(form for form in ALL_FORMS if form not in ("pga", "cga"))
"""Without those whose further channels are constant: with constants dropped they are the even forms exactly."""

FEW_FORMS = ("trs_matrix", "axis_angle", "sixd", "dual_quaternion", "cga_even")
"""One of each kind, for the larger tables."""

DOUBLE_FORMS = ("axis_angle", "quaternion", "dual_quaternion", "pga_even", "cga_even")
"""Forms that have two features for each pose."""

TARGET = {"task": "target", "poses": "full", "translation": "medium", "sign": "canonical", "scaling": "standard"}
INPUT = TARGET | {"task": "input"}
POSE_FACTORS: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {
    "target, base case": (TARGET, ALL_FORMS),
    "input, base case": (INPUT, NARROW_FORMS),
    "child seen from parent, two world poses": (INPUT | {"poses": "two poses"}, NARROW_FORMS),
    "child seen from parent, composed": (INPUT | {"poses": "composed"}, NARROW_FORMS),
    "target, large translations": (TARGET | {"translation": "large"}, NARROW_FORMS),
    "target, random sign": (TARGET | {"sign": "random"}, DOUBLE_FORMS),
    "in and out, parent-relative": (TARGET | {"task": "both", "poses": "relative"}, NARROW_FORMS),
    "in and out, absolute": (TARGET | {"task": "both", "poses": "absolute"}, NARROW_FORMS),
    "target, not standardised": (TARGET | {"scaling": "raw"}, ALL_FORMS),
    "target, yaw only": (TARGET | {"poses": "yaw"}, NARROW_FORMS),
    "target, small translations": (TARGET | {"translation": "small"}, NARROW_FORMS),
    "input, random sign": (INPUT | {"sign": "random"}, DOUBLE_FORMS),
    "input, yaw only": (INPUT | {"poses": "yaw"}, NARROW_FORMS),
    "input, large translations": (INPUT | {"translation": "large"}, NARROW_FORMS),
}
"""One factor at a time from the base cases: settings and forms."""

RATES = (3e-3, 1e-2, 3e-2, 1e-1, 3e-1)
"""Learning rates that every form of "poses" and "pairs" is tried with."""

FIRST = sum(len(forms) for _, forms in list(POSE_FACTORS.values())[:6])
"""How many trainings the first six settings are."""


@dataclass(frozen=True)
class PaperPlan:
    """Sizes of everything."""

    sizes: Sizes = FULL
    seeds: int = 10
    classification: int = 20
    few: int = 40
    topology: int = 100
    generation: int = 100
    links: int = 100
    steps: int = 300
    most_cubes: int = 1_000_000
    rates: tuple[float, ...] = RATES


QUICK_PLAN = PaperPlan(
    QUICK, seeds=2, classification=10, few=20, topology=15, generation=5, links=15, steps=60, most_cubes=10_000
)


def paper_runs(plan: PaperPlan) -> list[Run]:
    """The paper's three experiments; for each seed all five forms before the next seed."""
    epochs = {"classification": plan.classification, "topology": plan.topology, "generation": plan.generation}
    return [
        Run(name, {"form": form, "seed": seed, "epochs": count})
        for name, count in epochs.items()
        for seed, form in product(range(plan.seeds), PAPER_FORMS.values())
    ]


def pose_runs(plan: PaperPlan) -> dict[tuple[str, str], Run]:
    """By factor and form."""
    size = {"seeds": plan.seeds, "steps": plan.steps, "rates": list(plan.rates)}
    return {
        (name, form): Run("poses", {**settings, **size, "form": form})
        for name, (settings, forms) in POSE_FACTORS.items()
        for form in forms
    }


def pair_runs(plan: PaperPlan) -> dict[tuple[str, str, str], Run]:
    """By rotation, what is shown of the poses, and form."""
    size = {"seeds": plan.seeds, "steps": plan.steps, "rates": list(plan.rates)}
    forms = {"full": NARROW_FORMS, "yaw": FEW_FORMS}
    return {
        (rotation, poses, form): Run("pairs", {"rotation": rotation, "poses": poses, "form": form, **size})
        for rotation, known in forms.items()
        for poses, form in (*product(("absolute", "relative"), known), ("shipped", ""))
    }


def rule_runs() -> dict[str, Run]:
    """By rotation."""
    return {rotation: Run("rules", {"rotation": rotation}) for rotation in ("full", "yaw")}


def scale_runs(plan: PaperPlan) -> list[Run]:
    """By number of cubes, tenfold each time."""
    return [Run("scale", {"cubes": count}) for count in (10_000, 100_000, 1_000_000) if count <= plan.most_cubes]


def link_runs(plan: PaperPlan) -> dict[str, list[Run]]:
    """The paper's autoencoder on unseen scenes: by form, one run per seed."""
    return {
        form: [
            Run("link_prediction", {"rotation": "full", "form": form, "seed": seed, "epochs": plan.links})
            for seed in range(plan.seeds)
        ]
        for form in PAPER_FORMS.values()
    }


DOUBLED_FORMS = ("trs_matrix", "axis_angle", "sixd", "dual_quaternion")
"""Forms whose position's channels can be given twice: CGA's motors have theirs twice already."""

FEW_FACTORS: dict[str, tuple[dict[str, Any], tuple[int, ...], tuple[str, ...]]] = {
    "poses": ({}, (4, 8, 16), FEW_FORMS),
    "poses, not standardised": ({"scaling": "raw"}, (4,), FEW_FORMS),
    "poses, position twice": ({"doubled": True}, (4,), DOUBLED_FORMS),
    "all components": ({}, (4,), tuple(PAPER_FORMS.values())),
}
"""What the network sees: settings, numbers of training scenes, and forms."""


def few_runs(plan: PaperPlan) -> dict[tuple[str, int, str], list[Run]]:
    """Classification from few scenes: by what the network sees, number of scenes and form, one run per seed."""
    found = {}
    for see, (factor, counts, forms) in FEW_FACTORS.items():
        only_poses = see != "all components"
        components = ["trs"] if only_poses else ["info", "trs", "mesh", "action"]
        for count, form in product(counts, forms):
            settings: dict[str, Any] = {
                "form": form, "epochs": plan.few, "training": count, "components": components, "stretch": only_poses,
                **factor,
            }  # fmt: skip
            found[see, count, form] = [Run("classification", settings | {"seed": seed}) for seed in range(plan.seeds)]
    return found


def all_runs(plan: PaperPlan) -> list[Run]:
    """Everything, the main questions first, then seed by seed: what is there when it is stopped is balanced."""
    poses, pairs = list(pose_runs(plan).values()), list(pair_runs(plan).values())
    seeds: list[list[Run]] = [[] for _ in range(plan.seeds)]
    slow: list[list[Run]] = [[] for _ in range(plan.seeds)]
    for run in (*paper_runs(plan), *chain(*link_runs(plan).values()), *chain(*few_runs(plan).values())):
        (slow if run.experiment == "generation" else seeds)[run.settings["seed"]].append(run)
    main = [*rule_runs().values(), *poses[:FIRST], *pairs, *seeds[0], *poses[FIRST:], *scale_runs(plan), *slow[0]]
    return [*main, *chain(*seeds[1:]), *chain(*slow[1:])]
