#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""schema_check.py SCHEMA DOCUMENT ...: one line for each document, "good" or the fault."""
import json
import sys
import warnings

warnings.simplefilter('ignore')
try:
    import jsonschema
except ImportError:
    sys.exit(77)
with open(sys.argv[1]) as file:
    schema = json.load(file)
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)
for path in sys.argv[2:]:
    with open(path) as file:
        errors = [e.message for e in validator.iter_errors(json.load(file))]
    print(errors[0].replace('\n', ' ')[:300] if errors else 'good')
