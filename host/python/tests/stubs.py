"""Writes python/pneudrive/tables.pyi from the list of keys: `python stubs.py`."""

from pathlib import Path

import pneudrive
from pneudrive.tables import class_name

STUB = Path(__file__).parents[1] / "python" / "pneudrive" / "tables.pyi"

HEAD = '''"""The tables of a rig file as classes. Written by tests/stubs.py from the list of keys."""

from collections.abc import Mapping, Sequence
from typing import Any, TypedDict, type_check_only

from numpy.typing import NDArray

from ._pneudrive import Rig

class Table:
    """A table of a rig. Its attributes are the keys; they are read-only: `rig.with_(...)` makes another rig."""

    def __init__(self, rig: Rig) -> None: ...

CLASSES: dict[str, type[Table]]

def class_name(table: str) -> str: ...
'''


def text() -> str:
    """The stub."""
    tables: dict[str, list[str]] = {}
    for key in pneudrive.keys():
        table, _, name = key["path"].rpartition(".")
        if table:
            tables.setdefault(table, []).append(_property(name, key))
    classes = (f"\nclass {class_name(table)}(Table):\n" + "".join(keys) for table, keys in tables.items())
    return HEAD + "".join(classes) + _keywords()


def _keywords() -> str:
    """What `Rig` and `Rig.new` take as keywords."""
    paths = {key["path"]: _given(key["type"]) for key in pneudrive.keys()}
    # A number without its unit in the name has it in the text: load__mass="8 kg".
    for key in pneudrive.keys():
        if key["unit"] and key["type"].startswith("float"):
            stem = key["path"][: _stem(key["path"], key["unit"])]
            paths.setdefault(stem, "str")
    keys = (f"    {path.replace('.', '__', 1)}: {kind}\n" for path, kind in paths.items())
    head = '\n@type_check_only\nclass RigKeys(TypedDict, total=False):\n    """Keys of a rig file, as keywords."""\n\n'
    answers = (f"    {question['name']}: str | float\n" for question in pneudrive.questions())
    asked = '\n@type_check_only\nclass Answers(TypedDict, total=False):\n    """Figures of data sheets."""\n\n'
    return head + "".join(keys) + asked + "".join(answers)


def _given(kind: str) -> str:
    """The type that a key takes, by the type that it has."""
    kind = kind.removesuffix(" | None").replace("list[tuple[float, int]]", "list[list[float]]")
    wide = kind.replace("list[", "Sequence[").replace("dict[", "Mapping[")
    return wide if wide == kind or "Mapping" in wide else f"{wide} | NDArray[Any]"


def _stem(path: str, unit: str) -> int:
    """Where the unit begins in the name of a key."""
    ending = "_" + unit.replace("/", "_per_").replace(" ", "_").lower()
    return len(path) - len(ending) if path.endswith(ending) else len(path)


def _property(name: str, key: dict[str, str]) -> str:
    unit = f", {key['unit']}" if key["unit"] else ""
    meaning = key["meaning"].replace("\\", "\\\\").replace('"""', "'''")
    doc = f"{meaning.rstrip('.')}{unit}."
    return f'    @property\n    def {name}(self) -> {key["type"]}:\n        """{doc}"""\n'


if __name__ == "__main__":
    STUB.write_text(text())
