"""The DataFrame of a table whose rows have names. Loaded with the first table: it brings pandas."""

from __future__ import annotations

from typing import Any

import pandas


class NamedRows(pandas.DataFrame):
    """Rows answer to `.loc[NAME]`, and the names are a column too. What is printed has them once,
    and hides no column: where a terminal is too narrow, the last ones go on below."""

    @property
    def _constructor(self) -> Any:
        return pandas.DataFrame

    def __repr__(self) -> str:
        return self.to_string(index=False, float_format="{:.6g}".format, max_colwidth=60,
                              line_width=pandas.get_option("display.width"),
                              max_rows=pandas.get_option("display.max_rows"))

    def _repr_html_(self) -> str:
        return self.to_html(index=False, max_rows=pandas.get_option("display.max_rows"))


def named_rows(frame: pandas.DataFrame, column: str) -> NamedRows:
    out = NamedRows(frame)
    out.index = list(frame[column])
    return out
