#!/usr/bin/python3
"""Checks a JSON document of implicit-geodesic against its schema.

usage: validate_json.py SCHEMA.json DOCUMENT.json

Exit code 0: valid; 1: not, with the places on stdout; 77: the module jsonschema is missing
(Debian: python3-jsonschema).
"""
import json
import sys

try:
    import jsonschema
except ImportError:
    print("the Python module jsonschema is missing")
    sys.exit(77)


def refuse(constant):
    raise ValueError(f"{constant} is no JSON number")


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file, parse_constant=refuse)


def main(schema_path, document_path):
    schema = load(schema_path)
    validator = jsonschema.validators.validator_for(schema)
    validator.check_schema(schema)
    errors = list(validator(schema).iter_errors(load(document_path)))
    for error in errors:
        print(f"{document_path}: {error.json_path}: {error.message[:200]}")
    return 1 if errors else 0


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
