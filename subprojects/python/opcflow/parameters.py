# SPDX-License-Identifier: BSD-3-Clause
"""Declarations of parameters and metrics, as class attributes of a plugin.

Each function returns a declaration. On instances the attribute is the value: converted to the
declared unit, or None if the flow sets no value and there is no default.
"""


class Invalid(ValueError):
    """A parameter whose value is not valid: raise Invalid("parameter", "message")."""

    def __init__(self, parameter, message):
        super().__init__(message)
        self.parameter = parameter


class Parameter:
    """Declaration of a parameter; see opc_parameter in opcflow/plugin.h."""

    def __init__(self, type, summary, preset=None, required=False, no_effect=False, **fields):
        self.fields = {"type": type, "summary": summary}
        if preset is not None:
            self.fields["preset"] = preset if isinstance(preset, str) else repr(preset)
        flags = ["required"] * required + ["no_effect"] * no_effect
        for name, side in (("at_least", "min"), ("above", "min"), ("at_most", "max"),
                           ("below", "max")):
            bound = fields.pop(name, None)
            if bound is not None:
                flags.append(name)
                self.fields[side] = float(bound)
        self.fields["flags"] = flags
        self.fields.update({k: v for k, v in fields.items() if v is not None})

    def __set_name__(self, owner, name):
        self.name = name

    def __get__(self, instance, owner=None):
        return self if instance is None else instance.__dict__.get(self.name)

    def __set__(self, instance, value):
        instance.__dict__[self.name] = value

    def describe(self):
        """Return the declaration as a dictionary."""
        return {"name": self.fields.get("name", self.name), **self.fields}


def real(summary, unit=None, preset=None, follows=None, **options):
    """Declare a number in `unit`. Options: required, at_least, above, at_most, below, no_effect,
    former, and name, which sets another name in flows. `follows` is an expression of the
    scanner, such as "0.311 lambda/NA"."""
    return Parameter("real", summary, preset, unit=unit, follows=follows, **options)


def integer(summary, preset=None, **options):
    """Declare an integer, with the options of real."""
    return Parameter("int", summary, preset, **options)


def boolean(summary, preset=None, **options):
    """Declare a truth value."""
    if isinstance(preset, bool):
        preset = str(preset).lower()
    return Parameter("bool", summary, preset, **options)


def choice(summary, choices, preset=None, **options):
    """Declare one word of the sequence `choices`."""
    return Parameter("choice", summary, preset, choices="|".join(choices), **options)


def text(summary, preset=None, **options):
    """Declare a text."""
    return Parameter("text", summary, preset, **options)


def file(summary, **options):
    """Declare an existing file; the value is the path."""
    return Parameter("file", summary, **options)


def output(summary, preset=None, **options):
    """Declare the name of a file in the run folder, for Step.output_path."""
    return Parameter("output", summary, preset, **options)


def reals(summary, unit=None, preset=None, **options):
    """Declare a list of numbers in `unit`."""
    return Parameter("reals", summary, preset, unit=unit, **options)


def mapping(summary, choices=None, preset=None, **options):
    """Declare a dictionary of texts. `choices`: allowed keys."""
    return Parameter("map", summary, preset, choices="|".join(choices) if choices else None,
                     **options)


def metric(summary, unit=None, better=None, tolerance=0.0):
    """Declare a metric of a step. `better` is "lower", "higher" or None."""
    return Metric(summary, unit, better, tolerance)


class Metric:
    """Declaration of a metric; see opc_metric in opcflow/plugin.h."""

    def __init__(self, summary, unit, better, tolerance):
        self.fields = {"summary": summary, "unit": unit, "better": better, "tolerance": tolerance}

    def __set_name__(self, owner, name):
        self.name = name

    def describe(self):
        """Return the declaration as a dictionary."""
        return {"name": self.name, **self.fields}
