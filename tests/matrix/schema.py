"""JSON against docs/cullhull.schema.json: the few words of JSON Schema that it uses, no others."""

from __future__ import annotations

import json
from typing import Any, Optional

_TYPES = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "null": type(None),
    "number": (int, float),
    "integer": int,
}
_WORDS = {
    "description",
    "type",
    "required",
    "properties",
    "additionalProperties",
    "items",
    "enum",
    "const",
    "minimum",
    "anyOf",
    "$ref",
}


def _is(value: Any, kind: str) -> bool:
    if isinstance(value, bool):
        return kind == "boolean"
    return isinstance(value, _TYPES[kind])


def fault_of(schema: Any, name: str, value: Any) -> Optional[str]:
    """Where a text, parsed or not, is not what the definition describes; None where it is."""
    if isinstance(value, bytes):
        value = json.loads(value)
    return _fault(schema, schema["$defs"][name], value, name)


def _fault(schema: Any, rule: Any, value: Any, at: str) -> Optional[str]:
    unknown = set(rule) - _WORDS
    if unknown:
        raise ValueError(f"schema.py does not know {sorted(unknown)}")
    if "$ref" in rule:
        fault = _fault(schema, schema["$defs"][rule["$ref"].removeprefix("#/$defs/")], value, at)
        if fault:
            return fault
    if "anyOf" in rule:
        faults = [_fault(schema, choice, value, at) for choice in rule["anyOf"]]
        if None not in faults:
            return faults[0]
    if "const" in rule and value != rule["const"]:
        return f"{at}: {value!r} is not {rule['const']!r}"
    if "enum" in rule and value not in rule["enum"]:
        return f"{at}: {value!r} is none of {rule['enum']}"
    kinds = rule.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    if kinds and not any(_is(value, kind) for kind in kinds):
        return f"{at}: {value!r} is no {' or '.join(kinds)}"
    if "minimum" in rule and isinstance(value, (int, float)) and value < rule["minimum"]:
        return f"{at}: {value} is less than {rule['minimum']}"
    return _members(schema, rule, value, at)


def _members(schema: Any, rule: Any, value: Any, at: str) -> Optional[str]:
    if isinstance(value, dict):
        absent = [name for name in rule.get("required", []) if name not in value]
        if absent:
            return f"{at}: no {absent[0]}"
        known = rule.get("properties", {})
        for name, member in value.items():
            inner = known.get(name, rule.get("additionalProperties", True))
            if inner is False:
                return f"{at}: {name} is not in the schema"
            fault = None if inner is True else _fault(schema, inner, member, f"{at}.{name}")
            if fault:
                return fault
    if isinstance(value, list) and "items" in rule:
        for i, item in enumerate(value):
            fault = _fault(schema, rule["items"], item, f"{at}[{i}]")
            if fault:
                return fault
    return None
