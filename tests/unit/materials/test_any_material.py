"""The material of a case file: a set, a set with a bulk modulus, a kind with its constants, and what is refused."""

from __future__ import annotations

import pytest
from pydantic import TypeAdapter, ValidationError

from tactsim.case.json_schema import described
from tactsim.interfaces import Material
from tactsim.materials.any_material import AnyMaterial
from tactsim.materials.library import LIBRARY, named_material
from tactsim.materials.linear_elastic import LinearElastic
from tactsim.materials.neo_hookean import NeoHookean
from tactsim.registry import kinds

READER = TypeAdapter(AnyMaterial)


def read(value):
    """As a case file is read: a bare number is an error."""
    return READER.validate_python(value, context={"units": "required"})


@pytest.mark.parametrize("name", sorted(LIBRARY))
def test_a_set_is_read_by_its_name(name):
    assert read(name) == LIBRARY[name].material
    assert read({"set": name}) == LIBRARY[name].material
    assert LIBRARY[name].name == name


def test_a_kind_is_read_with_its_constants():
    assert read({"kind": "neo_hookean", "c10": "3 kPa"}) == NeoHookean(c10=3e3)
    assert read({"kind": "neo_hookean", "c10": "3 kPa", "bulk_modulus": "1 MPa"}) == NeoHookean(c10=3e3, bulk_modulus=1e6)
    assert read({"kind": "linear_elastic", "youngs_modulus": "18 kPa", "poisson_ratio": 0.49}) == LinearElastic.example()


def test_a_set_takes_another_bulk_modulus():
    plain = named_material("icf_stable").material
    material = read({"set": "icf_stable", "bulk_modulus": "1 MPa"})
    assert material.bulk_modulus == 1e6
    assert material.model_copy(update={"bulk_modulus": None}) == plain
    assert read({"set": "icf_stable", "bulk_modulus": None}) == plain


def test_a_material_passes_as_it_is():
    material = NeoHookean(c10=3e3)
    assert read(material) is material


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("icf_stabel", "did you mean 'icf_stable'"),
        ("icf", "did you mean 'icf_printed' or 'icf_stable'"),
        ({"set": "icf_stabel"}, "did you mean 'icf_stable'"),
        ({"kind": "neo_hokean", "c10": "3 kPa"}, "unknown material kind 'neo_hokean' .did you mean 'neo_hookean'"),
        ({"kind": "neo_hookean", "c10": 3.0}, "has no unit"),
        ({"kind": "neo_hookean", "c10": "3 mm"}, "wrong dimension"),
        ({"kind": "neo_hookean"}, "c10"),
        ({"kind": "neo_hookean", "c10": "3 kPa", "c01": "1 kPa"}, "c01"),
        ({"kind": "neo_hookean", "c10": "-3 kPa"}, r"c10\n.*greater than 0"),
        ({"kind": "mooney_rivlin_2", "c10": "-3 kPa", "c01": "0 Pa"}, "shear modulus = -6000 Pa; it must be > 0 Pa"),
        ({"set": "icf_stable", "bulk_modulus": 1e6}, "has no unit"),
        ({"set": "icf_stable", "bulk_modulus": "1 TPa"}, "times the shear modulus"),
        ({"set": "icf_stable", "c10": "1 kPa"}, "c10"),
        ({"set": "icf_stable", "kind": "neo_hookean"}, "kind"),
        ({"set": 3}, "set"),
        ({"kind": ["neo_hookean"]}, "unknown material kind"),
        ({"c10": "3 kPa"}, "mapping with the key kind or set"),
        ({}, "mapping with the key kind or set"),
        (3.0, "name of a material set .*icf_stable"),
        (None, "name of a material set"),
        ([], "name of a material set"),
        ({"kind": "polynomial", "coefficients": {}}, "coefficients"),
        ({"kind": "polynomial", "coefficients": {"c00": "3 kPa"}}, "c00"),
        ({"kind": "polynomial", "coefficients": {"c100": "3 kPa"}}, "c100"),
    ],
)
def test_what_is_no_material_is_reported(value, words):
    with pytest.raises(ValidationError, match=words):
        read(value)


def test_the_schema_describes_sets_and_every_kind():
    schema = READER.json_schema()
    name, by_set, *by_kind = schema["oneOf"]
    assert name["enum"] == sorted(LIBRARY)
    text = str(schema)
    assert all(f"'{kind}'" in text for kind in kinds(Material))
    assert len(by_kind) == len(kinds(Material))
    assert all(choice["required"] == ["kind"] for choice in by_kind)
    assert by_set


def test_every_constant_in_the_schema_is_described():
    for kind, cls in kinds(Material).items():
        for field, entry in described(cls)["properties"].items():
            assert field == "kind" or entry.get("description"), f"{kind}.{field}"
