"""What all parts of a case share."""

from collections.abc import Iterable, Mapping
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, ValidationError

from fissura.case.report import fail, input_error
from fissura.errors import InputError


class Part(BaseModel):
    """Base of all parts of a case: frozen, keys that are not known are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid", validate_default=True)

    #: What copies keep besides values.
    stays: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def table(cls, key: str) -> type[BaseModel] | None:
        """Model of a table that is not among the fields.

        Parameters
        ----------
        key : str
            Name of the table.

        Returns
        -------
        type of BaseModel, or None
            None where there is none.

        Examples
        --------
        >>> fissura.Case.table("specimen") is None  # it is a field
        True
        """
        return None

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Copy with other values; defaults that were not given follow them. `with_` of a case also reaches into tables.

        The copy is validated from what was given to this one and from the update. pydantic's own copy would keep
        ``f_s = 3 f_t`` of the old ``f_t``, and check nothing. The text of the case file stays with a case.

        Parameters
        ----------
        update : mapping, optional
            New values by key, as a case file or a part of a case gives them.
        deep : bool, optional
            Whether parts that stay are copied, too.

        Returns
        -------
        Part
            The copy.

        Raises
        ------
        InputError
            A new value is wrong, or does not go with the others.

        Examples
        --------
        >>> from fissura.case import Discretization
        >>> Discretization(l_f=0.01).model_copy(update={"l_f": 0.02}).l_c
        0.08
        """
        if not update:
            return super().model_copy(deep=deep)
        data = {**self._given(update), **update}
        try:
            found = type(self).model_validate(data)
        except ValidationError as error:
            raise input_error(error, type(self), data) from None
        vars(found).update({name: value for name, value in vars(self).items() if name in self.stays})
        return found.model_copy(deep=True) if deep else found

    def copy(self, *, include: Any = None, exclude: Any = None, update: Any = None, deep: bool = False) -> Self:
        """The same as `model_copy`, by the name that pydantic had for it, whose own keeps defaults of old values.

        Parameters
        ----------
        include, exclude : None
            Not for parts of a case: they would take away what they must have.
        update, deep : optional
            As of `model_copy`.

        Returns
        -------
        Part
            The copy.

        Raises
        ------
        InputError
            A new value is wrong, or does not go with the others; or fields are to be left out.

        Examples
        --------
        >>> case.copy(update={"seed": 7}).seed
        7
        """
        if include is not None or exclude is not None:
            raise InputError("copy", "parts of a case cannot be left out", "update, deep")
        return self.model_copy(update=update, deep=deep)

    def _given(self, update: Mapping[str, Any]) -> dict[str, Any]:
        """Values that were given and stay so beside an update."""
        return {name: getattr(self, name) for name in self.model_fields_set}

    def _refuse_beside(self, first: str, others: Iterable[str], allowed: str) -> None:
        """Fail for a key that is given although another one is, with which it does not go."""
        for key in others:
            if getattr(self, key) is not None:
                fail(f"is given together with {first}", allowed, key)

    def _at_most_one(self, keys: Iterable[str], allowed: str) -> list[str]:
        """Which of some keys is given; fail where two are."""
        given = [key for key in keys if getattr(self, key) is not None]
        self._refuse_beside(given[0] if given else "", given[1:], allowed)
        return given
