"""Tables whose keys depend on a name: a law's constants, the dimensions of a shape."""

from collections.abc import Mapping
from contextlib import suppress
from typing import Any, ClassVar, Self

from pydantic import (
    BaseModel,
    ModelWrapValidatorHandler,
    PrivateAttr,
    SerializationInfo,
    SerializerFunctionWrapHandler,
    TypeAdapter,
    ValidationInfo,
    model_serializer,
    model_validator,
)

from fissura.case.named import Registry
from fissura.case.part import Part
from fissura.errors import InputError


class WithOwnTable(Part):
    """Part of a case with one table more, whose name and model are those of an entry of a registry."""

    #: Where the name is looked up.
    registry: ClassVar[Registry[Any]]

    _own: tuple[str, BaseModel] | None = PrivateAttr(default=None)

    @property
    def parameters(self) -> BaseModel | None:
        """The table that has the name, an instance of its model; None where there is none."""
        return None if self._own is None else self._own[1]

    @property
    def own_name(self) -> str | None:
        """Its name."""
        return None if self._own is None else self._own[0]

    def own(self, key: str) -> BaseModel | None:
        """The same, where it has this name."""
        return self._own[1] if self._own is not None and self._own[0] == key else None

    @classmethod
    def named_in(cls, data: Mapping[str, Any]) -> str | None:
        """The name in a table as a file has it, by default that of a further table in it; None where there is none."""
        return next((key for key in data if key not in cls.model_fields and key in cls.registry), None)

    @model_validator(mode="wrap")
    @classmethod
    def _with_own(cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        """Take out the table that has the name, and let its own model validate it."""
        name = cls.named_in(data) if isinstance(data, Mapping) else None
        if not isinstance(name, str) or name in cls.model_fields:
            return handler(data)
        rest = {key: value for key, value in data.items() if key != name}
        try:
            model = cls.registry.table(name)
        except InputError:
            if (info.context or {}).get("files_exist", True):
                raise
            return handler(rest)  # a case that was run where the name is known, and is only looked at here
        if model is None:
            return handler(data)
        found = handler(rest)
        # As an entry of a dictionary, so that errors tell the whole key.
        entries = TypeAdapter(dict[str, model])  # type: ignore[valid-type]
        found._own = name, entries.validate_python({name: data.get(name, {})}, context=info.context)[name]
        return found

    @model_serializer(mode="wrap")
    def _dumped(self, handler: SerializerFunctionWrapHandler, info: SerializationInfo) -> dict[str, Any]:
        out: dict[str, Any] = handler(self)
        if self._own is not None:
            out[self._own[0]] = self._own[1].model_dump(mode=info.mode)
        return out

    @classmethod
    def tables(cls) -> list[str]:
        """Names of tables that may stand there besides the fields; packages that cannot be imported have none."""
        found = []
        for name in cls.registry:
            with suppress(InputError):
                found += [name] if name not in cls.model_fields and cls.registry.table(name) else []
        return found

    @classmethod
    def table(cls, key: str) -> type[BaseModel] | None:
        """Model of a table that is not among the fields: that of a name in the registry."""
        return None if key in cls.model_fields or key not in cls.registry else cls.registry.table(key)

    def _given(self, update: Mapping[str, Any]) -> dict[str, Any]:
        given = super()._given(update)
        if self._own is not None and self.named_in({**given, self._own[0]: self._own[1], **update}) == self._own[0]:
            given[self._own[0]] = self._own[1]
        return given
