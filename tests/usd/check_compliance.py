"""Run USD's checks over some files: ``check_compliance.py {bpy,usd-core} FILE...``; exit status 1 if any complains."""

from __future__ import annotations

import sys
from typing import Any

if sys.argv[1] == "bpy":
    import bpy  # noqa: F401  Blender's own USD

from unisg_blender.usd.pxr_library import require_pxr

require_pxr()
from pxr import Usd, UsdUtils  # noqa: E402


def complaints(path: str) -> list[Any]:
    """What the compliance checker (older builds) and the validators (newer builds) say."""
    found: list[Any] = []
    if hasattr(UsdUtils, "ComplianceChecker"):
        checker = UsdUtils.ComplianceChecker(arkit=False, skipARKitRootLayerCheck=False)
        checker.CheckCompliance(path)
        found += checker.GetErrors() + checker.GetFailedChecks() + checker.GetWarnings()
    try:
        from pxr import UsdValidation
    except ImportError:
        return found
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    return found + [error.GetMessage() for error in context.Validate(Usd.Stage.Open(path))]


told = [text for path in sys.argv[2:] for text in complaints(path)]
print(f"checked {len(sys.argv) - 2} files with USD {Usd.GetVersion()}", *told, sep="\n")
sys.exit(1 if told else 0)
