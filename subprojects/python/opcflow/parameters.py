# SPDX-License-Identifier: BSD-3-Clause
"""Declarations of parameters and metrics, as class attributes of a plugin.

Each function returns a declaration. On instances the attribute is the value: converted to the
declared unit, or None if the flow sets no value and there is no default.
"""
from functools import partial


class Invalid(ValueError):
    """A parameter whose value is not valid: raise Invalid("parameter", "message")."""

    def __init__(self, parameter, message):
        super().__init__(message)
        self.parameter = parameter


class Declaration:
    """Base of declarations; `fields` are the members of the description."""

    def __set_name__(self, owner, name):
        self.name = name

    def describe(self):
        """Return the declaration as a dictionary."""
        return {"name": self.name, **self.fields}


class Parameter(Declaration):
    """Declaration of a parameter; see opc_parameter in opcflow/plugin.h. The functions below, such
    as real("a length", unit="nm", preset="2 um", above=0), take these arguments:

    summary    text of the documentation
    choices    of choice: the words; of mapping: the allowed keys
    unit       of real and reals: unit of the value
    preset     default, as in a flow
    follows    of real: a default that follows from the scanner, such as "0.311 lambda/NA"
    name       name in flows; default: name of the attribute
    former     an earlier name
    required   True: the flow must set a value
    no_effect  True: the value has no effect on results
    at_least, above, at_most, below  bounds
    """

    def __init__(self, type, summary, choices=None, preset=None, required=False, no_effect=False,
                 **fields):
        if isinstance(preset, bool):
            preset = str(preset).lower()
        if choices and not isinstance(choices, str):
            choices = "|".join(choices)
        flags = ["required"] * required + ["no_effect"] * no_effect
        for name, side in (("at_least", "min"), ("above", "min"), ("at_most", "max"),
                           ("below", "max")):
            bound = fields.pop(name, None)
            if bound is not None:
                flags.append(name)
                fields[side] = float(bound)
        unknown = set(fields) - {"unit", "follows", "name", "former", "min", "max"}
        if unknown:
            raise TypeError("unknown options of a parameter: %s" % ", ".join(sorted(unknown)))
        fields.update(type=type, summary=summary, choices=choices, flags=flags,
                      preset=preset if preset is None else str(preset))
        self.fields = {k: v for k, v in fields.items() if v is not None}

    def __get__(self, instance, owner=None):
        return self if instance is None else instance.__dict__.get(self.name)

    def __set__(self, instance, value):
        instance.__dict__[self.name] = value


real = partial(Parameter, "real")        # a number in `unit`
integer = partial(Parameter, "int")
boolean = partial(Parameter, "bool")
choice = partial(Parameter, "choice")    # one word of `choices`
text = partial(Parameter, "text")
file = partial(Parameter, "file")        # the path of an existing file
output = partial(Parameter, "output")    # the name of a file in the run folder: Step.output_path
reals = partial(Parameter, "reals")      # a list of numbers in `unit`
mapping = partial(Parameter, "map")      # a dictionary of texts
# Inputs of a step: transistors, a corrected mask. required=False: the flow can omit the input.
gates_input = partial(Parameter, "input", choices="gates", required=True)
mask_input = partial(Parameter, "input", choices="mask", required=True)


class Metric(Declaration):
    """Declaration of a metric of a step; see opc_metric in opcflow/plugin.h. `better` is "lower",
    "higher" or None."""

    def __init__(self, summary, unit=None, better=None, tolerance=0.0):
        self.fields = {"summary": summary, "unit": unit, "better": better, "tolerance": tolerance}


metric = Metric
