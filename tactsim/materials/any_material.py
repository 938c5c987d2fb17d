"""The material of a case file: the name of a shipped set, a set with another bulk modulus, or a kind with its constants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, cast

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import PydanticCustomError, core_schema

from tactsim.errors import UnknownName
from tactsim.interfaces import Material
from tactsim.materials.library import LIBRARY, named_material
from tactsim.materials.moduli import BulkModulus
from tactsim.materials.own_law import check_law
from tactsim.model import FrozenModel
from tactsim.registry import kind_class, kinds
from tactsim.relaxation import Relaxation


class SetReference(FrozenModel):
    """A shipped set, if need be with a bulk modulus or a relaxation of its own."""

    set: Annotated[str, Field(json_schema_extra={"enum": sorted(LIBRARY)})]
    """Name of the set."""
    bulk_modulus: BulkModulus | None = None
    """Bulk modulus; null means exactly incompressible."""
    relaxation: Relaxation | None = None
    """Relaxation of the isochoric stress; null means elastic."""


def read_material(value: Any, info: ValidationInfo) -> Material:
    """The material that a case file describes by text or by a mapping; a Material passes as it is.

    Raises
    ------
    ValueError
        Naming the wrong key, value, set or kind; pydantic adds the place.
    """
    if isinstance(value, Material):
        value.require_own_kind()
        return _checked(value)
    try:
        if isinstance(value, str):
            return named_material(value).material
        if isinstance(value, Mapping) and "set" in value:
            return _changed_set(SetReference.model_validate(value, context=info.context))
        if isinstance(value, Mapping) and "kind" in value:
            return _checked(cast(Material, kind_class(Material, str(value["kind"])).model_validate(value, context=info.context)))
    except UnknownName as error:
        raise PydanticCustomError("unknown_name", "{message}", {"message": str(error)}) from None
    raise ValueError(f"expected the name of a material set ({', '.join(sorted(LIBRARY))}) or a mapping with the key kind or set")


def _checked(material: Material) -> Material:
    """The material, after its own stress and tangent were looked at if no compiled form stands for them."""
    if material.compiled_form is None:
        check_law(material)
    return material


def _changed_set(reference: SetReference) -> Material:
    """The named set, its bulk modulus and relaxation replaced where they are given."""
    material = named_material(reference.set).material
    changes = reference.model_dump(exclude={"set"}, exclude_unset=True)
    return type(material).model_validate(material.model_dump() | changes) if changes else material


class _AnyMaterialSchema:
    """Teaches pydantic to read, write and describe any registered material."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(
            read_material,
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda material, info: material.model_dump(mode=info.mode, context=info.context), info_arg=True
            ),
        )

    def __get_pydantic_json_schema__(self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        name = {"type": "string", "enum": sorted(LIBRARY), "description": "Name of a shipped material set."}
        described: list[Any] = [handler(cls.__pydantic_core_schema__) for cls in (SetReference, *kinds(Material).values())]
        return {"oneOf": [name, described[0], *({"allOf": [one], "required": ["kind"]} for one in described[1:])]}


AnyMaterial = Annotated[Material, _AnyMaterialSchema()]
"""A Material in a model; ``"icf_stable"``, ``{set: icf_stable, bulk_modulus: 1 MPa}`` or ``{kind: neo_hookean, c10: 3 kPa}``."""
