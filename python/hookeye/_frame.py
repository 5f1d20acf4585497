"""The DataFrame of a table, printed whole. Loaded with the first table: it brings pandas."""

from __future__ import annotations

import textwrap
from typing import Any, List

import pandas

#: Longer texts are no cells of a table: they go on below it.
_CELL = 60


def _is_long(value: Any) -> bool:
    return isinstance(value, str) and (len(value) > _CELL or "\n" in value)


class Rows(pandas.DataFrame):
    """What is printed hides no column and cuts off no text: where a terminal is too narrow, the last
    columns go on below, and sentences stand below them all, by row."""

    _named = False

    @property
    def _constructor(self) -> Any:
        return pandas.DataFrame

    def __repr__(self) -> str:
        long = self._long()
        width = pandas.get_option("display.width") or 80
        rows = None if long else pandas.get_option("display.max_rows")
        said = self.drop(columns=long).to_string(
            index=not self._named, float_format="{:.6g}".format, max_colwidth=None, line_width=width,
            max_rows=rows)
        return "\n".join([said, *self._below(long, width)])

    def _long(self) -> List[str]:
        return [c for c in self.columns if self[c].dtype == object and self[c].map(_is_long).any()]

    def _below(self, long: List[str], width: int) -> List[str]:
        out = []
        for row, content in self.iterrows():
            for column in long:
                if isinstance(content[column], str) and content[column]:
                    out += textwrap.wrap(f"{row} {column}: {content[column]}", width,
                                         subsequent_indent="  ", break_on_hyphens=False)
        return out

    def _repr_html_(self) -> str:
        long = self._long()
        with pandas.option_context("display.max_colwidth", None):
            return self.to_html(index=not self._named,
                                max_rows=None if long else pandas.get_option("display.max_rows"))


class NamedRows(Rows):
    """Rows answer to `.loc[NAME]`, and the names are a column too. What is printed has them once."""

    _named = True


def named_rows(frame: pandas.DataFrame, column: str) -> NamedRows:
    out = NamedRows(frame)
    out.index = list(frame[column])
    return out
