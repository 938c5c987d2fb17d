"""An indentation that can be run, in any dimension, with a clock or without."""

from __future__ import annotations

from tactsim.experiments.indentation.setup import IndentationSetup
from tactsim.interfaces.run import Course, Findings


class PressingSetup(IndentationSetup):
    """What is given, with its run and its unloaded state; what computes them is loaded when it is needed."""

    def begin(self) -> Course:
        """Press to the touch of the inner sensor or to the end; see ``IndentationRecord`` for what is reported."""
        from tactsim.experiments.indentation.course import indentation_course

        return indentation_course(self)

    def unloaded(self) -> Findings:
        """The tissue and the body at first touch."""
        from tactsim.experiments.indentation.course import unloaded_indentation

        return unloaded_indentation(self)
