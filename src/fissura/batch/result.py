"""What results of many runs have in common: a folder that they are copied with, and a picture in notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Self

from fissura.files.folder import FolderKind, copied
from fissura.pictures.attempted import attempted
from fissura.text.rows import Described

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class FolderResult(Described):
    """A frozen dataclass whose files are in a folder."""

    kind: ClassVar[FolderKind]
    left_behind: ClassVar[dict[str, Any]] = {}  # what a copy in another folder has instead
    folder: Path

    def _notes(self) -> Iterable[str]:
        """What a notebook shows below the rows."""
        raise NotImplementedError

    def _figure(self) -> tuple[Figure | None, str]:
        """What a notebook shows beside the rows, and whose curves these are."""
        raise NotImplementedError

    def save(self, folder: str | Path, *, overwrite: bool = False) -> Self:
        """Copy all files to another folder, which `load` reads and the command goes on with.

        Parameters
        ----------
        folder : path
            New or empty, or with earlier results of this kind to be replaced.
        overwrite : bool, optional
            Whether it may hold such results.

        Returns
        -------
        Self
            The same, in its new folder.

        Raises
        ------
        InputError
            The folder holds something else, or cannot be written.
        OSError
            A file cannot be written.

        Examples
        --------
        >>> study.save("results/study").folder.name
        'study'
        >>> found.save("results/found again").folder.name
        'found again'
        """
        target = copied(self.folder, folder, self.kind, overwrite=overwrite)
        return replace(self, folder=target, **self.left_behind)  # type: ignore[type-var]

    def _repr_html_(self) -> str:
        from fissura.pictures.html import embedded, notebook_html

        def picture() -> str | None:
            figure, of = self._figure()
            return None if figure is None else embedded(figure, f"curves of {of}")

        rows = [*self.table(), ("results", str(self.folder))]
        return notebook_html(rows, self._notes(), attempted("the curves", picture))
