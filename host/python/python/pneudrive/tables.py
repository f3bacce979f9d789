"""The tables of a rig file as classes: `rig.load.mass_kg`, with the help text of `pneudrive rig explain`.

The classes are made from the list of keys that reads rig files, so that there is no second one.
"""

from __future__ import annotations

from typing import Any

from ._pneudrive import Rig, explain, keys


class Table:
    """A table of a rig. Its attributes are the keys; they are read-only: `rig.with_(...)` makes another rig."""

    _name = ""
    _keys: tuple[str, ...] = ()

    __slots__ = ("_rig",)

    def __init__(self, rig: Rig) -> None:
        object.__setattr__(self, "_rig", rig)

    def __setattr__(self, name: str, value: object) -> None:
        text = f"a rig does not change; rig.with_({self._name}__{name}={value!r}) makes another one"
        raise AttributeError(text)

    def __getattr__(self, name: str) -> Any:
        try:
            return self._rig[f"{self._name}.{name}"]
        except KeyError as error:
            raise AttributeError(error.args[0], name=name, obj=self) from None

    def __dir__(self) -> list[str]:
        return list(self._keys)

    def __repr__(self) -> str:
        values = ", ".join(f"{key}={getattr(self, key)!r}" for key in self._keys)
        return f"<{self._name}: {values}>"


def class_name(table: str) -> str:
    """`load` as `Load`."""
    return table.capitalize()


def _property(path: str, help_: str) -> property:
    return property(lambda table: table._rig[path], doc=help_)


def _tables() -> dict[str, list[dict[str, str]]]:
    tables: dict[str, list[dict[str, str]]] = {}
    for key in keys():
        table, _, name = key["path"].rpartition(".")
        if table:
            tables.setdefault(table, []).append({**key, "name": name})
    return tables


def _class_of(table: str, entries: list[dict[str, str]]) -> type[Table]:
    properties: dict[str, Any] = {entry["name"]: _property(entry["path"], entry["help"]) for entry in entries}
    own = {"_name": table, "_keys": tuple(properties), "__slots__": (), "__module__": __name__}
    return type(class_name(table), (Table,), {"__doc__": explain(table), **own, **properties})


def _getter(table: type[Table]) -> property:
    return property(lambda rig: table(rig), doc=table.__doc__)


CLASSES: dict[str, type[Table]] = {}
for _name, _entries in _tables().items():
    CLASSES[_name] = _class_of(_name, _entries)
    globals()[class_name(_name)] = CLASSES[_name]
    setattr(Rig, _name, _getter(CLASSES[_name]))
