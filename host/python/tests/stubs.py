"""Writes python/pneudrive/tables.pyi from the list of keys: `python stubs.py`."""

from pathlib import Path

import pneudrive
from pneudrive.tables import class_name

STUB = Path(__file__).parents[1] / "python" / "pneudrive" / "tables.pyi"

HEAD = '''"""The tables of a rig file as classes. Written by tests/stubs.py from the list of keys."""

from typing import Any

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
    return HEAD + "".join(classes)


def _property(name: str, key: dict[str, str]) -> str:
    unit = f", {key['unit']}" if key["unit"] else ""
    meaning = key["meaning"].replace("\\", "\\\\").replace('"""', "'''")
    doc = f"{meaning.rstrip('.')}{unit}."
    return f'    @property\n    def {name}(self) -> {key["type"]}:\n        """{doc}"""\n'


if __name__ == "__main__":
    STUB.write_text(text())
