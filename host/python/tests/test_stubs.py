"""Editors complete the keys of a rig from the list of keys."""

import stubs


def test_the_stub_of_the_tables_is_that_of_the_list_of_keys() -> None:
    assert stubs.STUB.read_text() == stubs.text(), "write it anew: python stubs.py"
