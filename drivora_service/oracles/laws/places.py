"""Lines and columns of the parts of a YAML file."""

from __future__ import annotations

from typing import Any

import yaml

Place = tuple[int, int]
"""Line and column, from 1."""


class Places:
    """Finds the places of values, and of characters inside them, in a text of YAML."""

    def __init__(self, text: str) -> None:
        """Reads the structure of a text that is known to be YAML."""
        self._text = text.removeprefix("\ufeff")
        self._root: Any = yaml.compose(self._text, Loader=yaml.SafeLoader)

    def of(self, pointer: str) -> Place:
        """Returns where the value at a JSON pointer begins; that of the nearest part around it."""
        mark = self._find_node(pointer)[0]
        return mark.line + 1, mark.column + 1

    def inside(self, pointer: str, offset: int) -> Place:
        """Returns where a character of the text value at a JSON pointer is.

        YAML folds lines and drops indentation, but keeps the order of all other characters: the
        n-th of the value that is not white space is the n-th in the file.
        """
        mark, node = self._find_node(pointer)
        if not isinstance(node, yaml.ScalarNode):
            return mark.line + 1, mark.column + 1
        value: str = node.value
        before = len("".join(value[:offset].split()))
        at_end = not value[offset:].strip()
        position = node.start_mark.index
        if node.style in ("|", ">"):
            position = self._text.index("\n", position)
        elif node.style in ("'", '"'):
            position += 1
        wanted = before - 1 if at_end and before else before
        seen = -1
        while position < len(self._text):
            if not self._text[position].isspace():
                seen += 1
                if seen == wanted:
                    break
            position += 1
        position += 1 if at_end and before else 0
        start = self._text.rfind("\n", 0, position) + 1
        return self._text.count("\n", 0, position) + 1, position - start + 1

    def _find_node(self, pointer: str) -> tuple[Any, Any]:
        """Returns the mark and the node of the deepest part of a pointer that exists."""
        node = self._root
        mark = node.start_mark
        for token in pointer.split("/")[1:]:
            key = token.replace("~1", "/").replace("~0", "~")
            if isinstance(node, yaml.MappingNode):
                found = next(((k, v) for k, v in node.value if k.value == key), None)
                if found is None:
                    break
                mark, node = found[0].start_mark, found[1]
            elif (
                isinstance(node, yaml.SequenceNode) and key.isdigit() and int(key) < len(node.value)
            ):
                node = node.value[int(key)]
                mark = node.start_mark
            else:
                break
        return mark, node
