"""Tables: pandas where it is there, else a plain table of the same columns."""

from __future__ import annotations

from html import escape
from typing import Any, Dict, Iterator, List, Sequence

from ._named import one_of
from .errors import UnknownName


def pandas_if_there() -> Any:
    """Loaded with the first table, not with the package: it takes longer than a fit."""
    try:
        import pandas
    except ImportError:
        return None
    return pandas


class Table:
    """Columns by name, rows in order. Stands in for a DataFrame where there is no pandas."""

    def __init__(self, rows: Sequence[Dict[str, Any]], columns: Sequence[str]) -> None:
        self.rows: List[Dict[str, Any]] = [dict(row) for row in rows]
        self.columns: List[str] = list(columns)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __getitem__(self, column: str) -> List[Any]:
        if column not in self.columns:
            wrong, right = f"there is no column {column!r}", one_of(column, self.columns)
            raise UnknownName(f"{wrong}\n  {right}", wrong=wrong, right=right)
        return [row.get(column) for row in self.rows]

    def _lines(self) -> List[List[str]]:
        def text(value: Any) -> str:
            return f"{value:.6g}" if isinstance(value, float) else "" if value is None else str(value)

        return [self.columns] + [[text(row.get(c)) for c in self.columns] for row in self.rows]

    def __repr__(self) -> str:
        lines = self._lines()
        widths = [max(len(line[i]) for line in lines) for i in range(len(self.columns))]
        return "\n".join("  ".join(cell.ljust(w) for cell, w in zip(line, widths)).rstrip()
                         for line in lines)

    def _repr_html_(self) -> str:
        head, *body = self._lines()
        row = lambda cells, tag: "<tr>" + "".join(f"<{tag}>{escape(c)}</{tag}>" for c in cells) + "</tr>"
        return "<table>" + row(head, "th") + "".join(row(line, "td") for line in body) + "</table>"


def table(rows: Sequence[Dict[str, Any]], columns: Sequence[str], index: str = "") -> Any:
    """A DataFrame (whose rows are named by a column, if told) where pandas is there, else a Table."""
    pandas = pandas_if_there()
    if pandas is None:
        return Table(rows, columns)
    frame = pandas.DataFrame(list(rows), columns=list(columns))
    from ._frame import Rows, named_rows

    return named_rows(frame, index) if index else Rows(frame)
