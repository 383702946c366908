"""An argument parser that says what a word that it does not know was perhaps meant to be."""

from __future__ import annotations

import argparse
import re
from typing import NoReturn

from ..errors import MISUSE, UNUSABLE_INPUT, did_you_mean, one_line

CHOICE = re.compile(r"invalid choice: '([^']*)' \(choose from (.*)\)")
STRANGE = "unrecognized arguments: "
VALUE = re.compile(r"argument [^:]*: must be ")
"""How the types of options refuse a value: the option is known, its value is an input that cannot be used."""
OPTION = re.compile(r"--[\w-]+")


class HelpfulParser(argparse.ArgumentParser):
    """As its base; an error is one line, and about a choice or an option it names the nearest one that there is."""

    def error(self, message: str) -> NoReturn:
        """Print the message and exit: with status 1 where a value cannot be used, else with 2."""
        hint = f" (see '{self.prog} --help')"
        found, guess = CHOICE.search(message), ""
        if found:
            guess = did_you_mean(found[1], found[2].replace("'", "").split(", "))
        elif message.startswith(STRANGE):
            options = OPTION.findall(self.format_help())
            words = [word.split("=")[0] for word in message.removeprefix(STRANGE).split() if word.startswith("-")]
            guess = "".join(dict.fromkeys(did_you_mean(word, options) for word in words))
        self.exit(
            UNUSABLE_INPUT if VALUE.match(message) else MISUSE, f"{self.prog}: {one_line(message)}{guess or hint}\n"
        )
